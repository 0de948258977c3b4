//! Time a stage, memory at the peak: the clock readings that the core itself does not take.

use crate::{
    perception::{Stage, StageObserver},
    time::Stamp,
};
use std::{
    collections::BTreeMap,
    fmt::Write,
    fs,
    time::{Duration, Instant},
};

/// Measures the stages of each keyframe.
#[derive(Debug, Default)]
pub(super) struct Stopwatch {
    running: Option<(Stage, Instant)>,
    current: BTreeMap<Stage, Duration>,
    keyframes: Vec<(Stamp, BTreeMap<Stage, Duration>)>,
}

impl StageObserver for Stopwatch {
    fn enter(&mut self, stage: Option<Stage>) {
        let now = now();
        if let Some((last, since)) = self.running.take() {
            *self.current.entry(last).or_default() += now - since;
        }
        self.running = stage.map(|stage| (stage, now));
    }
}

/// Time a keyframe over a whole run (ms).
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(super) struct KeyframeTime {
    pub(super) mean_ms: f64,
    pub(super) median_ms: f64,
    pub(super) p99_ms: f64,
}

impl Stopwatch {
    /// What was measured since the last call belongs to this keyframe.
    pub(super) fn end_keyframe(&mut self, stamp: Stamp) {
        self.keyframes.push((stamp, std::mem::take(&mut self.current)));
    }

    /// A line a keyframe, a column a stage (ms).
    pub(super) fn csv(&self) -> String {
        let mut text = String::from("stamp");
        for stage in Stage::ALL {
            text.push(',');
            text.push_str(stage.name());
        }
        text.push_str(",total\n");
        for (stamp, stages) in &self.keyframes {
            text.push_str(&stamp.to_string());
            for stage in Stage::ALL {
                let spent = stages.get(&stage).copied().unwrap_or_default();
                let _ = write!(text, ",{:.3}", spent.as_secs_f64() * 1e3);
            }
            let _ = writeln!(text, ",{:.3}", total_ms(stages));
        }
        text
    }

    /// The mean of each stage (ms) over at most so many groups of keyframes, with the time since the first keyframe (s).
    pub(super) fn profile(&self, groups: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
        let Some((first, _)) = self.keyframes.first() else { return (Vec::new(), Vec::new()) };
        let groups = self.keyframes.chunks(self.keyframes.len().div_ceil(groups).max(1));
        let group = |group: &[(Stamp, BTreeMap<Stage, Duration>)]| {
            let stages = Stage::ALL.map(|stage| {
                let spent = group.iter().filter_map(|(_, stages)| stages.get(&stage));
                let ms = spent.sum::<Duration>().as_secs_f64() * 1e3 / group.len() as f64;
                (ms * 1e3).round() / 1e3
            });
            let last = group.last().map_or(0.0, |(stamp, _)| stamp.seconds_since(*first));
            (last, stages.to_vec())
        };
        groups.map(group).unzip()
    }

    pub(super) fn keyframe_time(&self) -> Option<KeyframeTime> {
        let mut totals: Vec<f64> = self.keyframes.iter().map(|(_, s)| total_ms(s)).collect();
        totals.sort_by(f64::total_cmp);
        let at = |share: f64| totals.get(((totals.len() as f64 - 1.0) * share).round() as usize);
        Some(KeyframeTime {
            mean_ms: totals.iter().sum::<f64>() / totals.len().max(1) as f64,
            median_ms: *at(0.5)?,
            p99_ms: *at(0.99)?,
        })
    }
}

fn total_ms(stages: &BTreeMap<Stage, Duration>) -> f64 {
    stages.values().sum::<Duration>().as_secs_f64() * 1e3
}

/// The shells are where clocks are read.
#[expect(clippy::disallowed_methods, reason = "a shell measures time; the core does not")]
pub(super) fn now() -> Instant {
    Instant::now()
}

/// Largest resident memory of this process so far (MB), where the system says.
pub(super) fn peak_memory_mb() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes / 1024.0)
}
