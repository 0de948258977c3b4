//! Support planes: horizontal surfaces that objects stand on.
//!
//! Liao et al. 2020, section IV-A, after Zhang et al. 2019: RANSAC with a gravity prior. Several planes at several
//! heights are kept: floor, table tops, shelves.

use super::{Frame, bounds::Bounds};
use crate::geometry::Plane;
use nalgebra::{Cholesky, Matrix3, Point3, Unit, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// How support planes are found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SupportSettings {
    /// Largest angle between a plane's normal and gravity, the paper's eps0 (deg).
    pub max_tilt_deg: f64,
    /// Fewest points on a plane, the paper's eps1, counted at full image resolution.
    pub min_points: usize,
    /// Most planes in one frame.
    pub max_planes: usize,
    /// Every how many pixels a point is taken, in both directions.
    pub stride_px: u32,
    /// RANSAC hypotheses a plane.
    pub hypotheses: usize,
    /// Calibration error of the depth camera: planes are bent by about this much (m).
    pub flatness_m: f64,
}

impl Default for SupportSettings {
    fn default() -> Self {
        Self {
            max_tilt_deg: 10.0,
            min_points: 200,
            max_planes: 6,
            stride_px: 4,
            hypotheses: 60,
            flatness_m: 0.004,
        }
    }
}

/// A horizontal surface seen in one frame.
#[derive(Clone, Debug)]
pub struct SupportPlane {
    /// The plane in the level frame; its normal points up.
    pub plane: Plane,
    /// Points on it, counted at full image resolution.
    pub points: usize,
    /// Root mean square distance of its points (m).
    pub rms_m: f64,
    /// Points on it in the level frame, one each `stride_px` pixels, with their pixels.
    pub(super) inliers: Vec<GridPoint>,
}

impl SupportPlane {
    /// Height of a point above the plane (m).
    pub fn height_of(&self, point_in_level: &Point3<f64>) -> f64 {
        self.plane.signed_distance(point_in_level)
    }

    /// Points on the plane in the level frame.
    pub fn points_in_level(&self) -> impl Iterator<Item = Point3<f64>> + '_ {
        self.inliers.iter().map(|p| p.at)
    }
}

/// A sampled point with its pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridPoint {
    pub(super) u: i32,
    pub(super) v: i32,
    pub(super) at: Point3<f64>,
    /// Variance of the reading along the viewing ray over the squared range.
    relative_variance: f64,
}

/// Finds the support planes of a frame, the one with most points first.
pub fn find_support_planes(frame: &Frame<'_>, settings: &SupportSettings) -> Vec<SupportPlane> {
    let mut candidates = horizontal_points(frame, settings);
    let per_point = (settings.stride_px * settings.stride_px) as usize;
    let enough = (settings.min_points / per_point).max(6);
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut planes: Vec<SupportPlane> = Vec::new();
    while planes.len() < settings.max_planes && candidates.len() >= enough {
        let Some(hypothesis) = best_hypothesis(&candidates, settings, &mut rng) else { break };
        let refined = refine(&hypothesis, &candidates, settings);
        let plane = refined.unwrap_or(hypothesis);
        let near = |p: &GridPoint, sigmas: f64| is_near(p, &plane, sigmas, settings);
        let (inliers, rest): (Vec<_>, Vec<_>) =
            candidates.iter().partition(|p| near(p, INLIER_SIGMAS));
        let found = inliers.len();
        if found >= enough && refined.is_some() && !repeats(&planes, &inliers) {
            let sum: f64 = inliers.iter().map(|p| plane.signed_distance(&p.at).powi(2)).sum();
            planes.push(SupportPlane {
                plane,
                points: found * per_point,
                rms_m: (sum / found as f64).sqrt(),
                inliers,
            });
        }
        // What lies just outside the band is the same surface's tail, not another surface.
        let left: Vec<_> = rest.into_iter().filter(|p| !near(p, 2.0 * INLIER_SIGMAS)).collect();
        if left.len() + enough > candidates.len() {
            break;
        }
        candidates = left;
    }
    planes
}

/// Variance of a point's distance from `plane` (m^2): noise acts along the ray, so grazing views are less noisy across
/// the plane.
fn variance(point: &GridPoint, plane: &Plane, settings: &SupportSettings) -> f64 {
    let along = plane.normal.dot(&point.at.coords);
    point.relative_variance * along * along + settings.flatness_m * settings.flatness_m
}

/// Whether a point lies within `sigmas` standard deviations of a plane.
fn is_near(point: &GridPoint, plane: &Plane, sigmas: f64, settings: &SupportSettings) -> bool {
    let distance = plane.signed_distance(&point.at);
    distance * distance < sigmas * sigmas * variance(point, plane, settings)
}

/// Inliers lie this near to their plane (standard deviations).
const INLIER_SIGMAS: f64 = 3.0;

/// Sampled points whose local surface is roughly horizontal, in the order of the image's rows, at most one in each cell
/// of `stride_px`: a table top at eye level gives few readings, and none must be missed because its neighbour was
/// sampled.
fn horizontal_points(frame: &Frame<'_>, settings: &SupportSettings) -> Vec<GridPoint> {
    let (width, height) = (frame.depth().width() as i32, frame.depth().height() as i32);
    let stride = settings.stride_px.max(1) as i32;
    let mut out = Vec::new();
    for row in (0..height).step_by(stride as usize) {
        for column in (0..width).step_by(stride as usize) {
            let (middle_u, middle_v) = (column + stride / 2, row + stride / 2);
            let spots = std::iter::once((middle_u, middle_v)).chain(
                (row..row + stride).flat_map(|v| (column..column + stride).map(move |u| (u, v))),
            );
            let reading = |(u, v)| frame.depth().at(u, v).map(|z| (u, v, f64::from(z)));
            let Some((u, v, z)) = spots.into_iter().find_map(reading) else { continue };
            let Some(at) = frame.point_in_level(u, v) else { continue };
            if is_level(frame, u, v, at.z) {
                let sigma_m = frame.sigma_m(z);
                let relative_variance = sigma_m * sigma_m / at.coords.norm_squared();
                out.push(GridPoint { u, v, at, relative_variance });
            }
        }
    }
    out.sort_by_key(|p| (p.v, p.u));
    out
}

/// Whether the readings beside, above and below lie where a level surface through this one would put them.
///
/// A normal would say the same of surfaces seen from above, but not of a table top at eye level: there depth noise
/// throws points about in the plane, farther than they are apart. So depth is compared with depth, at the nearest
/// pixels above and below for which a level surface differs from an upright one by more than noise.
fn is_level(frame: &Frame<'_>, u: i32, v: i32, height_m: f64) -> bool {
    let (depth, (focal, _)) = (frame.depth(), frame.camera().focal());
    let Some(z) = depth.at(u, v).map(f64::from) else { return false };
    let sigma_m = frame.sigma_m(z);
    let is_at_eye_level = height_m.abs() < (EYE_LEVEL_SLOPE * z).min(EYE_LEVEL_M);
    // Pixels where a level surface would be farther away than this say nothing of the surface here.
    let max_change_m = if is_at_eye_level { 1.2 } else { 0.6 };
    let agrees = |du: i32, dv: i32| {
        for step in STEPS_PX {
            let (u, v) = (u + step * du, v + step * dv);
            let slope = frame.ray_slope(u, v)?;
            // Where a level surface is on that ray; rays at the horizon never meet it.
            let expected = height_m / slope;
            let change = (expected - z).abs();
            if expected <= 0.0 || change > max_change_m {
                return None;
            }
            let across = f64::from(step) * z / focal;
            let is_far_enough =
                if dv == 0 { across >= 3.0 * sigma_m } else { change >= TELLING_SIGMAS * sigma_m };
            if is_far_enough
                && across >= 0.005
                && let Some(measured) = depth.at(u, v).map(f64::from)
            {
                let off = (measured - expected).abs();
                return Some(off <= SLOPE_TOLERANCE * change + 3.0 * sigma_m + 0.1 * across);
            }
        }
        None
    };
    // At eye level one of two is enough: a table top is a few rows high there, and what is beyond its edge gives more
    // readings than itself.
    let both = |one: Option<bool>, other: Option<bool>| {
        let contradicted = one == Some(false) || other == Some(false);
        (one == Some(true) || other == Some(true)) && (is_at_eye_level || !contradicted)
    };
    height_m < -MIN_BELOW_EYE_M
        && both(agrees(0, 1), agrees(0, -1))
        && both(agrees(1, 0), agrees(-1, 0))
}

/// Below this fall of the view a surface is seen edge-on,
const EYE_LEVEL_SLOPE: f64 = 0.1;
/// if it is no further below the camera than this (m).
const EYE_LEVEL_M: f64 = 0.25;
/// A level surface is told from an upright one when they differ by this much (standard deviations of depth).
const TELLING_SIGMAS: f64 = 7.0;
/// How far the depth may be off, as a share of the change that a level surface would show.
const SLOPE_TOLERANCE: f64 = 0.35;
/// The top of a surface is seen from above only (m).
const MIN_BELOW_EYE_M: f64 = 0.02;

/// Tried in this order.
const STEPS_PX: [i32; 10] = [1, 2, 3, 4, 5, 6, 8, 12, 16, 24];

/// The hypothesis with most inliers: planes through three points, and level planes through one.
fn best_hypothesis(
    candidates: &[GridPoint],
    settings: &SupportSettings,
    rng: &mut ChaCha8Rng,
) -> Option<Plane> {
    let scored: Vec<&GridPoint> =
        candidates.iter().step_by(candidates.len().div_ceil(MAX_SCORED)).collect();
    let min_up = settings.max_tilt_deg.to_radians().cos();
    let mut best: Option<(usize, Plane)> = None;
    for round in 0..settings.hypotheses {
        let mut draw = || candidates[rng.random_range(0..candidates.len())].at;
        let a = draw();
        let plane = if round % 2 == 0 {
            Some(Plane::through(&a, Vector3::z_axis()))
        } else {
            plane_through(&a, &draw(), &draw()).filter(|plane| plane.normal.z >= min_up)
        };
        let Some(plane) = plane else { continue };
        let score = scored.iter().filter(|p| is_near(p, &plane, INLIER_SIGMAS, settings)).count();
        if best.is_none_or(|(most, _)| score > most) {
            best = Some((score, plane));
        }
    }
    best.map(|(_, plane)| plane)
}

const MAX_SCORED: usize = 2000;

fn plane_through(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>) -> Option<Plane> {
    let normal = Unit::try_new((b - a).cross(&(c - a)), 1e-6)?;
    Some(Plane::through(a, if normal.z < 0.0 { -normal } else { normal }))
}

/// Least squares on the inliers, repeated while they change; nothing if the plane tips over.
fn refine(start: &Plane, candidates: &[GridPoint], settings: &SupportSettings) -> Option<Plane> {
    let min_up = settings.max_tilt_deg.to_radians().cos();
    let mut plane = *start;
    for widening in [3.0, 2.0, 1.0, 1.0] {
        plane = least_squares_plane(&plane, candidates, widening * INLIER_SIGMAS, settings)?;
        if plane.normal.z < min_up {
            return None;
        }
    }
    Some(plane)
}

/// The height as a linear function of the position, by weighted least squares with gravity as a prior for the slope: a
/// strip of points must not tip the plane across it.
fn least_squares_plane(
    last: &Plane,
    candidates: &[GridPoint],
    sigmas: f64,
    settings: &SupportSettings,
) -> Option<Plane> {
    let near: Vec<&GridPoint> =
        candidates.iter().filter(|p| is_near(p, last, sigmas, settings)).collect();
    if near.len() < 3 {
        return None;
    }
    let center = near.iter().map(|p| p.at.coords).sum::<Vector3<f64>>() / near.len() as f64;
    let slope_prior = 1.0 / (settings.max_tilt_deg.to_radians() / 6.0).powi(2);
    let mut normal_matrix = Matrix3::from_diagonal(&Vector3::new(slope_prior, slope_prior, 0.0));
    let mut right_side = Vector3::zeros();
    for p in near {
        let d = p.at.coords - center;
        let row = Vector3::new(d.x, d.y, 1.0);
        let weight = 1.0 / variance(p, last, settings);
        normal_matrix += row * row.transpose() * weight;
        right_side += row * (weight * d.z);
    }
    let slope = Cholesky::new(normal_matrix)?.solve(&right_side);
    let normal = Unit::try_new(Vector3::new(-slope.x, -slope.y, 1.0), 1e-9)?;
    Some(Plane::through(&(center + Vector3::z() * slope.z).into(), normal))
}

/// Whether most of the points lie a few centimetres beside a plane that is already known, within its reach: a bent depth
/// image makes one floor look like two, and the top of a keyboard is no support.
fn repeats(planes: &[SupportPlane], inliers: &[GridPoint]) -> bool {
    let bounds = Bounds::of(inliers.iter().map(|p| p.at));
    planes.iter().any(|known| {
        let near = inliers.iter().filter(|p| known.height_of(&p.at).abs() < SAME_PLANE_M).count();
        let beside = known.inliers.iter().filter(|p| bounds.distance_on_ground_m(&p.at) < BESIDE_M);
        2 * near > inliers.len() && beside.count() >= MIN_BESIDE
    })
}

/// Two surfaces side by side that differ in height by less than this are one (m).
const SAME_PLANE_M: f64 = 0.04;
/// Surfaces are side by side when points of one are this near to the other (m),
const BESIDE_M: f64 = 0.1;
/// and so many of them.
const MIN_BESIDE: usize = 5;
