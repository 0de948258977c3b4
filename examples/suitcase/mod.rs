// A made-up camera: it looks at a suitcase of 0.4 x 0.3 x 0.5 m that stands on the floor, and moves to the right.

use ellipsoid_slam::{
    geometry::{Camera, CameraError, Distortion, Pose},
    nalgebra::{Point3, UnitQuaternion, Vector3},
    time::Stamp,
};

/// What one look gives.
pub(crate) struct Look {
    pub(crate) stamp: Stamp,
    pub(crate) odom_from_camera: Pose,
    /// Row by row (m).
    pub(crate) depth_m: Vec<f32>,
    /// `[x_min, y_min, x_max, y_max]` (px), as a detector would say it.
    pub(crate) corners: [f64; 4],
}

pub(crate) fn camera() -> Result<Camera, CameraError> {
    Camera::new((160, 120), (130.0, 130.0), (79.5, 59.5), Distortion::None)
}

/// Looks of a fifth of a second, from 1.2 m above the floor.
pub(crate) fn looks(camera: &Camera) -> impl Iterator<Item = Look> {
    (0..6).map(move |i| {
        let eye = Point3::new(-1.6, 0.4 - 0.16 * f64::from(i), 1.2);
        let forward = Point3::new(0.0, 0.0, 0.25) - eye;
        // An optical frame: z forward, y down.
        let turn = UnitQuaternion::face_towards(&forward, &-Vector3::z());
        let odom_from_camera = Pose::from_parts(eye.into(), turn);
        let (depth_m, corners) = rendered(camera, &odom_from_camera);
        Look { stamp: Stamp::from_secs(0.2 * f64::from(i)), odom_from_camera, depth_m, corners }
    })
}

fn rendered(camera: &Camera, odom_from_camera: &Pose) -> (Vec<f32>, [f64; 4]) {
    let origin = odom_from_camera.translation.vector;
    let mut corners = [f64::MAX, f64::MAX, f64::MIN, f64::MIN];
    let mut depth_m = Vec::new();
    for v in 0..camera.height() {
        for u in 0..camera.width() {
            let (x, y) = (f64::from(u), f64::from(v));
            let ray = odom_from_camera.rotation * camera.ray(x, y);
            let floor = if ray.z < 0.0 { -origin.z / ray.z } else { f64::INFINITY };
            let suitcase = entered(&origin, &ray);
            if suitcase < floor {
                let [x_min, y_min, x_max, y_max] = corners;
                corners = [x_min.min(x), y_min.min(y), x_max.max(x), y_max.max(y)];
            }
            depth_m.push(suitcase.min(floor) as f32);
        }
    }
    (depth_m, corners)
}

/// How far along a ray the suitcase begins; infinity if it is missed.
fn entered(origin: &Vector3<f64>, ray: &Vector3<f64>) -> f64 {
    let (low, high) = (Vector3::new(-0.2, -0.15, 0.0), Vector3::new(0.2, 0.15, 0.5));
    let a = (low - origin).component_div(ray);
    let b = (high - origin).component_div(ray);
    let (near, far) = (a.inf(&b).max(), a.sup(&b).min());
    if near < far { near } else { f64::INFINITY }
}
