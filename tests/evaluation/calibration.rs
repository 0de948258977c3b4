//! Errors in units of their covariance.

use ellipsoid_slam::{
    eval::{
        Calibration, EstimatedObject, GroundTruth, NormalisedError, ObjectScores, TrueObject,
        evaluate,
    },
    geometry::{Ellipsoid, Pose},
};
use nalgebra::{SMatrix, SVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_2;

type Covariance = SMatrix<f64, 9, 9>;

fn score(pairs: Vec<(Ellipsoid, Covariance, Ellipsoid)>) -> ObjectScores {
    let (mut map, mut objects) = (Vec::new(), Vec::new());
    for (id, (ellipsoid, covariance, truth)) in (1..).zip(pairs) {
        map.push(EstimatedObject { id, label: "tv".into(), ellipsoid, covariance });
        objects.push(TrueObject {
            id,
            label: "tv".into(),
            pose: truth.pose,
            size: truth.semi_axes * 2.0,
            observations: 9,
        });
    }
    evaluate(&map, &GroundTruth { frame_id: "map".into(), objects })
}

fn diagonal(sigmas: [f64; 9]) -> Covariance {
    Covariance::from_diagonal(&SVector::from(sigmas).map(|s| s * s))
}

const SIGMAS: [f64; 9] = [0.3, 0.3, 0.05, 0.1, 0.4, 0.2, 0.1, 0.2, 0.3];

#[test]
fn each_part_has_its_own_error() {
    let estimate = Ellipsoid::new(
        Pose::new(Vector3::new(1.0, 2.0, 3.0), Vector3::z() * FRAC_PI_2),
        Vector3::new(0.5, 0.2, 0.4),
    );
    let cases: [([f64; 9], [f64; 3]); 3] = [
        // Two standard deviations of the heading.
        ([0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], [4.0, 0.0, 0.0]),
        // One of the height and one of the depth along the object's own y axis.
        ([0.0, 0.0, 0.0, 0.0, -0.4, 0.2, 0.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
        // Three of the height of the body.
        ([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.9], [0.0, 0.0, 9.0]),
    ];
    for (delta, [heading, center, size]) in cases {
        let truth = estimate.retract(&SVector::from(delta));
        for quarters in 0..4 {
            let named = truth.quarter_turned(quarters);
            let scores = score(vec![(estimate, diagonal(SIGMAS), named)]);
            let per = |c: &Calibration| c.mean_nees_per_dimension.unwrap();
            let near = |got: f64, expected: f64| {
                assert!((got - expected).abs() < 1e-9, "{got} {expected}")
            };
            near(per(&scores.heading_calibration), heading);
            near(per(&scores.center_calibration), center / 3.0);
            near(per(&scores.size_calibration), size / 3.0);
            near(scores.matches[0].normalised.unwrap().nees, heading + center + size);
            assert_eq!(scores.matches[0].normalised.unwrap().dimensions, 7);
        }
    }
}

#[test]
fn correlations_have_a_sign_in_the_objects_frame() {
    let pose = Pose::new(Vector3::zeros(), Vector3::z() * FRAC_PI_2);
    let estimate = Ellipsoid::new(pose, Vector3::new(0.5, 0.2, 0.4));
    let mut covariance = diagonal([0.1, 0.1, 0.1, 0.1, 0.2, 0.1, 0.1, 0.1, 0.1]);
    covariance[(4, 5)] = 0.01;
    covariance[(5, 4)] = 0.01;
    // The map's +x is the object's -y: the error there is (-0.2, 0.1) in y and z, against the correlation.
    let truth = Ellipsoid::new(Pose::translation(0.2, 0.0, 0.1) * pose, estimate.semi_axes);
    let nees = score(vec![(estimate, covariance, truth)]).matches[0].normalised.unwrap().nees;
    assert!((nees - 4.0).abs() < 1e-9, "{nees}");
    let truth = Ellipsoid::new(Pose::translation(-0.2, 0.0, 0.1) * pose, estimate.semi_axes);
    let nees = score(vec![(estimate, covariance, truth)]).matches[0].normalised.unwrap().nees;
    assert!((nees - 4.0 / 3.0).abs() < 1e-9, "{nees}");
}

#[test]
fn a_round_object_has_no_heading_to_be_wrong_about() {
    let estimate = Ellipsoid::new(Pose::identity(), Vector3::new(0.5, 0.5, 0.4));
    let truth = Ellipsoid::new(Pose::rotation(Vector3::z() * 0.5), estimate.semi_axes);
    let scores = score(vec![(estimate, diagonal(SIGMAS), truth)]);
    assert_eq!(scores.heading_calibration.objects, 0);
    let all = scores.matches[0].normalised.unwrap();
    assert!(all.dimensions == 6 && all.nees < 1e-9, "{all:?}");
}

#[test]
fn coverage_is_read_from_chi_square() {
    let error = |nees: f64, dimensions: usize| NormalisedError { nees, dimensions };
    let one = Calibration::new(&[0.4, 2.6, 6.5, 6.7].map(|nees| error(nees, 1)));
    assert_eq!((one.within_50, one.within_90, one.within_99), (Some(0.25), Some(0.5), Some(0.75)));
    // The same number is a small error in seven dimensions.
    let seven = Calibration::new(&[0.4, 2.6, 6.5, 6.7].map(|nees| error(nees, 7)));
    assert_eq!((seven.within_50, seven.within_90), (Some(0.5), Some(1.0)));
    assert!((seven.mean_nees_per_dimension.unwrap() - 16.2 / 28.0).abs() < 1e-12);
}

#[test]
fn errors_drawn_from_the_covariance_are_calibrated() {
    const OBJECTS: usize = 300;
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut unit = || random.random_range(-1.0..1.0_f64);
    let mut pairs = Vec::new();
    for index in 0..OBJECTS {
        // A covariance with all correlations, and an error drawn from it.
        let mixing = Covariance::from_fn(|_, _| unit()) * 0.02 + Covariance::identity() * 0.02;
        // Twelve uniform draws of variance 1/3, over two, are nearly normal.
        let normal = SVector::<f64, 9>::from_fn(|_, _| (0..12).map(|_| unit()).sum::<f64>() / 2.0);
        let place = Vector3::new((index % 20) as f64 * 3.0, (index / 20) as f64 * 3.0, 0.0);
        let pose = Pose::new(place, Vector3::z() * 3.0 * unit());
        let estimate = Ellipsoid::new(pose, Vector3::new(0.6, 0.3, 0.4));
        let truth = estimate.retract(&(mixing * normal));
        pairs.push((estimate, mixing * mixing.transpose(), truth));
    }
    let scores = score(pairs);
    for part in [
        scores.heading_calibration,
        scores.center_calibration,
        scores.size_calibration,
        scores.calibration,
    ] {
        assert_eq!(part.objects, OBJECTS);
        // Three standard errors: 0.087 of a half, 0.052 of nine tenths, 0.25 of the mean in one dimension.
        let mean = part.mean_nees_per_dimension.unwrap();
        assert!((mean - 1.0).abs() < 0.25, "{part:?}");
        assert!((part.within_50.unwrap() - 0.5).abs() < 0.087, "{part:?}");
        assert!((part.within_90.unwrap() - 0.9).abs() < 0.052, "{part:?}");
        assert!(part.within_99.unwrap() > 0.97, "{part:?}");
    }
}
