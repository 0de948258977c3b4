//! Which way an upright object is turned, from its points seen from above.

use super::segmentation::SurfacePoint;
use nalgebra::Vector2;

/// Heading of the object's axes and how sure it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heading {
    /// Angle of one of the axes in the level frame (rad), modulo a quarter turn.
    pub(super) yaw: f64,
    /// Standard deviation (rad).
    pub(super) sigma: f64,
    /// Whether straight faces or edges tell it; otherwise a square has none.
    pub(super) of_faces: bool,
}

/// Heading from the normals of vertical faces, which agree modulo a quarter turn on anything box-like.
///
/// `None` when too few faces were seen or they agree on nothing: a round object.
pub(super) fn heading_of_faces(points: &[SurfacePoint]) -> Option<Heading> {
    let normals: Vec<Vector2<f64>> =
        points.iter().filter_map(|p| p.normal.map(|n| n.xy())).filter(|n| n.norm() > 0.8).collect();
    if normals.len() < MIN_NORMALS || normals.len() * 12 < points.len() {
        return None;
    }
    // The mean direction of the quadrupled angle, reweighted so that rounded edges and clutter lose their say.
    let mut weights = vec![1.0; normals.len()];
    let mut yaw = 0.0;
    let mut concentration = 0.0;
    for _ in 0..4 {
        let (mut c, mut s, mut total) = (0.0, 0.0, 0.0);
        for (n, w) in normals.iter().zip(&weights) {
            let angle = 4.0 * n.y.atan2(n.x);
            c += w * angle.cos();
            s += w * angle.sin();
            total += w;
        }
        if total <= 0.0 {
            return None;
        }
        yaw = 0.25 * s.atan2(c);
        concentration = c.hypot(s) / total;
        for (n, w) in normals.iter().zip(&mut weights) {
            let off = quarter_difference(n.y.atan2(n.x), yaw);
            *w = 1.0 / (1.0 + (off / FACE_SPREAD_RAD).powi(4));
        }
    }
    let near = normals
        .iter()
        .filter(|n| quarter_difference(n.y.atan2(n.x), yaw).abs() < 2.0 * FACE_SPREAD_RAD)
        .count();
    if concentration < 0.5 || 3 * near < normals.len() {
        return None;
    }
    // Neighbouring normals share pixels: about one in ten counts.
    let spread = (-2.0 * concentration.max(1e-3).ln()).max(0.0).sqrt() / 4.0;
    let sigma = spread / (0.1 * near as f64).max(1.0).sqrt();
    Some(Heading { yaw, sigma: sigma.hypot(MIN_SIGMA_RAD), of_faces: true })
}

/// Heading of the smallest rectangle around the footprint.
pub(super) fn heading_of_rectangle(points: &[SurfacePoint]) -> Heading {
    let flat: Vec<Vector2<f64>> = points.iter().map(|p| p.at.coords.xy()).collect();
    let area = |yaw: f64| {
        let (sin, cos) = yaw.sin_cos();
        let extent = |axis: Vector2<f64>| {
            let mut c: Vec<f64> = flat.iter().map(|p| p.dot(&axis)).collect();
            let (low, high) = (quantile(&mut c, 0.02), quantile(&mut c, 0.98));
            high - low
        };
        extent(Vector2::new(cos, sin)) * extent(Vector2::new(-sin, cos))
    };
    let steps = 30;
    let step = std::f64::consts::FRAC_PI_2 / f64::from(steps);
    let areas: Vec<f64> = (0..steps).map(|i| area(f64::from(i) * step)).collect();
    let best = (0..areas.len()).min_by(|a, b| areas[*a].total_cmp(&areas[*b])).unwrap_or(0);
    let mut yaw = best as f64 * step;
    let mut width = step;
    for _ in 0..4 {
        width *= 0.5;
        yaw = [yaw - width, yaw, yaw + width]
            .into_iter()
            .min_by(|a, b| area(*a).total_cmp(&area(*b)))
            .unwrap_or(yaw);
    }
    // A footprint whose rectangle hardly grows when it is turned says little about its heading.
    let worst = areas.iter().copied().fold(0.0, f64::max);
    let contrast = (1.0 - areas[best] / worst.max(1e-9)).clamp(0.0, 1.0);
    let sigma = (0.02 / contrast.max(0.02)).hypot(MIN_SIGMA_RAD).min(0.8);
    Heading { yaw, sigma, of_faces: false }
}

/// The `share` quantile; reorders `values`.
pub(super) fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let at = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

/// `a - b` modulo a quarter turn, within ±45 degrees (rad).
pub(super) fn quarter_difference(a: f64, b: f64) -> f64 {
    let quarter = std::f64::consts::FRAC_PI_2;
    let d = (a - b).rem_euclid(quarter);
    if d > 0.5 * quarter { d - quarter } else { d }
}

const MIN_NORMALS: usize = 25;
/// Spread of normals on one face, from depth noise (rad).
const FACE_SPREAD_RAD: f64 = 0.2;
/// No heading is better than this: handles, drawers and round edges (rad).
pub(super) const MIN_SIGMA_RAD: f64 = 0.02;
