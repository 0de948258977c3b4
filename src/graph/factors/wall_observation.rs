//! The wall that one depth image shows.

use crate::graph::{
    Factor, Kernel, Linearization, Noise, NoiseError, PoseId, Variable, VariableId, WallId,
};
use nalgebra::{DVector, Point3, SMatrix, Vector2, Vector3};

/// Ties a wall to the pose it was seen from.
///
/// With `c` and `n` the middle of what was seen and the normal there, in the frame of the pose `x`, and `m`, `t`, `w` the
/// normal, the horizontal direction and a point of the wall in the map, the residual is, before whitening,
/// `[t . R n, m . (x c - w)]`: the sine of the angle between the normals, and how far the middle is from the wall (rad,
/// m). About the middle, errors of the two are independent. Planes as landmarks: Kaess 2015, Simultaneous
/// localization and mapping with infinite planes; where walls are upright, two numbers are left.
#[derive(Clone, Debug)]
pub struct WallObservation {
    variables: [VariableId; 2],
    center: Point3<f64>,
    normal: Vector3<f64>,
    noise: Noise<2>,
    kernel: Kernel,
}

impl WallObservation {
    /// `center` (m) and the unit vector `normal` are in the frame of the pose; `sigmas` are those of the direction (rad)
    /// and of the distance at the centre (m).
    ///
    /// # Errors
    /// When a sigma is not a positive number.
    pub fn new(
        (pose, wall): (PoseId, WallId),
        (center, normal): (Point3<f64>, Vector3<f64>),
        sigmas: [f64; 2],
    ) -> Result<Self, NoiseError> {
        let noise = Noise::from_sigmas(sigmas)?;
        let variables = [pose.into(), wall.into()];
        Ok(Self { variables, center, normal, noise, kernel: Kernel::Quadratic })
    }

    /// The same with a robust kernel.
    #[must_use]
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }
}

impl Factor for WallObservation {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        let (pose, wall) = (at[0].pose(), at[1].known_wall());
        let turn = wall.along().dot(&(pose.rotation * self.normal).xy());
        let residual = Vector2::new(turn, wall.signed_distance(&(pose * self.center).xy()));
        DVector::from_column_slice(self.noise.whiten(&residual).as_slice())
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let (pose, wall) = (at[0].pose(), at[1].known_wall());
        let to_pose = pose.rotation.inverse();
        let [along, normal] =
            [wall.along(), wall.normal()].map(|d| to_pose * Vector3::new(d.x, d.y, 0.0));
        let off = (pose * self.center).xy() - wall.point;
        let mut jacobian = SMatrix::<f64, 2, 8>::zeros();
        // d . R Exp(w) p changes by d . R (w x p) = w . (p x R^T d).
        let turned = self.normal.cross(&along);
        let moved = self.center.coords.cross(&normal);
        jacobian.fixed_view_mut::<1, 3>(0, 0).copy_from(&turned.transpose());
        jacobian.fixed_view_mut::<1, 3>(1, 0).copy_from(&moved.transpose());
        jacobian.fixed_view_mut::<1, 3>(1, 3).copy_from(&normal.transpose());
        // As the wall turns, its normal moves along it, and what was along it against the normal.
        jacobian[(0, 6)] = -normal.dot(&self.normal);
        jacobian[(1, 6)] = wall.along().dot(&off);
        jacobian[(1, 7)] = -1.0;
        let residual = Vector2::new(along.dot(&self.normal), wall.normal().dot(&off));
        Linearization::new(&self.noise.whiten(&residual), &self.noise.whiten(&jacobian))
    }

    fn kernel(&self) -> Kernel {
        self.kernel
    }
}
