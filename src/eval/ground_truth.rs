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
        let objects = file.objects.into_iter().map(checked).collect::<Result<_, _>>()?;
        Self::new(file.frame_id, objects)
    }

    /// The objects in a frame.
    ///
    /// # Errors
    /// When an id comes twice.
    pub fn new(frame_id: String, objects: Vec<TrueObject>) -> Result<Self, GroundTruthError> {
        let mut ids = BTreeSet::new();
        match objects.iter().find(|object| !ids.insert(object.id)) {
            Some(object) => Err(GroundTruthError::DuplicateId { id: object.id }),
            None => Ok(Self { frame_id, objects }),
        }
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
    /// An object at `position` (m), turned by a quaternion xyzw, with its full extents (m); seen in no frame.
    ///
    /// # Errors
    /// When the pose is not finite, a size is not positive or the label is empty.
    pub fn new(
        id: u64,
        label: String,
        position: [f64; 3],
        orientation: [f64; 4],
        size: [f64; 3],
    ) -> Result<Self, GroundTruthError> {
        let bad = |problem| GroundTruthError::BadObject { id, problem };
        let pose = pose_from_xyzw(position, orientation)
            .ok_or_else(|| bad("the pose is not finite or the quaternion is not of unit length"))?;
        if !size.iter().all(|s| s.is_finite() && *s > 0.0) {
            return Err(bad("the size is not positive"));
        }
        if label.is_empty() {
            return Err(bad("the label is empty"));
        }
        Ok(Self { id, label, pose, size: size.into(), observations: 0 })
    }

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
    let object = TrueObject::new(id, label, position, orientation, size)?;
    Ok(TrueObject { observations, ..object })
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
