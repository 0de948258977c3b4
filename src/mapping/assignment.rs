//! The best assignment of measurements to objects, and where it is not clear.

use pathfinding::{kuhn_munkres::kuhn_munkres, matrix::Matrix};
use std::collections::BTreeMap;

/// What it costs each measurement to be each of the objects that it may be.
pub(super) type Costs = Vec<BTreeMap<usize, f64>>;

/// The assignment of smallest cost: for each measurement its object, or nothing where that costs `alone`.
pub(super) fn assign(costs: &Costs, alone: f64) -> Vec<Option<usize>> {
    let mut objects: Vec<usize> = costs.iter().flat_map(|row| row.keys().copied()).collect();
    objects.sort_unstable();
    objects.dedup();
    if objects.is_empty() {
        return vec![None; costs.len()];
    }
    // The algorithm wants numbers of a total order, and at least as many columns as rows: those beyond the objects mean
    // that a measurement stays alone.
    let saved = |(row, column): (usize, usize)| {
        let cost = objects.get(column).and_then(|object| costs[row].get(object));
        cost.map_or(0, |cost| ((alone - cost).max(0.0) * 1e9) as i64)
    };
    let weights = Matrix::from_fn(costs.len(), objects.len() + costs.len(), saved);
    let (_, columns) = kuhn_munkres(&weights);
    let pairs = columns.into_iter().enumerate();
    pairs.map(|pair| objects.get(pair.1).copied().filter(|_| saved(pair) > 0)).collect()
}

/// The other objects that a measurement might as well be: where giving it that one, and its own to the measurement that
/// has it, costs less than `margin` more.
pub(super) fn rivals(
    costs: &Costs,
    assigned: &[Option<usize>],
    measurement: usize,
    (alone, margin): (f64, f64),
) -> Vec<usize> {
    let Some(own) = assigned[measurement] else { return Vec::new() };
    let cost = |measurement: usize, object: usize| {
        costs[measurement].get(&object).copied().unwrap_or(alone).min(alone)
    };
    let more = |other: usize| {
        let here = cost(measurement, other) - cost(measurement, own);
        let holder = assigned.iter().position(|object| *object == Some(other));
        here + holder.map_or(0.0, |holder| cost(holder, own) - cost(holder, other))
    };
    let others = costs[measurement].keys().copied().filter(|other| *other != own);
    let near = others.filter(|other| cost(measurement, *other) < alone);
    near.filter(|other| more(*other) < margin).collect()
}
