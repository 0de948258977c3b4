//! Exact volume of the common part of two oriented boxes.

use super::{Ellipsoid, Pose};
use nalgebra::{Point3, Vector3};

/// A box: `pose` takes its own axes to the frame it is given in, `half_extents` are positive (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// `frame_from_box`; the origin is the box's centre.
    pub pose: Pose,
    /// Half the side lengths along the box's own x, y, z (m).
    pub half_extents: Vector3<f64>,
}

impl From<&Ellipsoid> for OrientedBox {
    /// The external cuboid: half extents are the semi-axes.
    fn from(ellipsoid: &Ellipsoid) -> Self {
        Self { pose: ellipsoid.pose, half_extents: ellipsoid.semi_axes }
    }
}

impl OrientedBox {
    /// Volume (m^3).
    pub fn volume(&self) -> f64 {
        8.0 * self.half_extents.product()
    }

    /// The eight corners in the frame of `pose`.
    pub fn corners(&self) -> [Point3<f64>; 8] {
        std::array::from_fn(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let unit = Vector3::new(sign(0), sign(1), sign(2));
            self.pose * Point3::from(self.half_extents.component_mul(&unit))
        })
    }

    /// Faces as polygons, counter-clockwise seen from outside, in the box's own frame.
    fn faces(&self) -> Vec<Polygon> {
        let mut faces = Vec::with_capacity(6);
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let corner = |a: f64, b: f64| {
                    let mut p = Vector3::zeros();
                    p[axis] = sign * self.half_extents[axis];
                    p[u] = a * self.half_extents[u];
                    p[v] = b * sign * self.half_extents[v];
                    p
                };
                faces.push(vec![
                    corner(-1.0, -1.0),
                    corner(1.0, -1.0),
                    corner(1.0, 1.0),
                    corner(-1.0, 1.0),
                ]);
            }
        }
        faces
    }
}

type Polygon = Vec<Vector3<f64>>;

/// Volume of the common part (m^3), exact: the faces of one box are clipped by the other's half spaces.
pub fn intersection_volume(a: &OrientedBox, b: &OrientedBox) -> f64 {
    let a_from_b = a.pose.inverse() * b.pose;
    let mut faces: Vec<Polygon> = b.faces();
    for face in &mut faces {
        for vertex in face.iter_mut() {
            *vertex = (a_from_b * Point3::from(*vertex)).coords;
        }
    }
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            faces = clip_polyhedron(&faces, axis, sign, a.half_extents[axis]);
        }
    }
    // Divergence theorem: a third of the flux of x through the surface.
    let signed: f64 = faces
        .iter()
        .flat_map(|f| {
            (1..f.len().saturating_sub(1)).map(move |i| f[0].dot(&f[i].cross(&f[i + 1])) / 6.0)
        })
        .sum();
    signed.max(0.0)
}

/// Intersection over union of two boxes where they stand.
pub fn intersection_over_union(a: &OrientedBox, b: &OrientedBox) -> f64 {
    let common = intersection_volume(a, b);
    let union = a.volume() + b.volume() - common;
    if union > 0.0 { common / union } else { 0.0 }
}

/// Keeps the part of a convex polyhedron with `sign * x[axis] <= limit`, closing it with a new face.
fn clip_polyhedron(faces: &[Polygon], axis: usize, sign: f64, limit: f64) -> Vec<Polygon> {
    let mut kept = Vec::with_capacity(faces.len() + 1);
    let mut rim: Polygon = Vec::new();
    for face in faces {
        let clipped = clip_polygon(face, axis, sign, limit, &mut rim);
        if clipped.len() >= 3 {
            kept.push(clipped);
        }
    }
    if rim.len() >= 3 {
        kept.push(sorted_about_axis(rim, axis, sign));
    }
    kept
}

/// Sutherland and Hodgman 1974; the points made on the clipping plane are added to `rim`.
fn clip_polygon(face: &Polygon, axis: usize, sign: f64, limit: f64, rim: &mut Polygon) -> Polygon {
    let mut out = Vec::with_capacity(face.len() + 1);
    for (i, current) in face.iter().enumerate() {
        let next = &face[(i + 1) % face.len()];
        let (d0, d1) = (limit - sign * current[axis], limit - sign * next[axis]);
        if d0 >= 0.0 {
            out.push(*current);
        }
        if (d0 >= 0.0) != (d1 >= 0.0) {
            let mut cut = current + (next - current) * (d0 / (d0 - d1));
            cut[axis] = sign * limit;
            out.push(cut);
            rim.push(cut);
        }
    }
    out
}

/// The convex rim on a plane `x[axis] = const`, counter-clockwise seen from the side of `sign`.
fn sorted_about_axis(mut rim: Polygon, axis: usize, sign: f64) -> Polygon {
    let center = rim.iter().sum::<Vector3<f64>>() / rim.len() as f64;
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let angle = |p: &Vector3<f64>| (sign * (p[v] - center[v])).atan2(p[u] - center[u]);
    rim.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    rim
}
