use super::{ROUNDING, ellipsoids, planes, poses, semi_axes};
use ellipsoid_slam::geometry::{Ellipsoid, EllipsoidError, Plane, Pose};
use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};
use proptest::prelude::*;

/// What an ellipsoid is, however its axes are named: its centre and shape matrix.
fn shape(e: &Ellipsoid) -> Matrix3<f64> {
    let r = e.pose.rotation.to_rotation_matrix().into_inner();
    r * Matrix3::from_diagonal(&e.semi_axes.component_mul(&e.semi_axes)) * r.transpose()
}

/// `Q* → H Q* H^T` under a point map `H`.
fn reflection(plane: &Plane) -> Matrix4<f64> {
    let n = plane.normal.into_inner();
    let mut h = Matrix4::identity();
    h.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Matrix3::identity() - n * n.transpose() * 2.0));
    h.fixed_view_mut::<3, 1>(0, 3).copy_from(&(-n * 2.0 * plane.offset));
    h
}

#[test]
fn at_the_origin_it_is_diagonal_with_squared_semi_axes() {
    let e = Ellipsoid::new(Pose::identity(), Vector3::new(1.0, 2.0, 3.0));
    let expected = Matrix4::from_diagonal(&Vector4::new(1.0, 4.0, 9.0, -1.0));
    assert!((e.dual_quadric() - expected).norm() < ROUNDING);
}

#[test]
fn what_is_no_ellipsoid_is_refused() {
    let diagonal = |x, y, z, w| Matrix4::from_diagonal(&Vector4::new(x, y, z, w));
    for (dual, smallest) in [
        (diagonal(1.0, -4.0, 9.0, -1.0), -4.0),
        (diagonal(1.0, 0.0, 9.0, -1.0), 0.0),
        (diagonal(1.0, 4.0, 9.0, 1.0), -9.0),
    ] {
        let expected = EllipsoidError::NotAnEllipsoid { smallest };
        assert_eq!(Ellipsoid::from_dual_quadric(&dual), Err(expected));
    }
    for dual in [diagonal(1.0, 1.0, 1.0, 0.0), diagonal(f64::NAN, 1.0, 1.0, -1.0)] {
        assert_eq!(Ellipsoid::from_dual_quadric(&dual), Err(EllipsoidError::NotFinite));
    }
}

proptest! {
    #[test]
    fn pose_and_axes_come_back_whatever_the_scale(
        e in ellipsoids(), size in 1e-3..1e3_f64, negative in any::<bool>(),
    ) {
        let scale = if negative { -size } else { size };
        let back = Ellipsoid::from_dual_quadric(&(e.dual_quadric() * scale)).unwrap();
        prop_assert!((back.center() - e.center()).norm() < ROUNDING);
        // The centre's square (up to 75) swallows digits of small squared semi-axes.
        prop_assert!((shape(&back) - shape(&e)).norm() < 1e-8);
        let mut sorted: [f64; 3] = e.semi_axes.into();
        sorted.sort_by(f64::total_cmp);
        prop_assert!((back.semi_axes - Vector3::from(sorted)).norm() < 1e-6, "ascending");
        let r = back.pose.rotation.to_rotation_matrix().into_inner();
        prop_assert!((r.determinant() - 1.0).abs() < ROUNDING, "right-handed");
        prop_assert!((r * r.transpose() - Matrix3::identity()).norm() < ROUNDING);
    }

    #[test]
    fn equal_axes_are_no_trouble(pose in poses(), a in 0.02..2.0, b in 0.02..2.0) {
        for semi_axes in [Vector3::new(a, a, b), Vector3::new(a, a, a)] {
            let e = Ellipsoid::new(pose, semi_axes);
            let back = Ellipsoid::from_dual_quadric(&e.dual_quadric()).unwrap();
            prop_assert!((shape(&back) - shape(&e)).norm() < 1e-8);
        }
    }

    #[test]
    fn a_plane_touches_it_where_the_dual_form_vanishes(
        e in ellipsoids(), normal in super::directions(),
    ) {
        // The support function of an ellipsoid: how far it reaches along a direction.
        let reach = (shape(&e) * normal.into_inner()).dot(&normal).sqrt();
        let touching = e.center() + normal.into_inner() * reach;
        let plane = Plane::through(&touching, normal);
        let n = normal.into_inner();
        let pi = Vector4::new(n.x, n.y, n.z, plane.offset);
        prop_assert!((pi.transpose() * e.dual_quadric() * pi)[0].abs() < 1e-8);
    }

    #[test]
    fn it_moves_as_a_dual_quadric_does(e in ellipsoids(), a_from_b in poses()) {
        let h = a_from_b.to_homogeneous();
        let expected = h * e.dual_quadric() * h.transpose();
        let moved = e.transformed(&a_from_b).dual_quadric();
        prop_assert!((moved - expected).norm() < 1e-7);
    }

    #[test]
    fn its_mirror_image_is_its_reflected_dual_quadric(e in ellipsoids(), plane in planes()) {
        let image = e.mirrored(&plane);
        let h = reflection(&plane);
        let expected = h * e.dual_quadric() * h.transpose();
        // Centres up to 25 m away are squared.
        prop_assert!((image.dual_quadric() - expected).norm() < 1e-6);
        let r = image.pose.rotation.to_rotation_matrix().into_inner();
        prop_assert!((r.determinant() - 1.0).abs() < ROUNDING, "right-handed");
        prop_assert!((r * r.transpose() - Matrix3::identity()).norm() < ROUNDING);
        let twice = image.mirrored(&plane);
        prop_assert!((twice.dual_quadric() - e.dual_quadric()).norm() < 1e-6, "an involution");
    }

    #[test]
    fn naming_axes_differently_leaves_the_body(e in ellipsoids(), quarters in -9_i64..9) {
        let renamed = e.quarter_turned(quarters);
        prop_assert!((renamed.dual_quadric() - e.dual_quadric()).norm() < 1e-8);
        let back = renamed.quarter_turned(-quarters);
        prop_assert!((back.semi_axes - e.semi_axes).norm() < ROUNDING);
        prop_assert!(super::pose_distance(&back.pose, &e.pose) < 1e-7);
    }

    #[test]
    fn axes_are_squared_semi_axes(s in semi_axes()) {
        let e = Ellipsoid::new(Pose::identity(), s);
        let back = Ellipsoid::from_dual_quadric(&-e.dual_quadric()).unwrap();
        prop_assert!((back.semi_axes.product() - s.product()).abs() < ROUNDING);
    }
}
