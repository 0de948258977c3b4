//! A new run against figures that were kept.

use super::results::Results;
use crate::eval::Interval;

/// What came of a comparison.
pub(super) struct Comparison {
    /// Means that were compared.
    pub(super) compared: usize,
    /// A sentence for each that is not as it was.
    pub(super) differences: Vec<String>,
}

/// Looks for each new mean in the interval that was kept; what was kept but not run again is passed over.
pub(super) fn compare(fresh: &Results, kept: &Results) -> Comparison {
    let mut comparison = Comparison { compared: 0, differences: Vec::new() };
    for (key, cell) in &fresh.cells {
        let Some(before) = kept.cells.get(key) else {
            comparison.differences.push(format!("{key} is not in the file"));
            continue;
        };
        for (metric, now) in &cell.metrics {
            let what = format!("{key}, {}", metric.title());
            comparison.mean(&what, now, before.metrics.get(metric));
        }
        for (metric, curve) in &cell.curves {
            let before = before.curves.get(metric);
            for (at, now) in curve.iter().enumerate() {
                let Some(now) = now else { continue };
                let before = before.and_then(|curve| curve.get(at)?.as_ref());
                let what = format!("{key}, {} after {} views", metric.title(), at + 1);
                comparison.mean(&what, now, before);
            }
        }
    }
    comparison
}

impl Comparison {
    fn mean(&mut self, what: &str, now: &Interval, before: Option<&Interval>) {
        self.compared += 1;
        match before {
            None => self.differences.push(format!("{what}: is {}, was not there", now.mean)),
            Some(before) if !before.holds(now.mean) => self.differences.push(format!(
                "{what}: is {}, was {} ± {}",
                now.mean,
                before.mean,
                before.half_width.unwrap_or(0.0)
            )),
            Some(_) => (),
        }
    }
}
