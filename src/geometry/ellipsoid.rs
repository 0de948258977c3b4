//! The ellipsoid landmark: a pose and three semi-axes, and its dual quadric.

use super::{Plane, Pose};
use nalgebra::{
    Isometry3, Matrix3, Matrix4, Point3, Rotation3, SVector, SymmetricEigen, Translation3,
    UnitQuaternion, Vector3, Vector6,
};
use thiserror::Error;

/// An ellipsoid: `pose` takes its own axes to the frame it is given in, `semi_axes` are half its extents (m).
///
/// Its tangent space has nine dimensions: rotation (rad) and translation (m) in the ellipsoid's own frame
/// (right perturbation), then the logarithms of the semi-axes, which keeps them positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// `frame_from_ellipsoid`.
    pub pose: Pose,
    /// Positive half extents along the ellipsoid's own x, y, z (m).
    pub semi_axes: Vector3<f64>,
}

/// Why a matrix is not the dual quadric of an ellipsoid.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EllipsoidError {
    /// An element is not finite or the scale (element 4,4) is zero.
    #[error("the dual quadric is not finite or has no scale")]
    NotFinite,
    /// The quadric is a hyperboloid, a paraboloid or degenerate.
    #[error(
        "the dual quadric is not an ellipsoid: its smallest squared semi-axis is {smallest} m^2"
    )]
    NotAnEllipsoid {
        /// Smallest eigenvalue of the shape matrix (m^2).
        smallest: f64,
    },
}

impl Ellipsoid {
    /// An ellipsoid from its pose and positive semi-axes (m).
    pub fn new(pose: Pose, semi_axes: Vector3<f64>) -> Self {
        debug_assert!(semi_axes.iter().all(|s| *s > 0.0), "semi-axes {semi_axes} must be positive");
        Self { pose, semi_axes }
    }

    /// Centre in the frame of `pose`.
    pub fn center(&self) -> Point3<f64> {
        self.pose.translation.vector.into()
    }

    /// The same ellipsoid in frame `a`, given in frame `b`. Liao et al. 2020, eq. (12).
    pub fn transformed(&self, a_from_b: &Pose) -> Self {
        Self { pose: a_from_b * self.pose, semi_axes: self.semi_axes }
    }

    /// The mirror image in `plane`.
    pub fn mirrored(&self, plane: &Plane) -> Self {
        let n = plane.normal.into_inner();
        let reflection = Matrix3::identity() - n * n.transpose() * 2.0;
        // A reflection turns a right-handed frame into a left-handed one; an ellipsoid is its own mirror
        // image along its z axis, so flipping that axis back makes it right-handed.
        let flip_z = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
        let rotation = reflection * self.pose.rotation.to_rotation_matrix().into_inner() * flip_z;
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        let center = plane.mirrored(&self.center());
        Self {
            pose: Isometry3::from_parts(Translation3::from(center.coords), rotation),
            semi_axes: self.semi_axes,
        }
    }

    /// The dual quadric `Q*`, 4x4, scaled to `Q*[3,3] = -1`. Liao et al. 2020, eq. (4) and (5).
    pub fn dual_quadric(&self) -> Matrix4<f64> {
        let z = self.pose.to_homogeneous();
        let s = self.semi_axes.map(|s| s * s);
        z * Matrix4::from_diagonal(&s.push(-1.0)) * z.transpose()
    }

    /// The ellipsoid of a dual quadric of any scale. Its axes come in ascending order of length.
    ///
    /// # Errors
    /// When the matrix is not finite or is not the dual quadric of a proper ellipsoid.
    pub fn from_dual_quadric(dual: &Matrix4<f64>) -> Result<Self, EllipsoidError> {
        let scale = -dual[(3, 3)];
        if !dual.iter().all(|v| v.is_finite()) || scale == 0.0 {
            return Err(EllipsoidError::NotFinite);
        }
        let q = dual / scale;
        let center: Vector3<f64> = -q.fixed_view::<3, 1>(0, 3).into_owned();
        let shape = q.fixed_view::<3, 3>(0, 0).into_owned() + center * center.transpose();
        let eigen = SymmetricEigen::new((shape + shape.transpose()) * 0.5);
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let values = order.map(|i| eigen.eigenvalues[i]);
        if values[0] <= 0.0 {
            return Err(EllipsoidError::NotAnEllipsoid { smallest: values[0] });
        }
        let (x, y) = (eigen.eigenvectors.column(order[0]), eigen.eigenvectors.column(order[1]));
        let axes = Matrix3::from_columns(&[x.into(), y.into(), x.cross(&y)]);
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        Ok(Self {
            pose: Isometry3::from_parts(Translation3::from(center), rotation),
            semi_axes: Vector3::from(values.map(f64::sqrt)),
        })
    }

    /// `F(X) = X^T Q X` with `Q` scaled to -1 at the centre: 0 on the surface, negative inside.
    /// Liao et al. 2020, eq. (6).
    pub fn algebraic_distance(&self, point: &Point3<f64>) -> f64 {
        let own = self.pose.inverse_transform_point(point);
        own.coords.component_div(&self.semi_axes).norm_squared() - 1.0
    }

    /// `self ⊞ delta` with `delta` = `[rotation, translation, log semi-axes]`.
    pub fn retract(&self, delta: &SVector<f64, 9>) -> Self {
        let twist: Vector6<f64> = delta.fixed_rows::<6>(0).into_owned();
        let log_axes: Vector3<f64> = delta.fixed_rows::<3>(6).into_owned();
        Self {
            pose: super::retract(&self.pose, &twist),
            semi_axes: self.semi_axes.component_mul(&log_axes.map(f64::exp)),
        }
    }

    /// `other ⊟ self`: the `delta` for which `self.retract(delta)` is `other`.
    pub fn local(&self, other: &Self) -> SVector<f64, 9> {
        let twist = super::local(&self.pose, &other.pose);
        let log_axes = other.semi_axes.component_div(&self.semi_axes).map(f64::ln);
        let mut delta = SVector::<f64, 9>::zeros();
        delta.fixed_rows_mut::<6>(0).copy_from(&twist);
        delta.fixed_rows_mut::<3>(6).copy_from(&log_axes);
        delta
    }

    /// The same upright body with its x and y axes renamed so that its heading differs from `reference_yaw`
    /// by at most 45 degrees. Liao et al. 2020 leave open that eq. (13) depends on how axes are named.
    pub fn relabelled_towards(&self, reference_yaw: f64) -> Self {
        self.quarter_turned(self.quarters_towards(reference_yaw))
    }

    /// Quarter turns, for [`Ellipsoid::quarter_turned`], that bring the heading nearest to `reference_yaw` (rad).
    pub fn quarters_towards(&self, reference_yaw: f64) -> i64 {
        let turn = (reference_yaw - super::yaw_of(&self.pose)) / std::f64::consts::FRAC_PI_2;
        turn.round() as i64
    }

    /// The same body with its axes renamed by `quarters` quarter turns about its own z axis.
    pub fn quarter_turned(&self, quarters: i64) -> Self {
        let quarters = quarters.rem_euclid(4);
        let angle = quarters as f64 * std::f64::consts::FRAC_PI_2;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let s = self.semi_axes;
        let semi_axes = if quarters % 2 == 0 { s } else { Vector3::new(s.y, s.x, s.z) };
        Self { pose: self.pose * turn, semi_axes }
    }
}
