use super::{cost, ids, outlines};
use crate::geometry::{poses, upright_pose};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose},
    graph::{
        BoxError, BoxObservation, BoxSide, Factor, NoiseError,
        Variable::{Ellipsoid as Body, Pose as Place},
    },
};
use nalgebra::{DVector, Vector3};
use proptest::prelude::*;

fn side(at: f64) -> Option<BoxSide> {
    Some(BoxSide { at, sigma: 0.01 })
}

fn observation(outline: Outline, sides: [Option<BoxSide>; 4]) -> BoxObservation {
    let (pose, _, object) = ids();
    BoxObservation::new(pose, object, Pose::identity(), outline, sides).unwrap()
}

/// Residual of a body in the camera's frame.
fn residual(factor: &BoxObservation, body: Ellipsoid) -> DVector<f64> {
    factor.residual(&[Place(Pose::identity()), Body(body)])
}

/// A cube with an edge of 1 m whose near face is 1.5 m away: its corners are at 0.5 / 1.5.
fn cube() -> Ellipsoid {
    Ellipsoid::new(Pose::translation(0.0, 0.0, 2.0), Vector3::repeat(0.5))
}

#[test]
fn a_cube_by_hand() {
    let third = 1.0 / 3.0;
    let sides = [side(-third - 0.02), side(-third), side(third + 0.01), side(third)];
    let got = residual(&observation(Outline::Cuboid, sides), cube());
    // Predicted minus measured: the left side is 0.02 right of the measured one.
    assert!((got - DVector::from_vec(vec![2.0, 0.0, -1.0, 0.0])).norm() < 1e-9);
    // A ball inside it is seen under asin(0.5 / 2).
    let tangent = 0.25_f64.asin().tan();
    let sides = [side(-tangent), side(-tangent), side(tangent), side(tangent)];
    assert!(residual(&observation(Outline::Ellipsoid, sides), cube()).norm() < 1e-9);
    assert!(tangent < third, "the ellipse of a cube is smaller than its box");
}

#[test]
fn a_camera_on_a_robot() {
    // The camera looks along the robot's x axis: its z is x, its x is -y, its y is -z.
    let rotation = nalgebra::UnitQuaternion::from_basis_unchecked(&[
        -Vector3::y(),
        -Vector3::z(),
        Vector3::x(),
    ]);
    let base_from_camera = Pose::from_parts(Vector3::new(0.2, 0.0, 1.0).into(), rotation);
    let (pose, _, object) = ids();
    let sides = [None, None, side(0.5 / 1.5), None];
    let factor =
        BoxObservation::new(pose, object, base_from_camera, Outline::Cuboid, sides).unwrap();
    let base = upright_pose(0.0, Vector3::new(5.0, 5.0, 0.0));
    let body = |y: f64| Ellipsoid::new(Pose::translation(7.2, y, 1.0), Vector3::repeat(0.5));
    assert!(factor.residual(&[Place(base), Body(body(5.0))]).norm() < 1e-9);
    // To the robot's left is to the left in the image, where the right side has smaller coordinates.
    let moved = factor.residual(&[Place(base), Body(body(5.15))]);
    assert!((moved[0] - -0.1 / 0.01).abs() < 1e-9, "{moved}");
}

#[test]
fn cut_sides_are_no_measurements() {
    let factor = observation(Outline::Cuboid, [None, side(0.0), None, side(0.3)]);
    let got = residual(&factor, cube());
    assert_eq!(got.len(), 2);
    assert!((got[0] - -100.0 / 3.0).abs() < 1e-9 && (got[1] - 10.0 / 3.0).abs() < 1e-9, "{got}");
    let linear = factor.linearize(&[Place(Pose::identity()), Body(cube())]);
    assert_eq!(linear.jacobian.shape(), (2, 15));
}

#[test]
fn what_is_wrong_with_a_box_is_named() {
    let (pose, _, object) = ids();
    let made = |sides| {
        BoxObservation::new(pose, object, Pose::identity(), Outline::Cuboid, sides).unwrap_err()
    };
    assert_eq!(made([None; 4]), BoxError::NoSides);
    let at = f64::INFINITY;
    assert_eq!(made([side(0.0), side(at), None, None]), BoxError::NotFinite { side: 1, at });
    let blurred = Some(BoxSide { at: 0.0, sigma: 0.0 });
    assert_eq!(
        made([None, None, blurred, None]),
        BoxError::Noise(NoiseError::Sigma { index: 2, value: 0.0 })
    );
}

/// An optimiser that starts with an object behind the camera has to find the way out.
#[test]
fn the_derivative_leads_out_from_behind_the_camera() {
    let sides = [side(-0.3), side(-0.3), side(0.3), side(0.3)];
    for outline in [Outline::Ellipsoid, Outline::Cuboid, Outline::Cylinder] {
        let factor = observation(outline, sides);
        let at = |z: f64| {
            let body = Ellipsoid::new(Pose::translation(0.1, 0.05, z), Vector3::repeat(0.3));
            [Place(Pose::identity()), Body(body)]
        };
        for z in [-3.0, -1.0, -0.3, 0.0, 0.2, 0.5] {
            let linear = factor.linearize(&at(z));
            let slope = (linear.residual.transpose() * &linear.jacobian)[(0, 11)];
            assert!(slope < 0.0, "{outline:?} at {z} m: forward costs {slope}");
            assert!(linear.jacobian.iter().all(|v| v.is_finite()));
            assert!(cost(&factor, &at(z)) > cost(&factor, &at(2.0)));
        }
    }
}

proptest! {
    #[test]
    fn where_the_map_has_its_origin_does_not_matter(
        x in poses(), camera in poses(), motion in poses(), outline in outlines(),
    ) {
        let (pose, _, object) = ids();
        let sides = [side(-0.3), side(-0.1), side(0.4), side(0.2)];
        let factor = BoxObservation::new(pose, object, camera, outline, sides).unwrap();
        let body = cube().transformed(&(x * camera));
        let here = cost(&factor, &[Place(x), Body(body)]);
        let there = cost(&factor, &[Place(motion * x), Body(body.transformed(&motion))]);
        prop_assert!((here - there).abs() < 1e-6 * (1.0 + here));
    }
}
