//! What came of an input, as the fields of `ellipsoid_slam.Update`.

use crate::{
    arguments::{PoseParts, parts},
    run::StampedPose,
};
use ellipsoid_slam::{
    mapping::{ObjectChange, Relocalised},
    pipeline::{BoxResult, Keyframe, Update},
};
use pyo3::IntoPyObject;

#[derive(IntoPyObject)]
pub(crate) struct UpdateRecord {
    poses: Vec<StampedPose>,
    keyframes: Vec<KeyframeRecord>,
    /// What happened, the object, and the other one where there are two.
    changes: Vec<(&'static str, u64, Option<u64>)>,
    /// Stamp, reason, sentence.
    dropped: Vec<(i64, &'static str, String)>,
    relocalised: Option<RelocalisedRecord>,
}

#[derive(IntoPyObject)]
struct KeyframeRecord {
    stamp_ns: i64,
    map_from_camera: PoseParts,
    boxes: Vec<BoxRecord>,
}

#[derive(IntoPyObject)]
struct BoxRecord {
    label: String,
    corners: (f64, f64, f64, f64),
    object_id: Option<u64>,
    /// Reason and sentence.
    refused: Option<(&'static str, String)>,
}

#[derive(IntoPyObject)]
struct RelocalisedRecord {
    map_from_seen: PoseParts,
    objects: usize,
    false_probability: f64,
}

impl From<&Update> for UpdateRecord {
    fn from(update: &Update) -> Self {
        let poses = update.poses.iter();
        let dropped = update.dropped.iter();
        Self {
            poses: poses.map(|p| (p.stamp.as_nanos(), parts(&p.map_from_base))).collect(),
            keyframes: update.keyframes.iter().map(KeyframeRecord::from).collect(),
            changes: update.changes.iter().map(change).collect(),
            dropped: dropped.map(|d| (d.stamp.as_nanos(), d.reason, d.why.clone())).collect(),
            relocalised: update.relocalised.as_ref().map(RelocalisedRecord::from),
        }
    }
}

impl From<&Keyframe> for KeyframeRecord {
    fn from(keyframe: &Keyframe) -> Self {
        Self {
            stamp_ns: keyframe.stamp.as_nanos(),
            map_from_camera: parts(&keyframe.map_from_camera),
            boxes: keyframe.boxes.iter().map(BoxRecord::from).collect(),
        }
    }
}

impl From<&BoxResult> for BoxRecord {
    fn from(result: &BoxResult) -> Self {
        let rect = result.detection.rect;
        Self {
            label: result.detection.label().to_owned(),
            corners: (rect.x_min, rect.y_min, rect.x_max, rect.y_max),
            object_id: result.object.map(|id| id.0),
            refused: result.measurement.as_ref().err().map(|why| (why.reason(), why.to_string())),
        }
    }
}

impl From<&Relocalised> for RelocalisedRecord {
    fn from(found: &Relocalised) -> Self {
        Self {
            map_from_seen: parts(&found.map_from_seen),
            objects: found.matches.len(),
            false_probability: found.false_probability,
        }
    }
}

fn change(change: &ObjectChange) -> (&'static str, u64, Option<u64>) {
    match change {
        ObjectChange::Confirmed(id) => ("confirmed", id.0, None),
        ObjectChange::Removed(id) => ("removed", id.0, None),
        ObjectChange::Merged { kept, gone } => ("merged", kept.0, Some(gone.0)),
        ObjectChange::Split { from, into } => ("split", from.0, Some(into.0)),
    }
}
