use super::covariances;
use ellipsoid_slam::graph::{Noise, NoiseError};
use nalgebra::{Matrix2, Matrix3, SMatrix, Vector2};
use proptest::prelude::*;

#[test]
fn errors_come_out_in_sigmas() {
    let noise = Noise::from_sigmas([0.1, 2.0]).unwrap();
    assert!((noise.whiten(&Vector2::new(0.3, 4.0)) - Vector2::new(3.0, 2.0)).norm() < 1e-12);
    // Correlated by 0.6: knowing that the first is 1 sigma off, the second is 0.6 sigma off with a sigma of 0.8.
    let noise = Noise::from_covariance(&Matrix2::new(1.0, 0.6, 0.6, 1.0)).unwrap();
    assert!((noise.whiten(&Vector2::new(1.0, 1.4)) - Vector2::new(1.0, 1.0)).norm() < 1e-12);
    let twice = noise.scaled(4.0).unwrap();
    assert!((twice.whiten(&Vector2::new(1.0, 1.4)) - Vector2::new(2.0, 2.0)).norm() < 1e-12);
}

#[test]
fn what_is_wrong_is_named() {
    let good = Matrix3::<f64>::identity();
    let with = |row: usize, column: usize, value: f64| {
        let mut covariance = good;
        covariance[(row, column)] = value;
        Noise::from_covariance(&covariance).unwrap_err()
    };
    let infinite = f64::INFINITY;
    assert_eq!(with(2, 1, infinite), NoiseError::NotFinite { row: 2, column: 1, value: infinite });
    assert!(matches!(with(0, 2, f64::NAN), NoiseError::NotFinite { row: 0, column: 2, .. }));
    assert!(
        matches!(with(0, 1, 0.5), NoiseError::NotSymmetric { difference, .. } if difference.abs() == 0.5)
    );
    assert_eq!(with(1, 1, 0.0), NoiseError::NotPositiveDefinite);
    assert_eq!(with(1, 1, -2.0), NoiseError::NotPositiveDefinite);
    let zero = Noise::from_sigmas([1.0, 0.0]).unwrap_err();
    assert_eq!(zero, NoiseError::Sigma { index: 1, value: 0.0 });
    assert_eq!(zero.to_string(), "standard deviation 1 is 0, which is not a positive number");
    let noise = Noise::from_sigmas([1.0]).unwrap();
    assert_eq!(noise.scaled(0.0).unwrap_err(), NoiseError::Scale { scale: 0.0 });
}

proptest! {
    #[test]
    fn the_square_root_squares_to_the_information(covariance in covariances::<9>()) {
        let root = *Noise::from_covariance(&covariance).unwrap().square_root_information();
        let back = covariance * root.transpose() * root;
        prop_assert!((back - SMatrix::<f64, 9, 9>::identity()).norm() < 1e-9);
        prop_assert_eq!(root, root.lower_triangle());
    }
}
