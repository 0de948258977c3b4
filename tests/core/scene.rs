//! Rooms made of boxes, seen by an exact depth camera.

use ellipsoid_slam::{
    geometry::{Camera, Distortion, Ellipsoid, OrientedBox, Pose, Rect},
    perception::{DepthImage, DepthNoise, Detection},
};
use nalgebra::{Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Things in a world with z up.
#[derive(Clone, Default)]
pub(crate) struct Scene {
    things: Vec<OrientedBox>,
}

/// A depth image, and which thing each pixel shows.
pub(crate) struct View {
    pub(crate) depth: DepthImage,
    pub(crate) world_from_camera: Pose,
    shown: Vec<Option<usize>>,
}

impl Scene {
    /// A room with its floor at height 0.
    pub(crate) fn with_floor() -> Self {
        let mut scene = Self::default();
        scene.add(standing(0.0, [0.0, 0.0, -0.1], [40.0, 40.0, 0.1]));
        scene
    }

    /// Adds a thing and returns its number.
    pub(crate) fn add(&mut self, thing: OrientedBox) -> usize {
        self.things.push(thing);
        self.things.len() - 1
    }

    pub(crate) fn thing(&self, number: usize) -> &OrientedBox {
        &self.things[number]
    }

    /// The whole world turned about the vertical through the origin and moved.
    pub(crate) fn moved(&self, motion: &Pose) -> Self {
        let things = self.things.iter();
        Self { things: things.map(|t| OrientedBox { pose: motion * t.pose, ..*t }).collect() }
    }

    /// What a camera without noise sees.
    pub(crate) fn seen_from(&self, world_from_camera: &Pose) -> View {
        self.seen_with(world_from_camera, None)
    }

    /// What a depth camera sees, with seeded noise.
    pub(crate) fn seen_with(&self, world_from_camera: &Pose, seed: Option<u64>) -> View {
        let camera = camera();
        let mut rng = seed.map(ChaCha8Rng::seed_from_u64);
        let (mut metres, mut shown) = (Vec::new(), Vec::new());
        for v in 0..camera.height() {
            for u in 0..camera.width() {
                let ray = camera.ray(f64::from(u), f64::from(v));
                let hits = self
                    .things
                    .iter()
                    .enumerate()
                    .filter_map(|(i, t)| Some((depth_at(t, world_from_camera, &ray)?, i)));
                let nearest = hits.min_by(|a, b| a.0.total_cmp(&b.0));
                let depth = nearest.filter(|hit| hit.0 < 10.0).map(|(z, i)| {
                    let noise = rng.as_mut().map_or(0.0, bell) * DepthNoise::default().sigma_m(z);
                    (z + noise, i)
                });
                metres.push(depth.map_or(f32::NAN, |(z, _)| z as f32));
                shown.push(depth.map(|(_, i)| i));
            }
        }
        let depth = DepthImage::new(camera.width(), camera.height(), metres).unwrap();
        View { depth, world_from_camera: *world_from_camera, shown }
    }
}

/// The smallest box round some boxes: of a thing that is made of several.
pub(crate) fn round_all(boxes: impl IntoIterator<Item = Rect>) -> Rect {
    let both = |a: Rect, b: Rect| Rect {
        x_min: a.x_min.min(b.x_min),
        y_min: a.y_min.min(b.y_min),
        x_max: a.x_max.max(b.x_max),
        y_max: a.y_max.max(b.y_max),
    };
    boxes.into_iter().reduce(both).unwrap()
}

impl View {
    /// The box a perfect detector draws around what can be seen of a thing.
    pub(crate) fn box_around(&self, thing: usize) -> Rect {
        self.try_box_around(thing).unwrap()
    }

    /// The same, or nothing where the thing cannot be seen.
    pub(crate) fn try_box_around(&self, thing: usize) -> Option<Rect> {
        let width = self.depth.width() as usize;
        let pixels = self.shown.iter().enumerate().filter(|(_, s)| **s == Some(thing));
        let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        for (at, _) in pixels {
            let (u, v) = ((at % width) as f64, (at / width) as f64);
            low = (low.0.min(u), low.1.min(v));
            high = (high.0.max(u), high.1.max(v));
        }
        Rect::new(low.0, low.1, high.0, high.1)
    }

    pub(crate) fn up_in_camera(&self) -> Unit<Vector3<f64>> {
        self.world_from_camera.rotation.inverse() * Vector3::z_axis()
    }
}

pub(crate) fn detection(label: &str, rect: Rect) -> Detection {
    Detection::new(rect, vec![(label.into(), 0.9)]).unwrap()
}

/// A Kinect's view: 640x480 pixels, 63 degrees wide.
pub(crate) fn camera() -> Camera {
    Camera::new((640, 480), (525.0, 525.0), (319.5, 239.5), Distortion::None).unwrap()
}

/// A box turned by `yaw` about the vertical around its centre.
pub(crate) fn standing(yaw: f64, center: [f64; 3], half_extents: [f64; 3]) -> OrientedBox {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    let pose = Pose::from_parts(Translation3::from(Vector3::from(center)), rotation);
    OrientedBox { pose, half_extents: half_extents.into() }
}

/// The ellipsoid with a box's extents.
pub(crate) fn inside(thing: &OrientedBox) -> Ellipsoid {
    Ellipsoid::new(thing.pose, thing.half_extents)
}

/// `world_from_camera` of a camera at `eye` that looks along `yaw` and `down_deg` below the horizon.
pub(crate) fn looking(eye: [f64; 3], yaw: f64, down_deg: f64) -> Pose {
    let (sin_p, cos_p) = down_deg.to_radians().sin_cos();
    let ahead = Vector3::new(cos_p * yaw.cos(), cos_p * yaw.sin(), -sin_p);
    let right = Vector3::new(yaw.sin(), -yaw.cos(), 0.0);
    let rotation = Rotation3::from_basis_unchecked(&[right, ahead.cross(&right), ahead]);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    Pose::from_parts(Translation3::from(Vector3::from(eye)), rotation)
}

/// Depth at which a ray `(x, y, 1)` of the camera meets a box, by the slabs between its faces.
fn depth_at(thing: &OrientedBox, world_from_camera: &Pose, ray: &Vector3<f64>) -> Option<f64> {
    let box_from_camera = thing.pose.inverse() * world_from_camera;
    let (from, along) = (box_from_camera.translation.vector, box_from_camera.rotation * ray);
    let (mut enters, mut leaves) = (0.0_f64, f64::MAX);
    for axis in 0..3 {
        let cross = |side: f64| (side * thing.half_extents[axis] - from[axis]) / along[axis];
        let (a, b) = (cross(-1.0), cross(1.0));
        enters = enters.max(a.min(b));
        leaves = leaves.min(a.max(b));
    }
    (enters > 0.0 && enters < leaves).then_some(enters)
}

/// A normal variate, near enough: twelve uniform ones (variance 1).
fn bell(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()
}

#[test]
fn the_camera_sees_what_it_should() {
    // A cube's face 2 m ahead, 1 m up; the camera 1 m up looks along y.
    let mut scene = Scene::with_floor();
    let cube = scene.add(standing(0.0, [0.0, 2.5, 1.0], [0.5; 3]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2, 0.0));
    assert_eq!(view.depth.at(320, 240), Some(2.0));
    let rect = view.box_around(cube);
    // 0.5 m at 2 m: 131.25 px to each side, less than a pixel of it not seen whole.
    assert!((rect.width() - 262.5).abs() < 2.0 && (rect.center().0 - 319.5).abs() < 1.0);
    // The floor below: z = f * h / (v - cy).
    let floor = f64::from(view.depth.at(10, 470).unwrap());
    assert!((floor - 525.0 / 230.5).abs() < 1e-4);
    assert_eq!(view.depth.at(10, 10), None, "the sky");
    let in_camera = view.world_from_camera.inverse() * Point3::new(0.1, 2.0, 0.9);
    assert!((in_camera - Point3::new(0.1, 0.1, 2.0)).norm() < 1e-9, "right and down");
}
