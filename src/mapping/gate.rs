//! How well a measurement fits an object.

use super::{Hints, MapObject, Measured, Observation, ObservedBox};
use crate::{
    geometry::{Ellipsoid, OrientedBox, Pose, intersection_volume, skew},
    graph::{
        BoxObservation, BoxSide, CovarianceRoot, EllipsoidObservation, Factor, Graph,
        Linearization, PoseId, Variable,
    },
};
use nalgebra::{DMatrix, DVector, Matrix6, SMatrix};
use serde::{Deserialize, Serialize};

/// Which measurements may be one object. Costs are negative logarithms of probabilities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GateSettings {
    /// What it costs to take a measurement for something new; what fits an object worse is not that object.
    pub new_object_cost: f64,
    /// Where two answers differ by less, none is given.
    pub ambiguity: f64,
    /// Standard deviation of a centre besides what covariances say (m).
    pub position_sigma_m: f64,
    /// Of a semi-axis, as a share of it.
    pub size_sigma_ratio: f64,
    /// Of a heading (deg).
    pub heading_sigma_deg: f64,
    /// A box without a measurement is an object's where it overlaps so much of what is expected.
    pub min_box_overlap: f64,
}

impl Default for GateSettings {
    fn default() -> Self {
        Self {
            new_object_cost: 12.0,
            ambiguity: 1.5,
            position_sigma_m: 0.03,
            size_sigma_ratio: 0.15,
            heading_sigma_deg: 20.0,
            min_box_overlap: 0.3,
        }
    }
}

/// The way from the last pose that the graph has solved to where the robot is now, with its covariance.
pub(super) struct Step {
    /// That pose; nothing in a graph without poses.
    pub(super) pose: Option<PoseId>,
    /// Where that pose is.
    pub(super) map_from_pose: Pose,
    pub(super) pose_from_base: Pose,
    pub(super) covariance: Matrix6<f64>,
}

/// A measurement as the gate compares it.
pub(super) struct Candidate {
    factors: Vec<Box<dyn Factor>>,
}

impl Candidate {
    /// `pose` is that of the keyframe: only names the factor.
    pub(super) fn new(
        (observation, measured): (&Observation, &Measured),
        step: &Step,
        (pose, object): (PoseId, &MapObject),
        settings: &GateSettings,
    ) -> Self {
        if let Some(hints) = measured.glimpse.as_ref().filter(|_| observation.compares_box(object))
        {
            return Self::of_boxes((observation, measured, hints), step, (pose, object));
        }
        let ellipsoid = measured.ellipsoid.transformed(&step.pose_from_base);
        let mut covariance = measured.covariance + moved(&measured.ellipsoid, &step.covariance);
        let sigmas = [settings.position_sigma_m, settings.size_sigma_ratio];
        covariance[(2, 2)] += settings.heading_sigma_deg.to_radians().powi(2);
        for i in 0..3 {
            covariance[(3 + i, 3 + i)] += sigmas[0].powi(2);
            covariance[(6 + i, 6 + i)] += sigmas[1].powi(2);
        }
        // What has no covariance fits nothing; the graph will say why.
        let factor = EllipsoidObservation::new(
            pose,
            object.variable(),
            ellipsoid,
            &covariance,
            object.outline,
        );
        let factor = factor.map(|factor| Box::new(factor) as Box<dyn Factor>);
        Self { factors: factor.into_iter().collect() }
    }

    /// Of an object that was never measured, boxes are compared: where a box says that it is by itself, the usual size of its
    /// class says, which is wrong alike for all of them.
    fn of_boxes(
        (observation, measured, hints): (&Observation, &Measured, &Hints),
        step: &Step,
        (pose, object): (PoseId, &MapObject),
    ) -> Self {
        let mut factors: Vec<Box<dyn Factor>> = Vec::new();
        let turned = step.covariance.fixed_view::<3, 3>(0, 0).symmetric_eigenvalues().max();
        let ObservedBox { base_from_camera, sides } = observation.sides;
        let camera = step.pose_from_base * base_from_camera;
        let loose = |side: BoxSide| {
            let sigma = (side.sigma * SIDE_DOUBT).hypot(turned.max(0.0).sqrt());
            BoxSide { sigma, ..side }
        };
        let sides = sides.map(|side| side.map(loose));
        let sides = BoxObservation::new(pose, object.variable(), camera, object.outline, sides);
        factors.extend(sides.ok().map(|factor| Box::new(factor) as Box<dyn Factor>));
        let ellipsoid = measured.ellipsoid.transformed(&step.pose_from_base);
        let depth = EllipsoidObservation::new(
            pose,
            object.variable(),
            ellipsoid,
            &hints.depth_covariance,
            object.outline,
        );
        factors.extend(depth.ok().map(|factor| Box::new(factor) as Box<dyn Factor>));
        Self { factors }
    }

    /// What it costs to be an object: half the squared Mahalanobis distance with the joint covariance of pose and object
    /// (Kaess and Dellaert 2009, Covariance recovery from a square root information matrix for data association), and more
    /// for an object that would fit anything because it is hardly known. `known` is their [`joint_covariance`].
    pub(super) fn cost(
        &self,
        graph: &Graph,
        step: &Step,
        (object, known): (&MapObject, &DMatrix<f64>),
    ) -> f64 {
        if self.factors.is_empty() {
            return f64::MAX;
        }
        let estimate = graph.ellipsoid(object.variable());
        let at = [Variable::Pose(step.map_from_pose), Variable::Ellipsoid(estimate)];
        let linear: Vec<_> = self.factors.iter().map(|factor| factor.linearize(&at)).collect();
        let rows = linear.iter().map(|linear| linear.residual.len()).sum();
        let (mut residual, mut jacobian) = (DVector::zeros(rows), DMatrix::zeros(rows, 15));
        let mut row = 0;
        for Linearization { residual: r, jacobian: j } in &linear {
            residual.rows_mut(row, r.len()).copy_from(r);
            jacobian.rows_mut(row, r.len()).copy_from(j);
            row += r.len();
        }
        let mut innovation = &jacobian * known * jacobian.transpose();
        (0..rows).for_each(|i| innovation[(i, i)] += 1.0);
        match innovation.cholesky() {
            Some(factors) => {
                let vagueness =
                    factors.l_dirty().diagonal().iter().map(|entry| entry.ln()).sum::<f64>();
                0.5 * residual.dot(&factors.solve(&residual))
                    + (VAGUENESS_SHARE * vagueness).min(MOST_VAGUENESS)
            }
            None => f64::MAX,
        }
    }
}

/// How well the pose that a step begins at is known.
pub(super) struct KnownPose {
    root: CovarianceRoot,
    /// Of `[rotation, translation]`.
    pub(super) covariance: Matrix6<f64>,
}

impl KnownPose {
    pub(super) fn new(graph: &Graph, pose: PoseId) -> Self {
        let root = graph.covariance_root(&[pose.into()]);
        let covariance = root.with(&root).fixed_view::<6, 6>(0, 0).into_owned();
        Self { root, covariance }
    }
}

/// The joint covariance of the pose that a step begins at, which is certain where there is none, and an object.
pub(super) fn joint_covariance(
    graph: &Graph,
    pose: Option<&KnownPose>,
    object: &MapObject,
) -> DMatrix<f64> {
    let own = graph.covariance_root(&[object.variable().into()]);
    let mut joint = DMatrix::zeros(15, 15);
    joint.view_mut((6, 6), (9, 9)).copy_from(&own.with(&own));
    if let Some(pose) = pose {
        let both = pose.root.with(&own);
        joint.view_mut((0, 0), (6, 6)).copy_from(&pose.covariance);
        joint.view_mut((6, 0), (9, 6)).copy_from(&both.transpose());
        joint.view_mut((0, 6), (6, 9)).copy_from(&both);
    }
    joint
}

/// The covariance that an uncertain step gives to what is measured after it, as a right perturbation of the object.
fn moved(measured: &Ellipsoid, step: &Matrix6<f64>) -> SMatrix<f64, 9, 9> {
    let object_from_base = measured.pose.rotation.inverse().to_rotation_matrix().into_inner();
    let mut adjoint = SMatrix::<f64, 9, 6>::zeros();
    adjoint.fixed_view_mut::<3, 3>(0, 0).copy_from(&object_from_base);
    adjoint.fixed_view_mut::<3, 3>(3, 3).copy_from(&object_from_base);
    let turned = -object_from_base * skew(measured.center().coords);
    adjoint.fixed_view_mut::<3, 3>(3, 0).copy_from(&turned);
    adjoint * step * adjoint.transpose()
}

/// The common part of two bodies' boxes, as a share of the smaller and of both together.
pub(super) fn overlap(a: &Ellipsoid, b: &Ellipsoid) -> (f64, f64) {
    let (a, b) = (OrientedBox::from(a), OrientedBox::from(b));
    let common = intersection_volume(&a, &b);
    let (smaller, sum) = (a.volume().min(b.volume()), a.volume() + b.volume());
    (common / smaller, common / (sum - common))
}

/// Sides of single boxes are wrong by more than they say now and then.
const SIDE_DOUBT: f64 = 2.0;
/// The likelihood of a measurement falls with the root of the innovation's determinant. Half of its logarithm counts, as a
/// pose that is hardly known makes all objects vague alike,
const VAGUENESS_SHARE: f64 = 0.5;
/// and no more than this: a measurement must find an object of which there were only glimpses.
const MOST_VAGUENESS: f64 = 4.0;
