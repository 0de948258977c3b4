//! Coloured triangle meshes and the solids they are composed of.

use crate::geometry::Pose;
use nalgebra::{Isometry3, Point2, Point3, Rotation3, Unit, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Red, green, blue.
pub type Color = [u8; 3];

/// Facets of a surface of revolution: a cup's outline is then within 0.9 % of a circle.
const FACETS: usize = 24;

/// A triangle mesh with a colour for each triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    colors: Vec<Color>,
}

impl Mesh {
    /// Corners of the triangles (m).
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// Three indices into [`Mesh::vertices`] a triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// A colour for each triangle.
    pub fn colors(&self) -> &[Color] {
        &self.colors
    }

    /// The smallest and the largest coordinates of all vertices, or nothing without any.
    pub fn bounds(&self) -> Option<(Point3<f64>, Point3<f64>)> {
        let first = *self.vertices.first()?;
        Some(self.vertices.iter().fold((first, first), |(low, high), v| (low.inf(v), high.sup(v))))
    }

    /// The same mesh in frame `a`, given in frame `b`.
    pub(super) fn transformed(mut self, a_from_b: &Pose) -> Self {
        for vertex in &mut self.vertices {
            *vertex = a_from_b * *vertex;
        }
        self
    }

    /// The same mesh turned about the vertical, so that of all upright boxes round it the one along x and y has the
    /// smallest footprint, within half a degree.
    pub(super) fn turned_into_its_smallest_box(self) -> Self {
        let turn = |step: u32| {
            let angle = FRAC_PI_2 * f64::from(step) / 180.0;
            Isometry3::rotation(Vector3::z() * angle)
        };
        let area = |step: u32| {
            let turn = turn(step);
            let turned = self.vertices.iter().map(|vertex| (turn * vertex).xy());
            let (low, high) = turned.fold(
                (Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2])),
                |(low, high), at| (low.inf(&at), high.sup(&at)),
            );
            (high - low).product()
        };
        let areas: Vec<f64> = (0..180).map(area).collect();
        let best = (0..180).min_by(|a, b| areas[*a as usize].total_cmp(&areas[*b as usize]));
        self.transformed(&turn(best.unwrap_or(0)))
    }

    /// Adds all triangles of another mesh.
    pub(super) fn add(&mut self, other: &Self) {
        let base = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + base)));
        self.colors.extend_from_slice(&other.colors);
    }

    /// Adds an axis-aligned box from its smallest and largest coordinates.
    pub(super) fn add_box(&mut self, low: [f64; 3], high: [f64; 3], color: Color) {
        let corner = |i: usize| {
            let side = |axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] };
            Point3::new(side(0), side(1), side(2))
        };
        let base = self.add_vertices((0..8).map(corner));
        for [a, b, c, d] in
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        {
            self.add_quad([a, b, c, d].map(|i| base + i), color);
        }
    }

    /// Adds the surface that a profile of `(radius, z)` sweeps about the vertical through `(x, y)`.
    ///
    /// The profile runs along the outside upwards; where it should close, it starts and ends at radius 0.
    pub(super) fn add_lathe(&mut self, x: f64, y: f64, profile: &[(f64, f64)], color: Color) {
        let ring = |&(radius, z): &(f64, f64)| {
            (0..FACETS).map(move |k| {
                let (sin, cos) = (TAU * k as f64 / FACETS as f64).sin_cos();
                Point3::new(x + radius * cos, y + radius * sin, z)
            })
        };
        let base = self.add_vertices(profile.iter().flat_map(ring));
        self.add_rings(base, profile.len(), FACETS, color);
    }

    /// Adds an upright cylinder about the vertical through `(x, y)` between two heights.
    pub(super) fn add_cylinder(
        &mut self,
        (x, y): (f64, f64),
        radius: f64,
        (bottom, top): (f64, f64),
        color: Color,
    ) {
        self.add_lathe(x, y, &[(0.0, bottom), (radius, bottom), (radius, top), (0.0, top)], color);
    }

    /// Adds an ellipsoid, or its upper half standing on its centre.
    pub(super) fn add_ellipsoid(
        &mut self,
        center: Point3<f64>,
        semi_axes: Vector3<f64>,
        upper_half: bool,
        color: Color,
    ) {
        const RINGS: usize = 8;
        let start = if upper_half { 0.0 } else { -0.25 * TAU };
        let mut vertices = Vec::with_capacity((RINGS + 2) * FACETS);
        for i in 0..=RINGS + 1 {
            // The first ring is a point at the centre of the base, which closes the half ellipsoid.
            let latitude = start + (0.25 * TAU - start) * i.saturating_sub(1) as f64 / RINGS as f64;
            let radius = if i == 0 { 0.0 } else { latitude.cos() };
            for k in 0..FACETS {
                let (sin, cos) = (TAU * k as f64 / FACETS as f64).sin_cos();
                let unit = Vector3::new(radius * cos, radius * sin, latitude.sin());
                vertices.push(center + semi_axes.component_mul(&unit));
            }
        }
        let base = self.add_vertices(vertices);
        self.add_rings(base, RINGS + 2, FACETS, color);
    }

    /// Adds a round tube of eight facets along a path of at least two points, closed at both ends.
    pub(super) fn add_tube(&mut self, path: &[Point3<f64>], radius: f64, color: Color) {
        const SIDES: usize = 8;
        let mut vertices = Vec::with_capacity((path.len() + 2) * SIDES);
        let ring_at = |i: usize, radius: f64| {
            let ahead = path[(i + 1).min(path.len() - 1)] - path[i.saturating_sub(1)];
            let along = Unit::try_new(ahead, 1e-9).unwrap_or(Vector3::z_axis());
            let turn = Rotation3::rotation_between(&Vector3::z(), &along)
                .unwrap_or(Rotation3::from_axis_angle(&Vector3::x_axis(), 0.5 * TAU));
            (0..SIDES).map(move |k| {
                let (sin, cos) = (TAU * k as f64 / SIDES as f64).sin_cos();
                path[i] + turn * Vector3::new(radius * cos, radius * sin, 0.0)
            })
        };
        vertices.extend(ring_at(0, 0.0));
        for i in 0..path.len() {
            vertices.extend(ring_at(i, radius));
        }
        vertices.extend(ring_at(path.len() - 1, 0.0));
        let base = self.add_vertices(vertices);
        self.add_rings(base, path.len() + 2, SIDES, color);
    }

    /// Adds a leaf: a thin diamond from `root` to `tip`, a third of its length wide, slightly folded.
    pub(super) fn add_leaf(&mut self, root: Point3<f64>, tip: Point3<f64>, color: Color) {
        let along = tip - root;
        let across = Unit::try_new(along.cross(&Vector3::z()), 1e-9).unwrap_or(Vector3::x_axis());
        let half_width = across.into_inner() * (along.norm() / 6.0);
        let fold = Vector3::z() * (along.norm() / 12.0);
        let middle = root + along * 0.45;
        let base =
            self.add_vertices([root, middle + half_width + fold, tip, middle - half_width + fold]);
        // Two triangles that share the midrib.
        self.add_triangle([base, base + 1, base + 2], color);
        self.add_triangle([base, base + 2, base + 3], color);
    }

    /// Adds a flat four-cornered face.
    pub(super) fn add_face(&mut self, corners: [Point3<f64>; 4], color: Color) {
        let base = self.add_vertices(corners);
        self.add_quad([base, base + 1, base + 2, base + 3], color);
    }

    fn add_vertices(&mut self, vertices: impl IntoIterator<Item = Point3<f64>>) -> u32 {
        let base = self.vertices.len() as u32;
        self.vertices.extend(vertices);
        base
    }

    /// Connects consecutive rings of `sides` vertices each.
    fn add_rings(&mut self, base: u32, rings: usize, sides: usize, color: Color) {
        for ring in 1..rings {
            for k in 0..sides {
                let index = |r: usize, s: usize| base + (r * sides + s % sides) as u32;
                let (below, above) = (ring - 1, ring);
                self.add_quad(
                    [index(below, k), index(below, k + 1), index(above, k + 1), index(above, k)],
                    color,
                );
            }
        }
    }

    fn add_quad(&mut self, [a, b, c, d]: [u32; 4], color: Color) {
        self.add_triangle([a, b, c], color);
        self.add_triangle([a, c, d], color);
    }

    /// Triangles without area, as at the poles of a lathe, are left out.
    fn add_triangle(&mut self, triangle: [u32; 3], color: Color) {
        let [a, b, c] = triangle.map(|i| self.vertices[i as usize]);
        if (b - a).cross(&(c - a)).norm() > 1e-12 {
            self.triangles.push(triangle);
            self.colors.push(color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume by the divergence theorem; right only for closed meshes with one orientation.
    fn volume(mesh: &Mesh) -> f64 {
        let tetrahedron = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.vertices[i as usize].coords);
            a.dot(&b.cross(&c)) / 6.0
        };
        mesh.triangles.iter().map(tetrahedron).sum()
    }

    #[test]
    fn solids_are_closed_and_have_their_volume() {
        let color = [1, 2, 3];
        let polygon = FACETS as f64 / 2.0 * (TAU / FACETS as f64).sin();
        let octagon = 4.0 * (TAU / 8.0).sin();
        let mut cuboid = Mesh::default();
        cuboid.add_box([1.0, 2.0, 3.0], [2.0, 4.0, 6.0], color);
        let mut cylinder = Mesh::default();
        cylinder.add_cylinder((3.0, 1.0), 0.5, (1.0, 3.0), color);
        let mut tube = Mesh::default();
        tube.add_tube(&[Point3::origin(), Point3::new(1.0, 2.0, 2.0)], 0.1, color);
        let mut ball = Mesh::default();
        ball.add_ellipsoid(Point3::new(1.0, 1.0, 1.0), Vector3::repeat(1.0), false, color);
        let mut dome = Mesh::default();
        dome.add_ellipsoid(Point3::new(1.0, 1.0, 1.0), Vector3::repeat(1.0), true, color);
        let sphere = 2.0 * TAU / 3.0;
        for (name, mesh, expected, tolerance) in [
            ("box", &cuboid, 6.0, 1e-9),
            ("cylinder", &cylinder, polygon * 0.25 * 2.0, 1e-9),
            ("tube", &tube, octagon * 0.01 * 3.0, 1e-9),
            // Eight rings and 24 facets cut a little off.
            ("ball", &ball, sphere, 0.06 * sphere),
            ("dome", &dome, 0.5 * sphere, 0.03 * sphere),
        ] {
            let got = volume(mesh);
            assert!((got - expected).abs() <= tolerance, "{name}: {got} instead of {expected}");
            assert_eq!(mesh.colors.len(), mesh.triangles.len());
        }
    }
}
