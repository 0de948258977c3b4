//! Which way a top is turned, from those of its edges that are its own.

use super::{
    Frame,
    footprint::{Heading, MIN_SIGMA_RAD},
    segmentation::SurfacePoint,
};
use nalgebra::{Matrix2, Point2, SymmetricEigen, Vector2};

/// Heading of the longest straight edge of a top, whose `points` are sampled every `stride` pixels, row by row. `None` where no
/// edge was seen for long enough.
///
/// Much of a table is behind chairs and outside the image. What is seen of its top ends there, too, but says nothing of how it is
/// turned. Its own edges are those beyond which something farther off is seen.
pub(super) fn heading_of_edges(
    frame: &Frame<'_>,
    points: &[SurfacePoint],
    stride: i32,
) -> Option<Heading> {
    let edge = own_edge(frame, points, stride);
    let every = edge.len().div_ceil(MAX_POINTS).max(1);
    let ends: Vec<&SurfacePoint> = edge.iter().copied().step_by(every).collect();
    let mut best: Option<(usize, Line)> = None;
    for (i, a) in ends.iter().enumerate() {
        for line in ends[i + 1..].iter().filter_map(|b| Line::through(a, b)) {
            let count = edge.iter().filter(|p| line.has(p)).count();
            if best.as_ref().is_none_or(|(most, _)| count > *most) {
                best = Some((count, line));
            }
        }
    }
    let (_, line) = best?;
    heading_along(&edge.into_iter().filter(|p| line.has(p)).collect::<Vec<_>>())
}

/// The points of the top beside which the camera looks past it.
fn own_edge<'a>(
    frame: &Frame<'_>,
    points: &'a [SurfacePoint],
    stride: i32,
) -> Vec<&'a SurfacePoint> {
    let is_top = |u: i32, v: i32| points.binary_search_by_key(&(v, u), |p| (p.v, p.u)).is_ok();
    let ends = |p: &SurfacePoint, du: i32, dv: i32| {
        let beyond =
            (1..=LOOK_STEPS).map(|step| (p.u + step * stride * du, p.v + step * stride * dv));
        let depth_m = frame.depth().at(p.u, p.v).map_or(f64::INFINITY, f64::from);
        for (u, v) in beyond {
            if is_top(u, v) {
                return false;
            }
            if let Some(z) = frame.depth().at(u, v) {
                return f64::from(z) > depth_m + FARTHER_M + 4.0 * p.sigma_m;
            }
        }
        false
    };
    let is_edge = |p: &&SurfacePoint| {
        [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().any(|(du, dv)| ends(p, du, dv))
    };
    points.iter().filter(is_edge).collect()
}

/// A line seen from above.
struct Line {
    from: Point2<f64>,
    across: Vector2<f64>,
}

impl Line {
    /// Through two points that lie far enough from each other.
    fn through(a: &SurfacePoint, b: &SurfacePoint) -> Option<Self> {
        let along = (b.at - a.at).xy();
        let across = Vector2::new(-along.y, along.x).try_normalize(0.5 * SHORTEST_M)?;
        Some(Self { from: a.at.xy(), across })
    }

    /// Whether a point is on it.
    fn has(&self, p: &SurfacePoint) -> bool {
        let off_m = (p.at.xy() - self.from).dot(&self.across).abs();
        off_m < NEAR_M + 1.5 * noise_m(p, &self.across)
    }
}

/// Heading of the line through some points, by total least squares; nothing where they are too few or too near to each other.
fn heading_along(points: &[&SurfacePoint]) -> Option<Heading> {
    let n = points.len() as f64;
    let mean = points.iter().map(|p| p.at.xy().coords).sum::<Vector2<f64>>() / n;
    let off_mean = points.iter().map(|p| p.at.xy().coords - mean);
    let scatter: Matrix2<f64> = off_mean.map(|d| d * d.transpose()).sum();
    let eigen = SymmetricEigen::new(scatter / n);
    let longest = eigen.eigenvalues.imax();
    let (along, spread) = (eigen.eigenvectors.column(longest), eigen.eigenvalues[longest]);
    // Evenly spread points of a line have a variance of a twelfth of its squared length.
    let length_m = (12.0 * spread).sqrt();
    if length_m < SHORTEST_M || points.len() < FEWEST {
        return None;
    }
    let across = Vector2::new(-along.y, along.x);
    let noise_m = points.iter().map(|p| noise_m(p, &across)).sum::<f64>() / n;
    let own_m = eigen.eigenvalues[1 - longest].max(0.0).sqrt().max(noise_m);
    let sigma = own_m / (spread * (INDEPENDENT_SHARE * n).max(1.0)).sqrt();
    let yaw = along.y.atan2(along.x);
    Some(Heading { yaw, sigma: sigma.hypot(MIN_SIGMA_RAD), of_faces: true })
}

fn noise_m(p: &SurfacePoint, across: &Vector2<f64>) -> f64 {
    p.noise_along_m(&across.push(0.0))
}

/// Points of an edge that lines are tried through.
const MAX_POINTS: usize = 60;
/// How far past a point one looks, in samples: beside a jump of the depth readings are missing.
const LOOK_STEPS: i32 = 3;
/// What is seen past an edge is farther off by this, noise aside (m).
const FARTHER_M: f64 = 0.08;
/// Points so near to a line are on it, noise aside (m).
const NEAR_M: f64 = 0.01;
/// Shorter parts of an edge say too little (m),
const SHORTEST_M: f64 = 0.3;
/// and so do fewer points.
const FEWEST: usize = 8;
/// Neighbouring points share steps of the disparity: so many of them count.
const INDEPENDENT_SHARE: f64 = 0.2;
