//! What all trials say together: means over seeds with their intervals.

use super::{
    metric::Metric,
    trial::{CURVE_METRICS, Trial},
};
use crate::eval::Interval;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// `experiments.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Results {
    /// From 1 to this.
    pub(super) seeds: u64,
    /// How many frames a sequence has; nothing for what suits the trajectory.
    pub(super) frames: Option<usize>,
    /// By the case's key.
    pub(super) cells: BTreeMap<String, Cell>,
}

/// One row on one sequence under one protocol.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Cell {
    /// Objects that were found, over all seeds.
    pub(super) found: usize,
    /// Objects that count, over all seeds.
    pub(super) true_objects: usize,
    pub(super) metrics: BTreeMap<Metric, Interval>,
    /// What the intervals are made of, seed by seed.
    #[serde(skip)]
    pub(super) samples: BTreeMap<Metric, Vec<Option<f64>>>,
    /// By the number of views, from 1; empty where association is not given.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) curves: BTreeMap<Metric, Vec<Option<Interval>>>,
}

impl Cell {
    /// Over the trials of all seeds; a seed in which nothing could be measured is left out.
    pub(super) fn of(trials: &[Trial]) -> Self {
        let over_seeds = |value: &dyn Fn(&Trial) -> Option<f64>| {
            let samples: Vec<f64> = trials.iter().filter_map(value).collect();
            Interval::of(&samples).map(rounded)
        };
        let measured: BTreeSet<Metric> =
            trials.iter().flat_map(|trial| trial.metrics.keys().copied()).collect();
        let sample = |trial: &Trial, metric| trial.metrics.get(&metric).copied();
        let metrics = measured
            .iter()
            .filter_map(|metric| Some((*metric, over_seeds(&|trial| sample(trial, *metric))?)));
        let samples = measured
            .iter()
            .map(|metric| (*metric, trials.iter().map(|trial| sample(trial, *metric)).collect()));
        let views = trials.iter().map(|trial| trial.curve.len()).max().unwrap_or(0);
        let curve = |which: usize| {
            let at = |views: usize| over_seeds(&|trial| (*trial.curve.get(views)?)[which]);
            (0..views).map(at).collect()
        };
        let curves = CURVE_METRICS.into_iter().enumerate().filter(|_| views > 0);
        Self {
            found: trials.iter().map(|trial| trial.found).sum(),
            true_objects: trials.iter().map(|trial| trial.true_objects).sum(),
            metrics: metrics.collect(),
            samples: samples.collect(),
            curves: curves.map(|(which, metric)| (metric, curve(which))).collect(),
        }
    }
}

impl Cell {
    /// The same, as far as no figure shows its curves.
    pub(super) fn without_curves(self) -> Self {
        Self { curves: BTreeMap::new(), ..self }
    }
}

/// By how much the first is more than the second on the same seeds.
pub(super) fn difference(a: &Cell, b: &Cell, metric: Metric) -> Option<Interval> {
    let pairs = a.samples.get(&metric)?.iter().zip(b.samples.get(&metric)?);
    let differences: Vec<f64> = pairs.filter_map(|(a, b)| Some((*a)? - (*b)?)).collect();
    Interval::of(&differences)
}

/// The last decimals of a file that is committed would differ from machine to machine and mean nothing.
fn rounded(interval: Interval) -> Interval {
    let round = |value: f64| (value * 1e6).round() / 1e6;
    Interval { mean: round(interval.mean), half_width: interval.half_width.map(round), ..interval }
}

impl Results {
    /// How many seeds.
    pub(super) fn seeds_in_words(&self) -> String {
        format!("{} seed{}", self.seeds, if self.seeds == 1 { "" } else { "s" })
    }

    /// The text of `experiments.json`, a line a cell.
    pub(super) fn json(&self) -> Result<String, serde_json::Error> {
        let cells = self.cells.iter().map(|(key, cell)| {
            Ok(format!("{}: {}", serde_json::to_string(key)?, serde_json::to_string(cell)?))
        });
        let cells: Vec<String> = cells.collect::<Result<_, serde_json::Error>>()?;
        Ok(format!(
            "{{\n\"seeds\": {},\n\"frames\": {},\n\"cells\": {{\n{}\n}}\n}}\n",
            self.seeds,
            serde_json::to_string(&self.frames)?,
            cells.join(",\n")
        ))
    }
}
