//! What is published of an update, on which topic and how: the same for the live node and for result bags.
//!
//! The map's topics are complete messages: who comes late gets the last one and has everything. So that they do not
//! cost more the larger the map grows, a large map is published less often (`OBJECTS_PER_SECOND`), and nothing is
//! published as long as nothing changes.

mod annotations;
mod approach;
mod costmap;
mod drawing;
mod object_frames;
mod outgoing;
mod query;
mod room;
mod way;

pub use annotations::image_annotations;
pub use approach::{Whereabouts, approach_object};
pub use drawing::{draw_debug_image, draw_saved_objects, outline_in_image};
pub use outgoing::{Outgoing, OutputTopic};
pub use query::{View, query_objects};
pub use room::Room;

use crate::{
    config::{GroundSettings, NodeSettings, PublishSettings},
    geometry::Pose,
    mapping::{MapObject, ObjectId},
    msg::{
        convert::{
            ObjectShapes, deletion_markers, detections_3d, header, landmark_detections,
            measurement_array, measurement_markers, object_array, object_markers, odometry_message,
            path, pose_covariance, tf_message,
        },
        visualization_msgs::MarkerArray,
    },
    pipeline::{
        CameraMessage, CameraRole, FramePose, Input, Keyframe, ObjectSlam, OdometryMessage,
        StampedTransform, Update,
    },
    time::Stamp,
};
use costmap::Costmap;
use object_frames::object_frames;
use std::collections::{BTreeMap, BTreeSet};
use way::Way;

/// Objects that are published a second, at most: maps of up to 200 objects follow a detector of 10 Hz.
const OBJECTS_PER_SECOND: f64 = 2000.0;
/// How long markers of objects that are gone are deleted again, in case a message was lost (s).
const DELETED_AGAIN_S: f64 = 10.0;

/// Decides what follows from updates.
#[derive(Debug)]
pub struct Publication {
    settings: PublishSettings,
    ground: GroundSettings,
    map_frame: String,
    camera: Option<CameraMessage>,
    way: Way,
    /// Objects that have markers.
    shown: BTreeSet<ObjectId>,
    /// Objects that had markers, and when these were first deleted.
    gone: BTreeMap<ObjectId, Stamp>,
    /// When the map was published, and with how many objects.
    published: Option<(Stamp, usize)>,
    /// Whether the map has changed since.
    changed: bool,
    view: Option<View>,
    costmap: Costmap,
}

impl Publication {
    /// Nothing has been published yet.
    pub fn new(settings: &NodeSettings) -> Self {
        Self {
            settings: settings.publish,
            ground: settings.ground,
            map_frame: settings.map_frame.clone(),
            camera: None,
            way: Way::default(),
            shown: BTreeSet::new(),
            gone: BTreeMap::new(),
            published: None,
            changed: false,
            view: None,
            costmap: Costmap::default(),
        }
    }

    /// Takes note of what later messages need from the input.
    pub fn hear(&mut self, input: &Input) {
        if let Input::Camera(camera) = input
            && camera.role == CameraRole::Color
        {
            self.camera = Some(camera.clone());
        }
    }

    /// From now on.
    pub fn change_settings(&mut self, settings: &NodeSettings) {
        (self.settings, self.ground) = (settings.publish, settings.ground);
        self.changed = true;
    }

    /// Another map takes the place of the one before: its way is forgotten, and markers of objects that are not there
    /// any more are deleted.
    pub fn reset(&mut self, stamp: Stamp, slam: &ObjectSlam) -> Vec<(Stamp, Outgoing)> {
        self.way = Way::default();
        self.view = None;
        let mut out = vec![(stamp, Outgoing::Path(path(&[], stamp, &self.map_frame)))];
        self.map(stamp, slam, &mut out);
        self.costmap(stamp, slam, &mut out);
        out
    }

    /// Somebody has edited the map.
    pub fn edited(&mut self, stamp: Stamp, slam: &ObjectSlam) -> Vec<(Stamp, Outgoing)> {
        let mut out = Vec::new();
        self.map(stamp, slam, &mut out);
        self.costmap(stamp, slam, &mut out);
        out
    }

    /// Where the base is in the map, after all that is known now.
    pub fn base(&self, slam: &ObjectSlam) -> Option<Pose> {
        self.way.latest().map(|pose| slam.map_from_base(pose))
    }

    /// What the camera saw last, for [`query_objects`].
    pub fn view(&self) -> Option<&View> {
        self.view.as_ref()
    }

    /// The messages that follow from an update, each with the stamp of what it follows from.
    pub fn update(&mut self, update: &Update, slam: &ObjectSlam) -> Vec<(Stamp, Outgoing)> {
        let mut out = Vec::new();
        for pose in &update.poses {
            self.pose(pose, slam, &mut out);
        }
        for keyframe in &update.keyframes {
            self.keyframe(keyframe, &mut out);
        }
        let found = update.keyframes_3d.iter().flat_map(|keyframe| &keyframe.found);
        self.changed |= found.into_iter().any(|(_, object)| object.is_some());
        self.changed |= !update.changes.is_empty() || update.relocalised.is_some();
        let newest = update.poses.iter().map(|pose| pose.stamp).max();
        if let Some(stamp) = newest.filter(|stamp| self.changed && self.is_due(*stamp)) {
            self.map(stamp, slam, &mut out);
        }
        if let Some(stamp) = newest.filter(|stamp| self.costmap.is_due(*stamp)) {
            self.costmap(stamp, slam, &mut out);
        }
        out
    }

    /// The complete map and way, whatever was published before.
    pub fn finish(&mut self, slam: &ObjectSlam) -> Vec<(Stamp, Outgoing)> {
        let mut out = Vec::new();
        if let Some(stamp) = self.way.latest().map(|pose| pose.stamp) {
            let poses = self.way.poses(slam);
            out.push((stamp, Outgoing::Path(path(&poses, stamp, &self.map_frame))));
            self.map(stamp, slam, &mut out);
            self.costmap(stamp, slam, &mut out);
        }
        out
    }

    fn pose(&mut self, pose: &FramePose, slam: &ObjectSlam, out: &mut Vec<(Stamp, Outgoing)>) {
        let (odom_frame, base_frame) = slam.frames();
        let correction = StampedTransform {
            stamp: pose.stamp,
            frame_id: self.map_frame.clone(),
            child_frame_id: odom_frame.to_owned(),
            parent_from_child: pose.map_from_base * pose.odom_from_base.inverse(),
        };
        out.push((pose.stamp, Outgoing::Transforms(tf_message(&[correction]))));
        let covariance = slam.covariance(pose).map(|own| {
            let mut flat = [0.0; 36];
            let fixed = pose_covariance(&pose.map_from_base, &own);
            flat.copy_from_slice(fixed.as_flattened());
            Box::new(flat)
        });
        let reading = OdometryMessage {
            stamp: pose.stamp,
            frame_id: self.map_frame.clone(),
            child_frame_id: base_frame.to_owned(),
            odom_from_base: pose.map_from_base,
            covariance,
        };
        out.push((pose.stamp, Outgoing::Odometry(Box::new(odometry_message(&reading)))));
        if self.way.add(pose, self.settings.path_step_m) {
            let poses = self.way.poses(slam);
            out.push((pose.stamp, Outgoing::Path(path(&poses, pose.stamp, &self.map_frame))));
        }
    }

    fn keyframe(&mut self, keyframe: &Keyframe, out: &mut Vec<(Stamp, Outgoing)>) {
        self.changed |= keyframe.boxes.iter().any(|found| found.object.is_some());
        let Some(camera) = &self.camera else { return };
        self.view =
            Some(View { camera: camera.camera.clone(), map_from_camera: keyframe.map_from_camera });
        let in_camera = header(keyframe.stamp, &camera.frame_id);
        if self.settings.measurements {
            let markers = measurement_markers(keyframe, &self.map_frame);
            out.push((
                keyframe.stamp,
                Outgoing::Measurements(measurement_array(keyframe, in_camera.clone())),
            ));
            out.push((keyframe.stamp, Outgoing::MeasurementMarkers(markers)));
        }
        if self.settings.landmarks {
            out.push((
                keyframe.stamp,
                Outgoing::Landmarks(landmark_detections(keyframe, in_camera)),
            ));
        }
    }

    /// Whether as much time has passed as publishing a map of this size may take.
    fn is_due(&self, now: Stamp) -> bool {
        let Some((at, objects)) = self.published else { return true };
        let passed = now.seconds_since(at);
        // A clock that was set back must not keep the map from being published.
        passed < 0.0 || passed >= objects as f64 / OBJECTS_PER_SECOND
    }

    fn map(&mut self, stamp: Stamp, slam: &ObjectSlam, out: &mut Vec<(Stamp, Outgoing)>) {
        let objects: Vec<&MapObject> = slam.objects().collect();
        let now: BTreeSet<ObjectId> = objects.iter().map(|object| object.id).collect();
        self.gone.extend(self.shown.difference(&now).map(|id| (*id, stamp)));
        self.gone.retain(|id, since| {
            !now.contains(id) && stamp.seconds_since(*since).abs() < DELETED_AGAIN_S
        });
        let (settings, frame) = (&self.settings, self.map_frame.as_str());
        let mut markers = deletion_markers(self.gone.keys().copied(), stamp, frame).markers;
        let shapes = ObjectShapes { ellipsoids: settings.ellipsoids, cuboids: settings.cuboids };
        let shown = object_markers(objects.iter().copied(), shapes, stamp, frame);
        markers.extend(shown.markers);
        out.push((stamp, Outgoing::Markers(MarkerArray { markers })));
        out.push((stamp, Outgoing::Boxes(detections_3d(objects.iter().copied(), stamp, frame))));
        out.push((stamp, Outgoing::Objects(object_array(objects.iter().copied(), stamp, frame))));
        if settings.object_frames {
            let frames = object_frames(objects.iter().copied(), stamp, frame);
            out.push((stamp, Outgoing::ObjectFrames(tf_message(&frames))));
        }
        self.costmap.note_change();
        self.published = Some((stamp, objects.len()));
        (self.shown, self.changed) = (now, false);
    }

    /// The ground that objects cover, if it has changed.
    fn costmap(&mut self, stamp: Stamp, slam: &ObjectSlam, out: &mut Vec<(Stamp, Outgoing)>) {
        if !self.settings.costmap {
            return;
        }
        let floor_m = self.base(slam).map_or(0.0, |base| base.translation.z);
        let at = (stamp, self.map_frame.as_str());
        let costmap = self.costmap.next(slam.objects(), floor_m, &self.ground, at);
        out.extend(costmap.map(|costmap| (stamp, Outgoing::Costmap(costmap))));
    }
}

/// A pose of the base where nobody else says it: `odom -> base`, for whoever looks at a result without its bag.
pub fn base_transform(pose: &FramePose, slam: &ObjectSlam) -> StampedTransform {
    let (odom_frame, base_frame) = slam.frames();
    StampedTransform {
        stamp: pose.stamp,
        frame_id: odom_frame.to_owned(),
        child_frame_id: base_frame.to_owned(),
        parent_from_child: pose.odom_from_base,
    }
}
