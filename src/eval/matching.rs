//! Which object of the map is which true object.

use nalgebra::Point3;
use pathfinding::{kuhn_munkres::kuhn_munkres, matrix::Matrix};

/// Centres farther apart than this do not belong to the same object (m).
pub const MATCH_DISTANCE_M: f64 = 0.75;

/// Pairs `(index in a, index in b)` of points within `max_distance_m`, in the order of `a`.
///
/// The assignment is optimal: the sum of all distances is smallest, where a point that stays alone counts as one at
/// the largest distance. So the result does not depend on the order of the points, and two close pairs are not torn
/// apart for the sake of a third that is barely within the distance.
pub fn assignment(
    a: &[Point3<f64>],
    b: &[Point3<f64>],
    max_distance_m: f64,
) -> Vec<(usize, usize)> {
    if a.is_empty() || b.is_empty() {
        return Vec::new();
    }
    let (rows, columns) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    // The algorithm wants numbers of a total order: nanometres saved by making a pair.
    let saved = |(row, column): (usize, usize)| {
        let metres = max_distance_m - nalgebra::distance(&rows[row], &columns[column]);
        (metres.max(0.0) * 1e9) as i64
    };
    let weights = Matrix::from_fn(rows.len(), columns.len(), saved);
    let (_, column_of_row) = kuhn_munkres(&weights);
    let paired = column_of_row.into_iter().enumerate();
    let paired = paired.filter(|(row, column)| saved((*row, *column)) > 0);
    let mut pairs: Vec<(usize, usize)> =
        paired.map(|(r, c)| if a.len() <= b.len() { (r, c) } else { (c, r) }).collect();
    pairs.sort_unstable();
    pairs
}
