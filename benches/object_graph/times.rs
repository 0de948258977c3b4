//! What is said of the times of a run.

use crate::world::{Keyframe, closures};

/// After a closure the tree settles during so many keyframes, which do not count as away from it.
const SETTLING: usize = 10;
/// Growth is from the first so many keyframes to the last.
const STRETCH: usize = 1000;

/// A run over all keyframes.
pub(crate) struct Run {
    /// By keyframe (ms).
    pub(crate) times: Vec<f64>,
    pub(crate) cost: f64,
    /// Of the batch optimum that is reached from there.
    pub(crate) batch_cost: f64,
}

/// Of some times (ms).
pub(crate) struct Spread {
    pub(crate) p50: f64,
    pub(crate) p99: f64,
    pub(crate) max: f64,
}

pub(crate) struct Summary {
    /// (s)
    pub(crate) total: f64,
    pub(crate) all: Spread,
    pub(crate) away: Spread,
    /// Medians away from closures.
    first: f64,
    last: f64,
}

impl Run {
    pub(crate) fn summary(&self, settling: &[bool]) -> Summary {
        let away = |stretch: &[f64], settling: &[bool]| {
            let kept = stretch.iter().zip(settling).filter(|(_, is_settling)| !**is_settling);
            spread(kept.map(|(time, _)| *time).collect())
        };
        let (count, times) = (self.times.len(), &self.times);
        let (head, tail) = (STRETCH.min(count), count.saturating_sub(STRETCH));
        Summary {
            total: times.iter().sum::<f64>() * 1e-3,
            all: spread(times.clone()),
            away: away(times, settling),
            first: away(&times[..head], &settling[..head]).p50,
            last: away(&times[tail..], &settling[tail..]).p50,
        }
    }

    pub(crate) fn print(&self, name: &str, settling: &[bool]) {
        let Summary { total, all, away, first, last } = self.summary(settling);
        println!("  {name}: {total:.2} s in total");
        println!(
            "    all keyframes:       p50 {:.3}, p99 {:.2}, max {:.1} ms",
            all.p50, all.p99, all.max
        );
        println!(
            "    away from closures:  p50 {:.3}, p99 {:.2}, max {:.1} ms (not within {SETTLING} keyframes of one)",
            away.p50, away.p99, away.max
        );
        println!(
            "    growth of the median from the first {STRETCH} to the last: {first:.3} to {last:.3} ms, {:.2} times",
            last / first
        );
        println!(
            "    cost {:.2}, batch optimum {:.2}: {:+.4} %",
            self.cost,
            self.batch_cost,
            100.0 * (self.cost / self.batch_cost - 1.0)
        );
    }
}

fn spread(mut times: Vec<f64>) -> Spread {
    times.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        let at = times.len().saturating_sub(1) as f64 * share;
        times.get(at.round() as usize).copied().unwrap_or(f64::NAN)
    };
    Spread { p50: quantile(0.5), p99: quantile(0.99), max: quantile(1.0) }
}

/// Which keyframes close a loop or follow one that does.
pub(crate) fn settling(world: &[Keyframe]) -> Vec<bool> {
    let closures = closures(world);
    let since = |at: usize| at.saturating_sub(SETTLING);
    (0..world.len()).map(|at| closures[since(at)..=at].contains(&true)).collect()
}
