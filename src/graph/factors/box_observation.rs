//! The box that a detector draws round an object. Liao et al. 2020, eq. (15).

use crate::{
    geometry::{Ellipsoid, ImageSide, Outline, Pose, Silhouette, Tangent},
    graph::{EllipsoidId, Factor, Kernel, Linearization, NoiseError, PoseId, Variable, VariableId},
};
use nalgebra::{DMatrix, DVector, Point3, Vector3};
use thiserror::Error;

/// A side of a detector's box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxSide {
    /// Where it is in undistorted normalised image coordinates: `x/z` or `y/z` of what is seen there.
    pub at: f64,
    /// Its standard deviation, in the same coordinates.
    pub sigma: f64,
}

/// Why a box is not an observation.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BoxError {
    /// All four sides are cut by the image.
    #[error("no side of the box is inside the image")]
    NoSides,
    /// A side is infinite or not a number.
    #[error("side {side} of the box is at {at}")]
    NotFinite {
        /// Counted from 0: left, upper, right, lower.
        side: usize,
        /// Where it is said to be.
        at: f64,
    },
    /// A standard deviation is not one.
    #[error(transparent)]
    Noise(#[from] NoiseError),
}

/// The sides of a detector's box touch the outline of the object: `r` = (predicted - detected) / sigma, side by side.
///
/// The sides are predicted from the outline of the object, see [`Silhouette`]. Liao et al. 2020 take the ellipse of
/// `C* = P Q* P^T` for every object: corners of furniture lie outside of it, so that its ellipsoid grows too large.
/// Their `P_det` is left to the sides' standard deviations.
///
/// For all poses the residual is finite and its derivative bounded. An object that reaches behind the camera where a
/// side was seen costs much, and the derivative leads to the front.
#[derive(Clone, Debug)]
pub struct BoxObservation {
    variables: [VariableId; 2],
    pose_from_camera: Pose,
    outline: Outline,
    sides: [Option<BoxSide>; 4],
    kernel: Kernel,
}

impl BoxObservation {
    /// `sides` are left, upper, right and lower. `None` is a side that the border of the image cuts: it says nothing
    /// about the object.
    ///
    /// # Errors
    /// When there is no side or a number is not finite, or a standard deviation is not positive.
    pub fn new(
        pose: PoseId,
        ellipsoid: EllipsoidId,
        pose_from_camera: Pose,
        outline: Outline,
        sides: [Option<BoxSide>; 4],
    ) -> Result<Self, BoxError> {
        if sides.iter().all(Option::is_none) {
            return Err(BoxError::NoSides);
        }
        for (index, side) in sides.iter().enumerate() {
            let Some(BoxSide { at, sigma }) = *side else { continue };
            if !at.is_finite() {
                return Err(BoxError::NotFinite { side: index, at });
            }
            NoiseError::inverse_of_sigma(index, sigma)?;
        }
        let variables = [pose.into(), ellipsoid.into()];
        Ok(Self { variables, pose_from_camera, outline, sides, kernel: Kernel::Quadratic })
    }

    /// The same box round another object: what was taken for two turned out to be one.
    pub fn of(self, ellipsoid: EllipsoidId) -> Self {
        Self { variables: [self.variables[0], ellipsoid.into()], ..self }
    }

    /// The same with `scale` times the information.
    ///
    /// # Errors
    /// When the scale is not a positive finite number.
    pub fn scaled(mut self, scale: f64) -> Result<Self, NoiseError> {
        let shrink = NoiseError::inverse_of_sigma(0, scale)?.sqrt();
        self.sides.iter_mut().flatten().for_each(|side| side.sigma *= shrink);
        Ok(self)
    }

    /// The same with a robust kernel.
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }

    fn body_in_camera(&self, at: &[Variable]) -> Ellipsoid {
        let pose_from_object = at[0].pose().inv_mul(at[1].pose());
        let camera_from_object = self.pose_from_camera.inv_mul(&pose_from_object);
        Ellipsoid { pose: camera_from_object, semi_axes: at[1].known_ellipsoid().semi_axes }
    }

    /// Every side that was measured, with the one that is predicted.
    fn predicted(&self, body: &Ellipsoid) -> impl Iterator<Item = (BoxSide, Tangent)> {
        let silhouette = Silhouette::new(body, self.outline);
        self.sides.iter().zip(ImageSide::ALL).filter_map(move |(measured, side)| {
            let measured = (*measured)?;
            Some((measured, silhouette.tangent(side, measured.at)))
        })
    }

    fn rows(&self) -> usize {
        self.sides.iter().flatten().count()
    }
}

impl Factor for BoxObservation {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        let body = self.body_in_camera(at);
        let whitened =
            self.predicted(&body).map(|(measured, tangent)| measured.whitened(tangent.at));
        DVector::from_iterator(self.rows(), whitened)
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let body = self.body_in_camera(at);
        let mut residual = DVector::zeros(self.rows());
        let mut jacobian = DMatrix::zeros(self.rows(), 15);
        for (row, (measured, tangent)) in self.predicted(&body).enumerate() {
            residual[row] = measured.whitened(tangent.at);
            let gradient = tangent.gradient / measured.sigma;
            let by_object = body.pose.rotation.inverse_transform_vector(&gradient);
            let by_pose = self.pose_from_camera.rotation * gradient;
            let contact_in_camera = body.pose * Point3::from(tangent.contact);
            let contact_in_pose = (self.pose_from_camera * contact_in_camera).coords;
            let mut set = |column: usize, block: &Vector3<f64>| {
                jacobian.fixed_view_mut::<1, 3>(row, column).tr_copy_from(block);
            };
            // The pose moves the contact the other way.
            set(0, &by_pose.cross(&contact_in_pose));
            set(3, &-by_pose);
            set(6, &tangent.contact.cross(&by_object));
            set(9, &by_object);
            set(12, &tangent.contact.component_mul(&by_object));
        }
        Linearization { residual, jacobian }
    }

    fn kernel(&self) -> Kernel {
        self.kernel
    }
}

impl BoxSide {
    fn whitened(&self, predicted: f64) -> f64 {
        (predicted - self.at) / self.sigma
    }
}
