//! A place in full: who is who, the best pose, and how probable it all is.

use super::{
    Constellation, ExpectedPlace, Relocalised,
    hypotheses::Candidates,
    landmark::{Body, Comparison, Placement, wrapped},
};
use nalgebra::{Matrix2, Matrix4, Vector2, Vector3, Vector4};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A seen object that is one of the map's.
pub(super) struct Match {
    pub(super) seen: usize,
    pub(super) known: usize,
}

/// A place that explains some of the seen objects.
pub(super) struct Place {
    pub(super) placement: Placement,
    /// Of heading and translation in the map (rad, m).
    pub(super) covariance: Matrix4<f64>,
    pub(super) matches: Vec<Match>,
    /// Logarithm of how much likelier all that was seen is here than by chance.
    pub(super) evidence: f64,
    /// What each seen object contributes to that.
    of_seen: Vec<f64>,
    /// Whether the place explains it, as far as errors go.
    explains: Vec<bool>,
}

impl Place {
    /// The best place near a first guess: who is who and where that puts it, in turns.
    pub(super) fn refined(
        start: &Placement,
        seen: &[Body],
        map: &Constellation,
        candidates: &[Candidates],
        expected: Option<&ExpectedPlace>,
    ) -> Option<Self> {
        let mut placement = *start;
        let mut information = Matrix4::zeros();
        for doubt_m in DOUBTS_M {
            let matches = assigned(&placement, seen, map, candidates, doubt_m);
            for _ in 0..STEPS {
                let step;
                (information, step) = normal_equations(&placement, &matches, seen, map, expected);
                let step = information.cholesky()?.solve(&step);
                placement.yaw += step[0];
                placement.shift += step.fixed_rows::<3>(1);
            }
        }
        let covariance = information.cholesky()?.inverse();
        let matches = assigned(&placement, seen, map, candidates, 0.0);
        let mut of_seen = vec![map.settings.new_object_probability.ln(); seen.len()];
        let mut explains = vec![false; seen.len()];
        for (found, evidence) in &matches {
            of_seen[found.seen] = log_with_new(*evidence, map);
            let known = &map.bodies[found.known];
            explains[found.seen] =
                Comparison::new(&seen[found.seen], known, &placement).is_plausible();
        }
        let place = covariance.determinant().sqrt() * TAU * TAU;
        let evidence = of_seen.iter().sum::<f64>()
            + place.ln()
            + log_prior_density(&placement, expected, map.area);
        let matches = matches.into_iter().map(|(found, _)| found).collect();
        Some(Self { placement, covariance, matches, evidence, of_seen, explains })
    }

    /// Whether another place is this one: it puts the seen objects to about the same places.
    pub(super) fn is_same(&self, other: &Self, seen: &[Body]) -> bool {
        let apart = |body: &Body| {
            (self.placement.place(&body.center) - other.placement.place(&body.center)).norm()
        };
        let mean = seen.iter().map(apart).sum::<f64>() / seen.len() as f64;
        mean < SAME_PLACE_M
    }

    /// Whether the mirror image of what was recognised would fit as well: objects in a row are the same from either side.
    /// One or two that do not fit prove nothing, as they may be others.
    pub(super) fn fits_mirrored(&self, seen: &[Body], map: &Constellation) -> bool {
        let known = || self.matches.iter().map(|m| map.bodies[m.known].center.xy());
        let count = self.matches.len();
        let middle = known().sum::<Vector2<f64>>() / count as f64;
        let scatter: Matrix2<f64> =
            known().map(|at| (at - middle) * (at - middle).transpose()).sum();
        let across =
            0.5 * (2.0 * scatter[(0, 1)]).atan2(scatter[(0, 0)] - scatter[(1, 1)]) + FRAC_PI_2;
        let across = Vector2::new(across.cos(), across.sin());
        let fits = |m: &&Match| {
            let (body, known) = (&seen[m.seen], &map.bodies[m.known]);
            let at = self.placement.place(&body.center).xy() - middle;
            let mirrored = middle + at - across * (2.0 * at.dot(&across));
            let apart = (known.center.xy() - mirrored).norm_squared();
            let variance = known.horizontal_variance() + body.horizontal_variance();
            apart < MAX_SIGMAS * MAX_SIGMAS * variance
        };
        self.matches.iter().filter(fits).count() + 2 >= count
    }

    /// The place as it is reported.
    pub(super) fn relocalised(&self, false_probability: f64) -> Relocalised {
        Relocalised {
            map_from_seen: self.placement.pose(),
            covariance: self.covariance,
            matches: self.matches.iter().map(|m| (m.seen, m.known)).collect(),
            false_probability,
        }
    }

    /// How much the single object that speaks most for this place says.
    pub(super) fn largest_contribution(&self) -> f64 {
        self.of_seen.iter().copied().fold(0.0, f64::max)
    }

    /// How much the objects that another place cannot explain speak for this one, and how much without the one that
    /// says most. What the other explains a little worse says nothing: two places that look the same are never measured
    /// equally well.
    pub(super) fn advantage(&self, other: &Self) -> (f64, f64) {
        let (mut sum, mut largest) = (0.0, 0.0_f64);
        for seen in 0..self.of_seen.len() {
            if !other.explains[seen] {
                let more = self.of_seen[seen] - other.of_seen[seen];
                sum += more;
                largest = largest.max(more);
            }
        }
        (sum, sum - largest)
    }
}

/// Logarithm of the likelihood of an object that is known with this evidence, or new.
fn log_with_new(evidence: f64, map: &Constellation) -> f64 {
    let new = map.settings.new_object_probability;
    (new + (1.0 - new) * evidence.exp()).ln()
}

/// Who is who at a place, most evident first, nobody twice, and how evident it is.
fn assigned(
    placement: &Placement,
    seen: &[Body],
    map: &Constellation,
    candidates: &[Candidates],
    doubt_m: f64,
) -> Vec<(Match, f64)> {
    let mut pairs = Vec::new();
    for (s, body) in seen.iter().enumerate() {
        let at = placement.place(&body.center);
        let most = map.largest_variance + body.horizontal_variance() + doubt_m * doubt_m;
        for candidate in candidates[s].near(at.x, MAX_SIGMAS * (2.0 * most).sqrt()) {
            let known = &map.bodies[candidate.known];
            let reach = (known.center - at).xy().norm_squared();
            let variance = known.horizontal_variance() + body.horizontal_variance();
            if reach > MAX_SIGMAS * MAX_SIGMAS * 2.0 * (variance + doubt_m * doubt_m) {
                continue;
            }
            let compared = Comparison::new(body, known, placement);
            let evidence = candidate.evidence
                + compared.likeness
                + compared.log_ground_density(doubt_m * doubt_m);
            if evidence > 0.0 {
                pairs.push((Match { seen: s, known: candidate.known }, evidence));
            }
        }
    }
    pairs.sort_by(|a, b| {
        b.1.total_cmp(&a.1).then((a.0.seen, a.0.known).cmp(&(b.0.seen, b.0.known)))
    });
    let mut matches: Vec<(Match, f64)> = Vec::new();
    for (found, evidence) in pairs {
        let is_free = |m: &(Match, f64)| m.0.seen != found.seen && m.0.known != found.known;
        if matches.iter().all(is_free) {
            matches.push((found, evidence));
        }
    }
    matches
}

/// Information about heading and translation, and its product with the step to the least squares solution.
fn normal_equations(
    placement: &Placement,
    matches: &[(Match, f64)],
    seen: &[Body],
    map: &Constellation,
    expected: Option<&ExpectedPlace>,
) -> (Matrix4<f64>, Vector4<f64>) {
    // Where next to nothing is known the step must not become infinite.
    let mut information = Matrix4::from_diagonal(&BARELY_KNOWN.map(|sigma| 1.0 / (sigma * sigma)));
    let mut right = Vector4::zeros();
    for (found, _) in matches {
        let body = &seen[found.seen];
        let compared = Comparison::new(body, &map.bodies[found.known], placement);
        let Some(weight) = compared.spread.cholesky().map(|c| c.inverse()) else { continue };
        let arm = placement.rotation() * body.center;
        let mut jacobian = nalgebra::Matrix3x4::zeros();
        jacobian.set_column(0, &Vector3::new(-arm.y, arm.x, 0.0));
        jacobian.fixed_view_mut::<3, 3>(0, 1).fill_with_identity();
        information += jacobian.transpose() * weight * jacobian;
        right += jacobian.transpose() * weight * compared.apart;
        information[(0, 0)] += 1.0 / compared.turned_variance;
        right[0] += compared.turned / compared.turned_variance;
    }
    if let Some((prior, weight)) = expected.and_then(|e| Some((e, e.covariance.cholesky()?))) {
        let weight = weight.inverse();
        information += weight;
        right += weight * -difference(placement, prior);
    }
    (information, right)
}

/// How far a place is from the expected one.
fn difference(placement: &Placement, expected: &ExpectedPlace) -> Vector4<f64> {
    let prior = Placement::of_pose(&expected.pose);
    let shift = placement.shift - prior.shift;
    Vector4::new(wrapped(placement.yaw - prior.yaw, TAU), shift.x, shift.y, shift.z)
}

/// Logarithm of the density of a place before anything is seen (1/rad/m^3).
fn log_prior_density(placement: &Placement, expected: Option<&ExpectedPlace>, area: f64) -> f64 {
    let Some(expected) = expected else { return -(TAU * area * STOREY_M).ln() };
    let Some(root) = expected.covariance.cholesky() else { return f64::NEG_INFINITY };
    let apart = difference(placement, expected);
    let log_volume = 2.0 * TAU.ln() + 0.5 * root.determinant().ln();
    -0.5 * apart.dot(&root.solve(&apart)) - log_volume
}

/// From the first guess to the last step, additional doubt about where things are (m).
const DOUBTS_M: [f64; 4] = [0.3, 0.15, 0.0, 0.0];
/// Gauss-Newton steps for each.
const STEPS: usize = 2;
/// What is farther off is not looked at.
const MAX_SIGMAS: f64 = 5.0;
/// Two places that put what was seen within this are one (m).
const SAME_PLACE_M: f64 = 0.3;
/// Heights between which a robot may have been switched on (m).
const STOREY_M: f64 = 1.0;
/// Standard deviations of a place before anything is seen (rad, m).
const BARELY_KNOWN: Vector4<f64> = Vector4::new(10.0, 1e3, 1e3, 1e3);
