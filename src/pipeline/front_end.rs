//! What needs no map: pairing of messages, and what single images show.

use super::{
    Calibration, CameraMessage, DepthMessage, Dropped, Input, Settings,
    mount::{Mount, Tilt},
    odometry::Reading,
    placement::Placement,
    stamp_offset::StampOffset,
    sync::{Moment, Sync},
};
use crate::{
    geometry::{Camera, Pose},
    perception::{
        DepthImage, Detection, Detection3d, Frame, FrameEstimate, PerceptionSettings, Rays, Stage,
        StageObserver, estimate_frame, find_floor, register_depth,
    },
    time::Stamp,
};
use nalgebra::{Point3, Unit, Vector3};
use std::collections::BTreeSet;

/// The first half of the method. It learns nothing from the map, so it can run ahead of [`ObjectSlam::join`] on a
/// thread of its own: what comes out is the same.
///
/// [`ObjectSlam::join`]: super::ObjectSlam::join
#[derive(Debug)]
pub struct FrontEnd {
    settings: Settings,
    sync: Sync,
    color_rays: Option<Rays>,
    depth_rays: Option<Rays>,
    mount: Option<Mount>,
    stamp_offset: StampOffset,
}

/// What a message made possible; often nothing.
#[derive(Clone, Debug, Default)]
pub struct Perceived {
    pub(super) frames: Vec<PerceivedFrame>,
    pub(super) dropped: Vec<Dropped>,
}

/// One depth image, settled, or objects that were measured in space at one time.
#[derive(Clone, Debug)]
pub(super) struct PerceivedFrame {
    pub(super) stamp: Stamp,
    pub(super) odom_frame: String,
    pub(super) base_frame: String,
    pub(super) odometry: Reading,
    pub(super) odometry_covariance: Option<Box<[f64; 36]>>,
    /// Nothing if the detector did not look at the image, or it cannot be used, or there is none.
    pub(super) look: Option<Look>,
    /// What a detector that measures in space found, with the pose of its frame on the base.
    pub(super) in_space: Option<Vec<(Detection3d, Pose)>>,
}

/// What an image shows.
#[derive(Clone, Debug)]
pub(super) struct Look {
    /// As TF has it, turned by the tilt that the floor tells.
    pub(super) base_from_camera: Pose,
    pub(super) placement: Placement,
    pub(super) calibration: Calibration,
    /// Of boxes and depth.
    pub(super) camera: Camera,
    pub(super) depth: DepthImage,
    pub(super) detections: Vec<Detection>,
    pub(super) estimate: FrameEstimate,
}

impl Perceived {
    /// Whether there is nothing to join.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty() && self.dropped.is_empty()
    }
}

impl FrontEnd {
    /// Nothing has come yet.
    pub fn new(settings: Settings) -> Self {
        let sync = Sync::new(settings.sync.clone());
        let stamp_offset = StampOffset::new(settings.sync.stamp_sigma_s);
        Self { settings, sync, color_rays: None, depth_rays: None, mount: None, stamp_offset }
    }

    /// From now on these settings count.
    pub fn change_settings(&mut self, settings: Settings) {
        self.sync.change_settings(settings.sync.clone());
        self.settings = settings;
    }

    /// Takes one message and perceives what it settles.
    pub fn take(&mut self, input: Input, observer: &mut dyn StageObserver) -> Perceived {
        let mut perceived = Perceived::default();
        self.sync.push(input, &mut perceived.dropped);
        self.work(false, &mut perceived, observer);
        self.sync.drop_stale_boxes(&mut perceived.dropped);
        perceived
    }

    /// Works off what is still waiting: nothing more will come.
    pub fn finish(&mut self, observer: &mut dyn StageObserver) -> Perceived {
        let mut perceived = Perceived::default();
        self.work(true, &mut perceived, observer);
        perceived.dropped.extend(self.sync.leftovers());
        perceived
    }

    fn work(&mut self, last: bool, perceived: &mut Perceived, observer: &mut dyn StageObserver) {
        while let Some(mut moment) = self.sync.next(last, &mut perceived.dropped) {
            let (odom_frame, base_frame) = self.sync.frames();
            let mut frame = PerceivedFrame {
                stamp: moment.depth.stamp,
                odom_frame: odom_frame.to_owned(),
                base_frame: base_frame.to_owned(),
                odometry: moment.odometry,
                odometry_covariance: moment.odometry_covariance.take(),
                look: None,
                in_space: None,
            };
            if let Some(mut detections) = moment.detections.take() {
                let limited = self.limit(frame.stamp, &mut detections);
                perceived.dropped.extend(limited);
                match self.look(moment, detections, observer) {
                    Ok(look) => frame.look = Some(look),
                    Err(dropped) => perceived.dropped.push(dropped),
                }
                observer.enter(None);
            }
            perceived.frames.push(frame);
        }
        while let Some(moment) = self.sync.next_3d(last, &mut perceived.dropped) {
            let (odom_frame, base_frame) = self.sync.frames();
            perceived.frames.push(PerceivedFrame {
                stamp: moment.stamp,
                odom_frame: odom_frame.to_owned(),
                base_frame: base_frame.to_owned(),
                odometry: moment.odometry,
                odometry_covariance: moment.odometry_covariance,
                look: None,
                in_space: Some(self.most_probable(moment.detections)),
            });
        }
    }

    /// As many detections in space as boxes of an image are looked at, with the score that these need.
    fn most_probable(&self, mut found: Vec<(Detection3d, Pose)>) -> Vec<(Detection3d, Pose)> {
        let PerceptionSettings { min_score, max_boxes, .. } = self.settings.perception;
        found.retain(|(detection, _)| detection.probability() >= min_score);
        found.sort_by(|(a, _), (b, _)| b.probability().total_cmp(&a.probability()));
        found.truncate(max_boxes);
        found
    }

    /// Keeps the most probable boxes and names, in the order in which they came: what an image costs is bounded.
    fn limit(&self, stamp: Stamp, detections: &mut Vec<Detection>) -> Vec<Dropped> {
        let (most, most_names) =
            (self.settings.perception.max_boxes, self.settings.perception.max_names);
        let boxes = detections.len();
        if boxes > most {
            let mut ranked: Vec<usize> = (0..boxes).collect();
            let probability = |at: &usize| detections[*at].probability();
            ranked.sort_by(|a, b| probability(b).total_cmp(&probability(a)).then(a.cmp(b)));
            let kept: BTreeSet<usize> = ranked.into_iter().take(most).collect();
            let mut at = 0..;
            detections.retain(|_| at.next().is_some_and(|at| kept.contains(&at)));
        }
        let names: usize = detections.iter_mut().map(|d| d.keep_names(most_names)).sum();
        let dropped = |reason, why| Dropped { stamp, reason, why };
        let of_boxes = (boxes > most).then(|| {
            let why = format!(
                "the image has {boxes} boxes: the {most} most probable ones were looked at"
            );
            dropped("too_many_boxes", why)
        });
        let of_names = (names > 0).then(|| {
            let why = format!("{names} names of boxes were left out: each box keeps the {most_names} most probable");
            dropped("too_many_names", why)
        });
        of_boxes.into_iter().chain(of_names).collect()
    }

    /// Depth and boxes become ellipsoids. Liao et al. 2020, section IV.
    fn look(
        &mut self,
        moment: Moment,
        mut detections: Vec<Detection>,
        observer: &mut dyn StageObserver,
    ) -> Result<Look, Dropped> {
        detections
            .retain(|detection| detection.probability() >= self.settings.perception.min_score);
        let stamp = moment.depth.stamp;
        observer.enter(Some(Stage::Registration));
        let depth = self.depth_in_color(moment.depth, &moment.color, moment.registration)?;
        let Moment { color, odometry, velocity, .. } = moment;
        let odom_from_base = odometry.odom_from_base;
        observer.enter(Some(Stage::SupportPlanes));
        let place = (&color, &odom_from_base, &moment.base_from_camera);
        let (tilt, floor_below_m) = self.level(stamp, &depth, place);
        let base_from_camera = tilt.turned(&moment.base_from_camera);
        let rays = rays_of(&mut self.color_rays, &color.camera);
        let up = up_in_camera(&odom_from_base, &base_from_camera);
        let frame = Frame::new(&depth, rays, &up, self.settings.depth_noise);
        let frame = frame.above_floor(floor_below_m);
        let estimate = estimate_frame(&frame, &detections, &self.settings.perception, observer);
        let used_s = self.stamp_offset.correction_s();
        self.stamp_offset.see(
            &estimate.walls,
            (&odometry.start_from_base(), &base_from_camera),
            (used_s, velocity[2]),
        );
        self.sync.shift_odometry(self.stamp_offset.correction_s());
        let offset = self.stamp_offset.known();
        let calibration = Calibration::new(self.mount.as_ref().map(Mount::slow), offset);
        let camera_at = base_from_camera.translation.vector.into();
        let placement = Placement { camera_at, tilt, jitter: velocity * offset.sigma_s };
        let camera = color.camera;
        Ok(Look { base_from_camera, placement, calibration, camera, depth, detections, estimate })
    }

    /// How the camera is tilted in an image against TF, by the floor where it shows, and how far the floor is below it (m).
    fn level(
        &mut self,
        stamp: Stamp,
        depth: &DepthImage,
        (color, odom_from_base, base_from_camera): (&CameraMessage, &Pose, &Pose),
    ) -> (Tilt, Option<f64>) {
        if self.sync.frames().1 == color.frame_id {
            return (Tilt::none(), None);
        }
        if self.mount.as_ref().is_some_and(|mount| !mount.is_of(&color.frame_id)) {
            self.mount = None;
        }
        let mount = self.mount.get_or_insert_with(|| Mount::new(&color.frame_id));
        let expected = mount.expected();
        let base_from_camera = expected.turned(base_from_camera);
        let up = up_in_camera(odom_from_base, &base_from_camera);
        let rays = rays_of(&mut self.color_rays, &color.camera);
        let frame = Frame::new(depth, rays, &up, self.settings.depth_noise);
        let level_from_base = frame.level_from_camera() * base_from_camera.inverse();
        let wheels = level_from_base * Point3::origin();
        let PerceptionSettings { support, segmentation, .. } = &self.settings.perception;
        let tilt = match find_floor(&frame, &wheels, segmentation.max_range_m, support) {
            Some(floor) => {
                let base_from_level = level_from_base.rotation.inverse();
                mount.correct(stamp, (&floor, &wheels), &base_from_level)
            }
            None => expected,
        };
        (tilt, mount.floor_under_wheels_m().map(|under_m| under_m - wheels.z))
    }

    /// Depth as the colour camera sees it, whose image the boxes live in.
    fn depth_in_color(
        &mut self,
        depth: DepthMessage,
        color: &CameraMessage,
        registration: Option<(CameraMessage, Pose)>,
    ) -> Result<DepthImage, Dropped> {
        let (size, owner) = match &registration {
            Some((camera, _)) => (&camera.camera, &camera.frame_id),
            None => (&color.camera, &color.frame_id),
        };
        if (depth.image.width(), depth.image.height()) != (size.width(), size.height()) {
            return Err(Dropped {
                stamp: depth.stamp,
                reason: "size_mismatch",
                why: format!(
                    "the depth image is {}x{}, the camera info of \"{owner}\" says {}x{}",
                    depth.image.width(),
                    depth.image.height(),
                    size.width(),
                    size.height()
                ),
            });
        }
        let Some((camera, color_from_depth)) = registration else { return Ok(depth.image) };
        let rays = rays_of(&mut self.depth_rays, &camera.camera);
        let noise = &self.settings.depth_noise;
        Ok(register_depth(&depth.image, rays, &color.camera, &color_from_depth, noise))
    }
}

/// Against gravity, in the camera's frame.
fn up_in_camera(odom_from_base: &Pose, base_from_camera: &Pose) -> Unit<Vector3<f64>> {
    (odom_from_base * base_from_camera).rotation.inverse() * Vector3::z_axis()
}

/// The rays of a camera, computed anew only when the calibration changes.
fn rays_of<'a>(cache: &'a mut Option<Rays>, camera: &Camera) -> &'a Rays {
    if cache.as_ref().is_some_and(|rays| rays.camera() != camera) {
        *cache = None;
    }
    cache.get_or_insert_with(|| Rays::new(camera.clone()))
}
