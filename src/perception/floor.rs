//! The floor that the robot's wheels stand on: it says how the camera is tilted against it.

use super::{Frame, SupportSettings};
use crate::geometry::Plane;
use nalgebra::{Cholesky, Matrix2, Matrix3, Point3, Unit, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The floor in one frame.
#[derive(Clone, Copy, Debug)]
pub struct Floor {
    /// In the frame's level frame; its normal points up.
    pub plane: Plane,
    /// Covariance (rad^2) of its slopes: how much it rises along x, where the camera looks, and along y.
    pub slope_covariance: Matrix2<f64>,
}

impl Floor {
    /// How much it rises along x and y of the level frame (rad), where gravity was known exactly 0.
    pub fn slopes(&self) -> Vector2<f64> {
        let up = self.plane.normal;
        Vector2::new(-up.x / up.z, -up.y / up.z)
    }
}

/// Finds the plane that comes nearest to `wheels`, the base's origin in the level frame, and looks level but for a generous tilt.
///
/// The planes of [`find_support_planes`](super::find_support_planes) take gravity as known within a few degrees already; this one tells
/// gravity, so it is searched among all readings near where the floor has to be.
pub fn find_floor(
    frame: &Frame<'_>,
    wheels: &Point3<f64>,
    max_range_m: f64,
    settings: &SupportSettings,
) -> Option<Floor> {
    let samples = samples(frame, wheels, max_range_m, settings.flatness_m);
    let per_sample = (STRIDE_PX * STRIDE_PX) as usize;
    let enough = (MIN_POINTS / per_sample).max(6);
    if samples.len() < enough {
        return None;
    }
    let plane = best_plane(&samples, wheels)?;
    let (plane, slope_covariance) = refined(plane, &samples, enough, settings.flatness_m)?;
    is_under_wheels(&plane, wheels).then_some(Floor { plane, slope_covariance })
}

/// A reading near where the floor has to be, with the variance of its height (m^2).
#[derive(Clone, Copy)]
struct Sample {
    at: Point3<f64>,
    variance: f64,
}

impl Sample {
    fn is_near(&self, plane: &Plane, sigmas: f64) -> bool {
        plane.signed_distance(&self.at).powi(2) < sigmas * sigmas * self.variance
    }
}

fn samples(
    frame: &Frame<'_>,
    wheels: &Point3<f64>,
    max_range_m: f64,
    flatness_m: f64,
) -> Vec<Sample> {
    let (width, height) = (frame.depth().width() as i32, frame.depth().height() as i32);
    let mut out = Vec::new();
    for v in (STRIDE_PX / 2..height).step_by(STRIDE_PX as usize) {
        for u in (STRIDE_PX / 2..width).step_by(STRIDE_PX as usize) {
            let Some(at) = frame.point_in_level(u, v) else { continue };
            let Some(z) = frame.depth().at(u, v).map(f64::from) else { continue };
            let from_wheels = at - wheels;
            // Noise acts along the ray, which a floor meets at a grazing angle.
            let sigma_m = frame.sigma_m(z) * at.z / at.coords.norm();
            let variance = sigma_m.powi(2) + flatness_m.powi(2);
            let reach_m = MAX_TILT * from_wheels.xy().norm() + WHEELS_M;
            if z <= max_range_m && at.z < 0.0 && from_wheels.z.abs() < reach_m {
                out.push(Sample { at, variance });
            }
        }
    }
    out
}

/// The plane through three samples that has most of the others on it.
fn best_plane(samples: &[Sample], wheels: &Point3<f64>) -> Option<Plane> {
    let scored: Vec<&Sample> = samples.iter().step_by(samples.len().div_ceil(MAX_SCORED)).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut best: Option<(usize, Plane)> = None;
    for _ in 0..HYPOTHESES {
        let mut draw = || samples[rng.random_range(0..samples.len())].at;
        let (a, b, c) = (draw(), draw(), draw());
        let Some(normal) = Unit::try_new((b - a).cross(&(c - a)), MIN_BASE_M * MIN_BASE_M) else {
            continue;
        };
        let plane = Plane::through(&a, if normal.z < 0.0 { -normal } else { normal });
        if !is_under_wheels(&plane, wheels) {
            continue;
        }
        let score = scored.iter().filter(|s| s.is_near(&plane, INLIER_SIGMAS)).count();
        if best.is_none_or(|(most, _)| score > most) {
            best = Some((score, plane));
        }
    }
    best.map(|(_, plane)| plane)
}

fn is_under_wheels(plane: &Plane, wheels: &Point3<f64>) -> bool {
    let is_level = plane.normal.xy().norm() < MAX_TILT * plane.normal.z;
    is_level && plane.signed_distance(wheels).abs() < WHEELS_M
}

/// Height as a linear function of the place, by least squares on the inliers, and the covariance of its slopes.
fn refined(
    start: Plane,
    samples: &[Sample],
    enough: usize,
    flatness_m: f64,
) -> Option<(Plane, Matrix2<f64>)> {
    let mut found = None;
    let mut plane = start;
    for _ in 0..REFINEMENTS {
        let near: Vec<&Sample> =
            samples.iter().filter(|s| s.is_near(&plane, INLIER_SIGMAS)).collect();
        if near.len() < enough {
            return None;
        }
        let center = near.iter().map(|s| s.at.coords).sum::<Vector3<f64>>() / near.len() as f64;
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        let mut spread = Matrix2::zeros();
        for sample in &near {
            let d = sample.at.coords - center;
            let row = Vector3::new(d.x, d.y, 1.0);
            matrix += row * row.transpose() / sample.variance;
            right += row * (d.z / sample.variance);
            spread += d.xy() * d.xy().transpose() / near.len() as f64;
        }
        let inverse = Cholesky::new(matrix)?.inverse();
        let solution = inverse * right;
        let normal = Unit::try_new(Vector3::new(-solution.x, -solution.y, 1.0), 1e-9)?;
        plane = Plane::through(&(center + Vector3::z() * solution.z).into(), normal);
        let noise = inverse.fixed_view::<2, 2>(0, 0).into_owned() * SHARED;
        // The camera bends the floor by as much as it is not flat, over as far as it is seen.
        let bent = Cholesky::new(spread)?.inverse() * flatness_m.powi(2);
        found = Some((plane, noise + bent));
    }
    found
}

/// Pixels between samples.
const STRIDE_PX: i32 = 8;
/// Fewest readings on a floor, counted at full image resolution.
const MIN_POINTS: usize = 3000;
/// Tangent of the largest tilt: mounts are off by a few degrees, ramps rise by five.
const MAX_TILT: f64 = 0.18;
/// The floor passes the base's origin within this much: some bases have it at the height of the axle (m).
const WHEELS_M: f64 = 0.15;
/// Points that give a plane are about this far apart (m).
const MIN_BASE_M: f64 = 0.2;
const INLIER_SIGMAS: f64 = 3.0;
const HYPOTHESES: usize = 150;
const MAX_SCORED: usize = 500;
const REFINEMENTS: usize = 3;
/// Readings that are worth as much as one independent one: neighbours share errors of the sensor.
const SHARED: f64 = 10.0;
const SEED: u64 = 11;
