//! `ObjectSlam::handle` with hand-made messages.

mod arrays;
mod calibration;
mod clocks;
mod glimpses;
mod in_space;
mod limits;
mod missing;
mod moved_chair;
mod odometry_jumps;
mod pairing;
mod pictures;
mod poses;
mod random_orders;
mod replay;
mod settings;

use ellipsoid_slam::{
    geometry::{Camera, Distortion, Pose},
    perception::{DepthImage, Detection},
    pipeline::{
        CameraMessage, CameraRole, DepthMessage, DetectionsMessage, Input, ObjectSlam,
        OdometryMessage, Settings, StampedTransform, Update,
    },
    time::Stamp,
};

/// A system and all that came out of it.
pub(crate) struct Run {
    pub(crate) slam: ObjectSlam,
    pub(crate) total: Update,
}

impl Run {
    pub(crate) fn new(settings: Settings) -> Self {
        Self { slam: ObjectSlam::new(settings), total: Update::default() }
    }

    /// With the camera's calibration and its place on the base.
    pub(crate) fn ready() -> Self {
        let mut run = Self::new(Settings::default());
        run.feed([color_camera(), camera_on_base()]);
        run
    }

    pub(crate) fn feed(&mut self, inputs: impl IntoIterator<Item = Input>) -> Update {
        let mut new = Update::default();
        for input in inputs {
            add(&mut new, &self.slam.handle(input, &mut ()));
        }
        add(&mut self.total, &new);
        new
    }

    pub(crate) fn finish(&mut self) -> Update {
        let last = self.slam.finish(&mut ());
        add(&mut self.total, &last);
        last
    }

    /// Milliseconds of all images that got a pose.
    pub(crate) fn posed(&self) -> Vec<i64> {
        self.total.poses.iter().map(|p| millis(p.stamp)).collect()
    }

    /// Milliseconds of all images whose boxes were worked on.
    pub(crate) fn keyframes(&self) -> Vec<i64> {
        self.total.keyframes.iter().map(|k| millis(k.stamp)).collect()
    }

    /// Milliseconds and reasons of all that was dropped.
    pub(crate) fn dropped(&self) -> Vec<(i64, &'static str)> {
        self.total.dropped.iter().map(|d| (millis(d.stamp), d.reason)).collect()
    }
}

fn add(total: &mut Update, new: &Update) {
    total.poses.extend_from_slice(&new.poses);
    total.keyframes.extend_from_slice(&new.keyframes);
    total.dropped.extend_from_slice(&new.dropped);
}

pub(crate) fn millis(stamp: Stamp) -> i64 {
    stamp.as_nanos() / 1_000_000
}

/// A present-day stamp, `ms` milliseconds into the recording.
pub(crate) fn at(ms: i64) -> Stamp {
    Stamp::from_nanos(ms * 1_000_000)
}

/// A depth image of a wall, small because its content does not matter.
pub(crate) fn depth(ms: i64) -> Input {
    depth_in("camera", ms)
}

pub(crate) fn depth_in(frame_id: &str, ms: i64) -> Input {
    let image = DepthImage::new(16, 12, vec![2.0; 16 * 12]).unwrap();
    Input::Depth(DepthMessage { stamp: at(ms), frame_id: frame_id.into(), image })
}

/// Boxes of the image at `ms`; none, but looked for.
pub(crate) fn boxes(ms: i64) -> Input {
    boxes_with(ms, Vec::new())
}

pub(crate) fn boxes_with(ms: i64, detections: Vec<Detection>) -> Input {
    Input::Detections(DetectionsMessage { stamp: at(ms), frame_id: "camera".into(), detections })
}

/// The base `ms` millimetres ahead of where it started: a metre a second.
pub(crate) fn odometry(ms: i64) -> Input {
    odometry_at(ms, Pose::translation(ms as f64 / 1000.0, 0.0, 0.0))
}

pub(crate) fn odometry_at(ms: i64, odom_from_base: Pose) -> Input {
    Input::Odometry(OdometryMessage {
        stamp: at(ms),
        frame_id: "odom".into(),
        child_frame_id: "base_link".into(),
        odom_from_base,
        covariance: None,
    })
}

pub(crate) fn transform(is_static: bool, ms: i64, frames: [&str; 2], pose: Pose) -> Input {
    let transforms = vec![StampedTransform {
        stamp: at(ms),
        frame_id: frames[0].into(),
        child_frame_id: frames[1].into(),
        parent_from_child: pose,
    }];
    Input::Transforms { is_static, transforms }
}

pub(crate) fn small_camera() -> Camera {
    Camera::new((16, 12), (14.0, 14.0), (7.5, 5.5), Distortion::None).unwrap()
}

pub(crate) fn camera_info(role: CameraRole, frame_id: &str, camera: Camera) -> Input {
    Input::Camera(CameraMessage { role, stamp: at(0), frame_id: frame_id.into(), camera })
}

pub(crate) fn color_camera() -> Input {
    camera_info(CameraRole::Color, "camera", small_camera())
}

/// The camera a metre above the base, looking ahead.
pub(crate) fn camera_on_base() -> Input {
    let pose = crate::scene::looking([0.0, 0.0, 1.0], 0.0, 0.0);
    transform(true, 0, ["base_link", "camera"], pose)
}
