use crate::geometry::{upright_ellipsoids, upright_pose};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose},
    perception::{fit_ellipsoid, fit_probability, residual, retract_upright},
};
use nalgebra::{Point3, SVector, Vector3};
use proptest::prelude::*;

/// Points on a sphere, evenly by Fibonacci's spiral.
fn sphere(n: u32) -> impl Iterator<Item = Vector3<f64>> {
    (0..n).map(move |i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
        let angle = f64::from(i) * std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let r = (1.0 - z * z).sqrt();
        Vector3::new(r * angle.cos(), r * angle.sin(), z)
    })
}

fn surface(e: &Ellipsoid, n: u32) -> Vec<Point3<f64>> {
    sphere(n).map(|p| e.pose * Point3::from(p.component_mul(&e.semi_axes))).collect()
}

/// A grid on all faces of a cuboid with these half extents.
fn cuboid_surface(half: Vector3<f64>, cells: i32) -> Vec<Point3<f64>> {
    let mid = |i: i32| (2.0 * f64::from(i) + 1.0) / f64::from(cells) - 1.0;
    let mut points = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            for i in 0..cells {
                for j in 0..cells {
                    let mut p = Vector3::zeros();
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, mid(i), mid(j));
                    points.push(p.component_mul(&half).into());
                }
            }
        }
    }
    points
}

#[test]
fn the_residual_by_hand() {
    // Twice as far out as the surface along x: F = 4 - 1, times the root of 1 * 2 * 0.5.
    let e = Ellipsoid::new(Pose::identity(), Vector3::new(1.0, 2.0, 0.5));
    let (r, _) = residual(&Point3::new(2.0, 0.0, 0.0), &e);
    assert!((r - 3.0).abs() < 1e-12);
    assert!((residual(&Point3::origin(), &e).0 + 1.0).abs() < 1e-12);
}

/// Points on a cube's faces lie on or outside the ellipsoid of its extents, so eq. (7) takes it for larger.
///
/// With x^2 + y^2 + z^2 = q on the faces of the unit cube, E[q] = 5/3 and E[q^2] = 43/15 (the grid has nearly
/// these means), and s^3 (E[q^2] / s^4 - 2 E[q] / s^2 + 1) is least where 3 s^4 - 2 E[q] s^2 - E[q^2] = 0.
#[test]
fn a_whole_cube_is_taken_for_1_30_of_its_size() {
    for half in [0.2, 0.7] {
        let points = cuboid_surface(Vector3::repeat(half), 40);
        let start = Ellipsoid::new(Pose::identity(), Vector3::repeat(half));
        let fitted = fit_ellipsoid(&points, &start).ellipsoid;
        let mean: f64 = 5.0 / 3.0;
        let square = (mean + (mean * mean + 3.0 * 43.0 / 15.0).sqrt()) / 3.0;
        for s in fitted.semi_axes.iter() {
            assert!((s / half - square.sqrt()).abs() < 0.005, "{}", s / half);
            assert!((s / half - 1.30).abs() < 0.01, "{}", s / half);
        }
    }
}

#[test]
fn a_perfect_fit_has_probability_one() {
    let e =
        Ellipsoid::new(upright_pose(0.4, Vector3::new(1.0, 2.0, 3.0)), Vector3::new(0.4, 0.2, 0.3));
    assert!((fit_probability(&surface(&e, 200), &e, Outline::Ellipsoid) - 1.0).abs() < 1e-12);
    let cuboid: Vec<Point3<f64>> =
        cuboid_surface(e.semi_axes, 10).iter().map(|p| e.pose * p).collect();
    assert!((fit_probability(&cuboid, &e, Outline::Cuboid) - 1.0).abs() < 1e-12);
    assert!(fit_probability(&cuboid, &e, Outline::Ellipsoid) < 0.9);
    assert_eq!(fit_probability(&[], &e, Outline::Cuboid), 0.0);
}

#[test]
fn a_small_misfit_is_judged_alike_at_any_size() {
    let probability = |size: f64| {
        let e = Ellipsoid::new(Pose::identity(), Vector3::new(0.4, 0.2, 0.3) * size);
        let larger = Ellipsoid::new(e.pose, e.semi_axes * 1.3);
        fit_probability(&surface(&e, 100), &larger, Outline::Ellipsoid)
    };
    assert!((probability(0.1) - probability(2.0)).abs() < 1e-12);
    assert!(probability(1.0) < 0.95);
}

proptest! {
    #[test]
    fn the_jacobian_is_the_slope(e in upright_ellipsoids(), direction in crate::geometry::directions(), out in 0.3..2.0) {
        let point = e.pose * Point3::from(direction.into_inner().component_mul(&e.semi_axes) * out);
        let (_, jacobian) = residual(&point, &e);
        for i in 0..7 {
            // A step in proportion to the body: a thin one bends sooner. Central differences of a smooth function:
            // truncation about h^2, rounding about 1e-16 / h.
            let size = if (1..4).contains(&i) { e.semi_axes.min() } else { 1.0 };
            let h = 2e-6 * size;
            let at = |h: f64| {
                let mut delta = SVector::<f64, 7>::zeros();
                delta[i] = h;
                residual(&point, &retract_upright(&e, &delta)).0
            };
            let slope = (at(h) - at(-h)) / (2.0 * h);
            let scale = jacobian.amax().max(1e-3) ;
            prop_assert!(
                (jacobian[i] - slope).abs() < 1e-6 * scale,
                "coordinate {i}: {} against {slope}", jacobian[i]
            );
        }
    }

    #[test]
    fn a_known_ellipsoid_is_recovered(
        a in 0.1..0.8, ratio in 0.4..0.8, c in 0.1..0.8, yaw in -1.5..1.5,
        off in prop::array::uniform7(-0.15..0.15),
    ) {
        let truth = Ellipsoid::new(
            upright_pose(yaw, Vector3::new(1.0, -2.0, 0.5)),
            Vector3::new(a, a * ratio, c),
        );
        let mut delta = SVector::<f64, 7>::from(off);
        for i in 1..4 {
            delta[i] *= truth.semi_axes.min();
        }
        let points = surface(&truth, 300);
        let report = fit_ellipsoid(&points, &retract_upright(&truth, &delta));
        let fitted = report.ellipsoid;
        prop_assert!(report.final_cost <= report.initial_cost);
        prop_assert!((fitted.dual_quadric() - truth.dual_quadric()).norm() < 1e-4, "{report:?}");
        prop_assert!(fit_probability(&points, &fitted, Outline::Ellipsoid) > 0.999_999);
        let up = fitted.pose.rotation * Vector3::z();
        prop_assert!((up - Vector3::z()).norm() < 1e-9, "upright");
    }

    #[test]
    fn the_cost_never_grows(
        e in upright_ellipsoids(), points in prop::collection::vec(crate::geometry::points(), 0..40),
    ) {
        let report = fit_ellipsoid(&points, &e);
        let cost = |e: &Ellipsoid| points.iter().map(|p| residual(p, e).0.powi(2)).sum::<f64>();
        prop_assert!(report.final_cost <= report.initial_cost);
        let (first, last) = (cost(&e), cost(&report.ellipsoid));
        prop_assert!((report.initial_cost - first).abs() <= 1e-9 * first.max(1.0));
        prop_assert!((report.final_cost - last).abs() <= 1e-9 * first.max(1.0));
        prop_assert!(report.ellipsoid.semi_axes.min() > 0.0);
    }
}
