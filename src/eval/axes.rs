//! Which of a box's axes is up and which is its main one, whatever their names are.

use crate::geometry::OrientedBox;
use nalgebra::{Matrix3, Vector2, Vector3};

/// Index of the axis that is the most vertical.
pub(super) fn up_axis(body: &OrientedBox) -> usize {
    let height = (body.pose.rotation.inverse() * Vector3::z()).abs();
    height.imax()
}

/// Half the longer and half the shorter side of the footprint (m).
pub(super) fn footprint(body: &OrientedBox) -> (f64, f64) {
    let up = up_axis(body);
    let [a, b] = [(up + 1) % 3, (up + 2) % 3].map(|axis| body.half_extents[axis]);
    (a.max(b), a.min(b))
}

/// The direction of the longer side of the footprint, projected on the horizontal plane; not a unit vector.
pub(super) fn main_axis(body: &OrientedBox) -> Vector2<f64> {
    let up = up_axis(body);
    let [a, b] = [(up + 1) % 3, (up + 2) % 3];
    let axis = if body.half_extents[a] >= body.half_extents[b] { a } else { b };
    let mut own = Vector3::zeros();
    own[axis] = 1.0;
    (body.pose.rotation * own).xy()
}

/// The 24 right-handed ways to name a box's axes, as rotations `old_from_new`.
pub(super) fn namings() -> impl Iterator<Item = Matrix3<f64>> {
    const PERMUTATIONS: [[usize; 3]; 6] =
        [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    PERMUTATIONS.into_iter().flat_map(|permutation| {
        (0..8).filter_map(move |signs: u8| {
            let mut matrix = Matrix3::zeros();
            for (column, row) in permutation.into_iter().enumerate() {
                matrix[(row, column)] = if signs >> column & 1 == 1 { -1.0 } else { 1.0 };
            }
            (matrix.determinant() > 0.0).then_some(matrix)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_24_different_right_handed_namings() {
        let all: Vec<Matrix3<f64>> = namings().collect();
        assert_eq!(all.len(), 24);
        for (i, a) in all.iter().enumerate() {
            assert_eq!(a * a.transpose(), Matrix3::identity());
            assert!(all[i + 1..].iter().all(|b| a != b));
        }
    }
}
