//! The true objects of a scene, `*.gt.json`.

use crate::geometry::{OrientedBox, Pose, pose_from_xyzw};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use thiserror::Error;

/// What stands where in truth.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundTruth {
    /// The frame that poses are in.
    pub frame_id: String,
    /// In the order of the file; no id twice.
    pub objects: Vec<TrueObject>,
}

/// One true object.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueObject {
    /// Its identity.
    pub id: u64,
    /// Its class.
    pub label: String,
    /// `frame_from_object`: the origin is the centre of the object's box.
    pub pose: Pose,
    /// Full extents along the object's own axes (m).
    pub size: Vector3<f64>,
    /// Frames that show it.
    pub observations: u64,
}

/// Why a text is not a ground truth.
#[derive(Debug, Error)]
pub enum GroundTruthError {
    /// Not JSON, or not in this form.
    #[error("not a ground truth file: {0}")]
    Form(#[from] serde_json::Error),
    /// The same id twice.
    #[error("two objects have the id {id}")]
    DuplicateId {
        /// The id.
        id: u64,
    },
    /// A number that cannot be.
    #[error("object {id}: {problem}")]
    BadObject {
        /// The object.
        id: u64,
        /// What is wrong with it.
        problem: &'static str,
    },
}

impl GroundTruth {
    /// Reads the text of a `*.gt.json` file. Fields that are not known here are passed over.
    ///
    /// # Errors
    /// When a field is missing, a pose is not finite, a size is not positive or an id comes twice.
    pub fn from_json(text: &str) -> Result<Self, GroundTruthError> {
        let file: File = serde_json::from_str(text)?;
        let mut ids = BTreeSet::new();
        if let Some(object) = file.objects.iter().find(|o| !ids.insert(o.id)) {
            return Err(GroundTruthError::DuplicateId { id: object.id });
        }
        let objects = file.objects.into_iter().map(checked).collect::<Result<_, _>>()?;
        Ok(Self { frame_id: file.frame_id, objects })
    }

    /// The text of the `*.gt.json` file.
    ///
    /// # Errors
    /// Never for what was read or checked.
    pub fn to_json(&self) -> Result<String, GroundTruthError> {
        let objects = self.objects.iter().map(record).collect();
        let file = File { frame_id: self.frame_id.clone(), objects };
        let mut text = serde_json::to_string_pretty(&file)?;
        text.push('\n');
        Ok(text)
    }
}

impl TrueObject {
    /// The object's box.
    pub fn oriented_box(&self) -> OrientedBox {
        OrientedBox { pose: self.pose, half_extents: self.size * 0.5 }
    }
}

#[derive(Serialize, Deserialize)]
struct File {
    frame_id: String,
    objects: Vec<Record>,
}

#[derive(Serialize, Deserialize)]
struct Record {
    id: u64,
    label: String,
    position: [f64; 3],
    orientation: [f64; 4],
    size: [f64; 3],
    observations: u64,
}

fn checked(record: Record) -> Result<TrueObject, GroundTruthError> {
    let Record { id, label, position, orientation, size, observations } = record;
    let bad = |problem| GroundTruthError::BadObject { id, problem };
    let pose = pose_from_xyzw(position, orientation)
        .ok_or_else(|| bad("the pose is not finite or the quaternion is not of unit length"))?;
    if !size.iter().all(|s| s.is_finite() && *s > 0.0) {
        return Err(bad("the size is not positive"));
    }
    if label.is_empty() {
        return Err(bad("the label is empty"));
    }
    Ok(TrueObject { id, label, pose, size: size.into(), observations })
}

fn record(object: &TrueObject) -> Record {
    let q = object.pose.rotation;
    Record {
        id: object.id,
        label: object.label.clone(),
        position: object.pose.translation.vector.into(),
        orientation: [q.i, q.j, q.k, q.w],
        size: object.size.into(),
        observations: object.observations,
    }
}
