//! Casting a ray through every pixel.

use super::scene::Scene;
use crate::geometry::{Camera, Pose};
use parry3d::{
    bounding_volume::Aabb,
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy},
    query::Ray,
};
use rayon::prelude::*;

/// What a perfect camera sees: exact depth, the object and the colour at every pixel, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// Depth along the optical axis (m); NaN where nothing is hit.
    pub depth_m: Vec<f32>,
    /// Id of the object, 0 for the building and for nothing.
    pub instances: Vec<u16>,
    /// Cosine of the angle between the ray and the surface normal.
    pub incidence_cosines: Vec<f32>,
    /// Red, green, blue.
    pub rgb: Vec<u8>,
}

/// A scene prepared for casting rays.
pub struct Renderer {
    bvh: Bvh,
    facets: Vec<Facet>,
}

/// A triangle as `Moller and Trumbore 1997` want it.
struct Facet {
    corner: Vector,
    edge_1: Vector,
    edge_2: Vector,
    normal: Vector,
    instance: u16,
    color: [u8; 3],
}

/// One pixel, before images are made of it.
#[derive(Clone, Copy)]
struct Pixel {
    depth_m: f32,
    instance: u16,
    incidence_cosine: f32,
    rgb: [u8; 3],
}

const NOTHING: Pixel =
    Pixel { depth_m: f32::NAN, instance: 0, incidence_cosine: 1.0, rgb: [0, 0, 0] };

impl Renderer {
    /// Builds the search tree over all triangles of a scene.
    pub fn new(scene: &Scene) -> Self {
        let bodies = std::iter::once((0, &scene.building))
            .chain(scene.objects.iter().map(|o| (o.id as u16, &o.mesh)));
        let mut facets = Vec::new();
        for (instance, mesh) in bodies {
            for (triangle, color) in mesh.triangles().iter().zip(mesh.colors()) {
                let [a, b, c] = triangle.map(|i| {
                    let v = mesh.vertices()[i as usize];
                    Vector::new(v.x as f32, v.y as f32, v.z as f32)
                });
                let (edge_1, edge_2) = (b - a, c - a);
                let normal = edge_1.cross(edge_2).normalize_or_zero();
                facets.push(Facet { corner: a, edge_1, edge_2, normal, instance, color: *color });
            }
        }
        let boxes = facets.iter().map(Facet::bounds).enumerate();
        Self { bvh: Bvh::from_iter(BvhBuildStrategy::Binned, boxes), facets }
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.facets.len()
    }

    /// The image of a rectified `camera` at `world_from_camera`; rows are shared among threads.
    pub fn render(&self, camera: &Camera, world_from_camera: &Pose) -> Rendered {
        let width = camera.width() as usize;
        let mut pixels = vec![NOTHING; width * camera.height() as usize];
        pixels.par_chunks_mut(width).enumerate().for_each(|(v, row)| {
            self.render_row(camera, world_from_camera, v, row);
        });
        Rendered {
            depth_m: pixels.iter().map(|p| p.depth_m).collect(),
            instances: pixels.iter().map(|p| p.instance).collect(),
            incidence_cosines: pixels.iter().map(|p| p.incidence_cosine).collect(),
            rgb: pixels.iter().map(|p| p.rgb).collect::<Vec<_>>().into_flattened(),
        }
    }

    fn render_row(&self, camera: &Camera, world_from_camera: &Pose, v: usize, row: &mut [Pixel]) {
        let origin = world_from_camera.translation.vector.cast::<f32>();
        let origin = Vector::new(origin.x, origin.y, origin.z);
        let mut last_hit = None;
        for (u, pixel) in row.iter_mut().enumerate() {
            // The direction has z = 1 in the camera frame, so the ray's parameter is the depth.
            let direction = world_from_camera.rotation * camera.ray(u as f64, v as f64);
            let direction = direction.cast::<f32>();
            let ray = Ray::new(origin, Vector::new(direction.x, direction.y, direction.z));
            last_hit = self.cast(&ray, last_hit);
            if let Some((index, depth_m)) = last_hit {
                *pixel = self.facets[index as usize].seen(&ray, depth_m);
            }
        }
    }

    /// Nearest triangle and its depth. Trying the neighbour's triangle first prunes most of the tree.
    fn cast(&self, ray: &Ray, neighbour: Option<(u32, f32)>) -> Option<(u32, f32)> {
        let guess =
            neighbour.and_then(|(index, _)| Some((index, self.facets[index as usize].hit(ray)?)));
        let limit = guess.map_or(f32::MAX, |(_, depth)| depth);
        self.bvh
            .cast_ray(ray, limit, |index, best| {
                self.facets[index as usize].hit(ray).filter(|depth| *depth < best)
            })
            .or(guess)
    }
}

impl Facet {
    fn bounds(&self) -> Aabb {
        let (b, c) = (self.corner + self.edge_1, self.corner + self.edge_2);
        Aabb::new(self.corner.min(b).min(c), self.corner.max(b).max(c))
    }

    /// Depth at which the ray meets this triangle from either side.
    #[inline]
    fn hit(&self, ray: &Ray) -> Option<f32> {
        // Neighbouring triangles overlap by a millionth of an edge, so that no ray slips between them.
        const MARGIN: f32 = 1e-6;
        let p = ray.dir.cross(self.edge_2);
        let determinant = self.edge_1.dot(p);
        if determinant == 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let to_origin = ray.origin - self.corner;
        let u = to_origin.dot(p) * inverse;
        if !(-MARGIN..=1.0 + MARGIN).contains(&u) {
            return None;
        }
        let q = to_origin.cross(self.edge_1);
        let v = ray.dir.dot(q) * inverse;
        if v < -MARGIN || u + v > 1.0 + MARGIN {
            return None;
        }
        let depth = self.edge_2.dot(q) * inverse;
        (depth > 0.0).then_some(depth)
    }

    fn seen(&self, ray: &Ray, depth_m: f32) -> Pixel {
        let incidence_cosine = (self.normal.dot(ray.dir) / ray.dir.length()).abs();
        // Half of the light comes from a lamp, half from everywhere.
        let light = Vector::new(0.36, 0.48, 0.8);
        let facing = if self.normal.dot(ray.dir) < 0.0 { self.normal } else { -self.normal };
        let mut brightness = 0.55 + 0.45 * facing.dot(light).max(0.0);
        if self.instance == 0 && facing.z > 0.9 {
            brightness *= checker(ray.point_at(depth_m));
        }
        let rgb = self.color.map(|c| (f32::from(c) * brightness).min(255.0) as u8);
        Pixel { depth_m, instance: self.instance, incidence_cosine, rgb }
    }
}

/// Floor tiles, 30 cm wide, alternate in brightness.
fn checker(point: Vector) -> f32 {
    let tile = (point.x / 0.3).floor() + (point.y / 0.3).floor();
    if tile.rem_euclid(2.0) < 0.5 { 1.0 } else { 0.82 }
}
