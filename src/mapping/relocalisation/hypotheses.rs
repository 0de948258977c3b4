//! Where the constellation might be: every pair of objects that fits a pair of the map says a place.

use super::{
    Constellation,
    landmark::{Body, Placement},
};
use nalgebra::Vector3;
use std::{collections::BTreeMap, f64::consts::TAU};

/// The places that pairs propose, best first, each once, and how far the search went.
pub(super) struct Proposals {
    pub(super) placements: Vec<Placement>,
    /// A place that explains more of the seen objects than this was among those looked at.
    pub(super) complete_above: usize,
}

/// An object of the map that a seen one might be, and how much its label and size speak for that.
pub(super) struct Candidate {
    pub(super) known: usize,
    pub(super) evidence: f64,
}

/// Exact but for the bound: any place that explains two of the objects looked at is proposed by these two.
///
/// Objects are taken in the order of how few candidates they have. After the first `r` of `n` objects every place that
/// explains more than `n - r + 1` has been proposed, as it explains at least two of the `r`.
pub(super) fn proposals(
    seen: &[Body],
    map: &Constellation,
    candidates: &[Vec<Candidate>],
) -> Proposals {
    let mut rarest: Vec<usize> = (0..seen.len()).filter(|l| !candidates[*l].is_empty()).collect();
    rarest.sort_by_key(|l| (candidates[*l].len(), *l));
    let reach = Reach::of(seen);
    let mut cells: BTreeMap<[i64; 4], (f64, Placement)> = BTreeMap::new();
    let (mut budget, mut whole) = (MAX_COMPARED, rarest.len());
    for (j, second) in rarest.iter().enumerate() {
        let cost: usize = rarest[..j]
            .iter()
            .map(|first| candidates[*first].len() * candidates[*second].len())
            .sum();
        if cost > budget {
            whole = j;
            break;
        }
        budget -= cost;
        for first in &rarest[..j] {
            for placement in placements((*first, *second), seen, map, candidates) {
                let score = placement.quick_score(seen, map, candidates);
                let cell = reach.cell(&placement.placement);
                let entry = cells.entry(cell).or_insert((score, placement.placement));
                if score > entry.0 {
                    *entry = (score, placement.placement);
                }
            }
        }
    }
    let mut best: Vec<(f64, Placement)> = cells.into_values().collect();
    best.sort_by(|a, b| b.0.total_cmp(&a.0));
    best.truncate(MAX_PROPOSALS);
    Proposals {
        placements: best.into_iter().map(|(_, placement)| placement).collect(),
        complete_above: rarest.len() - whole + 1,
    }
}

/// Where the seen objects are, to tell places apart by where they put these.
struct Reach {
    middle: Vector3<f64>,
    radius: f64,
}

impl Reach {
    fn of(seen: &[Body]) -> Self {
        let middle = seen.iter().map(|b| b.center).sum::<Vector3<f64>>() / seen.len() as f64;
        let radius = seen.iter().map(|b| (b.center - middle).norm()).fold(CELL_M, f64::max);
        Self { middle, radius }
    }

    fn cell(&self, placement: &Placement) -> [i64; 4] {
        let at = placement.place(&self.middle) / CELL_M;
        let turn = placement.yaw.rem_euclid(TAU) * self.radius / CELL_M;
        [at.x, at.y, at.z, turn].map(|x| x.round() as i64)
    }
}

/// A place as a pair says it.
struct ByPair {
    placement: Placement,
    /// Middle of the pair as it was seen.
    middle: Vector3<f64>,
    /// Of the middle (m^2).
    shift_variance: f64,
    /// Of the heading (rad^2).
    yaw_variance: f64,
}

/// All places that put two seen objects onto two of the map.
fn placements(
    (first, second): (usize, usize),
    seen: &[Body],
    map: &Constellation,
    candidates: &[Vec<Candidate>],
) -> Vec<ByPair> {
    let (a, b) = (&seen[first], &seen[second]);
    let step = b.center - a.center;
    let length = step.xy().norm();
    let mut found = Vec::new();
    for from in &candidates[first] {
        for to in candidates[second].iter().filter(|to| to.known != from.known) {
            let (c, d) = (&map.bodies[from.known], &map.bodies[to.known]);
            let known = d.center - c.center;
            let known_length = known.xy().norm();
            let sum = |of: fn(&Body) -> f64| [a, b, c, d].iter().map(|body| of(body)).sum::<f64>();
            let across = sum(Body::horizontal_variance);
            let upright = sum(|body| body.spread[(2, 2)]);
            if (length - known_length).abs() > GATE * across.sqrt()
                || (step.z - known.z).abs() > GATE * upright.sqrt()
            {
                continue;
            }
            // So near to each other that they do not say a heading.
            let baseline = 0.5 * (length + known_length);
            if baseline < MIN_BASELINE_IN_SIGMAS * across.sqrt() {
                continue;
            }
            let yaw = known.y.atan2(known.x) - step.y.atan2(step.x);
            let turned = Placement { yaw, shift: Vector3::zeros() };
            let middle = 0.5 * (a.center + b.center);
            let shift = 0.5 * (c.center + d.center) - turned.place(&middle);
            found.push(ByPair {
                placement: Placement { yaw, shift },
                middle,
                shift_variance: 0.25 * across,
                yaw_variance: across / (baseline * baseline),
            });
        }
    }
    found
}

impl ByPair {
    /// About how much the seen objects speak for it: without headings, and with objects of the map used twice.
    fn quick_score(
        &self,
        seen: &[Body],
        map: &Constellation,
        candidates: &[Vec<Candidate>],
    ) -> f64 {
        let of_seen = |(body, candidates): (&Body, &Vec<Candidate>)| {
            let at = self.placement.place(&body.center);
            let lever = (body.center - self.middle).xy().norm_squared();
            let own = body.horizontal_variance() + self.shift_variance + self.yaw_variance * lever;
            let of_candidate = |candidate: &Candidate| {
                let known = &map.bodies[candidate.known];
                let variance = own + known.horizontal_variance();
                let apart = (known.center - at).xy().norm_squared();
                candidate.evidence - 0.5 * apart / variance - (TAU * variance).ln()
            };
            candidates.iter().map(of_candidate).fold(0.0, f64::max)
        };
        seen.iter().zip(candidates).map(of_seen).sum()
    }
}

/// Standard deviations within which two distances are the same.
const GATE: f64 = 4.0;
/// Pairs that are nearer to each other say too little about the heading.
const MIN_BASELINE_IN_SIGMAS: f64 = 2.0;
/// Places that differ by less are looked at once (m).
const CELL_M: f64 = 0.3;
/// Pairs of pairs that are compared at most.
const MAX_COMPARED: usize = 3_000_000;
/// Places that are looked at in full.
const MAX_PROPOSALS: usize = 60;
