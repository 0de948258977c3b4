//! How regular stamps are, and how well two topics' stamps match.

use crate::time::Stamp;
use serde::Serialize;

/// How regularly a topic is stamped.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Rhythm {
    /// Messages a second between the first and the last stamp.
    pub rate_hz: f64,
    /// Median time between messages in seconds.
    pub median_gap_s: f64,
    /// Longest time between messages in seconds.
    pub max_gap_s: f64,
    /// Times between messages that are longer than three medians.
    pub gaps: usize,
    /// Messages stamped before their predecessor.
    pub backwards: usize,
}

impl Rhythm {
    /// Of the stamps of a topic in the order of the bag.
    pub(super) fn of(stamps: &[Stamp]) -> Self {
        let backwards = stamps.windows(2).filter(|pair| pair[1] < pair[0]).count();
        let sorted = sorted(stamps);
        let mut gaps: Vec<f64> =
            sorted.windows(2).map(|pair| pair[1].seconds_since(pair[0])).collect();
        gaps.sort_by(f64::total_cmp);
        let (median_gap_s, max_gap_s) = (median(&gaps), gaps.last().copied().unwrap_or(0.0));
        let total: f64 = gaps.iter().sum();
        Self {
            rate_hz: if total > 0.0 { gaps.len() as f64 / total } else { 0.0 },
            median_gap_s,
            max_gap_s,
            gaps: gaps.iter().filter(|gap| **gap > 3.0 * median_gap_s).count(),
            backwards,
        }
    }
}

/// How well the stamps of one topic match those of another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Matching {
    /// Part of the messages with exactly the stamp of one of the other topic, from 0 to 1.
    pub exact_share: f64,
    /// Part of the messages within the slop of one of the other topic, from 0 to 1.
    pub within_slop_share: f64,
    /// Median distance to the nearest stamp of the other topic in seconds.
    pub median_offset_s: f64,
    /// Largest distance to the nearest stamp of the other topic in seconds.
    pub max_offset_s: f64,
}

impl Matching {
    /// Nothing if one of the topics has no messages.
    pub(super) fn of(stamps: &[Stamp], others: &[Stamp], slop_s: f64) -> Option<Self> {
        let others = sorted(others);
        let nearest = |stamp: &Stamp| {
            let after = others.partition_point(|other| other < stamp);
            let near = &others[after.saturating_sub(1)..others.len().min(after + 1)];
            near.iter().map(|other| other.seconds_since(*stamp).abs()).min_by(f64::total_cmp)
        };
        let mut offsets: Vec<f64> = stamps.iter().filter_map(nearest).collect();
        offsets.sort_by(f64::total_cmp);
        let max_offset_s = *offsets.last()?;
        let share = |count: usize| count as f64 / offsets.len() as f64;
        Some(Self {
            exact_share: share(offsets.partition_point(|offset| *offset == 0.0)),
            within_slop_share: share(offsets.partition_point(|offset| *offset <= slop_s)),
            median_offset_s: median(&offsets),
            max_offset_s,
        })
    }
}

/// For how many depth images there is odometry on both sides in time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coverage {
    /// Part of the depth images, from 0 to 1.
    pub share: f64,
}

impl Coverage {
    /// Nothing if one of the topics has no messages.
    pub(super) fn of(odometry: &[Stamp], depth: &[Stamp]) -> Option<Self> {
        let (first, last) = (*odometry.iter().min()?, *odometry.iter().max()?);
        let covered = depth.iter().filter(|stamp| (first..=last).contains(*stamp)).count();
        (!depth.is_empty()).then(|| Self { share: covered as f64 / depth.len() as f64 })
    }
}

fn sorted(stamps: &[Stamp]) -> Vec<Stamp> {
    let mut sorted = stamps.to_vec();
    sorted.sort_unstable();
    sorted
}

/// The middle of sorted values, the lower one of two; 0 for none.
fn median(sorted: &[f64]) -> f64 {
    sorted.get(sorted.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}
