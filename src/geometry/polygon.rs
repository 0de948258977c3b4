//! Polygons on the ground, by their corners in order.

use nalgebra::{Point2, Vector2};

/// Distance of a point from a polygon's border (m), negative inside, and the direction in which it grows. The corners may be
/// in either order, and the polygon need not be convex.
pub fn polygon_distance(corners: &[Point2<f64>], point: &Point2<f64>) -> (f64, Vector2<f64>) {
    let (mut nearest, mut is_inside) = (Vector2::new(f64::MAX, 0.0), false);
    for (i, from) in corners.iter().enumerate() {
        let to = &corners[(i + 1) % corners.len()];
        let apart = from_segment(&[*from, *to], point);
        if apart.norm_squared() < nearest.norm_squared() {
            nearest = apart;
        }
        // A ray to the right crosses the border an odd number of times.
        if (from.y > point.y) != (to.y > point.y)
            && point.x < from.x + (to.x - from.x) * (point.y - from.y) / (to.y - from.y)
        {
            is_inside = !is_inside;
        }
    }
    let distance = nearest.norm();
    let direction = if distance > 0.0 { nearest / distance } else { Vector2::x() };
    if is_inside { (-distance, -direction) } else { (distance, direction) }
}

/// From the nearest point of a segment to a point.
pub fn from_segment([from, to]: &[Point2<f64>; 2], point: &Point2<f64>) -> Vector2<f64> {
    let side = to - from;
    let along =
        ((point - from).dot(&side) / side.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    point - (from + side * along)
}

/// Whether two segments cross each other.
pub fn segments_cross([a, b]: &[Point2<f64>; 2], [c, d]: &[Point2<f64>; 2]) -> bool {
    let side = |from: &Point2<f64>, to: &Point2<f64>, point: &Point2<f64>| {
        (to - from).perp(&(point - from))
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Points all round a convex polygon whose corners are counter-clockwise, at a distance from its border, at most a step
/// apart (m).
pub fn points_around(corners: &[Point2<f64>], distance_m: f64, step_m: f64) -> Vec<Point2<f64>> {
    let corner = |i: usize| corners[i % corners.len()];
    // To the right of the way round: outwards.
    let outwards = |i: usize| {
        let side = corner(i + 1) - corner(i);
        Vector2::new(side.y, -side.x) / side.norm().max(f64::MIN_POSITIVE)
    };
    let pieces = |length_m: f64| (length_m / step_m).ceil().max(1.0);
    let mut points = Vec::new();
    for i in 0..corners.len() {
        let (from, to, normal, next) = (corner(i), corner(i + 1), outwards(i), outwards(i + 1));
        let (side, turn) = (to - from, normal.perp(&next).atan2(normal.dot(&next)));
        let (along, round) = (pieces(side.norm()), pieces(distance_m * turn.abs()));
        let middles = |count: f64| (0..count as usize).map(move |k| (k as f64 + 0.5) / count);
        points.extend(middles(along).map(|share| from + side * share + normal * distance_m));
        points.extend(middles(round).map(|share| {
            let (sin, cos) = (share * turn).sin_cos();
            let turned =
                Vector2::new(cos * normal.x - sin * normal.y, sin * normal.x + cos * normal.y);
            to + turned * distance_m
        }));
    }
    points
}
