//! The views that an object was measured from, and what similar ones are worth together.

use super::{SlamSettings, odometry::KeyframeId};
use crate::{
    geometry::Pose,
    graph::{
        BoxObservation, EllipsoidId, EllipsoidObservation, FactorId, Graph, NoiseError, PoseId,
    },
};
use std::{cmp::Reverse, collections::BTreeMap};

/// Factors of one object by the direction it was seen from.
#[derive(Clone, Debug, Default)]
pub(super) struct Views {
    sectors: BTreeMap<i64, Vec<View>>,
}

#[derive(Clone, Debug)]
pub(super) struct View {
    /// The keyframe it was made from.
    pub(super) keyframe: KeyframeId,
    /// How many looks at the object there had been; 0 where another object had it first.
    pub(super) order: u32,
    /// With all the information that the measurement claims.
    pub(super) factor: EllipsoidObservation,
    /// The sides of its box, as far as they say something besides.
    pub(super) sides: Option<BoxObservation>,
    in_graph: [Option<FactorId>; 2],
}

impl View {
    pub(super) fn new(
        keyframe: KeyframeId,
        factor: EllipsoidObservation,
        sides: Option<BoxObservation>,
    ) -> Self {
        Self { keyframe, order: 0, factor, sides, in_graph: [None; 2] }
    }

    /// Gives the graph its factors with the information that they have as one of `count` similar views.
    fn enter(
        &mut self,
        graph: &mut Graph,
        count: usize,
        correlation: f64,
    ) -> Result<(), NoiseError> {
        self.leave(graph);
        let factor = self.factor.clone().scaled(share(count, correlation))?;
        self.in_graph[0] = Some(graph.add_factor(factor));
        if let Some(sides) = &self.sides {
            let sides = sides.clone().scaled(share(count, SIDES_CORRELATION))?;
            self.in_graph[1] = Some(graph.add_factor(sides));
        }
        Ok(())
    }

    fn leave(&mut self, graph: &mut Graph) {
        let factors = std::mem::take(&mut self.in_graph);
        factors.into_iter().flatten().for_each(|factor| graph.remove_factor(factor));
    }
}

impl Views {
    /// Adds a measurement that was made from a keyframe of an object that is turned and placed as `map_from_object`.
    /// Returns the pose whose measurement was forgotten for it, if one was.
    ///
    /// Measurements from one direction see the same side and are wrong alike: if their errors have correlation `rho`,
    /// `n` of them are worth `n / (1 + (n - 1) rho)` independent ones. So each gets that share of its information,
    /// which shrinks for all of them as they become more. To save work it is set anew only when their number doubles,
    /// and as what they are worth is bounded, so is their number. The latest always counts: the robot's pose hangs on it.
    pub(super) fn add(
        &mut self,
        graph: &mut Graph,
        map_from_object: &Pose,
        mut view: View,
        settings: &SlamSettings,
    ) -> Result<Option<PoseId>, NoiseError> {
        let eye = graph.pose(view.keyframe.pose).translation.vector.into();
        let eye = map_from_object.inverse_transform_point(&eye);
        let bearing = eye.y.atan2(eye.x) / settings.similar_views_deg.to_radians();
        let sector = self.sectors.entry(bearing.round() as i64).or_default();
        let correlation = settings.similar_views_correlation;
        let mut forgotten = least_needed(sector).map(|at| sector.remove(at));
        forgotten.iter_mut().for_each(|view| view.leave(graph));
        let count = sector.len() + 1;
        if count.next_power_of_two() > sector.len().max(1).next_power_of_two() {
            for view in sector.iter_mut() {
                view.enter(graph, count, correlation)?;
            }
        }
        view.enter(graph, count, correlation)?;
        sector.push(view);
        Ok(forgotten.map(|view| view.keyframe.pose))
    }

    /// All of them, by direction.
    pub(super) fn all(&self) -> impl Iterator<Item = &View> {
        self.sectors.values().flatten()
    }

    /// Takes some out, with their factors.
    pub(super) fn take(&mut self, graph: &mut Graph, views: &[View]) {
        let factors = views.iter().flat_map(|view| view.in_graph).flatten();
        factors.for_each(|factor| graph.remove_factor(factor));
        for sector in self.sectors.values_mut() {
            sector.retain(|view| views.iter().all(|taken| taken.in_graph != view.in_graph));
        }
    }

    /// Adds the views that another object had. Returns the poses whose measurements were forgotten for them.
    pub(super) fn join(
        &mut self,
        graph: &mut Graph,
        (variable, map_from_object): (EllipsoidId, &Pose),
        views: Vec<View>,
        settings: &SlamSettings,
    ) -> Result<Vec<PoseId>, NoiseError> {
        let mut forgotten = Vec::new();
        for View { keyframe, factor, sides, .. } in views {
            let sides = sides.map(|sides| sides.of(variable));
            let view = View::new(keyframe, factor.of(variable), sides);
            forgotten.extend(self.add(graph, map_from_object, view, settings)?);
        }
        Ok(forgotten)
    }
}

/// The view to forget where there are too many: one of those that a keyframe has several of, otherwise the one whose
/// keyframe is worth least.
fn least_needed(views: &[View]) -> Option<usize> {
    let need = |view: &View| {
        let alike = views.iter().filter(|other| other.keyframe == view.keyframe).count();
        (Reverse(alike), view.keyframe.worth())
    };
    let least = (0..views.len()).min_by_key(|at| need(&views[*at]));
    least.filter(|_| views.len() == MAX_SIMILAR)
}

/// Share of its information that one of so many similar views has, up to the next power of two.
fn share(count: usize, correlation: f64) -> f64 {
    1.0 / (1.0 + (count.next_power_of_two() as f64 - 1.0) * correlation)
}

/// Errors of the sides of boxes in similar views: detectors draw them anew each time.
const SIDES_CORRELATION: f64 = 0.2;
/// With a correlation of a half, that many views are worth 1.9 independent ones, and all that could follow 2.
const MAX_SIMILAR: usize = 16;
