//! Symmetry planes, their score against the depth image, and the completion of what is hidden.
//!
//! Liao et al. 2020, section IV-B, with the score of Thrun and Wegbreit 2005.

use super::{Frame, Sight, segmentation::SurfacePoint};
use crate::geometry::Plane;
use nalgebra::{Point3, Unit, Vector3};
use serde::{Deserialize, Serialize};

/// How the objects of a class are symmetric. Liao et al. 2020, Table 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SymmetryType {
    /// Not to be relied on.
    None,
    /// One upright mirror plane: chairs, laptops, cups.
    #[default]
    Plane,
    /// Two upright mirror planes at right angles: tables, televisions, keyboards.
    DualPlane,
}

/// An upright mirror plane with its score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetryPlane {
    /// The plane.
    pub plane: Plane,
    /// `P_sym`: mean agreement of the mirrored points that the depth image can judge, in [0, 1].
    pub probability: f64,
    /// Share of the mirrored points that the depth image can judge, in [0, 1].
    pub evidence: f64,
    /// Standard deviation of the plane's position along its normal (m).
    pub sigma_m: f64,
}

/// Candidate plane: the angle of its normal and the normal's coordinate, in the level frame.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    angle: f64,
    offset: f64,
}

impl Candidate {
    fn plane(&self) -> Plane {
        let normal = Unit::new_unchecked(Vector3::new(self.angle.cos(), self.angle.sin(), 0.0));
        Plane { normal, offset: -self.offset }
    }
}

/// Refines the mirror plane with its normal at `angle` (rad) and coordinate `offset_m` along it, for an object that
/// extends `extent_m` along the normal. `is_centered` says that both its ends were seen, so that the plane is known to be
/// near the middle. `None` without evidence.
pub(super) fn refine_symmetry(
    frame: &Frame<'_>,
    points: &[SurfacePoint],
    angle: f64,
    offset_m: f64,
    extent_m: f64,
    is_centered: bool,
) -> Option<SymmetryPlane> {
    let every = points.len().div_ceil(MAX_SAMPLES).max(1);
    let samples: Vec<SurfacePoint> = points.iter().step_by(every).copied().collect();
    let judge = |c: &Candidate| score(frame, &samples, &c.plane(), 0.1 * extent_m);
    let mut best = Candidate { angle, offset: offset_m };
    let mut best_score = judge(&best);
    let search = if is_centered { 0 } else { 4 };
    for step in -search..=search {
        let offset = offset_m + f64::from(step) * 0.08 * extent_m;
        keep_better(&mut best, &mut best_score, Candidate { angle, offset }, &judge);
    }
    let (mut turn, mut shift) = (0.07, 0.04 * extent_m);
    for _ in 0..5 {
        for (da, d) in [(turn, 0.0), (-turn, 0.0), (0.0, shift), (0.0, -shift)] {
            let next = Candidate { angle: best.angle + da, offset: best.offset + d };
            if (next.angle - angle).abs() <= MAX_TURN_RAD {
                keep_better(&mut best, &mut best_score, next, &judge);
            }
        }
        (turn, shift) = (0.5 * turn, 0.5 * shift);
    }
    if best_score.evidence < MIN_EVIDENCE || best_score.probability() < MIN_PROBABILITY {
        return None;
    }
    Some(SymmetryPlane {
        plane: best.plane(),
        probability: best_score.probability(),
        evidence: best_score.evidence,
        sigma_m: width_of_peak(&best, &best_score, extent_m, &judge),
    })
}

fn keep_better(
    best: &mut Candidate,
    best_score: &mut Score,
    next: Candidate,
    judge: &impl Fn(&Candidate) -> Score,
) {
    let score = judge(&next);
    if score.objective() > best_score.objective() {
        (*best, *best_score) = (next, score);
    }
}

/// How far the plane can move before the objective drops to four fifths.
fn width_of_peak(
    best: &Candidate,
    score: &Score,
    extent_m: f64,
    judge: &impl Fn(&Candidate) -> Score,
) -> f64 {
    let drops = |shift: f64| {
        [-shift, shift].iter().all(|s| {
            let moved = Candidate { offset: best.offset + s, ..*best };
            judge(&moved).objective() < 0.8 * score.objective()
        })
    };
    [0.01, 0.02, 0.04, 0.08, 0.16]
        .into_iter()
        .map(|share| share * extent_m)
        .find(|shift| drops(*shift))
        .unwrap_or(0.3 * extent_m)
        .max(0.005)
}

/// What the depth image says of the mirrored points.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    /// Sum of the agreements of judged points over all points.
    agreement: f64,
    /// Judged points over all points.
    evidence: f64,
}

impl Score {
    /// `P_sym`.
    fn probability(&self) -> f64 {
        if self.evidence > 0.0 { self.agreement / self.evidence } else { 0.0 }
    }

    /// Agreement counts for, contradiction against, hidden points neither way: so a plane that throws everything
    /// into hidden space gains nothing.
    fn objective(&self) -> f64 {
        self.agreement - 0.5 * self.evidence
    }
}

/// Mirrors each point and looks where it lands: on a surface it agrees, in free space it contradicts, behind
/// a surface it says nothing. Points nearer to the plane than `min_distance_m` land on themselves and are left out.
fn score(frame: &Frame<'_>, samples: &[SurfacePoint], plane: &Plane, min_distance_m: f64) -> Score {
    let (mut agreement, mut judged) = (0.0, 0.0);
    for p in samples {
        if plane.signed_distance(&p.at).abs() < min_distance_m {
            continue;
        }
        let mirrored: Point3<f64> = plane.mirrored(&p.at);
        let Sight::Measured { beyond_m } = frame.look_at(&mirrored) else { continue };
        let sigma = (2.0 * p.sigma_m).hypot(SURFACE_SIGMA_M);
        // Along a grazing ray a small step across the surface is a long one along the ray.
        let incidence = p.normal.map_or(0.7, |n| {
            let n = n.into_inner() - plane.normal.into_inner() * (2.0 * plane.normal.dot(&n));
            (n.dot(&mirrored.coords) / mirrored.coords.norm()).abs().max(0.2)
        });
        let distance = beyond_m * incidence;
        if distance < -2.5 * sigma {
            continue;
        }
        judged += 1.0;
        agreement += (-0.5 * (distance / sigma).powi(2)).exp();
    }
    let n = samples.len().max(1) as f64;
    Score { agreement: agreement / n, evidence: judged / n }
}

const MAX_SAMPLES: usize = 160;
/// Tolerance for surfaces that are not exactly symmetric (m).
const SURFACE_SIGMA_M: f64 = 0.012;
/// The local search turns the plane by at most this much (rad).
const MAX_TURN_RAD: f64 = 0.18;
const MIN_EVIDENCE: f64 = 0.15;
const MIN_PROBABILITY: f64 = 0.5;
