use super::{ROUNDING, planes, points, poses};
use ellipsoid_slam::geometry::{Plane, Pose};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

#[test]
fn the_floor_seen_from_a_camera() {
    // z up in the world; the camera is 1.5 m above the floor and looks along the world's x: its y points down.
    let floor = Plane::through(&Point3::origin(), Vector3::z_axis());
    let columns =
        [-Vector3::y_axis(), -Vector3::z_axis(), Vector3::x_axis()].map(|c| c.into_inner());
    let rotation = UnitQuaternion::from_basis_unchecked(&columns);
    let world_from_camera = Pose::from_parts(Translation3::new(0.0, 0.0, 1.5), rotation);
    let in_camera = floor.transformed(&world_from_camera.inverse());
    assert!((in_camera.normal.into_inner() + Vector3::y()).norm() < ROUNDING, "up is -y");
    assert!((in_camera.offset - 1.5).abs() < ROUNDING, "the camera is on the positive side");
    assert!((floor.signed_distance(&Point3::new(3.0, 4.0, 0.2)) - 0.2).abs() < ROUNDING);
}

proptest! {
    #[test]
    fn distances_stay_when_all_is_moved(plane in planes(), point in points(), a_from_b in poses()) {
        let there = plane.transformed(&a_from_b).signed_distance(&(a_from_b * point));
        prop_assert!((there - plane.signed_distance(&point)).abs() < ROUNDING);
    }

    #[test]
    fn moving_there_and_back_changes_nothing(plane in planes(), a_from_b in poses()) {
        let back = plane.transformed(&a_from_b).transformed(&a_from_b.inverse());
        prop_assert!((back.normal.into_inner() - plane.normal.into_inner()).norm() < ROUNDING);
        prop_assert!((back.offset - plane.offset).abs() < ROUNDING);
    }

    #[test]
    fn a_mirror_image_is_as_far_on_the_other_side(plane in planes(), point in points()) {
        let image = plane.mirrored(&point);
        prop_assert!((plane.signed_distance(&image) + plane.signed_distance(&point)).abs() < ROUNDING);
        prop_assert!(plane.normal.cross(&(image - point)).norm() < ROUNDING, "along the normal");
        prop_assert!((plane.mirrored(&image) - point).norm() < ROUNDING, "an involution");
    }

    #[test]
    fn mirroring_keeps_distances(plane in planes(), a in points(), b in points()) {
        let apart = (plane.mirrored(&a) - plane.mirrored(&b)).norm();
        prop_assert!((apart - (a - b).norm()).abs() < ROUNDING);
    }
}
