//! Square cells on the ground, and which of them are covered.

use nalgebra::Point2;

/// Square cells on the ground. Their borders are at multiples of their size, so that a grid that grows keeps its cells.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundGrid {
    /// Size of a cell (m).
    pub cell_m: f64,
    /// The corner with the lowest coordinates (m).
    pub origin: Point2<f64>,
    /// Cells along x.
    pub width: usize,
    /// Cells along y.
    pub height: usize,
    /// Whether each cell is covered: along x first, from the origin on.
    pub covered: Vec<bool>,
}

impl GroundGrid {
    /// The cells that convex polygons cover, if only a part of them, and a border of one cell round all. Of nothing it is one
    /// cell. What would be more than `most_cells` (at least 9) gets larger cells.
    pub fn covering(polygons: &[Vec<Point2<f64>>], cell_m: f64, most_cells: usize) -> Self {
        let is_finite = |polygon: &&Vec<Point2<f64>>| {
            polygon.iter().all(|p| p.x.is_finite() && p.y.is_finite())
        };
        let polygons: Vec<_> = polygons.iter().filter(is_finite).collect();
        let mut cell_m = cell_m;
        let corners = || polygons.iter().copied().flatten();
        let (first, width, height) = loop {
            let index = |value: f64| (value / cell_m).floor();
            let low = |of: fn(&Point2<f64>) -> f64| {
                corners().map(of).reduce(f64::min).map_or(0.0, |low| index(low) - 1.0)
            };
            let count = |of: fn(&Point2<f64>) -> f64| {
                let high = corners().map(of).reduce(f64::max);
                high.map_or(1.0, |high| index(high) + 2.0 - low(of))
            };
            let (width, height) = (count(|p| p.x), count(|p| p.y));
            if width * height <= most_cells as f64 {
                break ([low(|p| p.x), low(|p| p.y)], width as usize, height as usize);
            }
            cell_m *= 2.0;
        };
        // How many polygons begin in a cell of a row, less those that ended before it.
        let mut begins = vec![0_i32; (width + 1) * height];
        for polygon in polygons {
            let cells = polygon
                .iter()
                .map(|p| Point2::new(p.x / cell_m - first[0], p.y / cell_m - first[1]));
            let cells: Vec<Point2<f64>> = cells.collect();
            for (row, (from, to)) in rows(&cells) {
                begins[row * (width + 1) + from] += 1;
                begins[row * (width + 1) + to + 1] -= 1;
            }
        }
        let covered = begins.chunks(width + 1).flat_map(|row| {
            row[..width].iter().scan(0, |open, change| {
                *open += change;
                Some(*open > 0)
            })
        });
        Self {
            cell_m,
            origin: Point2::new(first[0] * cell_m, first[1] * cell_m),
            width,
            height,
            covered: covered.collect(),
        }
    }
}

/// The rows of cells that a convex polygon covers, and its first and last cell in each; in cells from the grid's origin.
fn rows(corners: &[Point2<f64>]) -> impl Iterator<Item = (usize, (usize, usize))> + '_ {
    let ys = || corners.iter().map(|p| p.y);
    let (low, high) = (ys().fold(f64::MAX, f64::min), ys().fold(f64::MIN, f64::max));
    let (first, last) = ends(low, high);
    (first..=last).filter_map(move |row| {
        let (mut left, mut right) = (f64::MAX, f64::MIN);
        for (i, from) in corners.iter().enumerate() {
            let to = &corners[(i + 1) % corners.len()];
            for x in within_row(from, to, row as f64).into_iter().flatten() {
                (left, right) = (left.min(x), right.max(x));
            }
        }
        (left <= right).then(|| (row, ends(left, right)))
    })
}

/// From where to where along x a segment is in a row, if it is in it.
fn within_row(from: &Point2<f64>, to: &Point2<f64>, row: f64) -> Option<[f64; 2]> {
    let rise = to.y - from.y;
    let at = |y: f64| (y - from.y) / rise;
    let (enters, leaves) = if rise == 0.0 {
        if from.y < row || from.y > row + 1.0 {
            return None;
        }
        (0.0, 1.0)
    } else {
        let (a, b) = (at(row), at(row + 1.0));
        (a.min(b).max(0.0), a.max(b).min(1.0))
    };
    (enters <= leaves).then(|| [enters, leaves].map(|share| from.x + share * (to.x - from.x)))
}

/// The first and last cell of an interval. What only touches a cell does not cover it.
fn ends(low: f64, high: f64) -> (usize, usize) {
    let first = (low + TOUCHING).floor();
    (first as usize, (high - TOUCHING).floor().max(first) as usize)
}

/// Rounding, in cells.
const TOUCHING: f64 = 1e-6;
