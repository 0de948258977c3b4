//! Pairs what belongs together: depth, boxes, calibration and pose of one moment.
//!
//! Boxes come later than the image they were found in, with that image's stamp. Exact stamps are paired first, the
//! nearest within a slop otherwise; the pose is interpolated at the image's stamp.

use super::{
    CameraMessage, CameraPose, CameraRole, DepthMessage, DetectionsMessage, Input, OdometryMessage,
    StampedTransform,
    history::{Jump, Outside, is_long_before},
    odometry::{Odometry, Reading},
    sync_3d::Waiting3d,
    transforms::{MAX_FRAMES, TransformError, Transforms},
};
use crate::{
    geometry::{Pose, local},
    perception::Detection,
    time::Stamp,
};
use nalgebra::Vector6;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// How messages are paired.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SyncSettings {
    /// Largest difference between the stamps of boxes and depth (s).
    pub slop_s: f64,
    /// How long a depth image waits for its boxes, in the data's time (s).
    pub max_delay_s: f64,
    /// Most depth images that wait at once.
    pub max_waiting: usize,
    /// Fixed frame of the odometry, used where it comes from TF and not from `nav_msgs/Odometry`.
    pub odom_frame: String,
    /// Base frame, used likewise; empty: the camera's own.
    pub base_frame: String,
    /// Where the camera is on the base; empty: TF says it.
    pub camera_pose: CameraPose,
    /// How far the stamps of images and odometry usually are off from each other: one standard deviation (s).
    pub stamp_sigma_s: f64,
}

impl Default for SyncSettings {
    fn default() -> Self {
        Self {
            slop_s: 0.02,
            max_delay_s: 1.0,
            max_waiting: 40,
            odom_frame: "odom".into(),
            base_frame: "base_link".into(),
            camera_pose: CameraPose::default(),
            stamp_sigma_s: 0.02,
        }
    }
}

/// All that belongs to one depth image.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    pub(super) depth: DepthMessage,
    /// Boxes, if the detector looked at this image.
    pub(super) detections: Option<Vec<Detection>>,
    pub(super) color: CameraMessage,
    /// The depth camera and `color_from_depth`, where depth has to be registered.
    pub(super) registration: Option<(CameraMessage, Pose)>,
    pub(super) odometry: Reading,
    /// `[rotation, translation]` a second, in the base's own frame, just before the image.
    pub(super) velocity: Vector6<f64>,
    /// Of the odometry's reading nearest in time, where it came with one.
    pub(super) odometry_covariance: Option<Box<[f64; 36]>>,
    pub(super) base_from_camera: Pose,
}

/// A message that could not be used.
#[derive(Clone, Debug, PartialEq)]
pub struct Dropped {
    /// Stamp of the message.
    pub stamp: Stamp,
    /// A short key for counting.
    pub reason: &'static str,
    /// What happened, as a sentence with the names of topics or frames.
    pub why: String,
}

/// The waiting room.
#[derive(Debug)]
pub(super) struct Sync {
    settings: SyncSettings,
    depth: VecDeque<DepthMessage>,
    detections: VecDeque<DetectionsMessage>,
    color: Option<CameraMessage>,
    depth_camera: Option<CameraMessage>,
    odometry: Option<Odometry>,
    transforms: Transforms,
    pub(super) in_space: Waiting3d,
    newest: Option<Stamp>,
    /// What is added to an image's stamp before odometry is asked (s).
    stamp_offset_s: f64,
}

/// Pixels of all depth images that wait: thirty of 1920 x 1080, which are 250 MB.
const MAX_WAITING_PIXELS: usize = 1 << 26;
/// Velocities are means over this time: a reading or two of slow odometry (s).
const VELOCITY_OVER_S: f64 = 0.1;

impl Sync {
    pub(super) fn new(settings: SyncSettings) -> Self {
        Self {
            settings,
            depth: VecDeque::new(),
            detections: VecDeque::new(),
            color: None,
            depth_camera: None,
            odometry: None,
            transforms: Transforms::default(),
            in_space: Waiting3d::default(),
            newest: None,
            stamp_offset_s: 0.0,
        }
    }

    /// From the next image on, this is added to its stamp before odometry is asked (s).
    pub(super) fn shift_odometry(&mut self, seconds: f64) {
        self.stamp_offset_s = seconds;
    }

    pub(super) fn change_settings(&mut self, settings: SyncSettings) {
        self.settings = settings;
    }

    /// The odometry's fixed frame and the base frame, as far as known.
    pub(super) fn frames(&self) -> (&str, &str) {
        match &self.odometry {
            Some(odometry) => (&odometry.frame_id, &odometry.child_frame_id),
            None => (&self.settings.odom_frame, self.base_frame()),
        }
    }

    /// Takes a message in; what it is good for shows in [`Sync::next`].
    pub(super) fn push(&mut self, input: Input, dropped: &mut Vec<Dropped>) {
        match input {
            Input::Depth(depth) => self.push_depth(depth, dropped),
            Input::Camera(camera) => match camera.role {
                CameraRole::Color => self.color = Some(camera),
                CameraRole::Depth => self.depth_camera = Some(camera),
            },
            Input::Odometry(odometry) => self.push_odometry(odometry, dropped),
            Input::Transforms { is_static, transforms } => {
                for transform in &transforms {
                    if !self.transforms.insert(transform, is_static) {
                        dropped.push(one_frame_too_many(transform));
                    }
                }
            }
            Input::Detections3d(detections) => self.push_3d(detections, dropped),
            Input::Detections(detections) => {
                self.detections.push_back(detections);
                // Boxes with stamps of another clock never find an image: they must not pile up over a day.
                while self.detections.len() > self.settings.max_waiting {
                    dropped.extend(self.detections.pop_front().map(|d| without_depth(&d)));
                }
            }
        }
    }

    fn push_depth(&mut self, depth: DepthMessage, dropped: &mut Vec<Dropped>) {
        if let Some(newest) = self.newest
            && depth.stamp <= newest
        {
            if !is_long_before(depth.stamp, newest) {
                let back = newest.seconds_since(depth.stamp);
                dropped.push(Dropped {
                    stamp: depth.stamp,
                    reason: "stamp_goes_back",
                    why: format!("a depth image is {back:.3} s older than the one before it"),
                });
                return;
            }
            // The clock jumped: a bag was restarted, or the time was set. Nothing that waits belongs to the new time.
            self.jump_back(&Jump { from: newest, to: depth.stamp }, dropped);
        }
        self.newest = Some(depth.stamp);
        self.depth.push_back(depth);
    }

    fn jump_back(&mut self, jump: &Jump, dropped: &mut Vec<Dropped>) {
        for depth in self.depth.drain(..) {
            dropped.push(Dropped {
                stamp: depth.stamp,
                reason: "clock_jumped",
                why: "the stamps jumped back while this depth image was waiting".into(),
            });
        }
        self.detections.retain(|d| {
            let before = jump.is_before(d.stamp);
            if before {
                dropped.push(without_depth(d));
            }
            !before
        });
        self.poses_jump_back(jump);
    }

    pub(super) fn poses_jump_back(&mut self, jump: &Jump) {
        if let Some(odometry) = &mut self.odometry {
            odometry.jump_back(jump);
        }
        self.transforms.jump_back(jump);
    }

    fn push_odometry(&mut self, message: OdometryMessage, dropped: &mut Vec<Dropped>) {
        let stamp = message.stamp;
        let odometry = self.odometry.get_or_insert_with(|| Odometry::of(&message));
        let jumped = odometry.push(message);
        dropped.extend(jumped.map(|why| Dropped { stamp, reason: "odometry_jump", why }));
    }

    /// The next depth image for which nothing more is to be waited for. With `last`, nothing more will come.
    pub(super) fn next(&mut self, last: bool, dropped: &mut Vec<Dropped>) -> Option<Moment> {
        loop {
            let stamp = self.depth.front()?.stamp;
            let waited = self.newest.map_or(0.0, |newest| newest.seconds_since(stamp));
            let give_up = last
                || self.is_too_much(waited, self.depth.len())
                || self.waiting_pixels() > MAX_WAITING_PIXELS;
            let boxes = self.boxes_of_front(give_up);
            if boxes == Boxes::Wait {
                return None;
            }
            match self.poses_at(stamp, give_up) {
                Err(Unknown { early: true, .. }) if !give_up => return None,
                Err(unknown) => {
                    self.depth.pop_front();
                    self.take_boxes(&boxes);
                    let Unknown { reason, why, .. } = unknown;
                    dropped.push(Dropped { stamp, reason, why });
                }
                Ok(poses) => {
                    let depth = self.depth.pop_front()?;
                    let detections = self.take_boxes(&boxes);
                    return Some(Moment {
                        depth,
                        detections,
                        color: poses.color,
                        registration: poses.registration,
                        odometry: poses.odometry,
                        velocity: poses.velocity,
                        odometry_covariance: poses.odometry_covariance,
                        base_from_camera: poses.base_from_camera,
                    });
                }
            }
        }
    }

    /// Whether the oldest of what waits has waited long enough (s), or too much waits.
    pub(super) fn is_too_much(&self, waited_s: f64, waiting: usize) -> bool {
        waited_s > self.settings.max_delay_s || waiting > self.settings.max_waiting
    }

    fn waiting_pixels(&self) -> usize {
        self.depth.iter().map(|depth| depth.image.metres().len()).sum()
    }

    /// Boxes for which no depth image came, when nothing more will come.
    pub(super) fn leftovers(&mut self) -> Vec<Dropped> {
        self.detections.drain(..).map(|d| without_depth(&d)).collect()
    }

    /// Which detections belong to the oldest depth image.
    fn boxes_of_front(&self, give_up: bool) -> Boxes {
        let Some(front) = self.depth.front() else { return Boxes::Wait };
        if let Some(exact) = self.detections.iter().position(|d| d.stamp == front.stamp) {
            return Boxes::At(exact);
        }
        let distance = |a: Stamp, b: Stamp| a.seconds_since(b).abs();
        let nearest = (0..self.detections.len()).min_by(|a, b| {
            distance(self.detections[*a].stamp, front.stamp)
                .total_cmp(&distance(self.detections[*b].stamp, front.stamp))
        });
        if let Some(at) = nearest {
            let stamp = self.detections[at].stamp;
            let mine = distance(stamp, front.stamp);
            if mine <= self.settings.slop_s {
                // Another depth image, already here or next to come, may be nearer.
                let nearer = self.depth.iter().skip(1).any(|d| distance(d.stamp, stamp) < mine);
                if nearer {
                    return Boxes::None;
                }
                let settled = stamp <= front.stamp || self.newest.is_some_and(|n| n >= stamp);
                return if settled || give_up { Boxes::At(at) } else { Boxes::Wait };
            }
        }
        // A detector works in order: boxes of a later image mean that this one was skipped. Boxes of an image that
        // did not come yet say nothing: their stamp may be wrong.
        let skipped = self.detections.iter().any(|d| {
            d.stamp.seconds_since(front.stamp) > self.settings.slop_s
                && self.newest.is_some_and(|newest| d.stamp <= newest)
        });
        if skipped || give_up { Boxes::None } else { Boxes::Wait }
    }

    fn take_boxes(&mut self, boxes: &Boxes) -> Option<Vec<Detection>> {
        match boxes {
            Boxes::At(at) => self.detections.remove(*at).map(|d| d.detections),
            _ => None,
        }
    }

    /// Boxes older than every depth image that waits will find none any more.
    pub(super) fn drop_stale_boxes(&mut self, dropped: &mut Vec<Dropped>) {
        let oldest = self.depth.front().map(|d| d.stamp).or(self.newest);
        let Some(oldest) = oldest else { return };
        let (slop, settings) = (self.settings.slop_s, &mut self.detections);
        settings.retain(|d| {
            let stale = oldest.seconds_since(d.stamp) > slop;
            if stale {
                dropped.push(without_depth(d));
            }
            !stale
        });
    }

    fn base_frame(&self) -> &str {
        match &self.color {
            Some(color) if self.settings.base_frame.is_empty() => &color.frame_id,
            _ => &self.settings.base_frame,
        }
    }

    fn poses_at(&self, stamp: Stamp, give_up: bool) -> Result<Poses, Unknown> {
        let Some(color) = self.color.clone() else {
            return Err(Unknown::later("no_camera_info", "no camera info came".into()));
        };
        let registration = self.registration(&color, stamp)?;
        let base = match &self.odometry {
            Some(odometry) => odometry.child_frame_id.as_str(),
            None => self.base_frame(),
        };
        let (at, odometry) = match self.reading(stamp.shifted(self.stamp_offset_s)) {
            // At either end of a recording odometry covers the stamp, but not what is a few milliseconds beside it.
            Err(unknown) if !unknown.early || give_up => (stamp, self.reading(stamp)?),
            pose => (stamp.shifted(self.stamp_offset_s), pose?),
        };
        let before = self.reading(at.shifted(-VELOCITY_OVER_S));
        let velocity = before.map_or(Vector6::zeros(), |before| {
            local(&before.start_from_base(), &odometry.start_from_base()) / VELOCITY_OVER_S
        });
        let base_from_camera = match self.settings.camera_pose.base_from_camera() {
            Some(given) => given,
            None => self.lookup(base, &color.frame_id, stamp)?,
        };
        let odometry_covariance = self.odometry_covariance_at(stamp);
        Ok(Poses { color, registration, odometry, velocity, odometry_covariance, base_from_camera })
    }

    pub(super) fn odometry_covariance_at(&self, stamp: Stamp) -> Option<Box<[f64; 36]>> {
        self.odometry.as_ref().and_then(|odometry| odometry.covariance_at(stamp))
    }

    /// Where a frame other than the camera's is on the base; any but the base's own is the camera where its pose is given by hand.
    pub(super) fn place_on_base(&self, frame: &str, stamp: Stamp) -> Result<Pose, Unknown> {
        let base = self.frames().1;
        match self.settings.camera_pose.base_from_camera() {
            Some(given) if frame != base => Ok(given),
            _ => self.lookup(base, frame, stamp),
        }
    }

    pub(super) fn reading(&self, at: Stamp) -> Result<Reading, Unknown> {
        let Some(odometry) = &self.odometry else {
            let odom_from_base = self.lookup(&self.settings.odom_frame, self.base_frame(), at)?;
            return Ok(Reading { odom_from_base, start_from_odom: Pose::identity() });
        };
        odometry.at(at).map_err(|outside| Unknown {
            early: outside == Outside::After,
            reason: "no_odometry",
            why: format!("the odometry does not cover the depth image at {at}"),
        })
    }

    /// The depth camera and `color_from_depth`, where the oldest depth image has to be registered: in another frame, or in colour's
    /// with another calibration, as drivers do that align depth to the full image and give a smaller one to detectors.
    fn registration(
        &self,
        color: &CameraMessage,
        stamp: Stamp,
    ) -> Result<Option<(CameraMessage, Pose)>, Unknown> {
        let Some(depth) = self.depth.front() else { return Ok(None) };
        let frame = if depth.frame_id.is_empty() { &color.frame_id } else { &depth.frame_id };
        if *frame != color.frame_id {
            let camera = self.depth_camera.clone().ok_or_else(|| {
                let why = format!(
                    "depth is in \"{frame}\", colour in \"{}\", and the depth camera's info did not come",
                    color.frame_id
                );
                Unknown::later("no_depth_camera_info", why)
            })?;
            return Ok(Some((camera, self.lookup(&color.frame_id, frame, stamp)?)));
        }
        let size = (depth.image.width(), depth.image.height());
        let is_of_this_image = |info: &&CameraMessage| {
            let camera = &info.camera;
            info.frame_id == *frame && (camera.width(), camera.height()) == size
        };
        let info = self.depth_camera.as_ref().filter(is_of_this_image);
        let differs = info.filter(|info| info.camera != color.camera);
        Ok(differs.map(|info| (info.clone(), Pose::identity())))
    }

    fn lookup(&self, to: &str, from: &str, at: Stamp) -> Result<Pose, Unknown> {
        if to == from {
            return Ok(Pose::identity());
        }
        self.transforms.lookup(to, from, at).map_err(|e| Unknown {
            early: !matches!(e, TransformError::TooLate { .. })
                || !self.transforms.connects(to, from),
            reason: "no_transform",
            why: e.to_string(),
        })
    }
}

fn one_frame_too_many(transform: &StampedTransform) -> Dropped {
    let frame = &transform.child_frame_id;
    Dropped {
        stamp: transform.stamp,
        reason: "too_many_frames",
        why: format!("there are {MAX_FRAMES} frames, and \"{frame}\" is one more than are kept"),
    }
}

fn without_depth(detections: &DetectionsMessage) -> Dropped {
    Dropped {
        stamp: detections.stamp,
        reason: "no_depth_for_boxes",
        why: format!("no depth image is near the boxes' stamp {}", detections.stamp),
    }
}

#[derive(Debug, PartialEq)]
enum Boxes {
    At(usize),
    None,
    Wait,
}

struct Poses {
    color: CameraMessage,
    registration: Option<(CameraMessage, Pose)>,
    odometry: Reading,
    velocity: Vector6<f64>,
    odometry_covariance: Option<Box<[f64; 36]>>,
    base_from_camera: Pose,
}

/// A pose that is not known, and whether it may come.
pub(super) struct Unknown {
    pub(super) early: bool,
    pub(super) reason: &'static str,
    pub(super) why: String,
}

impl Unknown {
    fn later(reason: &'static str, why: String) -> Self {
        Self { early: true, reason, why }
    }
}
