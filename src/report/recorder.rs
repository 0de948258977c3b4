//! What is taken note of during a run.

use super::{
    color_images::ColorImages,
    crops::Crops,
    picture::{small_jpeg, thumbnail, whole},
    points::{Anchor, Placed},
    recorded::{BoxView, Counts, Overlay, Recorded, Step},
    rounded,
    sides::Sides,
    thinned::Thinned,
    tracks::Tracks,
};
use crate::{
    geometry::{Camera, Pose, yaw_of},
    mapping::{MapObject, ObjectChange, ObjectId, Queries},
    msg::convert::ColorMessage,
    pipeline::{FramePose, Keyframe, ObjectSlam, Update},
    publication::{View, outline_in_image},
    time::Stamp,
};
use std::rc::Rc;

/// Longer side of the images on the page (px).
const IMAGE_PX: u32 = 480;
/// An image that came as a JPEG of no more bytes is on the page as it is: that costs no time at all.
const SMALL_JPEG: usize = 32_000;
/// Least time from one place of the slider to the next (s).
const STEP_S: f64 = 0.3;
/// The same where the image has to be made smaller, which costs as much as the method does (s).
const STEP_OF_LARGE_S: f64 = 0.5;
/// Images and what is drawn over them, all together (bytes of the page).
const STEPS_BUDGET: usize = 11_000_000;
/// Poses of the base.
const MAX_POSES: usize = 3_000;
/// Pictures that outlines are drawn into.
pub const MAX_OVERLAYS: usize = 4;
/// Objects farther off are not outlined in images (m).
const MAX_RANGE_M: f64 = 8.0;

/// Takes note of what a report shows, within bounds that hold however long the run is.
#[derive(Debug)]
pub struct Recorder {
    start: Option<Stamp>,
    /// When the latest step was taken, or one left out for the sake of the budget.
    latest_step: f64,
    /// From one step to the next (s).
    step_s: f64,
    steps: Thinned<Step>,
    way: Thinned<FramePose>,
    overlays: Thinned<(ColorMessage, Anchor, Camera)>,
    counts: Vec<Counts>,
    tracks: Tracks,
    crops: Crops,
    sides: Sides,
}

impl Default for Recorder {
    fn default() -> Self {
        Self {
            start: None,
            latest_step: f64::NEG_INFINITY,
            step_s: STEP_S,
            steps: Thinned::new(STEPS_BUDGET),
            way: Thinned::new(MAX_POSES),
            overlays: Thinned::new(MAX_OVERLAYS),
            counts: Vec::new(),
            tracks: Tracks::new(),
            crops: Crops::default(),
            sides: Sides::default(),
        }
    }
}

impl Recorder {
    /// Takes note of what an update says of the map and of the base.
    pub fn take(&mut self, update: &Update) {
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
    }

    /// Takes note of a keyframe and of its image, which is decoded only if that is needed.
    pub fn keyframe(
        &mut self,
        keyframe: &Keyframe,
        anchor: &Anchor,
        slam: &ObjectSlam,
        images: &mut ColorImages,
    ) {
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
        if self.takes_step(t) {
            if self.overlays.takes_next()
                && let Some(image) = images.message(keyframe.stamp)
            {
                self.overlays.add((image.clone(), *anchor, keyframe.camera.clone()), 1);
            }
            self.add_step(t, keyframe, slam, images);
        }
        self.add_crops(t, keyframe, images);
    }

    /// Parts of the image that show objects of which there are too few.
    fn add_crops(&mut self, t: f64, keyframe: &Keyframe, images: &mut ColorImages) {
        let is_decoded = images.is_decoded(keyframe.stamp);
        for found in &keyframe.boxes {
            let Some(object) = found.object else { continue };
            if !self.crops.takes_next(object, is_decoded) {
                continue;
            }
            let Some(image) = images.decoded(keyframe.stamp) else { continue };
            if let Err(problem) = self.crops.add(object, t, &image, &found.detection.rect) {
                images.cannot_use(problem.to_string());
            }
        }
    }

    /// Whether the keyframe of a time (s) becomes a place of the slider.
    fn takes_step(&mut self, t: f64) -> bool {
        // Stamps are rounded. A clock may have been set back.
        let is_due = !(0.0..self.step_s - 2e-3).contains(&(t - self.latest_step));
        if is_due {
            self.latest_step = t;
        }
        is_due && self.steps.takes_next()
    }

    fn add_step(
        &mut self,
        t: f64,
        keyframe: &Keyframe,
        slam: &ObjectSlam,
        images: &mut ColorImages,
    ) {
        let (camera, map_from_camera) = (&keyframe.camera, keyframe.map_from_camera);
        let view = View { camera: camera.clone(), map_from_camera };
        let seen = slam.map().in_view(camera, &map_from_camera, MAX_RANGE_M);
        let outlined = seen.iter().map(|seen| {
            let lines = outline_in_image(&seen.object.ellipsoid(), seen.object.outline, &view);
            let pixels = lines.iter().flatten().flat_map(|p| [p.x, p.y]);
            (seen.object.id.0, pixels.map(|c| c.clamp(-9999.0, 9999.0).round() as i32).collect())
        });
        let jpeg = self.picture(keyframe.stamp, images);
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

    /// The image of a moment as a JPEG.
    fn picture(&mut self, stamp: Stamp, images: &mut ColorImages) -> Option<Vec<u8>> {
        let as_it_came = images.message(stamp).and_then(|image| small_jpeg(image, SMALL_JPEG));
        if as_it_came.is_some() {
            return as_it_came;
        }
        let image = images.decoded(stamp)?;
        self.step_s = STEP_OF_LARGE_S;
        match thumbnail(&image, &whole(&image), IMAGE_PX) {
            Ok(jpeg) => Some(jpeg),
            Err(problem) => {
                images.cannot_use(problem.to_string());
                None
            }
        }
    }

    fn move_map(&mut self, new_from_old: &Pose) {
        self.steps.iter_mut().for_each(|step| step.move_map(new_from_old));
        self.tracks.move_map(new_from_old);
        self.sides.move_map(new_from_old);
    }

    fn seconds(&mut self, stamp: Stamp) -> f64 {
        rounded(stamp.seconds_since(*self.start.get_or_insert(stamp)))
    }

    /// All that was taken note of and the points that were seen, in the frame of the map as it is at the end.
    pub fn finish(self, slam: &ObjectSlam, points: Rc<Placed>, images: ColorImages) -> Recorded {
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
            points,
            walls: slam.map().wall_ends().collect(),
            images: images.into_tally(),
        }
    }
}

fn object_of(id: Option<ObjectId>, slam: &ObjectSlam) -> Option<&MapObject> {
    let id = id?;
    slam.map().all().iter().find(|object| object.id == id)
}
