//! Walls: vertical planes, large enough to say where the robot is.
//!
//! They are landmarks for poses, as objects are, and there is nearly always one in sight. Planes as landmarks: Kaess
//! 2015, Simultaneous localization and mapping with infinite planes; here gravity is known, so that two numbers are left.

use super::{Frame, footprint::quantile, normal::rough_normal};
use crate::geometry::Pose;
use nalgebra::{Matrix2, Point3, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// How walls are found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WallSettings {
    /// Most walls in one frame; 0 for none.
    pub max_walls: usize,
    /// Shortest wall that is used (m).
    pub min_length_m: f64,
    /// Calibration error of the depth camera: planes are bent by about this much (m).
    pub flatness_m: f64,
    /// Error that all ranges have in common, as a share of them.
    pub range_error: f64,
}

impl Default for WallSettings {
    fn default() -> Self {
        Self { max_walls: 4, min_length_m: 1.0, flatness_m: 0.01, range_error: 0.005 }
    }
}

/// What one frame shows of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSegment {
    /// The middle of what is seen, in the camera's frame (m).
    pub center: Point3<f64>,
    /// Unit vector to the side of the camera, horizontal, in the camera's frame.
    pub normal: Vector3<f64>,
    /// Half of the length that is seen (m).
    pub half_length_m: f64,
    /// Standard deviation of the normal's direction (rad).
    pub heading_sigma: f64,
    /// Standard deviation of the distance at the middle (m).
    pub distance_sigma_m: f64,
}

impl WallSegment {
    /// The same in frame `a`, given in frame `b`.
    #[must_use]
    pub fn transformed(&self, a_from_b: &Pose) -> Self {
        Self { center: a_from_b * self.center, normal: a_from_b * self.normal, ..*self }
    }

    /// How far before the wall a point is (m).
    pub(super) fn before_m(&self, point: &Point3<f64>) -> f64 {
        (point - self.center).dot(&self.normal)
    }

    /// How far it is from a point to the wall along a horizontal unit vector (m), if that leads to what is seen of the wall, or
    /// near it.
    pub(super) fn distance_along_m(
        &self,
        from: &Point3<f64>,
        direction: &Vector3<f64>,
    ) -> Option<f64> {
        let towards = -self.normal.dot(direction);
        if towards < SAME_WAY_COSINE {
            return None;
        }
        let distance_m = self.before_m(from) / towards;
        let aside_m = (from + direction * distance_m - self.center).xy().norm();
        (distance_m > -BEHIND_M && aside_m < self.half_length_m + NEAR_M)
            .then_some(distance_m.max(0.0))
    }
}

/// A sampled point of something upright.
#[derive(Clone, Copy)]
struct Sample {
    reading: Reading,
    /// Horizontal unit vector to the camera's side.
    normal: Vector2<f64>,
}

/// A point in the level frame.
#[derive(Clone, Copy)]
struct Reading {
    column: usize,
    at: Point3<f64>,
    /// How far noise moves the point, seen from above: one standard deviation (m).
    noise_m: Vector2<f64>,
}

impl Reading {
    fn new(frame: &Frame<'_>, (u, v): (i32, i32), max_range_m: f64) -> Option<Self> {
        let z = f64::from(frame.depth().at(u, v)?);
        let at = frame.point_in_level(u, v).filter(|_| z <= max_range_m)?;
        let column = (u / STRIDE_PX) as usize;
        Some(Self { column, at, noise_m: at.coords.xy() * (frame.sigma_m(z) / z) })
    }
}

/// A line seen from above: `normal . p = offset`, the camera on the positive side.
#[derive(Clone, Copy)]
struct Line {
    normal: Vector2<f64>,
    offset_m: f64,
}

impl Line {
    fn distance_m(&self, reading: &Reading) -> f64 {
        self.normal.dot(&reading.at.coords.xy()) - self.offset_m
    }

    fn along(&self) -> Vector2<f64> {
        Vector2::new(-self.normal.y, self.normal.x)
    }

    fn variance(&self, reading: &Reading, settings: &WallSettings) -> f64 {
        settings.flatness_m.powi(2) + self.normal.dot(&reading.noise_m).powi(2)
    }

    fn is_near(&self, reading: &Reading, sigmas: f64, settings: &WallSettings) -> bool {
        let off_m = self.distance_m(reading);
        off_m * off_m < sigmas * sigmas * self.variance(reading, settings)
    }

    fn has(&self, sample: &Sample, sigmas: f64, settings: &WallSettings) -> bool {
        self.normal.dot(&sample.normal) > SAME_WAY_COSINE
            && self.is_near(&sample.reading, sigmas, settings)
    }
}

/// Walls in sight, the one with most points first.
pub fn find_walls(
    frame: &Frame<'_>,
    max_range_m: f64,
    settings: &WallSettings,
) -> Vec<WallSegment> {
    if settings.max_walls == 0 {
        return Vec::new();
    }
    let mut samples = upright_samples(frame, max_range_m);
    let tops = topmost_readings(frame, max_range_m);
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut walls = Vec::new();
    let camera_from_level = frame.level_from_camera().inverse();
    for _ in 0..settings.max_walls {
        if samples.len() < MIN_SAMPLES {
            break;
        }
        let Some(line) = best_line(&samples, settings, &mut rng) else { break };
        let Some(line) = refine(line, &samples, settings) else { break };
        let own: Vec<&Sample> =
            samples.iter().filter(|s| line.has(s, INLIER_SIGMAS, settings)).collect();
        if own.len() < MIN_SAMPLES {
            break;
        }
        let is_wall =
            is_flat(&line, &own, &samples, settings) && reaches_up(&line, &own, &tops, settings);
        if let Some(segment) = segment(&line, &own, settings).filter(|_| is_wall) {
            walls.push(segment.transformed(&camera_from_level));
        }
        samples.retain(|s| !line.has(s, 2.0 * INLIER_SIGMAS, settings));
    }
    walls
}

/// Points of upright surfaces, one in each cell of a grid of pixels.
fn upright_samples(frame: &Frame<'_>, max_range_m: f64) -> Vec<Sample> {
    let (width, height) = (frame.depth().width() as i32, frame.depth().height() as i32);
    let (focal, _) = frame.camera().focal();
    let mut out = Vec::new();
    for v in (STRIDE_PX / 2..height).step_by(STRIDE_PX as usize) {
        for u in (STRIDE_PX / 2..width).step_by(STRIDE_PX as usize) {
            let Some(reading) = Reading::new(frame, (u, v), max_range_m) else { continue };
            let range_m = reading.at.coords.norm();
            let step = (NORMAL_BASE_SIGMAS * frame.sigma_m(range_m) * focal / range_m).ceil();
            let step = (step as i32).clamp(2, 2 * STRIDE_PX);
            let normal = upright_normal(frame, (u, v), step);
            out.extend(normal.map(|normal| Sample { reading, normal }));
        }
    }
    out
}

/// The topmost reading of each column.
fn topmost_readings(frame: &Frame<'_>, max_range_m: f64) -> Vec<Option<Reading>> {
    let (width, height) = (frame.depth().width() as i32, frame.depth().height() as i32);
    let rows = (STRIDE_PX / 2..height).step_by(STRIDE_PX as usize);
    (STRIDE_PX / 2..width)
        .step_by(STRIDE_PX as usize)
        .map(|u| rows.clone().find_map(|v| Reading::new(frame, (u, v), max_range_m)))
        .collect()
}

/// The normal seen from above, of a surface that is upright.
fn upright_normal(frame: &Frame<'_>, (u, v): (i32, i32), step: i32) -> Option<Vector2<f64>> {
    let normal = rough_normal(frame, u, v, step).filter(|n| n.z.abs() <= MAX_RISE)?;
    normal.xy().try_normalize(1e-9)
}

/// RANSAC over lines through two points that agree with the normals.
fn best_line(samples: &[Sample], settings: &WallSettings, rng: &mut ChaCha8Rng) -> Option<Line> {
    let mut best: Option<(usize, Line)> = None;
    for _ in 0..HYPOTHESES {
        let mut draw = || samples[rng.random_range(0..samples.len())];
        let (a, b) = (draw(), draw());
        let way = b.reading.at.xy() - a.reading.at.xy();
        if way.norm() < MIN_BASE_M || a.normal.dot(&b.normal) < SAME_WAY_COSINE {
            continue;
        }
        let Some(normal) = Vector2::new(-way.y, way.x).try_normalize(1e-9) else { continue };
        let normal = if normal.dot(&a.normal) < 0.0 { -normal } else { normal };
        let line = Line { normal, offset_m: normal.dot(&a.reading.at.coords.xy()) };
        let score = samples.iter().filter(|s| line.has(s, INLIER_SIGMAS, settings)).count();
        if best.is_none_or(|(most, _)| score > most) {
            best = Some((score, line));
        }
    }
    best.filter(|(score, _)| *score >= MIN_SAMPLES).map(|(_, line)| line)
}

/// Weighted least squares on the inliers, repeated while they change.
fn refine(start: Line, samples: &[Sample], settings: &WallSettings) -> Option<Line> {
    let mut line = start;
    for widening in [2.0, 1.5, 1.0, 1.0] {
        let own = samples.iter().filter(|s| line.has(s, widening * INLIER_SIGMAS, settings));
        let (along, mut matrix, mut right) = (line.along(), Matrix2::zeros(), Vector2::zeros());
        for sample in own {
            let row = Vector2::new(along.dot(&sample.reading.at.coords.xy()), 1.0);
            let weight = 1.0 / line.variance(&sample.reading, settings);
            matrix += row * row.transpose() * weight;
            right += row * (weight * line.distance_m(&sample.reading));
        }
        let solution = matrix.cholesky()?.solve(&right);
        // distance = slope * along + rise: the line turns and moves.
        let normal = (line.normal - along * solution.x).try_normalize(1e-9)?;
        let point = line.normal * (line.offset_m + solution.y);
        line = Line { normal, offset_m: normal.dot(&point) };
    }
    // The camera sees its front.
    (line.offset_m < 0.0).then_some(line)
}

/// Whether the normals of what is near the line are, on average and mostly, the line's: things side by side have points on
/// one line, too.
fn is_flat(line: &Line, own: &[&Sample], samples: &[Sample], settings: &WallSettings) -> bool {
    let sum: Vector2<f64> = own.iter().map(|s| s.normal).sum();
    let near = samples.iter().filter(|s| line.is_near(&s.reading, INLIER_SIGMAS, settings)).count();
    sum.dot(&line.along()).abs() < MAX_SLANT * sum.dot(&line.normal)
        && own.len() as f64 > MIN_AGREEING * near as f64
}

/// Whether nothing is seen above it: one sees the wall above furniture.
fn reaches_up(
    line: &Line,
    own: &[&Sample],
    tops: &[Option<Reading>],
    settings: &WallSettings,
) -> bool {
    let columns: BTreeSet<usize> = own.iter().map(|s| s.reading.column).collect();
    let is_top = |top: Reading| line.is_near(&top, TOP_SIGMAS, settings);
    let reached = columns.iter().filter(|column| tops[**column].is_some_and(is_top)).count();
    3 * reached > 2 * columns.len()
}

/// What is seen of a line, in the level frame, if it is enough for a wall.
fn segment(line: &Line, own: &[&Sample], settings: &WallSettings) -> Option<WallSegment> {
    let along = line.along();
    let places: Vec<f64> = own.iter().map(|s| along.dot(&s.reading.at.coords.xy())).collect();
    let mut sorted = places.clone();
    let mut heights: Vec<f64> = own.iter().map(|s| s.reading.at.z).collect();
    let ends = (quantile(&mut sorted, 0.02), quantile(&mut sorted, 0.98));
    let rise_m = quantile(&mut heights, 0.95) - quantile(&mut heights, 0.05);
    let length_m = ends.1 - ends.0;
    if length_m < settings.min_length_m || rise_m < MIN_RISE_M {
        return None;
    }
    let (mut weight, mut moment, mut second) = (0.0, 0.0, 0.0);
    for (sample, place) in own.iter().zip(places) {
        let w = 1.0 / line.variance(&sample.reading, settings);
        weight += w;
        moment += w * place;
        second += w * place * place;
    }
    let middle = moment / weight;
    let spread = (second / weight - middle * middle).max(1e-6);
    let height_m = heights.iter().sum::<f64>() / heights.len() as f64;
    let foot = line.normal * line.offset_m + along * middle;
    let variance = SHARED / weight;
    Some(WallSegment {
        center: Point3::new(foot.x, foot.y, height_m),
        normal: Vector3::new(line.normal.x, line.normal.y, 0.0),
        half_length_m: 0.5 * length_m,
        heading_sigma: (variance / spread).sqrt().hypot(settings.flatness_m / length_m),
        distance_sigma_m: variance
            .sqrt()
            .hypot(settings.flatness_m)
            .hypot(settings.range_error * line.offset_m),
    })
}

/// Pixels between samples.
const STRIDE_PX: i32 = 8;
/// Neighbours that give a normal are apart by this many standard deviations of depth.
const NORMAL_BASE_SIGMAS: f64 = 3.0;
/// Normals of upright surfaces rise less than this, noise included.
const MAX_RISE: f64 = 0.4;
/// Cosine of the angle by which noise turns normals.
const SAME_WAY_COSINE: f64 = 0.8;
/// Points that give a line are this far apart (m).
const MIN_BASE_M: f64 = 0.4;
/// Tangent of how far the mean of a wall's normals is off.
const MAX_SLANT: f64 = 0.1;
/// Share of the points near a wall whose normals agree.
const MIN_AGREEING: f64 = 0.7;
/// What is seen above it belongs to it within so many standard deviations.
const TOP_SIGMAS: f64 = 4.0;
const INLIER_SIGMAS: f64 = 2.5;
const HYPOTHESES: usize = 60;
/// Fewest samples on a wall.
const MIN_SAMPLES: usize = 60;
/// Lowest wall (m).
const MIN_RISE_M: f64 = 0.4;
/// Readings that are worth as much as one independent one: neighbours share errors of the sensor.
const SHARED: f64 = 10.0;
const SEED: u64 = 7;
/// What is no farther behind a wall than this may stand against it (m).
const BEHIND_M: f64 = 0.1;
/// Walls go on for this much beyond what is seen of them (m).
const NEAR_M: f64 = 0.6;
