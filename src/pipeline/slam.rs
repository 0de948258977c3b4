//! The whole method on one page.

use super::{
    CameraMessage, DepthMessage, Dropped, Input, Settings,
    sync::{Moment, Sync},
};
use crate::{
    geometry::{Camera, Pose},
    mapping::{MapObject, ObjectId, ObjectMap, Observation},
    perception::{
        DepthImage, Detection, EllipsoidMeasurement, Frame, Rays, Refused, Stage, StageObserver,
        estimate_frame, register_depth,
    },
    time::Stamp,
};
use nalgebra::Vector3;

/// What came of one input.
#[derive(Clone, Debug, Default)]
pub struct Update {
    /// Pose of the base at each depth image that was settled, in the order of the images.
    pub poses: Vec<FramePose>,
    /// Images whose boxes were worked on.
    pub keyframes: Vec<Keyframe>,
    /// Messages that could not be used.
    pub dropped: Vec<Dropped>,
}

/// Where the base was when a depth image was taken.
#[derive(Clone, Copy, Debug)]
pub struct FramePose {
    /// Stamp of the depth image.
    pub stamp: Stamp,
    /// Pose of the base in the map.
    pub map_from_base: Pose,
    /// Pose of the base in the odometry's frame.
    pub odom_from_base: Pose,
}

/// What one image and its boxes gave.
#[derive(Clone, Debug)]
pub struct Keyframe {
    /// Stamp of the depth image.
    pub stamp: Stamp,
    /// Pose of the camera in the map.
    pub map_from_camera: Pose,
    /// For each box, in order, what came of it.
    pub boxes: Vec<BoxResult>,
    /// Heights of the support planes below the camera's position in the map (m).
    pub support_heights_m: Vec<f64>,
}

/// What came of one box.
#[derive(Clone, Debug)]
pub struct BoxResult {
    /// The detector's box.
    pub detection: Detection,
    /// The measurement in the camera frame, or why there is none.
    pub measurement: Result<EllipsoidMeasurement, Refused>,
    /// The object the measurement was joined to.
    pub object: Option<ObjectId>,
}

/// Object-level SLAM: inputs in, updates out. Reads no clock, does no input or output.
#[derive(Debug)]
pub struct ObjectSlam {
    settings: Settings,
    sync: Sync,
    map: ObjectMap,
    color_rays: Option<Rays>,
    depth_rays: Option<Rays>,
}

impl ObjectSlam {
    /// An empty map.
    pub fn new(settings: Settings) -> Self {
        let sync = Sync::new(settings.sync.clone());
        Self { settings, sync, map: ObjectMap::default(), color_rays: None, depth_rays: None }
    }

    /// Takes one message and does what it makes possible.
    pub fn handle(&mut self, input: Input, observer: &mut dyn StageObserver) -> Update {
        let mut update = Update::default();
        self.sync.push(input, &mut update.dropped);
        self.work(false, &mut update, observer);
        self.sync.drop_stale_boxes(&mut update.dropped);
        update
    }

    /// Works off what is still waiting: nothing more will come.
    pub fn finish(&mut self, observer: &mut dyn StageObserver) -> Update {
        let mut update = Update::default();
        self.work(true, &mut update, observer);
        update.dropped.extend(self.sync.leftovers());
        update
    }

    /// Objects seen often enough, in the order in which they were first seen.
    pub fn objects(&self) -> impl Iterator<Item = &MapObject> {
        self.map.confirmed(&self.settings.mapping)
    }

    /// The odometry's fixed frame and the base frame.
    pub fn frames(&self) -> (&str, &str) {
        self.sync.frames()
    }

    fn work(&mut self, last: bool, update: &mut Update, observer: &mut dyn StageObserver) {
        while let Some(mut moment) = self.sync.next(last, &mut update.dropped) {
            // Poses come from odometry: the map frame is the odometry's.
            let map_from_base = moment.odom_from_base;
            update.poses.push(FramePose {
                stamp: moment.depth.stamp,
                map_from_base,
                odom_from_base: moment.odom_from_base,
            });
            if let Some(detections) = moment.detections.take() {
                let keyframe = self.keyframe(moment, detections, observer);
                observer.enter(None);
                match keyframe {
                    Ok(keyframe) => update.keyframes.push(keyframe),
                    Err(dropped) => update.dropped.push(dropped),
                }
            }
        }
    }

    /// Liao et al. 2020, figure 2: depth and boxes become ellipsoids (section IV), which join the map (section V).
    fn keyframe(
        &mut self,
        moment: Moment,
        detections: Vec<Detection>,
        observer: &mut dyn StageObserver,
    ) -> Result<Keyframe, Dropped> {
        let stamp = moment.depth.stamp;
        let map_from_camera = moment.odom_from_base * moment.base_from_camera;
        let up_in_camera = map_from_camera.rotation.inverse() * Vector3::z_axis();

        observer.enter(Some(Stage::Registration));
        let depth = self.depth_in_color(moment.depth, &moment.color, moment.registration)?;
        let rays = rays_of(&mut self.color_rays, &moment.color.camera);
        let frame = Frame::new(&depth, rays, &up_in_camera, self.settings.depth_noise);
        let estimate = estimate_frame(&frame, &detections, &self.settings.perception, observer);

        observer.enter(Some(Stage::Mapping));
        let observations: Vec<Observation> = detections
            .iter()
            .zip(&estimate.objects)
            .filter_map(|(d, found)| Some(in_map(d, found.as_ref().ok()?, &map_from_camera)))
            .collect();
        let mut ids = self.map.observe(stamp, &observations, &self.settings.mapping).into_iter();
        let boxes = detections
            .into_iter()
            .zip(estimate.objects)
            .map(|(detection, measurement)| {
                let object = measurement.as_ref().ok().and_then(|_| ids.next().flatten());
                BoxResult { detection, measurement, object }
            })
            .collect();
        let camera_height_m = map_from_camera.translation.z;
        let support_heights_m = estimate
            .planes
            .iter()
            .map(|p| camera_height_m - p.plane.offset / p.plane.normal.z)
            .collect();
        Ok(Keyframe { stamp, map_from_camera, boxes, support_heights_m })
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
        Ok(register_depth(&depth.image, rays, &color.camera, &color_from_depth))
    }
}

/// The rays of a camera, computed anew only when the calibration changes.
fn rays_of<'a>(cache: &'a mut Option<Rays>, camera: &Camera) -> &'a Rays {
    if cache.as_ref().is_some_and(|rays| rays.camera() != camera) {
        *cache = None;
    }
    cache.get_or_insert_with(|| Rays::new(camera.clone()))
}

/// A measurement as the map wants it. Liao et al. 2020, eq. (12).
fn in_map(
    detection: &Detection,
    measurement: &EllipsoidMeasurement,
    map_from_camera: &Pose,
) -> Observation {
    let ellipsoid = measurement.ellipsoid.transformed(map_from_camera);
    let support_height_m = measurement.support.map(|plane| {
        let plane = plane.transformed(map_from_camera);
        let center = ellipsoid.center();
        center.z - plane.signed_distance(&center) / plane.normal.z
    });
    Observation {
        labels: detection.hypotheses().to_vec(),
        track: detection.track,
        ellipsoid,
        covariance: measurement.covariance,
        outline: measurement.outline,
        probability: measurement.probability.combined(),
        support_height_m,
    }
}
