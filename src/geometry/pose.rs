//! Rigid transforms and their tangent space.

use nalgebra::{
    Isometry3, Matrix3, Matrix6, Quaternion, Translation3, UnitQuaternion, Vector3, Vector6,
};

/// A rigid transform `a_from_b`.
pub type Pose = Isometry3<f64>;

/// A pose from a position and a quaternion xyzw, as files have them; nothing where a number is not finite or the
/// quaternion is farther from unit length than few digits explain.
pub fn pose_from_xyzw(position: [f64; 3], [x, y, z, w]: [f64; 4]) -> Option<Pose> {
    const TOLERANCE: f64 = 0.01;
    const ROUNDING: f64 = 1e-12;
    let quaternion = Quaternion::new(w, x, y, z);
    let off = (quaternion.norm() - 1.0).abs();
    (off < TOLERANCE && position.iter().all(|p| p.is_finite())).then(|| {
        // What has unit length stays as it is: a file that is read and written would change in its last digits.
        let rotation = if off < ROUNDING {
            UnitQuaternion::new_unchecked(quaternion)
        } else {
            UnitQuaternion::from_quaternion(quaternion)
        };
        Pose::from_parts(Translation3::from(position), rotation)
    })
}

/// The cross-product matrix: `skew(a) * b = a × b`.
pub fn skew(v: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

/// The pose reached by following the twist `[rotation, translation]` for one unit of time.
///
/// Barfoot, State Estimation for Robotics, eq. (7.25) with the order of the parts exchanged.
pub fn exp(twist: &Vector6<f64>) -> Pose {
    let phi = Vector3::new(twist[0], twist[1], twist[2]);
    let rho = Vector3::new(twist[3], twist[4], twist[5]);
    let translation = left_jacobian(phi) * rho;
    Pose::from_parts(Translation3::from(translation), UnitQuaternion::from_scaled_axis(phi))
}

/// The twist `[rotation, translation]` that [`exp`] takes to `pose`; the rotation angle is at most π.
pub fn log(pose: &Pose) -> Vector6<f64> {
    let phi = pose.rotation.scaled_axis();
    let rho = left_jacobian_inverse(phi) * pose.translation.vector;
    Vector6::new(phi.x, phi.y, phi.z, rho.x, rho.y, rho.z)
}

/// `pose * exp(twist)`.
pub fn retract(pose: &Pose, twist: &Vector6<f64>) -> Pose {
    pose * exp(twist)
}

/// The twist that takes `from` to `to`: the inverse of [`retract`].
pub fn local(from: &Pose, to: &Pose) -> Vector6<f64> {
    log(&(from.inverse() * to))
}

/// The pose at `fraction` (0 at `from`, 1 at `to`) of the way at constant twist.
pub fn interpolate(from: &Pose, to: &Pose, fraction: f64) -> Pose {
    retract(from, &(local(from, to) * fraction))
}

/// How twists change frames: `a_from_b * exp(twist) = exp(adjoint(a_from_b) * twist) * a_from_b`.
pub fn adjoint(a_from_b: &Pose) -> Matrix6<f64> {
    let rotation = a_from_b.rotation.to_rotation_matrix().into_inner();
    let mut adjoint = Matrix6::zeros();
    adjoint.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
    adjoint.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
    adjoint.fixed_view_mut::<3, 3>(3, 0).copy_from(&(skew(a_from_b.translation.vector) * rotation));
    adjoint
}

/// How the rotation vector of a rotation changes when that is perturbed on the right:
/// `log(Exp(phi) Exp(d)) = phi + rotation_log_derivative(phi) * d` to first order.
///
/// The inverse of the right Jacobian of SO(3). Barfoot, State Estimation for Robotics, eq. (7.76).
pub fn rotation_log_derivative(phi: Vector3<f64>) -> Matrix3<f64> {
    left_jacobian_inverse(-phi)
}

/// How a twist changes when its pose is perturbed on the right:
/// `log(exp(twist) exp(d)) = twist + log_derivative(twist) * d` to first order.
///
/// The inverse of the right Jacobian of SE(3). Barfoot, State Estimation for Robotics, eq. (7.95).
pub fn log_derivative(twist: &Vector6<f64>) -> Matrix6<f64> {
    let phi = -Vector3::new(twist[0], twist[1], twist[2]);
    let rho = -Vector3::new(twist[3], twist[4], twist[5]);
    let inverse = left_jacobian_inverse(phi);
    let mut derivative = Matrix6::zeros();
    derivative.fixed_view_mut::<3, 3>(0, 0).copy_from(&inverse);
    derivative.fixed_view_mut::<3, 3>(3, 3).copy_from(&inverse);
    let below = -inverse * left_jacobian_coupling(phi, rho) * inverse;
    derivative.fixed_view_mut::<3, 3>(3, 0).copy_from(&below);
    derivative
}

/// Heading of the x axis in the horizontal plane (rad), counter-clockwise seen from above.
pub fn yaw_of(pose: &Pose) -> f64 {
    let x = pose.rotation * Vector3::x();
    x.y.atan2(x.x)
}

/// Below this angle (rad) the closed forms lose digits and their Taylor series is exact to machine precision.
const SMALL_ANGLE: f64 = 1e-4;

fn left_jacobian(phi: Vector3<f64>) -> Matrix3<f64> {
    let (angle, s) = (phi.norm(), skew(phi));
    let (b, c) = if angle < SMALL_ANGLE {
        (0.5 - angle * angle / 24.0, 1.0 / 6.0 - angle * angle / 120.0)
    } else {
        ((1.0 - angle.cos()) / angle.powi(2), (angle - angle.sin()) / angle.powi(3))
    };
    Matrix3::identity() + s * b + s * s * c
}

fn left_jacobian_inverse(phi: Vector3<f64>) -> Matrix3<f64> {
    let (angle, s) = (phi.norm(), skew(phi));
    let c = if angle < SMALL_ANGLE {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        (1.0 - angle * (0.5 * angle).cos() / (2.0 * (0.5 * angle).sin())) / angle.powi(2)
    };
    Matrix3::identity() - s * 0.5 + s * s * c
}

/// What rotating does to the translation in the left Jacobian of SE(3). Barfoot, State Estimation for Robotics, eq.
/// (7.86).
fn left_jacobian_coupling(phi: Vector3<f64>, rho: Vector3<f64>) -> Matrix3<f64> {
    let (p, r) = (skew(phi), skew(rho));
    let [b, c, d] = coupling_coefficients(phi.norm());
    let (pr, rp, pp) = (p * r, r * p, p * p);
    let prp = pr * p;
    r * 0.5 + (pr + rp + prp) * b + (pp * r + rp * p - prp * 3.0) * c + (prp * p + p * prp) * d
}

fn coupling_coefficients(angle: f64) -> [f64; 3] {
    let square = angle * angle;
    // The closed forms divide differences of nearly equal numbers by the fifth power of the angle.
    const SERIES_BELOW: f64 = 0.05;
    if angle < SERIES_BELOW {
        return [
            1.0 / 6.0 - square / 120.0 + square * square / 5040.0,
            1.0 / 24.0 - square / 720.0 + square * square / 40_320.0,
            1.0 / 120.0 - square / 2520.0 + square * square / 120_960.0,
        ];
    }
    let (sin, cos) = angle.sin_cos();
    [
        (angle - sin) / (square * angle),
        (0.5 * square + cos - 1.0) / (square * square),
        (2.0 * angle - 3.0 * sin + angle * cos) / (2.0 * square * square * angle),
    ]
}
