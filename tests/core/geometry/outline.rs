//! The support function of outlines against their surfaces.

use super::{ROUNDING, directions, semi_axes};
use crate::graph::outlines;
use ellipsoid_slam::geometry::{Ellipsoid, OrientedBox, Outline, Pose};
use nalgebra::Vector3;
use proptest::prelude::*;

#[test]
fn support_by_hand() {
    let semi_axes = Vector3::new(0.3, 0.4, 0.5);
    let direction = Vector3::new(1.0, 1.0, -2.0);
    // The direction by semi-axes is (0.3, 0.4, -1).
    for (outline, expected) in [
        (Outline::Cuboid, 1.7),
        (Outline::Cylinder, 1.5),
        (Outline::Ellipsoid, 1.25_f64.sqrt()),
        (Outline::Superquadric(1.0, 1.0), 1.25_f64.sqrt()),
        // Exponents of 2 / (2 - 1/2) = 4/3 for the footprint.
        (
            Outline::Superquadric(1.0, 0.5),
            (0.3_f64.powf(4.0 / 3.0) + 0.4_f64.powf(4.0 / 3.0)).powf(0.75).hypot(1.0),
        ),
        // Towards the rhombus: 2 / (2 - 3/2) = 4.
        (
            Outline::Superquadric(1.0, 1.5),
            (0.3_f64.powi(4) + 0.4_f64.powi(4)).powf(0.25).hypot(1.0),
        ),
    ] {
        let support = outline.support(&direction, &semi_axes);
        assert!((support.reach - expected).abs() < 1e-12, "{outline:?}: {}", support.reach);
    }
    let corner = Outline::Cuboid.support(&direction, &semi_axes).contact;
    assert!((corner - Vector3::new(0.3, 0.4, -0.5)).norm() < 1e-12);
}

#[test]
fn a_whole_face_is_touched_in_its_middle() {
    let semi_axes = Vector3::new(0.3, 0.4, 0.5);
    // A sine of rounding says nothing about which edge is touched first.
    let down = Vector3::new(1e-17, -1e-16, -1.0);
    for outline in [Outline::Cuboid, Outline::Cylinder] {
        let contact = outline.support(&down, &semi_axes).contact;
        assert!((contact - Vector3::new(0.0, 0.0, -0.5)).norm() < 1e-9, "{outline:?}: {contact}");
    }
    let nowhere = Vector3::zeros();
    for outline in
        [Outline::Ellipsoid, Outline::Cuboid, Outline::Cylinder, Outline::Superquadric(0.5, 0.5)]
    {
        let support = outline.support(&nowhere, &semi_axes);
        assert_eq!((support.reach, support.contact.norm()), (0.0, 0.0), "{outline:?}");
    }
}

#[test]
fn superquadrics_end_at_the_cuboid_and_at_the_cylinder() {
    let (semi_axes, direction) = (Vector3::new(0.3, 0.4, 0.5), Vector3::new(0.2, -0.9, 0.5));
    let reach = |outline: Outline| outline.support(&direction, &semi_axes).reach;
    // A norm with exponent 1 + 1e-3 differs from the sum by as much.
    let cuboid = reach(Outline::Superquadric(1e-3, 1e-3));
    assert!((cuboid - reach(Outline::Cuboid)).abs() < 1e-3);
    let cylinder = reach(Outline::Superquadric(1e-3, 1.0));
    assert!((cylinder - reach(Outline::Cylinder)).abs() < 1e-3);
}

#[test]
fn what_has_no_vertical_faces_is_round() {
    let [elliptic, pointed] = [1.0, 1.5].map(|footprint| Outline::Superquadric(0.5, footprint));
    let round = [Outline::Ellipsoid, Outline::Cylinder, elliptic, pointed];
    assert!(round.iter().all(|outline| outline.is_round()));
    assert!(!Outline::Cuboid.is_round() && !Outline::Superquadric(1.0, 0.5).is_round());
}

proptest! {
    #[test]
    fn the_contact_is_on_the_surface_and_reaches_farthest(
        outline in outlines(), direction in directions(), semi_axes in semi_axes(),
        others in prop::collection::vec(directions(), 30),
    ) {
        let support = outline.support(&direction, &semi_axes);
        let radius = |p: &Vector3<f64>| outline.radius(&p.component_div(&semi_axes));
        prop_assert!((radius(&support.contact) - 1.0).abs() < ROUNDING);
        prop_assert!((direction.dot(&support.contact) - support.reach).abs() < ROUNDING);
        for other in others {
            let on_surface = other.component_mul(&semi_axes);
            let on_surface = on_surface / radius(&on_surface);
            prop_assert!(direction.dot(&on_surface) < support.reach + ROUNDING);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_contact(
        outline in outlines(), direction in directions(), semi_axes in semi_axes(),
        by in directions(),
    ) {
        let contact = outline.support(&direction, &semi_axes).contact;
        let h = 1e-6;
        let reach = |d: f64, s: f64| {
            let axes = semi_axes.zip_map(&by, |axis, by| axis * (s * by).exp());
            outline.support(&(*direction + *by * d), &axes).reach
        };
        let by_direction = (reach(h, 0.0) - reach(-h, 0.0)) / (2.0 * h);
        prop_assert!((by_direction - by.dot(&contact)).abs() < 1e-5, "{by_direction}");
        let by_log_axes = (reach(0.0, h) - reach(0.0, -h)) / (2.0 * h);
        let expected = by.dot(&direction.component_mul(&contact));
        prop_assert!((by_log_axes - expected).abs() < 1e-5, "{by_log_axes} is not {expected}");
    }

    #[test]
    fn a_cuboid_reaches_as_far_as_its_corners(direction in directions(), semi_axes in semi_axes()) {
        let body = Ellipsoid::new(Pose::identity(), semi_axes);
        let corners = OrientedBox::from(&body).corners();
        let farthest = corners.iter().map(|c| direction.dot(&c.coords)).fold(f64::MIN, f64::max);
        let reach = Outline::Cuboid.support(&direction, &semi_axes).reach;
        prop_assert!((reach - farthest).abs() < ROUNDING);
    }
}
