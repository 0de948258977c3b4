//! A first guess of an object of which there are only boxes. After Nicholson et al. 2019, QuadricSLAM.

use super::{Observation, ObservedBox, odometry::Place};
use crate::{
    geometry::{Ellipsoid, Pose},
    graph::{Graph, PoseId},
};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Boxes that wait for more of them.
#[derive(Clone, Debug, Default)]
pub(super) struct InitialViews {
    views: Vec<(Place, Observation)>,
}

impl InitialViews {
    /// Adds a view. Returns a first guess once three views
    /// see the object from sufficiently different places.
    pub(super) fn add(
        &mut self,
        graph: &Graph,
        place: &Place,
        observation: &Observation,
    ) -> Option<Ellipsoid> {
        if !observation.sides.sides.iter().all(Option::is_some) {
            return None;
        }
        self.views.push((*place, observation.clone()));
        if self.views.len() < MIN_VIEWS {
            return None;
        }
        let rays = self
            .views
            .iter()
            .filter_map(|(place, view)| Ray::through(&place.map_from_base(graph), &view.sides));
        guess(&rays.collect::<Vec<_>>())
    }

    /// Whether one of them is from this keyframe.
    pub(super) fn are_from(&self, pose: PoseId) -> bool {
        self.views.iter().any(|(place, _)| place.keyframe.pose == pose)
    }

    /// The views before the one that completed the guess.
    pub(super) fn earlier(&self) -> impl Iterator<Item = (&Place, &Observation)> {
        let count = self.views.len().saturating_sub(1);
        self.views[..count].iter().map(|(place, view)| (place, view))
    }
}

/// The middle of a box, seen from a camera.
struct Ray {
    map_from_camera: Pose,
    /// In the map; its z in the camera is 1.
    direction: Vector3<f64>,
    /// Half the width and height of the box, at a depth of 1.
    half_size: [f64; 2],
}

impl Ray {
    fn through(map_from_base: &Pose, seen: &ObservedBox) -> Option<Self> {
        let [left, upper, right, lower] = seen.sides;
        let (left, upper, right, lower) = (left?.at, upper?.at, right?.at, lower?.at);
        let map_from_camera = map_from_base * seen.base_from_camera;
        let middle = Vector3::new(0.5 * (left + right), 0.5 * (upper + lower), 1.0);
        Some(Self {
            map_from_camera,
            direction: map_from_camera.rotation * middle,
            half_size: [0.5 * (right - left), 0.5 * (lower - upper)],
        })
    }
}

/// The point nearest to all rays, and the size that the boxes have there on average.
fn guess(rays: &[Ray]) -> Option<Ellipsoid> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for ray in rays {
        let unit = ray.direction / ray.direction.norm();
        let across = Matrix3::identity() - unit * unit.transpose();
        normal += across;
        right += across * ray.map_from_camera.translation.vector;
    }
    let eigen = normal.symmetric_eigenvalues();
    if eigen.min() < MIN_PARALLAX * rays.len() as f64 {
        return None;
    }
    let center = normal.cholesky()?.solve(&right);
    let mut half = [0.0; 2];
    for ray in rays {
        let depth = (ray.map_from_camera.inverse() * nalgebra::Point3::from(center)).z;
        if depth < MIN_DEPTH_M {
            return None;
        }
        (0..2).for_each(|i| half[i] += depth * ray.half_size[i] / rays.len() as f64);
    }
    let pose = Pose::from_parts(center.into(), UnitQuaternion::identity());
    // Not round: a heading has to be there for boxes to change it.
    Some(Ellipsoid::new(pose, Vector3::new(1.1 * half[0], 0.9 * half[0], half[1])))
}

const MIN_VIEWS: usize = 3;
/// Smallest eigenvalue a ray: the squared sine of about 3 degrees between them.
const MIN_PARALLAX: f64 = 0.0025;
const MIN_DEPTH_M: f64 = 0.1;
