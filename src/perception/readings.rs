//! What depth says in the middle of a box that gave no measurement.

use super::{Frame, WallSegment, segmentation::SurfacePoint};
use crate::geometry::Rect;

/// What depth says in the middle of a box.
pub(super) struct Readings {
    /// All ranges (m).
    pub(super) ranges: Vec<f64>,
    /// That of the front of the object (m), if enough was read to tell.
    pub(super) of_object: Option<f64>,
    /// How far off the object is at most, as there is a wall (m).
    pub(super) before_m: f64,
    /// Whether the box shows a wall and nothing before it.
    pub(super) is_flat: bool,
}

impl Readings {
    /// Of a plant and between the legs of a chair one reads the wall behind more often than the object.
    pub(super) fn new(
        frame: &Frame<'_>,
        rect: &Rect,
        walls: &[WallSegment],
        are_others: &dyn Fn(&SurfacePoint) -> bool,
    ) -> Self {
        let cell = |low: f64, extent: f64, at: usize| {
            (low + extent * (0.25 + 0.5 * (at as f64 + 0.5) / GRID as f64)).round() as i32
        };
        let all = (0..GRID * GRID).filter_map(|at| {
            let u = cell(rect.x_min, rect.width(), at % GRID);
            SurfacePoint::read(frame, u, cell(rect.y_min, rect.height(), at / GRID))
        });
        let (read, others): (Vec<_>, Vec<_>) = all.partition(|p| !are_others(p));
        let range_m = |p: &SurfacePoint| p.at.coords.norm();
        let is_wall =
            |p: &&SurfacePoint| walls.iter().any(|wall| wall.before_m(&p.at).abs() < WALL_M);
        let at: (Vec<_>, Vec<_>) = read.iter().partition(is_wall);
        let [on_wall, few] = [at.0, at.1].map(|part| sorted(part.into_iter().map(range_m)));
        let is_thin = (FEW..GRID * GRID / 2).contains(&few.len());
        let of_object = if is_thin && few[3 * few.len() / 4] - few[few.len() / 4] < ONE_THING_M {
            lower_quartile(&few)
        } else if 2 * read.len() >= GRID * GRID {
            lower_quartile(&sorted(read.iter().map(range_m)))
        } else {
            None
        };
        let ranges = read.iter().chain(&others).map(range_m).collect();
        let farthest_m = on_wall.last().copied().filter(|_| on_wall.len() >= FEW);
        let is_flat = few.is_empty() && 4 * on_wall.len() >= 3 * GRID * GRID;
        Self { ranges, of_object, before_m: farthest_m.unwrap_or(f64::INFINITY), is_flat }
    }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

fn lower_quartile(sorted: &[f64]) -> Option<f64> {
    sorted.get(sorted.len() / 4).copied()
}

/// Depth readings are looked at on a grid of so many by so many.
pub(super) const GRID: usize = 7;
/// So few of these tell.
const FEW: usize = 4;
/// Where half of them differ by less, they are of one thing (m).
const ONE_THING_M: f64 = 0.3;
/// What is as near to a wall is the wall (m).
pub(super) const WALL_M: f64 = 0.1;
