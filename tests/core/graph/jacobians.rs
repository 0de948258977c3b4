//! Every factor's derivative against central differences.

use super::{assert_linearization, covariances, ids, outlines};
use crate::geometry::{directions, ellipsoids, planes, points, poses, vectors, walls};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose},
    graph::{
        BoxObservation, BoxSide, EllipsoidObservation, EllipsoidPrior, Factor, Noise, PosePrior,
        RelativePose, RightAngle, SizePrior, SupportContact, Upright,
        Variable::{Ellipsoid as Body, Pose as Place, Wall as Side},
        VariableIds, WallObservation,
    },
};
use nalgebra::{SVector, Translation3, Vector2, Vector3};
use proptest::{array::uniform9, prelude::*};
use std::f64::consts::FRAC_PI_2;

/// Errors as estimates have them, and much larger ones.
fn errors() -> impl Strategy<Value = SVector<f64, 9>> {
    (uniform9(-0.9..0.9), 0.0..1.0).prop_map(|(e, size)| SVector::<f64, 9>::from(e) * size)
}

/// A box whose left, upper, right and lower side is measured, or some of them.
fn boxes() -> impl Strategy<Value = [Option<BoxSide>; 4]> {
    let side = |at: f64| {
        let near = (at - 0.2..at + 0.2, 0.002..0.1);
        prop::option::weighted(0.8, near.prop_map(|(at, sigma)| BoxSide { at, sigma }))
    };
    (side(-0.2), side(-0.2), side(0.2), side(0.2))
        .prop_map(|(left, upper, right, lower)| [left, upper, right, lower])
        .prop_filter("no side", |sides| sides.iter().any(Option::is_some))
}

/// Objects before a camera, near its plane and behind it.
fn bodies_in_camera() -> impl Strategy<Value = Ellipsoid> {
    let center = (-1.0..1.0, -1.0..1.0, -0.5..4.0);
    let sizes = (0.05..0.6, 0.05..0.6, 0.05..0.6);
    (poses(), center, sizes).prop_map(|(turned, (x, y, z), (a, b, c))| {
        let pose = Pose::from_parts(Translation3::new(x, y, z), turned.rotation);
        Ellipsoid::new(pose, Vector3::new(a, b, c))
    })
}

proptest! {
    #[test]
    fn pose_prior(prior in poses(), e in errors(), covariance in covariances::<6>()) {
        let noise = Noise::from_covariance(&covariance).unwrap();
        let factor = PosePrior::new(ids().0, prior, noise);
        let at = Place(prior).retract(&e.as_slice()[..6]);
        assert_linearization(&factor, &[at]);
    }

    /// Away from where the two names of the horizontal axes fit equally well: there the cost has a ridge.
    #[test]
    fn size_prior(body in ellipsoids(), long in 1.0..3.0f64, height in 0.2..2.0f64) {
        let s = body.semi_axes;
        prop_assume!((s.x / s.y).ln().abs() > 0.01);
        let usual = Vector3::new(0.5 * long, 0.5, height);
        let factor = SizePrior::new(ids().2, usual, [0.3, 0.2]).unwrap();
        assert_linearization(&factor, &[Body(body)]);
    }

    #[test]
    fn ellipsoid_prior(prior in ellipsoids(), e in errors(), covariance in covariances::<9>()) {
        let noise = Noise::from_covariance(&covariance).unwrap();
        let factor = EllipsoidPrior::new(ids().2, prior, noise);
        assert_linearization(&factor, &[Body(prior.retract(&e))]);
    }

    #[test]
    fn relative_pose(
        i in poses(), step in poses(), e in errors(), covariance in covariances::<6>(),
    ) {
        let noise = Noise::from_covariance(&covariance).unwrap();
        let factor = RelativePose::new(ids().0, ids().1, &step, noise);
        let j = Place(i * step).retract(&e.as_slice()[..6]);
        assert_linearization(&factor, &[Place(i), j]);
    }

    #[test]
    fn ellipsoid_observation(
        x in poses(), measured in ellipsoids(), e in errors(), quarters in 0_i64..4,
        upside_down in any::<bool>(), covariance in covariances::<9>(), outline in outlines(),
    ) {
        let (pose, _, object) = ids();
        let factor =
            EllipsoidObservation::new(pose, object, measured, &covariance, outline).unwrap();
        let mut named = measured.retract(&e).quarter_turned(quarters);
        if upside_down {
            named.pose *= Pose::rotation(Vector3::x() * std::f64::consts::PI);
        }
        assert_linearization(&factor, &[Place(x), Body(named.transformed(&x))]);
    }

    #[test]
    fn box_observation(
        x in poses(), pose_from_camera in poses(), body in bodies_in_camera(), sides in boxes(),
        outline in outlines(),
    ) {
        let (pose, _, object) = ids();
        let factor =
            BoxObservation::new(pose, object, pose_from_camera, outline, sides).unwrap();
        let in_map = body.transformed(&(x * pose_from_camera));
        assert_linearization(&factor, &[Place(x), Body(in_map)]);
    }

    #[test]
    fn support_contact(plane in planes(), body in ellipsoids(), outline in outlines()) {
        let factor = SupportContact::new(ids().2, outline, plane, 0.02).unwrap();
        assert_linearization(&factor, &[Body(body)]);
    }

    #[test]
    fn wall_observation(
        x in poses(), wall in walls(), center in points(), normal in directions(),
    ) {
        let mut ids = VariableIds::default();
        let tied = (ids.next_pose(), ids.next_wall());
        let seen = (center, normal.into_inner());
        let factor = WallObservation::new(tied, seen, [0.01, 0.02]).unwrap();
        assert_linearization(&factor, &[Place(x), Side(wall)]);
    }

    #[test]
    fn right_angle(a in walls(), e in -0.9..0.9, shift in -2.0..2.0, quarters in -1_i8..3) {
        let mut ids = VariableIds::default();
        let factor = RightAngle::new(ids.next_wall(), ids.next_wall(), quarters, 0.01).unwrap();
        let b = a.turned(f64::from(quarters) * FRAC_PI_2).retract(&Vector2::new(e, shift));
        assert_linearization(&factor, &[Side(a), Side(b)]);
        let (off, expected) = (factor.residual(&[Side(a), Side(b)])[0] * 0.01, e);
        prop_assert!((off - expected).abs() < 1e-9, "{off} instead of {expected}");
    }

    #[test]
    fn upright(pose in poses(), semi_axes in vectors(1.0)) {
        let (place, _, object) = ids();
        assert_linearization(&Upright::new(place, 0.02).unwrap(), &[Place(pose)]);
        let body = Ellipsoid::new(pose, semi_axes.map(|s| s.abs() + 0.01));
        assert_linearization(&Upright::new(object, 0.02).unwrap(), &[Body(body)]);
    }
}
