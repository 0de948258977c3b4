//! Objects of which there are only boxes without depth, until one is measured.

use super::MapObject;
use crate::{
    geometry::skew,
    graph::{Graph, PoseId},
};
use nalgebra::SMatrix;

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
}

/// Standard deviation of the place of an object from which there must be more than glimpses (m).
const PLACED_SIGMA_M: f64 = 0.5;
