//! Which objects are near: a tree of bounding boxes.

use super::MapObject;
use crate::geometry::{Ellipsoid, Pose};
use nalgebra::{Point3, Vector3};
use parry3d::{
    bounding_volume::Aabb,
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy},
};

/// The objects of a map by where they are. Built anew for each sighting: every object may have moved a little, and a
/// thousand take a fraction of a millisecond.
pub(super) struct ObjectIndex {
    tree: Bvh,
}

impl ObjectIndex {
    pub(super) fn new(objects: &[MapObject]) -> Self {
        let boxes = objects.iter().map(|object| bounds(object.estimate(), 0.0)).enumerate();
        Self { tree: Bvh::from_iter(BvhBuildStrategy::Binned, boxes) }
    }

    /// Objects whose bounding box comes within a distance (m) of that of a body in the map, in order.
    pub(super) fn near(&self, body: &Ellipsoid, reach_m: f64) -> Vec<usize> {
        self.within(&bounds(body, reach_m))
    }

    /// Objects that a camera may have before it, as far as it sees (m), in order.
    pub(super) fn before(
        &self,
        map_from_camera: &Pose,
        corners: [Vector3<f64>; 4],
        range_m: f64,
    ) -> Vec<usize> {
        let eye = map_from_camera.translation.vector.into();
        let ends = corners.map(|ray| map_from_camera * Point3::from(ray * range_m));
        let (low, high) = ends
            .iter()
            .fold((eye, eye), |(low, high): (Point3<f64>, _), end| (low.inf(end), high.sup(end)));
        self.within(&Aabb::new(vector(&low.coords), vector(&high.coords)))
    }

    fn within(&self, region: &Aabb) -> Vec<usize> {
        let mut found: Vec<usize> =
            self.tree.intersect_aabb(region).map(|leaf| leaf as usize).collect();
        found.sort_unstable();
        found
    }
}

/// Of a box with an ellipsoid's pose and extents, grown by a margin (m).
fn bounds(body: &Ellipsoid, margin_m: f64) -> Aabb {
    let axes = body.pose.rotation.to_rotation_matrix().into_inner().abs();
    let half = (axes * body.semi_axes).add_scalar(margin_m);
    let center = body.center().coords;
    Aabb::new(vector(&(center - half)), vector(&(center + half)))
}

fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}
