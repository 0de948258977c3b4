//! What a run left for its report.

use super::{
    color_images::Tally, crops::Crop, picture::as_base64, points::Placed, rounded,
    sides::SideCounts, tracks::Track,
};
use crate::{
    geometry::Pose,
    msg::convert::ColorMessage,
    pipeline::{BoxResult, FramePose, Keyframe},
    publication::View,
    time::Stamp,
};
use nalgebra::Point2;
use serde::{Serialize, Serializer};
use std::{collections::BTreeMap, rc::Rc};

/// All that a report shows of a run, in the frame of the map as it is at the end.
#[derive(Debug)]
pub struct Recorded {
    pub(super) start: Stamp,
    /// Seconds since the start, the base after all optimisation, and as it was known at the time.
    pub(super) way: Vec<(f64, Pose, FramePose)>,
    pub(super) overlays: Vec<Overlay>,
    pub(super) crops: BTreeMap<u64, Vec<Crop>>,
    /// Crops of an object, at most.
    pub(super) most_crops: usize,
    pub(super) sides: BTreeMap<u64, SideCounts>,
    pub(super) counts: Vec<Counts>,
    pub(super) steps: Vec<Step>,
    pub(super) tracks: BTreeMap<u64, Track>,
    /// Changes of objects are left out that are so many times as large as otherwise.
    pub(super) coarseness: f64,
    pub(super) points: Rc<Placed>,
    /// Ends of walls seen from above.
    pub(super) walls: Vec<[Point2<f64>; 2]>,
    pub(super) images: Tally,
}

/// A colour image and where it was taken.
#[derive(Debug)]
pub(super) struct Overlay {
    pub(super) image: ColorMessage,
    pub(super) view: View,
}

/// A place of the time slider: a keyframe as it was at its time.
#[derive(Debug, Serialize)]
pub(super) struct Step {
    /// Since the start (s).
    pub(super) t: f64,
    /// `map_from_camera`.
    #[serde(serialize_with = "as_numbers")]
    pub(super) camera: Pose,
    /// Width and height that pixels are of.
    pub(super) size: [u32; 2],
    pub(super) focal_px: f64,
    #[serde(serialize_with = "as_base64_or_none")]
    pub(super) jpeg: Option<Vec<u8>>,
    pub(super) boxes: Vec<BoxView>,
    /// Objects in the image, each with its lines `x1, y1, x2, y2` (px).
    pub(super) outlines: Vec<(u64, Vec<i32>)>,
    /// Heights of the support planes (m).
    pub(super) planes_m: Vec<f64>,
}

/// A detector's box and what came of it.
#[derive(Debug, Serialize)]
pub(super) struct BoxView {
    label: String,
    probability: f64,
    /// Left, upper, right, lower (px).
    rect: [f64; 4],
    object: Option<u64>,
    /// Why it gave no measurement, in words.
    refused: Option<String>,
}

/// What of a keyframe is counted.
#[derive(Debug)]
pub(super) struct Counts {
    pub(super) t: f64,
    pub(super) objects: usize,
    pub(super) used: usize,
    pub(super) refused: BTreeMap<&'static str, usize>,
}

impl Step {
    /// Bytes of the page, about.
    pub(super) fn cost(&self) -> usize {
        let lines: usize = self.outlines.iter().map(|(_, numbers)| 5 * numbers.len()).sum();
        200 + self.jpeg.as_ref().map_or(0, |jpeg| 4 * jpeg.len() / 3)
            + 150 * self.boxes.len()
            + lines
    }

    pub(super) fn labels(&self) -> impl Iterator<Item = &str> {
        self.boxes.iter().map(|found| found.label.as_str())
    }

    /// The map got another frame.
    pub(super) fn move_map(&mut self, new_from_old: &Pose) {
        self.camera = new_from_old * self.camera;
        self.planes_m.iter_mut().for_each(|height| *height += new_from_old.translation.z);
    }
}

impl BoxView {
    pub(super) fn of(found: &BoxResult) -> Self {
        let rect = &found.detection.rect;
        Self {
            label: found.detection.label().to_owned(),
            probability: rounded(found.detection.probability()),
            rect: [rect.x_min, rect.y_min, rect.x_max, rect.y_max].map(f64::round),
            object: found.object.map(|id| id.0),
            refused: found.measurement.as_ref().err().map(ToString::to_string),
        }
    }
}

impl Counts {
    pub(super) fn of(t: f64, keyframe: &Keyframe, objects: usize) -> Self {
        let mut refused = BTreeMap::new();
        let why = keyframe.boxes.iter().filter_map(|found| found.measurement.as_ref().err());
        why.for_each(|refusal| *refused.entry(refusal.reason()).or_default() += 1);
        let used = keyframe.boxes.len() - refused.values().sum::<usize>();
        Self { t, objects, used, refused }
    }
}

/// Translation, then quaternion xyzw.
pub(super) fn numbers(pose: &Pose) -> [f64; 7] {
    let (at, turn) = (pose.translation.vector, pose.rotation);
    [at.x, at.y, at.z, turn.i, turn.j, turn.k, turn.w].map(|v| (v * 1e4).round() / 1e4)
}

fn as_numbers<S: Serializer>(pose: &Pose, serializer: S) -> Result<S::Ok, S::Error> {
    numbers(pose).serialize(serializer)
}

fn as_base64_or_none<S: Serializer>(
    bytes: &Option<Vec<u8>>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match bytes {
        Some(bytes) => as_base64(bytes, serializer),
        None => serializer.serialize_none(),
    }
}
