//! What people say of objects: what one is called, that it stays, that it is not there, or that there is another one.

use super::{MapObject, MergeError, ObjectId, ObjectMap, SavedObject};
use crate::{
    geometry::{Ellipsoid, Outline, Pose},
    time::Stamp,
};
use nalgebra::{SMatrix, SVector, UnitQuaternion, Vector3};
use std::{collections::BTreeMap, fmt};
use thiserror::Error;

/// A change that somebody asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Gives an object a name of its own, whatever detectors call it.
    Rename(ObjectId, String),
    /// Takes an object out of the map. If it is still there it will be found anew, as another one.
    Delete(ObjectId),
    /// Whether an object stays in the map and in its place whatever images say.
    Lock(ObjectId, bool),
    /// Adds an object that nobody has seen.
    Add(NewObject),
}

/// An object as somebody describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct NewObject {
    /// Its class, as detectors say it.
    pub label: String,
    /// Pose of its centre in the map; it stands upright.
    pub pose: Pose,
    /// Its full extents along its own axes (m).
    pub size_m: Vector3<f64>,
    /// What fills them.
    pub outline: Outline,
    /// Whether it stays whatever images say.
    pub locked: bool,
}

/// Why an edit was not made. The map is as it was.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EditError {
    /// There is no such object, or the graph could not be solved.
    #[error(transparent)]
    Map(#[from] MergeError),
    /// A name that is none.
    #[error(transparent)]
    Name(#[from] BadName),
    /// Where nothing can be.
    #[error("the position has to be within {} km of the map's origin", FARTHEST_M / 1e3)]
    Position,
    /// Objects are upright.
    #[error("the object has to be upright: only its heading may differ from the map's axes")]
    Tilted,
    /// What no object has.
    #[error("the size has to be three lengths above 0 and up to {LARGEST_M} m")]
    Size,
}

/// Why a text is no name or label.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum BadName {
    /// Nothing but spaces.
    #[error("a name must not be empty")]
    Empty,
    /// Longer than any.
    #[error("the name has {0} bytes, more than {MAX_NAME_BYTES}")]
    TooLong(usize),
    /// Line breaks and the like.
    #[error("the name has a control character in it")]
    Control,
}

/// A name without spaces round it.
///
/// # Errors
/// When it is empty, longer than 255 bytes, or has control characters in it.
pub fn checked_name(name: &str) -> Result<&str, BadName> {
    let name = name.trim();
    match name.len() {
        0 => Err(BadName::Empty),
        long if long > MAX_NAME_BYTES => Err(BadName::TooLong(long)),
        _ if name.chars().any(char::is_control) => Err(BadName::Control),
        _ => Ok(name),
    }
}

impl fmt::Display for Edit {
    /// What was done, of the object in question.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rename(_, name) => write!(f, "is called `{}`", name.trim()),
            Self::Delete(_) => write!(f, "is deleted"),
            Self::Lock(_, true) => write!(f, "is locked"),
            Self::Lock(_, false) => write!(f, "is not locked"),
            Self::Add(new) => write!(f, "is a new {}", new.label.trim()),
        }
    }
}

impl ObjectMap {
    /// Does what somebody asks for, at a time of the data; which object it was.
    ///
    /// # Errors
    /// When there is no such object, or what is said of it cannot be; in a sentence, and nothing has changed then.
    pub fn edit(&mut self, edit: &Edit, now: Stamp) -> Result<ObjectId, EditError> {
        match edit {
            Edit::Rename(id, name) => {
                let name = checked_name(name)?.to_owned();
                self.counting(*id)?.given_name = Some(name);
                Ok(*id)
            }
            Edit::Delete(id) => {
                self.counting(*id)?;
                self.remove(*id)?;
                Ok(*id)
            }
            Edit::Lock(id, locked) => {
                self.counting(*id)?.locked = *locked;
                Ok(*id)
            }
            Edit::Add(new) => self.add(new, now),
        }
    }

    fn counting(&mut self, id: ObjectId) -> Result<&mut MapObject, MergeError> {
        let mut all = self.objects.iter_mut();
        all.find(|object| object.id == id && object.counts()).ok_or(MergeError::Unknown(id))
    }

    fn add(&mut self, new: &NewObject, now: Stamp) -> Result<ObjectId, EditError> {
        let label = checked_name(&new.label)?;
        if !new.pose.translation.vector.iter().all(|v| v.abs() <= FARTHEST_M) {
            return Err(EditError::Position);
        }
        let up = new.pose.rotation * Vector3::z();
        if up.z < UPRIGHT || up.z.is_nan() {
            return Err(EditError::Tilted);
        }
        if !new.size_m.iter().all(|size| *size > SMALLEST_M && *size <= LARGEST_M) {
            return Err(EditError::Size);
        }
        let level = UnitQuaternion::rotation_between(&up, &Vector3::z()).unwrap_or_default();
        let pose = Pose::from_parts(new.pose.translation, level * new.pose.rotation);
        let sigmas = SVector::<f64, 9>::from(TOLD);
        let told = SavedObject {
            id: self.last_id + 1,
            label: label.to_owned(),
            name: None,
            locked: new.locked,
            labels: BTreeMap::from([(label.to_owned(), 1.0)]),
            existence: TOLD_EXISTENCE,
            observations: 0,
            first_seen: now,
            last_seen: now,
            ellipsoid: Ellipsoid::new(pose, new.size_m / 2.0),
            outline: new.outline,
            support_height_m: None,
            covariance: SMatrix::from_diagonal(&sigmas.component_mul(&sigmas)),
        };
        let added = MapObject::remembered(&told, &mut self.graph, &self.slam);
        let object = self.solved(added)?;
        let id = object.id;
        self.last_id = id.0;
        self.objects.push(object);
        Ok(id)
    }
}

/// As long as names of frames and classes on the wire may be.
const MAX_NAME_BYTES: usize = 255;
/// Farther off is a mistake (m).
const FARTHEST_M: f64 = 1e6;
const SMALLEST_M: f64 = 1e-3;
const LARGEST_M: f64 = 100.0;
/// Cosine of 3 degrees: people write few digits.
const UPRIGHT: f64 = 0.9986;
/// How well people know where things are: standard deviations of rotation (rad), translation (m), logarithms of the semi-axes.
const TOLD: [f64; 9] = [0.05, 0.05, 0.1, 0.05, 0.05, 0.05, 0.1, 0.1, 0.1];
/// Of what somebody says is there.
const TOLD_EXISTENCE: f64 = 0.99;
