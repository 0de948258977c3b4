//! Image boxes of bodies against other ways to compute them.

use super::{ROUNDING, poses, vectors};
use crate::graph::outlines;
use ellipsoid_slam::geometry::{
    Ellipsoid, ImageSide, NEAR_M, OrientedBox, Outline, Pose, Silhouette,
};
use nalgebra::{Matrix3, Matrix3x4, Point3, Vector3, Vector4};
use proptest::prelude::*;

/// Left, upper, right and lower side.
fn sides(body: &Ellipsoid, outline: Outline) -> [f64; 4] {
    let silhouette = Silhouette::new(body, outline);
    ImageSide::ALL.map(|side| silhouette.tangent(side, 0.0).at)
}

/// Bodies that are before the camera altogether.
fn visible_bodies() -> impl Strategy<Value = Ellipsoid> {
    let sizes = (0.05..0.5, 0.05..0.5, 0.05..0.5);
    (poses(), vectors(2.0), 1.0..5.0, sizes).prop_map(|(turned, aside, depth, (a, b, c))| {
        let center = Vector3::new(aside.x, aside.y, depth);
        let pose = Pose::from_parts(center.into(), turned.rotation);
        Ellipsoid::new(pose, Vector3::new(a, b, c))
    })
}

proptest! {
    /// `C* = P Q* P^T`, Liao et al. 2020, eq. (3): the line `u` touches the ellipse if `l^T C* l = 0`.
    #[test]
    fn an_ellipsoid_ends_where_its_dual_conic_does(body in visible_bodies()) {
        let p = Matrix3x4::<f64>::identity();
        let c: Matrix3<f64> = p * body.dual_quadric() * p.transpose();
        for (axis, low, high) in [(0, 0, 2), (1, 1, 3)] {
            // c33 u^2 - 2 c13 u + c11 = 0, with c33 negative.
            let (square, linear, constant) = (c[(2, 2)], c[(axis, 2)], c[(axis, axis)]);
            let root = (linear * linear - square * constant).sqrt();
            let got = sides(&body, Outline::Ellipsoid);
            prop_assert!((got[low] - (linear + root) / square).abs() < ROUNDING);
            prop_assert!((got[high] - (linear - root) / square).abs() < ROUNDING);
        }
    }

    #[test]
    fn a_cuboid_ends_at_its_outermost_corners(body in visible_bodies()) {
        let corners = OrientedBox::from(&body).corners();
        prop_assume!(corners.iter().all(|c| c.z > NEAR_M));
        let extreme = |axis: usize, sign: f64| {
            sign * corners.iter().map(|c| sign * c[axis] / c.z).fold(f64::MIN, f64::max)
        };
        let expected = [extreme(0, -1.0), extreme(1, -1.0), extreme(0, 1.0), extreme(1, 1.0)];
        for (got, expected) in sides(&body, Outline::Cuboid).iter().zip(expected) {
            prop_assert!((got - expected).abs() < 1e-12 * (1.0 + expected.abs()));
        }
    }

    /// Also for bodies that reach behind the camera on the other side.
    #[test]
    fn no_point_of_a_body_is_outside(
        body in visible_bodies(), outline in outlines(), back in 0.0..4.0,
        directions in prop::collection::vec(super::directions(), 40), guess in -3.0..3.0,
    ) {
        let mut body = body;
        body.pose.translation.z -= back;
        let silhouette = Silhouette::new(&body, outline);
        for (side, axis, sign) in [
            (ImageSide::Left, 0, -1.0),
            (ImageSide::Upper, 1, -1.0),
            (ImageSide::Right, 0, 1.0),
            (ImageSide::Lower, 1, 1.0),
        ] {
            let tangent = silhouette.tangent(side, guess);
            let steepest = tangent.at.abs().max(10.0).hypot(1.0) / NEAR_M;
            prop_assert!(tangent.at.is_finite() && tangent.gradient.norm() < steepest + ROUNDING);
            for direction in &directions {
                let point = direction.component_mul(&body.semi_axes);
                let point = point / outline.radius(&point.component_div(&body.semi_axes));
                let seen = body.pose * Point3::from(point);
                if seen.z > NEAR_M {
                    let at = sign * seen[axis] / seen.z;
                    prop_assert!(at < sign * tangent.at + ROUNDING * (1.0 + at.abs()), "{side:?}");
                }
            }
            // A contact is a point of the body, and where there is a tangent it is seen on it.
            let contact = body.pose * Point3::from(tangent.contact);
            let is_tangent = (contact[axis] - tangent.at * contact.z).abs() < 1e-7;
            prop_assert!(is_tangent || sign * tangent.at > sign * contact[axis] / contact.z.max(NEAR_M) - 1e-7);
            let radius = outline.radius(&tangent.contact.component_div(&body.semi_axes));
            prop_assert!(radius < 1.0 + ROUNDING);
        }
    }

    #[test]
    fn where_it_is_looked_for_does_not_matter(
        body in visible_bodies(), outline in outlines(), back in 0.0..4.0, guess in -5.0..5.0,
    ) {
        let mut body = body;
        body.pose.translation.z -= back;
        let silhouette = Silhouette::new(&body, outline);
        for side in ImageSide::ALL {
            let (a, b) = (silhouette.tangent(side, 0.0).at, silhouette.tangent(side, guess).at);
            prop_assert!((a - b).abs() < 1e-8 * (1.0 + a.abs()), "{side:?}: {a} and {b}");
        }
    }
}

/// A box round the camera has no sides, and the less the farther back it is.
#[test]
fn behind_the_camera_sides_are_far_out_and_go_farther() {
    for outline in [Outline::Ellipsoid, Outline::Cuboid, Outline::Cylinder] {
        let at = |z: f64| {
            let body = Ellipsoid::new(Pose::translation(0.1, 0.0, z), Vector3::new(0.3, 0.4, 0.3));
            sides(&body, outline)
        };
        let mut last = at(0.3);
        for step in 1..60 {
            let now = at(0.3 - 0.05 * f64::from(step));
            for side in 0..4 {
                let sign = if side < 2 { -1.0 } else { 1.0 };
                assert!(
                    sign * now[side] > sign * last[side],
                    "{outline:?}: {now:?} after {last:?}"
                );
                assert!(sign * now[side] > 4.0);
            }
            last = now;
        }
    }
}

/// At 1 cm before the camera a corner is seen far out, and a small motion would move it a long way.
#[test]
fn what_is_too_near_is_taken_to_be_farther() {
    let cube = Ellipsoid::new(Pose::translation(0.3, 0.0, 0.11), Vector3::repeat(0.1));
    let tangent = Silhouette::new(&cube, Outline::Cuboid).tangent(ImageSide::Right, 0.0);
    // Not at 0.4 / 0.01: from 10 on it goes at a slope of 1 / 0.05.
    assert!((tangent.at - (10.0 + (0.4 - 10.0 * 0.01) / 0.05)).abs() < 1e-12, "{}", tangent.at);
    assert!((tangent.gradient - Vector3::new(20.0, 0.0, -200.0)).norm() < 1e-9);
}

/// A long table under a camera at its middle: its far end and the far corners are seen, its near end is not.
#[test]
fn what_is_seen_of_a_body_that_reaches_behind_the_camera_is_exact() {
    let table = Ellipsoid::new(Pose::translation(0.0, 0.8, 0.5), Vector3::new(0.4, 0.1, 1.5));
    let [_, upper, _, lower] = sides(&table, Outline::Cuboid);
    // Its top is at y = 0.7 and ends 2 m ahead.
    assert!((upper - 0.35).abs() < 1e-12, "{upper}");
    assert!(lower > 10.0, "{lower}");
    let plane = Vector4::new(0.0, -1.0, upper, 0.0);
    let quadric = table.dual_quadric();
    assert!((plane.transpose() * quadric * plane)[0] < 0.0, "the ellipsoid is smaller");
}
