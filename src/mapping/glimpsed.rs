//! Objects of which there are only boxes without depth, until one is measured.

use super::{Hints, MapObject, ties::Tie, views::View};
use crate::{
    geometry::{Ellipsoid, skew},
    graph::{EllipsoidId, EllipsoidPrior, Graph, Noise, NoiseError, PoseId},
};
use nalgebra::{SMatrix, SVector};

impl MapObject {
    /// Whether it was never measured: its place follows from boxes without depth, seen from several places.
    pub fn is_glimpsed(&self) -> bool {
        self.glimpsed
    }

    /// Whether it is known where it is, seen from the robot. Glimpses tell it from different places only.
    pub(super) fn is_placed(&self) -> bool {
        self.placed
    }

    /// Looks whether it is known where it is from a pose that it was seen from: how well the pose is known is no matter.
    pub(super) fn judge_place(&mut self, graph: &Graph, pose: PoseId) {
        let pose_from_object = graph.pose(pose).inverse() * self.ellipsoid.pose;
        let mut by_both = SMatrix::<f64, 3, 15>::zeros();
        let rotation = pose_from_object.rotation.to_rotation_matrix().into_inner();
        by_both.fixed_view_mut::<3, 3>(0, 0).copy_from(&skew(pose_from_object.translation.vector));
        by_both.fixed_view_mut::<3, 3>(0, 3).copy_from(&-SMatrix::<f64, 3, 3>::identity());
        by_both.fixed_view_mut::<3, 3>(0, 9).copy_from(&rotation);
        let joint = graph.covariance(&[pose.into(), self.variable.into()]);
        let place: SMatrix<f64, 3, 3> =
            by_both * joint.fixed_view::<15, 15>(0, 0) * by_both.transpose();
        self.placed = place.symmetric_eigenvalues().max().sqrt() < PLACED_SIGMA_M;
    }

    /// From the first measurement on, glimpses say nothing new. Returns the poses they were made from.
    pub(super) fn forget_glimpses(&mut self, graph: &mut Graph) -> Vec<PoseId> {
        self.glimpsed = false;
        let glimpses: Vec<View> = self.views.all().cloned().collect();
        self.views.take(graph, &glimpses);
        self.ties.drain(..).for_each(|tie| graph.remove_factor(tie.in_graph));
        glimpses.iter().map(|view| view.keyframe.pose).collect()
    }

    /// Another one that is the same thing has told how large it usually is.
    pub(super) fn forget_usual_size(&mut self, graph: &mut Graph) {
        let is_of_view = |tie: &Tie| tie.pose.is_some();
        let sizes = self.ties.iter().filter(|tie| !is_of_view(tie));
        sizes.for_each(|tie| graph.remove_factor(tie.in_graph));
        self.ties.retain(is_of_view);
    }
}

impl Hints {
    /// That an object that was first seen as `first` is about as large as things of its class are.
    pub(super) fn prior(
        &self,
        object: EllipsoidId,
        first: &Ellipsoid,
    ) -> Result<EllipsoidPrior, NoiseError> {
        let usual = Ellipsoid { semi_axes: self.usual.semi_axes, ..*first };
        let mut covariance = SMatrix::from_diagonal(&SVector::from(ANYWHERE.map(|s| s * s)));
        covariance.fixed_view_mut::<3, 3>(6, 6).copy_from(&self.usual.covariance);
        Ok(EllipsoidPrior::new(object, usual, Noise::from_covariance(&covariance)?))
    }
}

/// What a class says of place and heading: nothing, except that what was nearer the camera than wide stands across (rad, m).
const ANYWHERE: [f64; 9] = [10.0, 10.0, 1.0, 100.0, 100.0, 100.0, 0.0, 0.0, 0.0];

/// Standard deviation of the place of an object from which there must be more than glimpses (m).
const PLACED_SIGMA_M: f64 = 0.6;
