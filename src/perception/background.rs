//! Walls that objects stand against.
//!
//! A cabinet, a bed or a television touches the wall behind it: Euclidean clustering makes one thing of them. What goes
//! on outside the detector's box, upright and flat, is that wall. The paper has no such step.

use super::{bounds::Bounds, segmentation::SurfacePoint};
use crate::geometry::{Plane, Rect};
use nalgebra::{Point3, Unit, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Takes the points on and behind the wall that shows round `rect` out of `points`, or nothing if no wall shows there.
pub(super) fn without_wall(points: &[SurfacePoint], rect: &Rect) -> Option<Vec<SurfacePoint>> {
    let ring: Vec<&SurfacePoint> = points.iter().filter(|p| !p.is_in(rect)).collect();
    let wall = wall_through(&ring)?;
    let kept = points.iter().filter(|p| wall.signed_distance(&p.at) > tolerance_m(p, &wall));
    Some(kept.copied().collect())
}

/// The upright plane with most of the points, its normal towards the camera (RANSAC).
fn wall_through(points: &[&SurfacePoint]) -> Option<Plane> {
    if points.len() < MIN_POINTS {
        return None;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut best: Option<(usize, Plane)> = None;
    for _ in 0..HYPOTHESES {
        let mut draw = || points[rng.random_range(0..points.len())].at;
        let Some(plane) = upright_plane(&draw(), &draw()) else { continue };
        let near = |p: &&&SurfacePoint| plane.signed_distance(&p.at).abs() < tolerance_m(p, &plane);
        let inliers = points.iter().filter(near).count();
        if best.is_none_or(|(most, _)| inliers > most) {
            best = Some((inliers, plane));
        }
    }
    let (inliers, wall) = best?;
    let is_wall = 2 * inliers > points.len() && span_m(points, &wall) > MIN_SPAN_M;
    is_wall.then_some(wall)
}

/// Diagonal of the box round the points on a plane (m).
fn span_m(points: &[&SurfacePoint], plane: &Plane) -> f64 {
    let near = points.iter().filter(|p| plane.signed_distance(&p.at).abs() < tolerance_m(p, plane));
    Bounds::of(near.map(|p| p.at)).diagonal_m()
}

/// The upright plane through two points, its normal towards the camera, which is the origin.
fn upright_plane(a: &Point3<f64>, b: &Point3<f64>) -> Option<Plane> {
    let along = b - a;
    let normal = Unit::try_new(Vector3::new(-along.y, along.x, 0.0), MIN_BASELINE_M)?;
    let plane = Plane::through(a, normal);
    Some(if plane.offset < 0.0 { Plane { normal: -normal, offset: -plane.offset } } else { plane })
}

fn tolerance_m(p: &SurfacePoint, plane: &Plane) -> f64 {
    WALL_M + 3.0 * p.noise_along_m(&plane.normal)
}

const MIN_POINTS: usize = 20;
/// What is smaller is no wall but the next thing on the table (m).
const MIN_SPAN_M: f64 = 0.6;
const HYPOTHESES: usize = 40;
/// Two points nearer than this do not tell a direction (m).
const MIN_BASELINE_M: f64 = 0.05;
/// Skirting boards and uneven plaster (m).
const WALL_M: f64 = 0.015;
