//! What the page plots over time.

use super::{recorded::Counts, recorded::Recorded, rounded};
use crate::geometry::yaw_of;
use serde::Serialize;
use std::collections::BTreeMap;

/// Bars of a plot, at most.
const MAX_BINS: usize = 150;

/// Boxes and objects, summed over bins of equal length.
#[derive(Debug, Serialize)]
pub(super) struct BoxSeries {
    /// End of each bin (s).
    t: Vec<f64>,
    objects: Vec<usize>,
    used: Vec<usize>,
    /// By reason.
    refused: BTreeMap<&'static str, Vec<usize>>,
}

/// How much the map corrects odometry, beside the first pose.
#[derive(Debug, Serialize)]
pub(super) struct Drift {
    t: Vec<f64>,
    metres: Vec<f64>,
    degrees: Vec<f64>,
}

impl BoxSeries {
    pub(super) fn of(counts: &[Counts]) -> Self {
        let per_bin = counts.len().div_ceil(MAX_BINS).max(1);
        let bins: Vec<&[Counts]> = counts.chunks(per_bin).collect();
        let reasons = counts.iter().flat_map(|count| count.refused.keys().copied());
        let mut refused: BTreeMap<&'static str, Vec<usize>> =
            reasons.map(|reason| (reason, Vec::new())).collect();
        for (reason, series) in &mut refused {
            let of = |count: &Counts| count.refused.get(reason).copied().unwrap_or_default();
            series.extend(bins.iter().map(|bin| bin.iter().map(of).sum::<usize>()));
        }
        let last = |bin: &&[Counts]| bin.last().map_or((0.0, 0), |count| (count.t, count.objects));
        Self {
            t: bins.iter().map(|bin| last(bin).0).collect(),
            objects: bins.iter().map(|bin| last(bin).1).collect(),
            used: bins.iter().map(|bin| bin.iter().map(|count| count.used).sum()).collect(),
            refused,
        }
    }
}

impl Drift {
    pub(super) fn of(recorded: &Recorded) -> Self {
        let (mut t, mut metres, mut degrees) = (Vec::new(), Vec::new(), Vec::new());
        let every = recorded.way.len().div_ceil(4 * MAX_BINS).max(1);
        let correction = |at: usize| {
            let pose = &recorded.way[at].2;
            pose.map_from_base * pose.odom_from_base.inverse()
        };
        for at in (0..recorded.way.len()).step_by(every) {
            let (first, now) = (correction(0), correction(at));
            // Of the base: how far a turn moves the origin of odometry says nothing.
            let odom = recorded.way[at].2.odom_from_base;
            let moved = (now * odom).translation.vector - (first * odom).translation.vector;
            t.push(rounded(recorded.way[at].0));
            metres.push(rounded(moved.norm()));
            degrees.push(rounded(yaw_of(&(first.inverse() * now)).to_degrees()));
        }
        Self { t, metres, degrees }
    }
}
