//! Objects of which there are only boxes without depth, until one is measured.

use super::{Hints, MapObject, Observation, SlamSettings, ties::Tie, views::View};
use crate::{
    geometry::{Ellipsoid, Plane, Pose, skew},
    graph::{EllipsoidId, EllipsoidPrior, Factor, Graph, Noise, NoiseError, PoseId, Variable},
};
use nalgebra::{Point3, SMatrix, SVector};

impl MapObject {
    /// Whether it was never measured: its place follows from boxes without depth, seen from several places.
    pub fn is_glimpsed(&self) -> bool {
        self.glimpsed
    }

    /// Whether it is known where it is, seen from the robot. Glimpses tell it from different places only.
    pub(super) fn is_placed(&self) -> bool {
        self.placed
    }

    /// Whether it may be anywhere along the directions that it was seen in.
    pub(super) fn is_adrift(&self) -> bool {
        self.glimpsed && !self.placed
    }

    /// Of what does not count yet, looks whether it is known where it is from a pose that it was seen from: how well the pose is
    /// known is no matter.
    pub(super) fn judge_place(&mut self, graph: &Graph, pose: PoseId) {
        if self.counts() {
            return;
        }
        let pose_from_object = graph.pose(pose).inverse() * self.ellipsoid.pose;
        let mut by_both = SMatrix::<f64, 3, 15>::zeros();
        let rotation = pose_from_object.rotation.to_rotation_matrix().into_inner();
        by_both.fixed_view_mut::<3, 3>(0, 0).copy_from(&skew(pose_from_object.translation.vector));
        by_both.fixed_view_mut::<3, 3>(0, 3).copy_from(&-SMatrix::<f64, 3, 3>::identity());
        by_both.fixed_view_mut::<3, 3>(0, 9).copy_from(&rotation);
        let joint = graph.covariance(&[pose.into(), self.variable.into()]);
        let place: SMatrix<f64, 3, 3> =
            by_both * joint.fixed_view::<15, 15>(0, 0) * by_both.transpose();
        let most_m = if self.stands() { STANDING_SIGMA_M } else { PLACED_SIGMA_M };
        self.placed = place.symmetric_eigenvalues().max().sqrt() < most_m;
    }

    /// Whether there are only glimpses of it, and nearly all of them may be of another object, wherever that is.
    pub(super) fn is_only_glimpsed_as(&self, other: &Self, graph: &Graph) -> bool {
        if !self.glimpsed {
            return false;
        }
        let body = Variable::Ellipsoid(graph.ellipsoid(other.variable));
        let shows_other = |view: &&View| {
            let at = [Variable::Pose(graph.pose(view.keyframe.pose)), body];
            let sides = view.sides.as_ref().map(|sides| sides.residual(&at));
            let own = view.factor.residual(&at);
            let rows = own.len() + sides.as_ref().map_or(0, |sides| sides.len());
            let squared = own.norm_squared() + sides.map_or(0.0, |sides| sides.norm_squared());
            squared < SAME_BOXES * rows as f64
        };
        let views = self.views.all().count();
        let shared = self.views.all().filter(shows_other).count();
        views > 0 && shared as f64 >= MOST_VIEWS * views as f64
    }

    /// Begins the estimate anew at the range from `eye` that all its boxes fit best: descent on a robust cost does not come
    /// from the range that the first box suggested to one twice as large.
    pub(super) fn range_anew(&self, graph: &mut Graph, eye: &Point3<f64>) {
        let estimate = graph.ellipsoid(self.variable);
        let line = estimate.center() - eye;
        let at_range = |ratio: f64| {
            let pose = Pose::from_parts((eye + ratio * line).into(), estimate.pose.rotation);
            Ellipsoid { pose, semi_axes: ratio * estimate.semi_axes }
        };
        let cost = |body: &Ellipsoid| -> f64 {
            let body = Variable::Ellipsoid(*body);
            let of_factor = |factor: &dyn Factor, at: &[Variable]| {
                factor.kernel().cost(factor.residual(at).norm_squared())
            };
            let of_view = |view: &View| {
                let at = [Variable::Pose(graph.pose(view.keyframe.pose)), body];
                let sides = view.sides.as_ref().map_or(0.0, |sides| of_factor(sides, &at));
                of_factor(&view.factor, &at) + sides
            };
            let by_itself = self.ties.iter().filter(|tie| tie.pose.is_none());
            self.views.all().map(of_view).sum::<f64>()
                + by_itself.map(|tie| of_factor(tie.factor(), &[body])).sum::<f64>()
        };
        let (mut best, mut least) = (None, cost(&estimate) - SURELY_BETTER);
        for ratio in RANGE_RATIOS {
            let body = at_range(ratio);
            let cost = cost(&body);
            if cost < least {
                (best, least) = (Some(body), cost);
            }
        }
        if let Some(body) = best {
            graph.set_ellipsoid(self.variable, body);
        }
    }

    /// Ties it to the floor in the map that it is said to stand on, if any, or to the lowest of several: an image may show a
    /// table's top and no floor. With the lower side of a box, that is a range.
    pub(super) fn stand_on(
        &mut self,
        graph: &mut Graph,
        floor: Option<Plane>,
        settings: &SlamSettings,
    ) -> Result<(), NoiseError> {
        let Some(floor) = floor else { return Ok(()) };
        let above_m = |plane: &Plane| plane.signed_distance(&self.ellipsoid.center());
        let known_m = self.ties.iter().find_map(Tie::support).map(above_m);
        if known_m.is_some_and(|known_m| above_m(&floor) < known_m + LOWER_BY_M) {
            return Ok(());
        }
        self.remove_ties(graph, |tie| tie.support().is_some());
        let to = (self.variable, self.outline);
        let support = Tie::support_factor(to, floor, settings)?;
        self.ties.push(Tie::new(graph, support, None));
        Ok(())
    }

    /// Whether it is known what it stands on.
    pub(super) fn stands(&self) -> bool {
        self.ties.iter().any(|tie| tie.support().is_some())
    }

    /// Another one that is the same thing has told how large it usually is.
    pub(super) fn forget_usual_size(&mut self, graph: &mut Graph) {
        self.remove_ties(graph, |tie| tie.pose.is_none() && tie.support().is_none());
    }
}

impl Observation {
    /// Whether it is hardly more than a direction.
    pub(super) fn is_glimpse(&self) -> bool {
        self.measured.as_ref().is_some_and(|measured| measured.glimpse.is_some())
    }

    /// Whether boxes alone tell if it is this object.
    pub(super) fn compares_box(&self, object: &MapObject) -> bool {
        self.is_glimpse() && object.is_glimpsed() && self.sides.has_any()
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

/// A glimpse may be of an object with this mean squared residual, in standard deviations; so many of them are enough.
const SAME_BOXES: f64 = 2.0;
const MOST_VIEWS: f64 = 0.75;
/// Ranges that are tried, as shares of the estimated one.
const RANGE_RATIOS: [f64; 8] = [0.4, 0.5, 0.65, 0.8, 1.25, 1.5, 2.0, 2.5];
/// A plane is another one where it is lower by so much (m).
const LOWER_BY_M: f64 = 0.1;
/// By so much the cost has to be less.
const SURELY_BETTER: f64 = 1.0;
/// What a class says of place and heading: nothing, except that what was nearer the camera than wide stands across (rad, m).
const ANYWHERE: [f64; 9] = [10.0, 10.0, 1.0, 100.0, 100.0, 100.0, 0.0, 0.0, 0.0];

/// Standard deviation of the place of an object from which there must be more than glimpses (m).
const PLACED_SIGMA_M: f64 = 0.6;
/// The same where the floor says how far off it is: nothing of it is a guess from the usual size.
const STANDING_SIGMA_M: f64 = 0.7;
