//! Normals of measured surfaces.

use super::Frame;
use nalgebra::{Point3, Unit, Vector3};

/// Normal of the surface at a pixel from its neighbours `step` pixels away, pointing to the camera's side.
///
/// Nothing where there is an edge between them.
pub(super) fn local_normal(
    frame: &Frame<'_>,
    u: i32,
    v: i32,
    step: i32,
) -> Option<Unit<Vector3<f64>>> {
    let (here, neighbours) = cross(frame, u, v, step)?;
    let [right, left, below, above] = neighbours;
    let bent = |a: &Point3<f64>, b: &Point3<f64>| {
        let (to_a, to_b) = (a - here, b - here);
        let (near, far) = (to_a.norm().min(to_b.norm()), to_a.norm().max(to_b.norm()));
        let off_line = to_a.cross(&to_b).norm() / (a - b).norm().max(1e-9);
        far > MAX_UNEVEN * near || off_line > MAX_BEND * near || to_a.dot(&to_b) > 0.0
    };
    if bent(&right, &left) || bent(&below, &above) {
        return None;
    }
    normal_of_cross(&here, &neighbours)
}

/// The same across edges and whatever noise makes of a surface.
pub(super) fn rough_normal(
    frame: &Frame<'_>,
    u: i32,
    v: i32,
    step: i32,
) -> Option<Unit<Vector3<f64>>> {
    let (here, neighbours) = cross(frame, u, v, step)?;
    normal_of_cross(&here, &neighbours)
}

/// The point at a pixel, and its neighbours right, left, below and above.
fn cross(frame: &Frame<'_>, u: i32, v: i32, step: i32) -> Option<(Point3<f64>, [Point3<f64>; 4])> {
    let right = frame.point_in_level(u + step, v)?;
    let left = frame.point_in_level(u - step, v)?;
    let below = frame.point_in_level(u, v + step)?;
    let above = frame.point_in_level(u, v - step)?;
    Some((frame.point_in_level(u, v)?, [right, left, below, above]))
}

fn normal_of_cross(
    here: &Point3<f64>,
    [right, left, below, above]: &[Point3<f64>; 4],
) -> Option<Unit<Vector3<f64>>> {
    let normal = Unit::try_new((below - above).cross(&(right - left)), 1e-9)?;
    Some(if normal.dot(&here.coords) > 0.0 { -normal } else { normal })
}

/// How much farther one neighbour may be than the opposite one.
const MAX_UNEVEN: f64 = 4.0;
/// How far a point may lie off the line between its neighbours, in distances of the nearer one.
const MAX_BEND: f64 = 0.5;
