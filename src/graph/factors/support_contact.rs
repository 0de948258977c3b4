//! Things that stand on something.

use crate::{
    geometry::{Ellipsoid, Outline, Plane, Pose, Support},
    graph::{EllipsoidId, Factor, Kernel, Linearization, NoiseError, Variable, VariableId},
};
use nalgebra::{DVector, SMatrix, Vector1, Vector3};

/// The lowest point of a body lies on a plane of the map: `r` = its signed distance from the plane, over sigma.
///
/// With the outline's support function `h`, the lowest point of a body with centre `c` is at `n · c - h(-R^T n)`
/// along the plane's normal `n`.
#[derive(Clone, Debug)]
pub struct SupportContact {
    variables: [VariableId; 1],
    outline: Outline,
    plane: Plane,
    inverse_sigma: f64,
    kernel: Kernel,
}

impl SupportContact {
    /// The body stands on the side of `plane` its normal points to; the plane is in the map.
    ///
    /// # Errors
    /// When sigma is not a positive number.
    pub fn new(
        ellipsoid: EllipsoidId,
        outline: Outline,
        plane: Plane,
        sigma_m: f64,
    ) -> Result<Self, NoiseError> {
        let inverse_sigma = NoiseError::inverse_of_sigma(0, sigma_m)?;
        let variables = [ellipsoid.into()];
        Ok(Self { variables, outline, plane, inverse_sigma, kernel: Kernel::Quadratic })
    }

    /// The same plane under another object: what was taken for two turned out to be one.
    pub fn of(self, ellipsoid: EllipsoidId) -> Self {
        Self { variables: [ellipsoid.into()], ..self }
    }

    /// The plane, in the map.
    pub fn plane(&self) -> &Plane {
        &self.plane
    }

    /// The same with a robust kernel.
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }

    /// Direction towards the plane in the body's frame, and where the body ends in it.
    fn lowest(&self, body: &Ellipsoid) -> (Vector3<f64>, Support) {
        let down = -body.pose.rotation.inverse_transform_vector(&self.plane.normal);
        (down, self.outline.support(&down, &body.semi_axes))
    }

    fn whitened(&self, body: &Ellipsoid, lowest: &Support) -> f64 {
        (self.plane.signed_distance(&body.center()) - lowest.reach) * self.inverse_sigma
    }
}

impl Factor for SupportContact {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        let body = at[0].known_ellipsoid();
        DVector::from_element(1, self.whitened(body, &self.lowest(body).1))
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let body = at[0].known_ellipsoid();
        let (down, lowest) = self.lowest(body);
        let by_rotation = lowest.contact.cross(&down);
        let by_size = down.component_mul(&lowest.contact);
        let mut jacobian = SMatrix::<f64, 1, 9>::zeros();
        jacobian.fixed_view_mut::<1, 3>(0, 0).tr_copy_from(&by_rotation);
        jacobian.fixed_view_mut::<1, 3>(0, 3).tr_copy_from(&down);
        jacobian.fixed_view_mut::<1, 3>(0, 6).tr_copy_from(&by_size);
        jacobian *= -self.inverse_sigma;
        Linearization::new(&Vector1::new(self.whitened(body, &lowest)), &jacobian)
    }

    fn move_map(&mut self, new_from_old: &Pose) {
        self.plane = self.plane.transformed(new_from_old);
    }

    fn kernel(&self) -> Kernel {
        self.kernel
    }
}
