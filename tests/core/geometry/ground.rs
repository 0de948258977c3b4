//! Footprints on the ground: which cells they cover, how far points are from them, and places all round.

use super::ROUNDING;
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{GroundGrid, OrientedBox, Outline, points_around, polygon_distance, segments_cross},
    mapping::footprint_of,
};
use nalgebra::{Point2, Point3, Vector3};
use proptest::prelude::*;

/// What a box of 0.6 m by 0.2 m covers, turned by an angle (rad) about its middle.
fn plank(x: f64, y: f64, yaw: f64) -> (OrientedBox, Vec<Point2<f64>>) {
    let pose = upright_pose(yaw, Vector3::new(x, y, 0.3));
    let body = OrientedBox { pose, half_extents: Vector3::new(0.3, 0.1, 0.3) };
    (body, footprint_of(&body, Outline::Cuboid))
}

fn is_covered(grid: &GroundGrid, at: &Point2<f64>) -> bool {
    let cell = (at - grid.origin) / grid.cell_m;
    let (column, row) = (cell.x.floor() as usize, cell.y.floor() as usize);
    assert!(cell.x >= 0.0 && column < grid.width && row < grid.height, "{at} is outside");
    grid.covered[row * grid.width + column]
}

#[test]
fn a_turned_box_covers_the_cells_under_it_and_not_those_of_its_mirror_image() {
    let (body, corners) = plank(-3.0, 2.0, 30.0_f64.to_radians());
    let grid = GroundGrid::covering(&[corners], 0.05, 1 << 20);
    for (along, across) in [(0.29, 0.09), (0.29, -0.09), (-0.29, 0.09), (-0.29, -0.09)] {
        let at = body.pose * Point3::new(along, across, 0.0);
        assert!(is_covered(&grid, &at.xy()), "{at}");
        let mirrored = Point2::new(at.x, 4.0 - at.y);
        // 0.29 m along the other diagonal is 0.2 m beside it.
        assert!(!is_covered(&grid, &mirrored), "{mirrored}");
    }
    // 0.12 m2, and the cells that are covered in part: at most those within a cell of its border of 1.6 m.
    let area = grid.covered.iter().filter(|covered| **covered).count() as f64 * 0.05 * 0.05;
    assert!((0.12..0.20).contains(&area), "{area} m2");
}

#[test]
fn cells_have_their_borders_at_multiples_of_their_size_and_what_only_touches_one_leaves_it_free() {
    let square = [[-0.1, 0.2], [0.1, 0.2], [0.1, 0.4], [-0.1, 0.4]].map(Point2::from).to_vec();
    let grid = GroundGrid::covering(&[square], 0.1, 1 << 20);
    assert!((grid.origin - Point2::new(-0.2, 0.1)).norm() < ROUNDING, "{}", grid.origin);
    let covered: Vec<usize> = (0..grid.covered.len()).filter(|i| grid.covered[*i]).collect();
    let at = |column: usize, row: usize| row * grid.width + column;
    assert_eq!(covered, [at(1, 1), at(2, 1), at(1, 2), at(2, 2)]);
}

#[test]
fn a_map_of_any_extent_has_a_bounded_grid_and_an_empty_one_has_one_cell() {
    let far = vec![plank(0.0, 0.0, 0.0).1, plank(9e7, -9e7, 1.0).1];
    let grid = GroundGrid::covering(&far, 0.05, 10_000);
    assert!(grid.width * grid.height <= 10_000 && grid.covered.len() == grid.width * grid.height);
    assert!(is_covered(&grid, &Point2::new(0.1, 0.05)));
    assert!(is_covered(&grid, &Point2::new(9e7, -9e7)));
    let empty = GroundGrid::covering(&[], 0.05, 10_000);
    assert_eq!((empty.width, empty.height, &empty.covered[..]), (1, 1, &[false][..]));
    let wild = vec![vec![Point2::new(f64::NAN, 0.0), Point2::new(f64::INFINITY, 1.0)]];
    assert_eq!(GroundGrid::covering(&wild, 0.05, 10_000), empty);
}

#[test]
fn places_round_a_square_are_on_all_its_sides_at_the_distance() {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Point2::from);
    let places = points_around(&square, 0.5, 0.1);
    for place in &places {
        assert!((polygon_distance(&square, place).0 - 0.5).abs() < ROUNDING, "{place}");
    }
    // Round a corner they keep the distance, too.
    let corner = Point2::new(1.0, 1.0) + nalgebra::Vector2::new(0.5, 0.5) * 0.5_f64.sqrt();
    for at in [Point2::new(1.5, 0.0), Point2::new(0.0, -1.5), corner] {
        let nearest = places.iter().map(|p| nalgebra::distance(p, &at)).fold(f64::MAX, f64::min);
        assert!(nearest < 0.06, "{at}: {nearest} m");
    }
}

#[test]
fn segments_cross_or_do_not() {
    let segment = |a: [f64; 2], b: [f64; 2]| [Point2::from(a), Point2::from(b)];
    let wall = segment([0.0, -1.0], [0.0, 1.0]);
    assert!(segments_cross(&wall, &segment([-1.0, 0.5], [1.0, 0.2])));
    assert!(!segments_cross(&wall, &segment([-1.0, 0.5], [-0.1, 0.2])));
    assert!(!segments_cross(&wall, &segment([-1.0, 1.5], [1.0, 1.2])));
}

proptest! {
    #[test]
    fn a_cell_is_covered_where_and_only_where_something_is(
        (x, y, yaw) in (-20.0..20.0, -20.0..20.0, -3.1..3.1), (u, v) in (-1.0..1.0, -1.0..1.0),
    ) {
        let (body, corners) = plank(x, y, yaw);
        let grid = GroundGrid::covering(std::slice::from_ref(&corners), 0.05, 1 << 20);
        let inside = body.pose * Point3::new(0.3 * u, 0.1 * v, 0.0);
        prop_assert!(is_covered(&grid, &inside.xy()));
        for (i, _) in grid.covered.iter().enumerate().filter(|(_, covered)| **covered) {
            let cell = nalgebra::Vector2::new((i % grid.width) as f64, (i / grid.width) as f64);
            let middle = grid.origin + cell.add_scalar(0.5) * grid.cell_m;
            // Half the diagonal of a cell.
            prop_assert!(polygon_distance(&corners, &middle).0 < 0.0354, "{middle}");
        }
    }
}
