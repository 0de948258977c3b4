//! The map file, `map.json`.

use super::{disk_problem, write_atomically};
use crate::{
    geometry::{Ellipsoid, Outline, Pose, pose_from_xyzw},
    mapping::{SavedMap, SavedObject, checked_name, proper_belief},
    pipeline::{MapsToSave, SET_ASIDE_MAP},
    time::Stamp,
};
use nalgebra::SMatrix;
use rustix::fs::OFlags;
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File, OpenOptions},
    io::{self, Read},
    os::unix::fs::OpenOptionsExt,
    path::{Path, PathBuf},
};
use thiserror::Error;

/// The largest map file that is read: about 100,000 objects.
const MAX_BYTES: u64 = 512 << 20;
/// The format's version; readers refuse others.
const VERSION: u32 = 1;

/// Why a text is not a map, or a map cannot be saved as one.
#[derive(Debug, Error)]
pub enum MapFileError {
    /// The operating system refused.
    #[error("the map cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The operating system did not write it.
    #[error("the map cannot be written: {}", disk_problem(.0))]
    Write(io::Error),
    /// A folder, a pipe, a device or a link.
    #[error("it is no regular file, and maps are; of a link, give what it points to")]
    NotAFile,
    /// What would be overwritten is something else.
    #[error("the file that is there is no map of this version: it is not overwritten")]
    NotAMap,
    /// Larger than any map.
    #[error("the map file is larger than {} MiB, which no map is", MAX_BYTES >> 20)]
    TooLarge,
    /// Not JSON, or not in this form.
    #[error("not a map file: {0}")]
    Form(#[from] serde_json::Error),
    /// Written by another version.
    #[error("the map has version {version}, this program reads version {VERSION}")]
    Version {
        /// The file's version.
        version: u32,
    },
    /// The same id twice.
    #[error("two objects have the id {id}")]
    DuplicateId {
        /// The id.
        id: u64,
    },
    /// A field that cannot be.
    #[error("object {id}: {field} {wanted}")]
    BadObject {
        /// The object.
        id: u64,
        /// The field.
        field: &'static str,
        /// What it has to be.
        wanted: &'static str,
    },
}

#[derive(Serialize, Deserialize)]
struct MapFile {
    version: u32,
    frame_id: String,
    objects: Vec<ObjectRecord>,
}

/// What every version has.
#[derive(Deserialize)]
struct VersionOnly {
    version: u32,
}

/// An object as the file has it: metres, seconds, quaternion xyzw.
#[derive(Serialize, Deserialize)]
struct ObjectRecord {
    id: u64,
    label: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    locked: bool,
    labels: BTreeMap<String, f64>,
    existence: f64,
    observations: u32,
    first_seen: f64,
    last_seen: f64,
    position: [f64; 3],
    orientation: [f64; 4],
    semi_axes: [f64; 3],
    outline: Outline,
    support_height: Option<f64>,
    covariance: Vec<f64>,
}

/// The text of a map file.
///
/// # Errors
/// When [`read_map`] would refuse it: an id that is there twice, or a field that cannot be.
pub fn map_json(map: &SavedMap) -> Result<String, MapFileError> {
    let objects: Vec<ObjectRecord> = map.objects.iter().map(record).collect();
    check(&objects)?;
    let file = MapFile { version: VERSION, frame_id: map.frame_id.clone(), objects };
    let mut text = serde_json::to_string_pretty(&file)?;
    text.push('\n');
    Ok(text)
}

/// Loads a map file. The file itself is opened: no link is followed, and a pipe that nobody writes to is not waited for.
///
/// # Errors
/// When it is no regular file, cannot be read, is larger than any map, or is not a map.
pub fn load_saved_map(path: &Path) -> Result<SavedMap, MapFileError> {
    read_map(&text_of(path)?)
}

fn text_of(path: &Path) -> Result<String, MapFileError> {
    let file = opened(path)?;
    let mut text = String::new();
    // What a file says about its length need not be so.
    let read = file.take(MAX_BYTES + 1).read_to_string(&mut text)?;
    if read as u64 > MAX_BYTES {
        return Err(MapFileError::TooLarge);
    }
    Ok(text)
}

fn opened(path: &Path) -> Result<File, MapFileError> {
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed();
    let file = OpenOptions::new().read(true).custom_flags(flags).open(path).map_err(|why| {
        let is_link = fs::symlink_metadata(path).is_ok_and(|there| there.is_symlink());
        if is_link { MapFileError::NotAFile } else { MapFileError::Io(why) }
    })?;
    // Of what was opened, whatever has come in its place since.
    if file.metadata()?.is_file() { Ok(file) } else { Err(MapFileError::NotAFile) }
}

/// Saves a map: a crash at any moment leaves the old file whole.
///
/// # Errors
/// When the map is one that could not be loaded, what is there is no map, or it cannot be written; the old one is still
/// there then.
pub fn save_map(path: &Path, map: &SavedMap) -> Result<(), MapFileError> {
    let text = map_json(map)?;
    match load_saved_map(path) {
        Ok(_) => {}
        Err(MapFileError::Io(why)) if why.kind() == io::ErrorKind::NotFound => {}
        Err(MapFileError::NotAFile) => return Err(MapFileError::NotAFile),
        Err(_) => return Err(MapFileError::NotAMap),
    }
    write_atomically(path, text.as_bytes()).map_err(MapFileError::Write)
}

/// Saves what a run leaves: the map in `path`, and another one beside it, whose file is returned. That one is written
/// first, since it may be what `path` has in it.
///
/// # Errors
/// As [`save_map`]. Where the first cannot be written the second is not.
pub fn save_maps(path: &Path, maps: &MapsToSave) -> Result<Option<PathBuf>, MapFileError> {
    let beside = match &maps.beside {
        None => None,
        Some((SET_ASIDE_MAP, map)) => Some(save_as_new(path, SET_ASIDE_MAP, map)?),
        Some((name, map)) => {
            let file = path.with_file_name(name);
            save_map(&file, map)?;
            Some(file)
        }
    };
    save_map(path, &maps.map)?;
    Ok(beside)
}

/// Saves a map beside `path`, under the name or, where another map has that, the name with a number.
fn save_as_new(path: &Path, name: &str, map: &SavedMap) -> Result<PathBuf, MapFileError> {
    let (text, stem) = (map_json(map)?, name.trim_end_matches(".json"));
    let (mut file, mut number) = (path.with_file_name(name), 1);
    loop {
        match text_of(&file) {
            Ok(there) if there == text => return Ok(file),
            Err(MapFileError::Io(why)) if why.kind() == io::ErrorKind::NotFound => break,
            _ => number += 1,
        }
        file = path.with_file_name(format!("{stem}_{number}.json"));
    }
    save_map(&file, map)?;
    Ok(file)
}

/// Reads the text of a map file. Fields that are not known here are passed over.
///
/// # Errors
/// When the version is another one, a field is missing or a value cannot be.
pub fn read_map(text: &str) -> Result<SavedMap, MapFileError> {
    let VersionOnly { version } = serde_json::from_str(text)?;
    if version != VERSION {
        return Err(MapFileError::Version { version });
    }
    let file: MapFile = serde_json::from_str(text)?;
    check(&file.objects)?;
    let objects = file.objects.into_iter().map(object).collect::<Result<_, _>>()?;
    Ok(SavedMap { frame_id: file.frame_id, objects })
}

/// What holds for every map file, read or written.
fn check(objects: &[ObjectRecord]) -> Result<(), MapFileError> {
    let mut ids = BTreeSet::new();
    for record in objects {
        let id = record.id;
        if !ids.insert(id) {
            return Err(MapFileError::DuplicateId { id });
        }
        let wrong = checks(record).into_iter().find(|(is_good, ..)| !is_good);
        if let Some((_, field, wanted)) = wrong {
            return Err(MapFileError::BadObject { id, field, wanted });
        }
        covariance_of(record)?;
        pose_of(record)?;
    }
    Ok(())
}

fn covariance_of(record: &ObjectRecord) -> Result<SMatrix<f64, 9, 9>, MapFileError> {
    covariance(&record.covariance).ok_or(MapFileError::BadObject {
        id: record.id,
        field: "covariance",
        wanted: "has to be 81 numbers of a symmetric positive definite matrix",
    })
}

fn pose_of(record: &ObjectRecord) -> Result<Pose, MapFileError> {
    pose_from_xyzw(record.position, record.orientation).ok_or(MapFileError::BadObject {
        id: record.id,
        field: "orientation",
        wanted: "has to be a quaternion of unit length",
    })
}

fn record(object: &SavedObject) -> ObjectRecord {
    let q = object.ellipsoid.pose.rotation;
    // Row-major; nalgebra stores columns.
    let covariance = object.covariance.transpose().as_slice().to_vec();
    ObjectRecord {
        id: object.id,
        label: object.label.clone(),
        name: object.name.clone(),
        locked: object.locked,
        labels: object.labels.clone(),
        existence: object.existence,
        observations: object.observations,
        first_seen: object.first_seen.as_secs(),
        last_seen: object.last_seen.as_secs(),
        position: object.ellipsoid.pose.translation.vector.into(),
        orientation: [q.i, q.j, q.k, q.w],
        semi_axes: object.ellipsoid.semi_axes.into(),
        outline: object.outline,
        support_height: object.support_height_m,
        covariance,
    }
}

fn object(record: ObjectRecord) -> Result<SavedObject, MapFileError> {
    let (covariance, pose) = (covariance_of(&record)?, pose_of(&record)?);
    Ok(SavedObject {
        id: record.id,
        label: record.label,
        name: record.name,
        locked: record.locked,
        labels: proper_belief(record.labels),
        existence: record.existence,
        observations: record.observations,
        first_seen: Stamp::from_secs(record.first_seen),
        last_seen: Stamp::from_secs(record.last_seen),
        ellipsoid: Ellipsoid::new(pose, record.semi_axes.into()),
        outline: record.outline,
        support_height_m: record.support_height,
        covariance,
    })
}

/// Whether each field is as it has to be.
fn checks(record: &ObjectRecord) -> [(bool, &'static str, &'static str); 9] {
    let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
    let positive = |values: &[f64]| finite(values) && values.iter().all(|v| *v > 0.0);
    let near = |values: &[f64], limit: f64| values.iter().all(|v| v.abs() <= limit);
    let probability = |p: &f64| (0.0..=1.0).contains(p);
    let stamps = [record.first_seen, record.last_seen];
    let exponents_fit = match record.outline {
        Outline::Superquadric(e1, e2) => positive(&[e1, e2]) && e1 <= 1.0 && e2 < 2.0,
        Outline::Ellipsoid | Outline::Cuboid | Outline::Cylinder => true,
    };
    let in_order = near(&stamps, MAX_STAMP_S) && stamps[0] <= stamps[1];
    let labels_fit = record.labels.values().all(probability)
        && record.labels.get(&record.label).is_some_and(|p| *p > 0.0);
    let name_fits = record.name.as_ref().is_none_or(|name| checked_name(name).is_ok());
    let support = record.support_height.is_none_or(|height| near(&[height], MAX_PLACE_M));
    let sizes = positive(&record.semi_axes) && near(&record.semi_axes, MAX_SIZE_M);
    [
        (!record.label.is_empty(), "label", "must not be empty"),
        (
            name_fits,
            "name",
            "must not be empty, longer than 255 bytes, or have control characters in it",
        ),
        (labels_fit, "labels", "have to have probabilities between 0 and 1, the label one above 0"),
        (probability(&record.existence), "existence", "has to be between 0 and 1"),
        (in_order, "first_seen", "has to be a time not after last_seen"),
        (near(&record.position, MAX_PLACE_M), "position", "has to be within 100,000 km"),
        (sizes, "semi_axes", "have to be positive and at most 1 km"),
        (
            exponents_fit,
            "outline",
            "has to have exponents above 0, of the profile up to 1 and of the footprint below 2",
        ),
        (support, "support_height", "has to be within 100,000 km"),
    ]
}

/// Northings of UTM are up to 10,000 km, and doubles tell micrometres apart there; farther off is a mistake (m).
const MAX_PLACE_M: f64 = 1e8;
const MAX_SIZE_M: f64 = 1e3;
/// What 64 bits of nanoseconds hold.
const MAX_STAMP_S: f64 = 9.2e9;
/// Variances beyond say nothing at all (rad^2, m^2, 1).
const MAX_VARIANCE: f64 = 1e9;

/// A row-major matrix, made exactly symmetric where it is so up to rounding.
fn covariance(numbers: &[f64]) -> Option<SMatrix<f64, 9, 9>> {
    /// Of the geometric mean of the two variances.
    const ASYMMETRY: f64 = 1e-6;
    if numbers.len() != 81 || !numbers.iter().all(|v| v.abs() <= MAX_VARIANCE) {
        return None;
    }
    let given = SMatrix::<f64, 9, 9>::from_row_slice(numbers);
    let is_symmetric = (0..81).all(|k| {
        let (i, j) = (k / 9, k % 9);
        let scale = (given[(i, i)] * given[(j, j)]).abs().sqrt();
        (given[(i, j)] - given[(j, i)]).abs() <= ASYMMETRY * scale
    });
    let symmetric = (given + given.transpose()) * 0.5;
    (is_symmetric && symmetric.cholesky().is_some()).then_some(symmetric)
}
