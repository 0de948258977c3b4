//! Least-squares fit of an upright ellipsoid to points.
//!
//! Liao et al. 2020, section IV-C.

use crate::geometry::{Ellipsoid, Outline};
use nalgebra::{
    Cholesky, Isometry3, Point3, SMatrix, SVector, Translation3, UnitQuaternion, Vector3,
};

/// Tangent of an upright ellipsoid: yaw (rad), translation in its own frame (m), log semi-axes.
type Tangent = SVector<f64, 7>;

/// What a fit did.
#[derive(Clone, Debug)]
pub struct FitReport {
    /// The fitted ellipsoid, upright like the initial one.
    pub ellipsoid: Ellipsoid,
    /// Sum of squared residuals of eq. (7) at the start and at the end.
    pub initial_cost: f64,
    /// Sum of squared residuals of eq. (7) at the end.
    pub final_cost: f64,
    /// Steps tried.
    pub iterations: usize,
}

/// Minimises the sum over the points of `(sqrt(s1 s2 s3) F(X))^2` from `initial` by Levenberg-Marquardt.
/// Liao et al. 2020, eq. (7): the volume keeps the ellipsoid from growing.
///
/// `initial` must be upright (its z axis is the frame's z axis) and stays so. A step is accepted on the true
/// cost only.
pub fn fit_ellipsoid(points: &[Point3<f64>], initial: &Ellipsoid) -> FitReport {
    let mut best = *initial;
    let initial_cost = cost(points, &best);
    let (mut best_cost, mut damping, mut iterations) = (initial_cost, 1e-3, 0);
    while iterations < MAX_ITERATIONS && damping < MAX_DAMPING {
        iterations += 1;
        let (hessian, gradient) = normal_equations(points, &best);
        let mut damped = hessian;
        for i in 0..7 {
            damped[(i, i)] += damping * hessian[(i, i)].max(1e-12);
        }
        let Some(factor) = Cholesky::new(damped) else {
            damping *= 10.0;
            continue;
        };
        let next = retract_upright(&best, &-factor.solve(&gradient));
        let next_cost = cost(points, &next);
        if next_cost.is_finite() && next_cost < best_cost {
            let converged = best_cost - next_cost < 1e-9 * best_cost;
            (best, best_cost) = (next, next_cost);
            damping = (damping * 0.1).max(1e-9);
            if converged {
                break;
            }
        } else {
            damping *= 10.0;
        }
    }
    FitReport { ellipsoid: best, initial_cost, final_cost: best_cost, iterations }
}

/// `P_fit`: 1 for a perfect fit. Liao et al. 2020, eq. (8), without its constant factor and with `T` made
/// dimensionless by leaving out the volume, so that small objects are not all taken for perfect fits.
pub fn fit_probability(points: &[Point3<f64>], body: &Ellipsoid, outline: Outline) -> f64 {
    if points.is_empty() {
        return 0.0;
    }
    let squared: f64 = points
        .iter()
        .map(|point| {
            let own = body.pose.inverse_transform_point(point);
            let radius = outline.radius(&own.coords.component_div(&body.semi_axes));
            (radius * radius - 1.0).powi(2)
        })
        .sum();
    (-0.5 * squared / points.len() as f64).exp()
}

/// The residual of eq. (7) for one point and its derivative by yaw, translation in the ellipsoid's own frame and
/// log semi-axes.
pub fn residual(point: &Point3<f64>, ellipsoid: &Ellipsoid) -> (f64, SVector<f64, 7>) {
    let q = ellipsoid.pose.inverse_transform_point(point).coords;
    let s = ellipsoid.semi_axes;
    let scaled = q.component_div(&s);
    let f = scaled.norm_squared() - 1.0;
    let root_volume = s.product().sqrt();
    let by_q = scaled.component_div(&s) * 2.0;
    // A right perturbation moves the point by -(rotation × q) - translation in the ellipsoid's frame.
    let by_yaw = by_q.dot(&q.cross(&Vector3::z()));
    let by_log_s = scaled.component_mul(&scaled) * -2.0 + Vector3::repeat(0.5 * f);
    let mut jacobian = Tangent::zeros();
    jacobian[0] = by_yaw;
    jacobian.fixed_rows_mut::<3>(1).copy_from(&-by_q);
    jacobian.fixed_rows_mut::<3>(4).copy_from(&by_log_s);
    (root_volume * f, jacobian * root_volume)
}

/// The upright ellipsoid moved by a tangent vector: yaw, translation in its own frame, log semi-axes.
pub fn retract_upright(ellipsoid: &Ellipsoid, delta: &SVector<f64, 7>) -> Ellipsoid {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), delta[0]);
    let shift = Translation3::new(delta[1], delta[2], delta[3]);
    let pose = ellipsoid.pose * Isometry3::from_parts(shift, turn);
    let log_s: Vector3<f64> = delta.fixed_rows::<3>(4).into_owned();
    Ellipsoid { pose, semi_axes: ellipsoid.semi_axes.component_mul(&log_s.map(f64::exp)) }
}

fn cost(points: &[Point3<f64>], ellipsoid: &Ellipsoid) -> f64 {
    let volume = ellipsoid.semi_axes.product();
    points.iter().map(|p| ellipsoid.algebraic_distance(p).powi(2)).sum::<f64>() * volume
}

fn normal_equations(points: &[Point3<f64>], at: &Ellipsoid) -> (SMatrix<f64, 7, 7>, Tangent) {
    let mut hessian = SMatrix::<f64, 7, 7>::zeros();
    let mut gradient = Tangent::zeros();
    for point in points {
        let (r, j) = residual(point, at);
        hessian.syger(1.0, &j, &j, 1.0);
        gradient += j * r;
    }
    hessian.fill_upper_triangle_with_lower_triangle();
    (hessian, gradient)
}

const MAX_ITERATIONS: usize = 50;
const MAX_DAMPING: f64 = 1e8;
