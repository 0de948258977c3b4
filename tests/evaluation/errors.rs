//! The measures of one object.

use ellipsoid_slam::{
    eval::{ObjectError, rotation_error_deg, shape_error},
    geometry::{OrientedBox, Pose},
};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// A box of full extents `size`, turned about the vertical by `yaw_deg`.
fn upright(center: [f64; 3], yaw_deg: f64, size: [f64; 3]) -> OrientedBox {
    let pose = Pose::new(center.into(), Vector3::z() * yaw_deg.to_radians());
    OrientedBox { pose, half_extents: Vector3::from(size) * 0.5 }
}

fn assert_near(got: f64, expected: f64) {
    assert!((got - expected).abs() < 1e-12, "{got} instead of {expected}");
}

/// All 24 rotations of a cube, as products of quarter turns.
fn cube_rotations() -> Vec<Matrix3<f64>> {
    let x = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0);
    let z = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let mut all = vec![Matrix3::identity()];
    let mut next = 0;
    while next < all.len() {
        for turn in [x, z] {
            let product = all[next] * turn;
            if !all.contains(&product) {
                all.push(product);
            }
        }
        next += 1;
    }
    assert_eq!(all.len(), 24);
    all
}

/// The same box with its axes named otherwise.
fn renamed(body: &OrientedBox, old_from_new: &Matrix3<f64>) -> OrientedBox {
    let turn = Rotation3::from_matrix_unchecked(*old_from_new);
    OrientedBox {
        pose: body.pose * UnitQuaternion::from_rotation_matrix(&turn),
        half_extents: old_from_new.transpose().abs() * body.half_extents,
    }
}

#[test]
fn a_perfect_estimate_has_no_error() {
    let truth = upright([1.0, -2.0, 0.4], 90.0, [0.9, 0.4, 0.8]);
    let error = ObjectError::new(&truth, &truth);
    assert_near(error.translation_m, 0.0);
    assert_near(error.rotation_deg.unwrap(), 0.0);
    assert_near(error.shape, 0.0);
    assert_near(error.paper_shape, 0.0);
    assert_near(error.iou, 1.0);
}

#[test]
fn centers_are_compared_in_all_directions() {
    let truth = upright([1.0, -2.0, 0.5], 0.0, [1.0, 1.0, 1.0]);
    for (shift, distance) in
        [([0.3, 0.4, 0.0], 0.5), ([-0.3, 0.0, 0.4], 0.5), ([0.0, -0.6, 0.8], 1.0)]
    {
        let center = Vector3::new(1.0, -2.0, 0.5) + Vector3::from(shift);
        let estimate = upright(center.into(), 0.0, [1.0, 1.0, 1.0]);
        assert_near(ObjectError::new(&estimate, &truth).translation_m, distance);
    }
    // Half of a cube is common to both, of one and a half.
    let shifted = upright([1.5, -2.0, 0.5], 0.0, [1.0, 1.0, 1.0]);
    assert_near(ObjectError::new(&shifted, &truth).iou, 1.0 / 3.0);
}

#[test]
fn headings_are_compared_modulo_half_a_turn() {
    let of = |yaw: f64| upright([0.0; 3], yaw, [1.0, 0.5, 0.7]);
    let cases = [
        (170.0, -5.0, 5.0),
        (30.0, 80.0, 50.0),
        (80.0, 30.0, 50.0),
        (0.0, 180.0, 0.0),
        (-45.0, 45.0, 90.0),
        (10.0, 270.0, 80.0),
    ];
    for (estimated, actual, expected) in cases {
        let got = rotation_error_deg(&of(estimated), &of(actual)).unwrap();
        assert!((got - expected).abs() < 1e-9, "{estimated} against {actual}: {got}");
    }
    // A swap of the footprint's sides is a quarter turn.
    let swapped = upright([0.0; 3], 0.0, [0.5, 1.0, 0.7]);
    assert_near(rotation_error_deg(&swapped, &of(0.0)).unwrap(), 90.0);
}

#[test]
fn a_footprint_that_is_round_in_truth_has_no_heading() {
    let long = upright([0.0; 3], 20.0, [1.0, 0.5, 0.7]);
    let nearly_round = upright([0.0; 3], 0.0, [1.0, 0.91, 3.0]);
    let not_round = upright([0.0; 3], 0.0, [0.89, 1.0, 3.0]);
    assert_eq!(rotation_error_deg(&long, &nearly_round), None);
    assert!(rotation_error_deg(&long, &not_round).is_some());
    // How round the estimate is does not decide.
    assert!(rotation_error_deg(&nearly_round, &long).is_some());
}

#[test]
fn shapes_are_compared_at_the_origin() {
    let unit = upright([0.0; 3], 0.0, [1.0, 1.0, 1.0]);
    let twice_as_long = upright([5.0, 0.0, 0.0], 0.0, [2.0, 1.0, 1.0]);
    assert_near(shape_error(&twice_as_long, &unit), 0.5);
    assert_near(shape_error(&unit, &twice_as_long), 0.5);
    // Turned by 45 degrees, the box around a square footprint has twice its area.
    let turned = upright([0.0; 3], 45.0, [1.0, 1.0, 1.0]);
    assert_near(shape_error(&turned, &unit), 0.5);
    assert_near(shape_error(&turned, &turned), 0.0);
    // Half as high, a third wider: (1/2) / (4/3 + 1 - ...) with a common part of 1 x 1 x 1/2.
    let other = upright([0.0; 3], 0.0, [4.0 / 3.0, 1.0, 0.5]);
    assert_near(shape_error(&other, &unit), 1.0 - 0.5 / (2.0 / 3.0 + 1.0 - 0.5));
}

#[test]
fn the_papers_shape_punishes_a_perfect_estimate_of_a_turned_box() {
    let turned = upright([0.0; 3], 45.0, [4.0, 1.0, 2.0]);
    // The box around the box is (4 + 1) / sqrt(2) wide, the one around the ellipsoid sqrt((16 + 1) / 2).
    let expected = 1.0 - (17.0 / 2.0) / (25.0 / 2.0);
    assert_near(ObjectError::new(&turned, &turned).paper_shape, expected);
    // An estimate inflated to the box around the box is perfect in its eyes.
    let side = 5.0 / 2f64.sqrt();
    let inflated = upright([0.0; 3], 0.0, [side, side, 2.0]);
    assert_near(ObjectError::new(&inflated, &turned).paper_shape, 0.0);
}

#[test]
fn nothing_depends_on_how_axes_are_named() {
    let estimate = upright([1.1, 2.0, 0.5], 33.0, [0.9, 0.4, 1.3]);
    let truth = upright([1.0, 2.1, 0.45], 15.0, [0.8, 0.5, 1.2]);
    let expected = ObjectError::new(&estimate, &truth);
    assert!((expected.rotation_deg.unwrap() - 18.0).abs() < 1e-9);
    for a in cube_rotations() {
        for b in cube_rotations() {
            let error = ObjectError::new(&renamed(&estimate, &a), &renamed(&truth, &b));
            let numbers = |e: &ObjectError| {
                [e.translation_m, e.rotation_deg.unwrap(), e.shape, e.paper_shape, e.iou]
            };
            for (got, expected) in numbers(&error).into_iter().zip(numbers(&expected)) {
                assert!((got - expected).abs() < 1e-9, "{a}{b}{error:?}");
            }
        }
    }
}

#[test]
fn the_median_is_taken_measure_by_measure() {
    let error = |translation_m: f64, rotation_deg: Option<f64>| ObjectError {
        translation_m,
        rotation_deg,
        shape: 2.0 * translation_m,
        paper_shape: 3.0 * translation_m,
        iou: 1.0 - translation_m,
    };
    let odd = [error(0.3, None), error(0.1, Some(8.0)), error(0.9, Some(4.0))];
    let median = ObjectError::median(&odd).unwrap();
    assert_near(median.translation_m, 0.3);
    assert_near(median.rotation_deg.unwrap(), 6.0);
    assert_near(median.iou, 0.7);
    let median = ObjectError::median(&[error(0.1, None), error(0.2, None)]).unwrap();
    assert_near(median.shape, 0.3);
    assert_near(median.paper_shape, 0.45);
    assert_eq!(median.rotation_deg, None);
    assert_eq!(ObjectError::median(&[]), None);
}
