//! What is taken note of during a run.

use super::{
    crops::Crops,
    picture::{thumbnail, whole},
    points::{Anchor, Cloud},
    recorded::{BoxView, Counts, Overlay, Recorded, Step},
    rounded,
    sides::Sides,
    thinned::Thinned,
    tracks::Tracks,
};
use crate::{
    geometry::{Camera, Pose, yaw_of},
    mapping::{MapObject, ObjectChange, ObjectId},
    msg::convert::{ColorMessage, RgbImage},
    pipeline::{FramePose, Keyframe, ObjectSlam, Update},
    publication::{View, outline_in_image},
    time::Stamp,
};
use std::collections::VecDeque;

/// Longer side of the images on the page (px).
const IMAGE_PX: u32 = 480;
/// Least time from one place of the slider to the next (s): decoding more images would cost more than the method does.
const STEP_S: f64 = 0.3;
/// Images and what is drawn over them, all together (bytes of the page).
const STEPS_BUDGET: usize = 11_000_000;
/// Poses of the base.
const MAX_POSES: usize = 3_000;
/// Pictures that outlines are drawn into.
const MAX_OVERLAYS: usize = 4;
/// Objects farther off are not outlined in images (m).
const MAX_RANGE_M: f64 = 8.0;
/// Colour images that wait for their depth image and boxes, at most.
const MAX_WAITING: usize = 64;
/// An image is of the same moment as a depth image if their stamps differ by less (s).
const SAME_MOMENT_S: f64 = 0.05;

/// Takes note of what a report shows, within bounds that hold however long the run is.
#[derive(Debug)]
pub struct Recorder {
    start: Option<Stamp>,
    waiting: VecDeque<ColorMessage>,
    /// When the latest step was taken, or one left out for the sake of the budget.
    latest_step: f64,
    steps: Thinned<Step>,
    way: Thinned<FramePose>,
    overlays: Thinned<(RgbImage, Anchor, Camera)>,
    counts: Vec<Counts>,
    tracks: Tracks,
    cloud: Cloud,
    crops: Crops,
    sides: Sides,
    images: Images,
}

/// A colour image that was decoded for a keyframe, for whoever draws into it.
#[derive(Debug)]
pub struct Shown {
    /// The keyframe's place in its update.
    pub keyframe: usize,
    /// The frame that the image is in.
    pub frame_id: String,
    /// The image.
    pub image: RgbImage,
}

/// What became of the colour images that were asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Images {
    pub(super) used: usize,
    pub(super) absent: usize,
    pub(super) undecodable: usize,
    /// Of the first that could not be decoded.
    pub(super) why: Option<String>,
}

impl Default for Recorder {
    fn default() -> Self {
        Self {
            start: None,
            waiting: VecDeque::new(),
            latest_step: f64::NEG_INFINITY,
            steps: Thinned::new(STEPS_BUDGET),
            way: Thinned::new(MAX_POSES),
            overlays: Thinned::new(MAX_OVERLAYS),
            counts: Vec::new(),
            tracks: Tracks::new(),
            cloud: Cloud::new(),
            crops: Crops::default(),
            sides: Sides::default(),
            images: Images::default(),
        }
    }
}

impl Recorder {
    /// Takes note of a colour image, which is decoded only if it is shown.
    pub fn hear_color(&mut self, image: ColorMessage) {
        if self.waiting.len() == MAX_WAITING {
            self.waiting.pop_front();
        }
        self.waiting.push_back(image);
    }

    /// Takes note of what came of an input. Returns the images that were decoded for it.
    pub fn take(&mut self, update: &Update, slam: &ObjectSlam) -> Vec<Shown> {
        if let Some(found) = &update.relocalised {
            self.move_map(&found.map_from_seen);
        }
        for change in &update.changes {
            if let ObjectChange::Merged { kept, gone } = change {
                self.crops.merge(*kept, *gone);
                self.sides.merge(*kept, *gone);
            }
        }
        for pose in &update.poses {
            self.start.get_or_insert(pose.stamp);
            if self.way.takes_next() {
                self.way.add(*pose, 1);
            }
        }
        let mut shown = Vec::new();
        for (at, keyframe) in update.keyframes.iter().enumerate() {
            let pose = update.poses.iter().find(|pose| pose.stamp == keyframe.stamp);
            if let Some(pose) = pose {
                let anchor = Anchor { pose: *pose, base_from_camera: keyframe.base_from_camera };
                let image = self.keyframe(keyframe, anchor, slam);
                shown.extend(image.map(|(image, frame_id)| Shown {
                    keyframe: at,
                    frame_id,
                    image,
                }));
            }
        }
        shown
    }

    fn keyframe(
        &mut self,
        keyframe: &Keyframe,
        anchor: Anchor,
        slam: &ObjectSlam,
    ) -> Option<(RgbImage, String)> {
        let t = self.seconds(keyframe.stamp);
        self.tracks.note(t, slam.objects());
        self.counts.push(Counts::of(t, keyframe, slam.objects().count()));
        for found in &keyframe.boxes {
            if let (Ok(measured), Some(object)) =
                (&found.measurement, object_of(found.object, slam))
            {
                let heading = yaw_of(&object.ellipsoid().pose);
                self.sides.add(object.id, heading, measured, &keyframe.map_from_camera);
            }
        }
        let takes_step = self.takes_step(t);
        let takes_points = self.cloud.wants(&anchor, takes_step);
        let takes_overlay = takes_step && self.overlays.takes_next();
        let boxes = keyframe.boxes.iter().filter_map(|found| Some((found.object?, found)));
        let cropped: Vec<_> =
            boxes.filter(|(object, _)| self.crops.takes_next(*object, takes_step)).collect();
        let takes_any = takes_step || takes_points || takes_overlay || !cropped.is_empty();
        let image = if takes_any { self.image_of(keyframe.stamp) } else { None };
        self.waiting.retain(|image| image.stamp() > keyframe.stamp);
        if takes_points {
            self.cloud.add(anchor, keyframe, image.as_ref().map(|(image, _)| image));
        }
        if takes_step {
            self.add_step(t, keyframe, image.as_ref().map(|(image, _)| image), slam);
        }
        let (image, frame_id) = image?;
        for (object, found) in cropped {
            let cropped = self.crops.add(object, t, &image, &found.detection.rect);
            self.note_problem(cropped.err().map(|e| e.to_string()));
        }
        if takes_overlay {
            self.overlays.add((image.clone(), anchor, keyframe.camera.clone()), 1);
        }
        Some((image, frame_id))
    }

    /// Whether the keyframe of a time (s) becomes a place of the slider.
    fn takes_step(&mut self, t: f64) -> bool {
        // Stamps are rounded. A clock may have been set back.
        let is_due = !(0.0..STEP_S - 2e-3).contains(&(t - self.latest_step));
        if is_due {
            self.latest_step = t;
        }
        is_due && self.steps.takes_next()
    }

    fn add_step(
        &mut self,
        t: f64,
        keyframe: &Keyframe,
        image: Option<&RgbImage>,
        slam: &ObjectSlam,
    ) {
        let (camera, map_from_camera) = (&keyframe.camera, keyframe.map_from_camera);
        let view = View { camera: camera.clone(), map_from_camera };
        let seen = slam.map().in_view(camera, &map_from_camera, MAX_RANGE_M);
        let outlined = seen.iter().map(|seen| {
            let lines = outline_in_image(&seen.object.ellipsoid(), seen.object.outline, &view);
            let pixels = lines.iter().flatten().flat_map(|p| [p.x, p.y]);
            (seen.object.id.0, pixels.map(|c| c.clamp(-9999.0, 9999.0).round() as i32).collect())
        });
        let jpeg = image.map(|image| thumbnail(image, &whole(image), IMAGE_PX)).transpose();
        let jpeg = jpeg.unwrap_or_else(|problem| {
            self.note_problem(Some(problem.to_string()));
            None
        });
        let step = Step {
            t,
            camera: map_from_camera,
            size: [camera.width(), camera.height()],
            focal_px: camera.focal().0,
            jpeg,
            boxes: keyframe.boxes.iter().map(BoxView::of).collect(),
            outlines: outlined.collect(),
            planes_m: keyframe.support_heights_m.iter().copied().map(rounded).collect(),
        };
        let cost = step.cost();
        self.steps.add(step, cost);
    }

    /// The colour image of a moment and its frame; why there is none is counted.
    fn image_of(&mut self, stamp: Stamp) -> Option<(RgbImage, String)> {
        let away = |image: &ColorMessage| image.stamp().seconds_since(stamp).abs();
        let nearest = self.waiting.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        let Some(image) = nearest.filter(|image| away(image) < SAME_MOMENT_S) else {
            self.images.absent += 1;
            return None;
        };
        match image.decoded() {
            Ok(decoded) => {
                self.images.used += 1;
                Some((decoded, image.frame_id().to_owned()))
            }
            Err(problem) => {
                self.note_problem(Some(problem.to_string()));
                None
            }
        }
    }

    fn note_problem(&mut self, problem: Option<String>) {
        let Some(problem) = problem else { return };
        self.images.undecodable += 1;
        self.images.why.get_or_insert(problem);
    }

    fn move_map(&mut self, new_from_old: &Pose) {
        self.steps.iter_mut().for_each(|step| step.move_map(new_from_old));
        self.tracks.move_map(new_from_old);
        self.sides.move_map(new_from_old);
    }

    fn seconds(&mut self, stamp: Stamp) -> f64 {
        rounded(stamp.seconds_since(*self.start.get_or_insert(stamp)))
    }

    /// All that was taken note of, in the frame of the map as it is at the end.
    pub fn finish(self, slam: &ObjectSlam) -> Recorded {
        let start = self.start.unwrap_or_default();
        let in_map: Vec<u64> = slam.objects().map(|object| object.id.0).collect();
        let sides = slam.objects().filter_map(|object| {
            let heading = yaw_of(&object.ellipsoid().pose);
            Some((object.id.0, self.sides.of(object.id, heading)?))
        });
        let sides = sides.collect();
        let way: Vec<(f64, Pose, FramePose)> = (self.way.iter())
            .map(|pose| (pose.stamp.seconds_since(start), slam.map_from_base(pose), *pose))
            .collect();
        let overlays = self.overlays.into_entries().into_iter().map(|(image, anchor, camera)| {
            let map_from_camera = anchor.map_from_camera(slam);
            Overlay { image, view: View { camera, map_from_camera } }
        });
        let overlays = overlays.collect();
        let (crops, most_crops) = self.crops.finish(&in_map);
        Recorded {
            start,
            way,
            overlays,
            crops,
            most_crops,
            sides,
            counts: self.counts,
            steps: self.steps.into_entries(),
            coarseness: self.tracks.coarseness(),
            tracks: self.tracks.finish(),
            points: self.cloud.finish(slam),
            walls: slam.map().wall_ends().collect(),
            images: self.images,
        }
    }
}

fn object_of(id: Option<ObjectId>, slam: &ObjectSlam) -> Option<&MapObject> {
    let id = id?;
    slam.map().all().iter().find(|object| object.id == id)
}
