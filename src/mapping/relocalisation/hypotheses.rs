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
    /// Where it is in the map (m).
    pub(super) x: f64,
}

/// The candidates of one seen object.
pub(super) struct Candidates {
    by_x: Vec<Candidate>,
    /// The most that one of them has.
    evidence: f64,
}

impl Candidates {
    pub(super) fn new(mut by_x: Vec<Candidate>) -> Self {
        by_x.sort_by(|a, b| a.x.total_cmp(&b.x));
        let evidence = by_x.iter().map(|c| c.evidence).fold(f64::MIN, f64::max);
        Self { by_x, evidence }
    }

    /// Those within `reach` of an x in the map (m).
    pub(super) fn near(&self, x: f64, reach: f64) -> &[Candidate] {
        let from = self.by_x.partition_point(|c| c.x < x - reach);
        let count = self.by_x[from..].partition_point(|c| c.x <= x + reach);
        &self.by_x[from..from + count]
    }

    /// How far off one of them still speaks for a place (m), when no variance of its distance is larger than this (m^2).
    ///
    /// It does where `d^2 < 2 v (e - ln(2 pi v))`, which rises with the variance up to `v = exp(e - 1) / 2 pi`.
    fn reach(&self, largest_variance: f64) -> f64 {
        let variance = largest_variance.min((self.evidence - 1.0).exp() / TAU);
        (2.0 * variance * (self.evidence - (TAU * variance).ln())).max(0.0).sqrt()
    }
}

/// Exact but for the bound: any place that explains two of the objects looked at is proposed by these two.
///
/// Objects are taken in the order of how few candidates they have. After the first `r` of `n` objects every place that
/// explains more than `n - r + 1` has been proposed, as it explains at least two of the `r`.
pub(super) fn proposals(
    seen: &[Body],
    map: &Constellation,
    candidates: &[Candidates],
) -> Proposals {
    let mut rarest: Vec<usize> =
        (0..seen.len()).filter(|l| !candidates[*l].by_x.is_empty()).collect();
    rarest.sort_by_key(|l| (candidates[*l].by_x.len(), *l));
    let reach = Reach::of(seen);
    let mut cells: BTreeMap<[i64; 4], (f64, Placement)> = BTreeMap::new();
    let (mut budget, mut whole) = (MAX_COMPARED, rarest.len());
    for (j, second) in rarest.iter().enumerate() {
        let compared = |first: &usize| -> usize {
            let pair = Pair::new((*first, *second), seen, map);
            let of_first = candidates[*first].by_x.iter();
            of_first.map(|from| candidates[*second].near(from.x, pair.reach).len()).sum()
        };
        let cost: usize = rarest[..j].iter().map(compared).sum();
        if cost > budget {
            whole = j;
            break;
        }
        budget -= cost;
        for first in &rarest[..j] {
            let pair = Pair::new((*first, *second), seen, map);
            for placement in pair.placements(map, &candidates[*first], &candidates[*second]) {
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

/// Two seen objects.
struct Pair<'a> {
    bodies: [&'a Body; 2],
    /// From one to the other (m).
    step: Vector3<f64>,
    /// What two of the map can be apart on the ground at most (m).
    reach: f64,
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

impl<'a> Pair<'a> {
    fn new((first, second): (usize, usize), seen: &'a [Body], map: &Constellation) -> Self {
        let bodies = [&seen[first], &seen[second]];
        let step = bodies[1].center - bodies[0].center;
        let own: f64 = bodies.iter().map(|body| body.horizontal_variance()).sum();
        let most = own + 2.0 * map.largest_variance;
        Self { bodies, step, reach: step.xy().norm() + GATE * most.sqrt() }
    }

    /// All places that put the two onto two of the map.
    fn placements(
        &self,
        map: &Constellation,
        firsts: &Candidates,
        seconds: &Candidates,
    ) -> Vec<ByPair> {
        let onto = firsts.by_x.iter().flat_map(|from| {
            let others = seconds.near(from.x, self.reach).iter();
            others.filter(|to| to.known != from.known).map(move |to| (from.known, to.known))
        });
        onto.filter_map(|(from, to)| self.onto([&map.bodies[from], &map.bodies[to]])).collect()
    }

    /// The place that puts the two onto these two of the map, if they can be the same.
    fn onto(&self, known: [&Body; 2]) -> Option<ByPair> {
        let ([a, b], [c, d]) = (self.bodies, known);
        let apart = d.center - c.center;
        let (length, known_length) = (self.step.xy().norm(), apart.xy().norm());
        let sum = |of: fn(&Body) -> f64| [a, b, c, d].into_iter().map(of).sum::<f64>();
        let across = sum(Body::horizontal_variance);
        let upright = sum(|body| body.spread[(2, 2)]);
        if (length - known_length).abs() > GATE * across.sqrt()
            || (self.step.z - apart.z).abs() > GATE * upright.sqrt()
        {
            return None;
        }
        // So near to each other that they do not say a heading.
        let baseline = 0.5 * (length + known_length);
        if baseline < MIN_BASELINE_IN_SIGMAS * across.sqrt() {
            return None;
        }
        let yaw = apart.y.atan2(apart.x) - self.step.y.atan2(self.step.x);
        let turned = Placement { yaw, shift: Vector3::zeros() };
        let middle = 0.5 * (a.center + b.center);
        let shift = 0.5 * (c.center + d.center) - turned.place(&middle);
        Some(ByPair {
            placement: Placement { yaw, shift },
            middle,
            shift_variance: 0.25 * across,
            yaw_variance: across / (baseline * baseline),
        })
    }
}

impl ByPair {
    /// About how much the seen objects speak for it: without headings, and with objects of the map used twice.
    fn quick_score(&self, seen: &[Body], map: &Constellation, candidates: &[Candidates]) -> f64 {
        let rotation = self.placement.rotation();
        let of_seen = |(body, candidates): (&Body, &Candidates)| {
            let at = rotation * body.center + self.placement.shift;
            let lever = (body.center - self.middle).xy().norm_squared();
            let own = body.horizontal_variance() + self.shift_variance + self.yaw_variance * lever;
            let of_candidate = |candidate: &Candidate| {
                let known = &map.bodies[candidate.known];
                let variance = own + known.horizontal_variance();
                let apart = (known.center - at).xy().norm_squared();
                candidate.evidence - 0.5 * apart / variance - (TAU * variance).ln()
            };
            let reach = candidates.reach(own + map.largest_variance);
            candidates.near(at.x, reach).iter().map(of_candidate).fold(0.0, f64::max)
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
