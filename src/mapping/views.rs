//! The views that an object was measured from, and what similar ones are worth together.

use super::{SlamSettings, odometry::Place};
use crate::graph::{EllipsoidObservation, FactorId, Graph, NoiseError, PoseId};
use nalgebra::Point3;
use std::{cmp::Reverse, collections::BTreeMap};

/// Factors of one object by the direction it was seen from.
#[derive(Clone, Debug, Default)]
pub(super) struct Views {
    sectors: BTreeMap<i64, Vec<View>>,
}

#[derive(Clone, Debug)]
struct View {
    pose: PoseId,
    /// The keyframe's.
    number: usize,
    /// With all the information that the measurement claims.
    factor: EllipsoidObservation,
    in_graph: FactorId,
}

impl Views {
    /// Adds a measurement that was made from a keyframe, with the eye in the object's frame. Returns the keyframe whose
    /// measurement was forgotten for it, if one was.
    ///
    /// Measurements from one direction see the same side and are wrong alike: if their errors have correlation `rho`,
    /// `n` of them are worth `n / (1 + (n - 1) rho)` independent ones. So each gets that share of its information,
    /// which shrinks for all of them as they become more. To save work it is set anew only when their number doubles,
    /// and as what they are worth is bounded, so is their number. The latest always counts: the robot's pose hangs on it.
    pub(super) fn add(
        &mut self,
        graph: &mut Graph,
        eye: &Point3<f64>,
        (place, factor): (&Place, EllipsoidObservation),
        settings: &SlamSettings,
    ) -> Result<Option<PoseId>, NoiseError> {
        let bearing = eye.y.atan2(eye.x) / settings.similar_views_deg.to_radians();
        let sector = self.sectors.entry(bearing.round() as i64).or_default();
        let share = |count: usize| {
            let expected = count.next_power_of_two() as f64;
            1.0 / (1.0 + (expected - 1.0) * settings.similar_views_correlation)
        };
        let forgotten = least_needed(sector).map(|at| sector.remove(at));
        forgotten.iter().for_each(|view| graph.remove_factor(view.in_graph));
        let now = share(sector.len() + 1);
        if now < share(sector.len().max(1)) {
            for view in sector.iter_mut() {
                graph.remove_factor(view.in_graph);
                view.in_graph = graph.add_factor(view.factor.clone().scaled(now)?);
            }
        }
        let in_graph = graph.add_factor(factor.clone().scaled(now)?);
        sector.push(View { pose: place.pose, number: place.number, factor, in_graph });
        Ok(forgotten.map(|view| view.pose))
    }
}

/// The view to forget where there are too many: one of those that a keyframe has several of, otherwise the one whose
/// keyframe's number can be halved least often. What is left is spread evenly over the whole drive, from the same
/// keyframes for all objects, so that few poses have to be kept.
fn least_needed(views: &[View]) -> Option<usize> {
    let need = |view: &View| {
        let alike = views.iter().filter(|other| other.pose == view.pose).count();
        (Reverse(alike), view.number.trailing_zeros())
    };
    let least = (0..views.len()).min_by_key(|at| need(&views[*at]));
    least.filter(|_| views.len() == MAX_SIMILAR)
}

/// With a correlation of a half, that many views are worth 1.9 independent ones, and all that could follow 2.
const MAX_SIMILAR: usize = 16;
