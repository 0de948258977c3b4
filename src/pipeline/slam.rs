//! The whole method on one page.

use super::{
    Calibration, Dropped, FrontEnd, Input, Perceived, Settings,
    front_end::{Look, PerceivedFrame},
    in_space::observation_in_space,
    maps::{LOCAL_FRAME, LOCAL_MAP, MapsToSave, SET_ASIDE_MAP, set_aside},
    observations::{observation, wall_in_base},
    odometry::Reading,
};
use crate::{
    geometry::{Camera, Pose},
    mapping::{
        Continuation, Edit, EditError, MapObject, ObjectChange, ObjectId, ObjectMap, Relocalised,
        SavedMap, Sighted, Sighting, View,
    },
    perception::{
        DepthImage, Detection, Detection3d, EllipsoidMeasurement, Refused, Stage, StageObserver,
        WallSegment,
    },
    time::Stamp,
};
use nalgebra::{Matrix6, Vector3};

/// What came of one input.
#[derive(Clone, Debug, Default)]
pub struct Update {
    /// Pose of the base at each depth image that was settled, in the order of the images.
    pub poses: Vec<FramePose>,
    /// Images whose boxes were worked on.
    pub keyframes: Vec<Keyframe>,
    /// What came of detections in space.
    pub keyframes_3d: Vec<Keyframe3d>,
    /// What happened to objects of the map, in order.
    pub changes: Vec<ObjectChange>,
    /// Messages that could not be used.
    pub dropped: Vec<Dropped>,
    /// The place in the saved map was recognised: from now on poses and objects are in its frame.
    pub relocalised: Option<Relocalised>,
}

impl Update {
    /// What came of a later input, too.
    pub(super) fn append(&mut self, later: Self) {
        self.poses.extend(later.poses);
        self.keyframes.extend(later.keyframes);
        self.keyframes_3d.extend(later.keyframes_3d);
        self.changes.extend(later.changes);
        self.dropped.extend(later.dropped);
        self.relocalised = later.relocalised.or(self.relocalised.take());
    }
}

/// Where the base was when a depth image was taken.
#[derive(Clone, Copy, Debug)]
pub struct FramePose {
    /// Stamp of the depth image.
    pub stamp: Stamp,
    /// Pose of the base in the map, as it is known at this time.
    pub map_from_base: Pose,
    /// Pose of the base in the odometry's frame.
    pub odom_from_base: Pose,
    /// Where the odometry's frame is in the one that it had at first: it jumps where a base driver begins anew.
    pub start_from_odom: Pose,
    /// How many keyframes the map had at this time.
    pub keyframes: usize,
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
    /// Walls in sight, in the camera frame.
    pub walls: Vec<WallSegment>,
    /// The camera that boxes and depth are of.
    pub camera: Camera,
    /// Pose of the camera on the base.
    pub base_from_camera: Pose,
    /// Depth as that camera sees it.
    pub depth: DepthImage,
    /// What is known by now of the camera's mount and of the clocks.
    pub calibration: Calibration,
}

/// What a detector measured in space at one time.
#[derive(Clone, Debug)]
pub struct Keyframe3d {
    /// When.
    pub stamp: Stamp,
    /// Each detection with the object that it was joined to.
    pub found: Vec<(Detection3d, Option<ObjectId>)>,
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

/// Object-level SLAM: inputs in, updates out. Reads no clock, does no input or output. Liao et al. 2020, figure 2.
///
/// Its two halves are a [`FrontEnd`], which needs no map, and [`ObjectSlam::join`]. A shell that must not keep images
/// waiting while the graph works has a front end of its own on another thread and hands over what that perceives.
#[derive(Debug)]
pub struct ObjectSlam {
    settings: Settings,
    front_end: FrontEnd,
    map: ObjectMap,
    /// The saved map, as long as the place in it is not known.
    waiting: Option<Continuation>,
    /// A saved map of few objects that was given up, since the place in it was not recognised.
    set_aside: Option<SavedMap>,
    odom_frame: String,
    base_frame: String,
}

impl ObjectSlam {
    /// An empty map.
    pub fn new(settings: Settings) -> Self {
        Self {
            front_end: FrontEnd::new(settings.clone()),
            map: ObjectMap::new(settings.mapping.clone(), settings.slam),
            waiting: None,
            set_aside: None,
            odom_frame: settings.sync.odom_frame.clone(),
            base_frame: settings.sync.base_frame.clone(),
            settings,
        }
    }

    /// Continues a saved map. `start` is `map_from_base` at the first frame, if it is known about.
    ///
    /// Until the place in the saved map is recognised, the map is odometry's frame at the first frame and has only what
    /// was seen since. An empty map is none. One of fewer than five objects, in which no place can be recognised, is
    /// entered at `start`; without that it is set aside as soon as five objects, or at the end more than it has, are known.
    pub fn continuing(settings: Settings, saved: SavedMap, start: Option<Pose>) -> Self {
        let mut new = Self::new(settings);
        if saved.objects.is_empty() {
            return new;
        }
        new.map = new.map.continuing(&saved);
        new.waiting = Some(Continuation::new(saved, start, new.settings.relocalisation));
        new
    }

    /// The saved map that the place was not recognised in yet, and why not.
    pub fn waiting(&self) -> Option<&Continuation> {
        self.waiting.as_ref()
    }

    /// What a run leaves to the next one. `map_frame` is the name of the map's frame.
    pub fn maps(&self, map_frame: &str) -> MapsToSave {
        let frame = if self.waiting.is_some() { LOCAL_FRAME } else { map_frame };
        let seen = SavedMap::of(self.map.lasting(), frame);
        match (&self.waiting, &self.set_aside) {
            // The two maps are in frames of their own: neither may be lost for the other.
            (Some(waiting), _) => MapsToSave {
                map: waiting.saved().clone(),
                beside: Some((LOCAL_MAP, seen)),
                why: Some(waiting.why().to_string()),
            },
            (None, Some(saved)) => {
                MapsToSave { map: seen, beside: Some((SET_ASIDE_MAP, saved.clone())), why: None }
            }
            (None, None) => MapsToSave { map: seen, beside: None, why: None },
        }
    }

    /// Changes an object as somebody asks for, at a time of the data; which one it was.
    ///
    /// # Errors
    /// When there is no such object, or what is said of it cannot be; nothing has changed then.
    pub fn edit(&mut self, edit: &Edit, now: Stamp) -> Result<ObjectId, EditError> {
        self.map.edit(edit, now)
    }

    /// Somebody says where the base is in the saved map (`map_from_base`), and where it is in what was seen so far, if anything was.
    /// False where no saved map waits for that: then nothing happens.
    pub fn place(&mut self, map_from_base: &Pose, seen_from_base: Option<Pose>) -> bool {
        let Some(waiting) = &mut self.waiting else { return false };
        waiting.place(&mut self.map, map_from_base, seen_from_base);
        true
    }

    /// From now on these settings count; what is in the map stays.
    pub fn change_settings(&mut self, settings: Settings) {
        self.front_end.change_settings(settings.clone());
        self.map.change_settings(settings.mapping.clone(), settings.slam);
        self.settings = settings;
    }

    /// Takes one message and does what it makes possible.
    pub fn handle(&mut self, input: Input, observer: &mut dyn StageObserver) -> Update {
        let perceived = self.front_end.take(input, observer);
        self.join(perceived, observer)
    }

    /// Works off what is still waiting: nothing more will come.
    pub fn finish(&mut self, observer: &mut dyn StageObserver) -> Update {
        let perceived = self.front_end.finish(observer);
        let mut update = self.join(perceived, observer);
        self.map.finish();
        self.relocalise(true, &mut update);
        update
    }

    /// Objects seen often enough, in the order in which they were first seen.
    pub fn objects(&self) -> impl Iterator<Item = &MapObject> {
        self.map.confirmed()
    }

    /// The map, for what else can be asked of it.
    pub fn map(&self) -> &ObjectMap {
        &self.map
    }

    /// Where the base was at a pose of an earlier [`Update`], after all that is known now.
    pub fn map_from_base(&self, pose: &FramePose) -> Pose {
        self.map.map_from_odom_at(pose.stamp, pose.keyframes)
            * (pose.start_from_odom * pose.odom_from_base)
    }

    /// Covariance of the latest pose of the base in the map, of `[rotation, translation]`, a right perturbation; nothing
    /// before the first keyframe.
    pub fn covariance(&self, latest: &FramePose) -> Option<Matrix6<f64>> {
        self.map.base_covariance(&(latest.start_from_odom * latest.odom_from_base))
    }

    /// The odometry's fixed frame and the base frame.
    pub fn frames(&self) -> (&str, &str) {
        (&self.odom_frame, &self.base_frame)
    }

    /// Joins what a front end perceived, in the order in which it was perceived.
    pub fn join(&mut self, perceived: Perceived, observer: &mut dyn StageObserver) -> Update {
        let mut update = Update { dropped: perceived.dropped, ..Update::default() };
        for frame in perceived.frames {
            let PerceivedFrame { stamp, odometry, .. } = frame;
            let Reading { odom_from_base, start_from_odom } = odometry;
            let start_from_base = start_from_odom * odom_from_base;
            (self.odom_frame, self.base_frame) = (frame.odom_frame, frame.base_frame);
            if let Some(look) = frame.look {
                observer.enter(Some(Stage::Mapping));
                let place = (stamp, &start_from_base, frame.odometry_covariance.clone());
                let keyframe = self.keyframe(place, look, &mut update);
                update.keyframes.push(keyframe);
                self.relocalise(false, &mut update);
                observer.enter(None);
            }
            if let Some(found) = frame.in_space {
                observer.enter(Some(Stage::Mapping));
                let place = (stamp, &start_from_base, frame.odometry_covariance);
                let keyframe = self.keyframe_3d(place, found, &mut update);
                update.keyframes_3d.push(keyframe);
                self.relocalise(false, &mut update);
                observer.enter(None);
            }
            update.poses.push(FramePose {
                stamp,
                map_from_base: self.map.map_from_odom() * start_from_base,
                odom_from_base,
                start_from_odom,
                keyframes: self.map.keyframes(),
            });
        }
        update
    }

    /// Looks whether the saved map can be entered, or a loop closed, by now.
    fn relocalise(&mut self, is_last: bool, update: &mut Update) {
        let Some(waiting) = &mut self.waiting else {
            update.changes.extend(self.map.close_loop(&self.settings.relocalisation));
            return;
        };
        if let Some((found, changes)) = waiting.attempt(&mut self.map, is_last) {
            self.waiting = None;
            update.relocalised = Some(found);
            update.changes.extend(changes);
        } else if waiting.is_outgrown_by(&self.map, is_last) {
            let why = set_aside(waiting);
            let latest = self.map.confirmed().map(|object| object.last_seen).max();
            let said = |stamp| Dropped { stamp, reason: "saved_map_set_aside", why };
            update.dropped.extend(latest.map(said));
            self.set_aside = self.waiting.take().map(Continuation::into_saved);
        }
    }

    /// Ellipsoids join the map. Liao et al. 2020, section V.
    fn keyframe(
        &mut self,
        (stamp, odom_from_base, odometry_covariance): (Stamp, &Pose, Option<Box<[f64; 36]>>),
        look: Look,
        update: &mut Update,
    ) -> Keyframe {
        let Look { base_from_camera, placement, calibration, camera, depth, detections, estimate } =
            look;
        let found = estimate.objects.iter().zip(&estimate.glimpses);
        let view = (&base_from_camera, &placement);
        let seen = detections.iter().zip(found).map(|(detection, (found, glimpse))| {
            observation(
                detection,
                (found.as_ref().ok(), glimpse.as_ref()),
                &camera,
                view,
                &self.settings,
            )
        });
        let sighted = self.map.observe(&Sighting {
            stamp,
            odom_from_base: *odom_from_base,
            odometry_covariance,
            observations: seen.collect(),
            walls: estimate.walls.iter().map(|w| wall_in_base(w, view)).collect(),
            view: Some(View {
                base_from_camera,
                camera: &camera,
                depth: &depth,
                noise: self.settings.depth_noise,
                max_range_m: self.settings.perception.segmentation.max_range_m,
            }),
        });
        update.dropped.extend(warnings(stamp, &sighted));
        update.changes.extend(sighted.changes);
        let map_from_camera = self.map.map_from_odom() * (odom_from_base * base_from_camera);
        let boxes = detections
            .into_iter()
            .zip(estimate.objects)
            .zip(sighted.objects)
            .map(|((detection, measurement), object)| BoxResult { detection, measurement, object })
            .collect();
        let camera_height_m = map_from_camera.translation.z;
        let support_heights_m = estimate
            .planes
            .iter()
            .map(|p| camera_height_m - p.plane.offset / p.plane.normal.z)
            .collect();
        let walls = estimate.walls;
        Keyframe {
            stamp,
            map_from_camera,
            boxes,
            support_heights_m,
            walls,
            calibration,
            camera,
            base_from_camera,
            depth,
        }
    }

    /// Objects that were measured in space join the map. No image tells what should have been seen, so that nothing is missed.
    fn keyframe_3d(
        &mut self,
        (stamp, odom_from_base, odometry_covariance): (Stamp, &Pose, Option<Box<[f64; 36]>>),
        found: Vec<(Detection3d, Pose)>,
        update: &mut Update,
    ) -> Keyframe3d {
        let up = odom_from_base.rotation.inverse() * Vector3::z_axis();
        let seen = found.iter().map(|(detection, base_from_frame)| {
            observation_in_space(detection, base_from_frame, &up, &self.settings)
        });
        let sighted = self.map.observe(&Sighting {
            stamp,
            odom_from_base: *odom_from_base,
            odometry_covariance,
            observations: seen.collect(),
            walls: Vec::new(),
            view: None,
        });
        update.dropped.extend(warnings(stamp, &sighted));
        update.changes.extend(sighted.changes);
        let found = found.into_iter().map(|(detection, _)| detection).zip(sighted.objects);
        Keyframe3d { stamp, found: found.collect() }
    }
}

/// What the map doubted or could not use.
fn warnings(stamp: Stamp, sighted: &Sighted) -> Vec<Dropped> {
    let doubts = sighted.notices.iter().map(|notice| (notice.reason(), notice.to_string()));
    let refused = sighted.refused.iter().map(|why| ("graph", why.clone()));
    doubts.chain(refused).map(|(reason, why)| Dropped { stamp, reason, why }).collect()
}
