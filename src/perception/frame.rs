//! One RGB-D frame as the estimators see it: depth, viewing rays and the direction of gravity.

use super::DepthImage;
use crate::geometry::{Camera, Pose};
use nalgebra::{Matrix3, Point2, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Standard deviation of a depth reading, growing with the square of the range.
///
/// Nguyen, Izadi and Lovell 2012, Modeling Kinect Sensor Noise, axial noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DepthNoise {
    /// Standard deviation at `best_range_m` (m).
    pub base_m: f64,
    /// Growth with the squared distance from `best_range_m` (m/m^2).
    pub quadratic_per_m: f64,
    /// Range at which the sensor is best (m).
    pub best_range_m: f64,
}

impl Default for DepthNoise {
    fn default() -> Self {
        Self { base_m: 0.0012, quadratic_per_m: 0.0019, best_range_m: 0.4 }
    }
}

impl DepthNoise {
    /// Standard deviation (m) of a reading of `depth_m`.
    pub fn sigma_m(&self, depth_m: f64) -> f64 {
        self.base_m + self.quadratic_per_m * (depth_m - self.best_range_m).powi(2)
    }
}

/// Viewing rays of every pixel: computed once for a camera, because undistortion is iterative.
#[derive(Clone, Debug)]
pub struct Rays {
    camera: Camera,
    /// `(x, y)` of the direction `(x, y, 1)`, row-major.
    directions: Vec<[f32; 2]>,
}

impl Rays {
    /// The rays of `camera`.
    pub fn new(camera: Camera) -> Self {
        let directions = (0..camera.height())
            .flat_map(|v| (0..camera.width()).map(move |u| (u, v)))
            .map(|(u, v)| {
                let ray = camera.ray(f64::from(u), f64::from(v));
                [ray.x as f32, ray.y as f32]
            })
            .collect();
        Self { camera, directions }
    }

    /// The camera they belong to.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    #[inline]
    pub(super) fn at(&self, u: i32, v: i32) -> Vector3<f64> {
        let [x, y] = self.directions[v as usize * self.camera.width() as usize + u as usize];
        Vector3::new(f64::from(x), f64::from(y), 1.0)
    }
}

/// A depth image with its geometry, seen from the *level* frame: origin at the camera, z up, x where the
/// camera looks (projected on the horizon).
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    depth: &'a DepthImage,
    rays: &'a Rays,
    noise: DepthNoise,
    level_from_camera: Matrix3<f64>,
    /// How far below the camera the floor is that the wheels stand on (m), if there are wheels and it was seen.
    floor_below_m: Option<f64>,
}

impl<'a> Frame<'a> {
    /// A frame whose depth image has the size of the rays' camera; `up_in_camera` points against gravity.
    pub fn new(
        depth: &'a DepthImage,
        rays: &'a Rays,
        up_in_camera: &Unit<Vector3<f64>>,
        noise: DepthNoise,
    ) -> Self {
        debug_assert_eq!(
            (depth.width(), depth.height()),
            (rays.camera.width(), rays.camera.height()),
            "depth registered to the camera has the camera's size"
        );
        let level_from_camera = level_from_camera(up_in_camera);
        Self { depth, rays, noise, level_from_camera, floor_below_m: None }
    }

    /// The same frame of a robot whose wheels stand on a floor so far below the camera (m).
    #[must_use]
    pub fn above_floor(self, floor_below_m: Option<f64>) -> Self {
        Self { floor_below_m, ..self }
    }

    /// How far below the camera the floor is that the wheels stand on (m), where that is known.
    pub fn floor_below_m(&self) -> Option<f64> {
        self.floor_below_m
    }

    /// Rotation from the camera's optical frame to the level frame; the origins coincide.
    pub fn level_from_camera(&self) -> Pose {
        let rotation = Rotation3::from_matrix_unchecked(self.level_from_camera);
        Pose::from_parts(Translation3::identity(), UnitQuaternion::from_rotation_matrix(&rotation))
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.rays.camera
    }

    /// The depth image.
    pub fn depth(&self) -> &DepthImage {
        self.depth
    }

    /// Standard deviation of the depth reading at a pixel of depth `depth_m` (m).
    pub fn sigma_m(&self, depth_m: f64) -> f64 {
        self.noise.sigma_m(depth_m)
    }

    /// The measured point at a pixel, in the level frame.
    #[inline]
    pub fn point_in_level(&self, u: i32, v: i32) -> Option<Point3<f64>> {
        let z = f64::from(self.depth.at(u, v)?);
        Some((self.level_from_camera * (self.rays.at(u, v) * z)).into())
    }

    /// Height in the level frame gained for each metre of depth along the ray of a pixel.
    #[inline]
    pub(super) fn ray_slope(&self, u: i32, v: i32) -> Option<f64> {
        let inside =
            u >= 0 && v >= 0 && (u as u32) < self.depth.width() && (v as u32) < self.depth.height();
        inside.then(|| self.level_from_camera.row(2).transpose().dot(&self.rays.at(u, v)))
    }

    /// Depth along the optical axis (m) of a point in the level frame, and the pixel it falls on.
    #[inline]
    pub fn project(&self, point_in_level: &Point3<f64>) -> Option<(f64, Point2<f64>)> {
        let in_camera = Point3::from(self.level_from_camera.tr_mul(&point_in_level.coords));
        Some((in_camera.z, self.rays.camera.project(&in_camera)?))
    }

    /// What the camera saw where a point in the level frame would be.
    pub fn look_at(&self, point_in_level: &Point3<f64>) -> Sight {
        let Some((depth, pixel)) = self.project(point_in_level) else { return Sight::Outside };
        let (width, height) = (f64::from(self.depth.width()), f64::from(self.depth.height()));
        // Half a pixel further, cutting decimals off rounds; outside the image it need not.
        let (u, v) = (pixel.x + 0.5, pixel.y + 0.5);
        if !(u >= 0.0 && v >= 0.0 && u < width && v < height) {
            return Sight::Outside;
        }
        match self.depth.at(u as i32, v as i32) {
            Some(measured) => Sight::Measured { beyond_m: f64::from(measured) - depth },
            None => Sight::NoReading,
        }
    }
}

/// What the camera saw in the direction of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sight {
    /// The point is outside the image.
    Outside,
    /// The pixel has no depth.
    NoReading,
    /// A surface `beyond_m` behind the point along the optical axis (negative: in front of it) (m).
    Measured {
        /// Measured depth less the point's depth (m).
        beyond_m: f64,
    },
}

fn level_from_camera(up_in_camera: &Unit<Vector3<f64>>) -> Matrix3<f64> {
    let up = up_in_camera.into_inner();
    // Looking straight down leaves no horizontal view direction: the image's upward direction serves then.
    let forward = [Vector3::z(), -Vector3::y()]
        .into_iter()
        .map(|axis| axis - up * up.dot(&axis))
        .find_map(|f| Unit::try_new(f, 0.05))
        .unwrap_or_else(Vector3::x_axis)
        .into_inner();
    let left = up.cross(&forward);
    Matrix3::from_rows(&[forward.transpose(), left.transpose(), up.transpose()])
}
