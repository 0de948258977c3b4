//! Maps: what is saved, and the file it is saved in.

use crate::{
    arguments::{PoseParts, parts, pose_of_matrix},
    errors,
};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, pose_from_xyzw},
    io,
    mapping::{SavedMap, SavedObject},
    nalgebra::SMatrix,
    time::Stamp,
};
use pyo3::{
    Bound, FromPyObject, IntoPyObject, PyAny, PyResult, Python, pyfunction, types::PyAnyMethods,
};
use std::{collections::BTreeMap, path::PathBuf};

/// The fields of `ellipsoid_slam.MapObject`, both ways.
#[derive(FromPyObject, IntoPyObject)]
pub(crate) struct ObjectRecord {
    id: u64,
    label: String,
    labels: BTreeMap<String, f64>,
    existence: f64,
    observations: u32,
    first_seen_ns: i64,
    last_seen_ns: i64,
    position: [f64; 3],
    orientation: [f64; 4],
    semi_axes: [f64; 3],
    outline: String,
    /// Of the profile and the footprint, for a superquadric.
    exponents: Option<(f64, f64)>,
    support_height_m: Option<f64>,
    /// Row by row.
    #[pyo3(from_py_with = row_by_row)]
    covariance: Vec<f64>,
    name: Option<String>,
    locked: bool,
}

/// The numbers of an array of numpy.
fn row_by_row(array: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    array.call_method0("ravel")?.call_method0("tolist")?.extract()
}

/// The fields of `ellipsoid_slam.ObjectMap`, both ways.
#[derive(FromPyObject, IntoPyObject)]
pub(crate) struct MapRecord {
    frame_id: String,
    objects: Vec<ObjectRecord>,
}

impl From<&SavedObject> for ObjectRecord {
    fn from(object: &SavedObject) -> Self {
        let (position, orientation) = parts(&object.ellipsoid.pose);
        let (outline, exponents) = match object.outline {
            Outline::Ellipsoid => ("ellipsoid", None),
            Outline::Cuboid => ("cuboid", None),
            Outline::Cylinder => ("cylinder", None),
            Outline::Superquadric(profile, footprint) => {
                ("superquadric", Some((profile, footprint)))
            }
        };
        Self {
            id: object.id,
            label: object.label.clone(),
            labels: object.labels.clone(),
            existence: object.existence,
            observations: object.observations,
            first_seen_ns: object.first_seen.as_nanos(),
            last_seen_ns: object.last_seen.as_nanos(),
            position,
            orientation,
            semi_axes: object.ellipsoid.semi_axes.into(),
            outline: outline.to_owned(),
            exponents,
            support_height_m: object.support_height_m,
            // nalgebra stores columns.
            covariance: object.covariance.transpose().as_slice().to_vec(),
            name: object.name.clone(),
            locked: object.locked,
        }
    }
}

impl From<&SavedMap> for MapRecord {
    fn from(map: &SavedMap) -> Self {
        Self {
            frame_id: map.frame_id.clone(),
            objects: map.objects.iter().map(ObjectRecord::from).collect(),
        }
    }
}

impl ObjectRecord {
    fn saved(self) -> PyResult<SavedObject> {
        let Self { id, .. } = self;
        let wrong = |what: &str| errors::map(format!("object {id}: {what}"));
        let outline = match (self.outline.as_str(), self.exponents) {
            ("ellipsoid", None) => Outline::Ellipsoid,
            ("cuboid", None) => Outline::Cuboid,
            ("cylinder", None) => Outline::Cylinder,
            ("superquadric", Some((profile, footprint))) => {
                Outline::Superquadric(profile, footprint)
            }
            _ => {
                return Err(wrong(
                    "outline has to be ellipsoid, cuboid, cylinder, or superquadric with exponents",
                ));
            }
        };
        let pose = pose_from_xyzw(self.position, self.orientation)
            .ok_or_else(|| wrong("orientation has to be a quaternion of unit length"))?;
        if !self.semi_axes.iter().all(|axis| axis.is_finite() && *axis > 0.0) {
            return Err(wrong("semi_axes have to be positive"));
        }
        if self.covariance.len() != 81 {
            return Err(wrong("covariance has to be a matrix of 9 x 9"));
        }
        Ok(SavedObject {
            id,
            label: self.label,
            name: self.name,
            locked: self.locked,
            labels: self.labels,
            existence: self.existence,
            observations: self.observations,
            first_seen: Stamp::from_nanos(self.first_seen_ns),
            last_seen: Stamp::from_nanos(self.last_seen_ns),
            ellipsoid: Ellipsoid::new(pose, self.semi_axes.into()),
            outline,
            support_height_m: self.support_height_m,
            covariance: SMatrix::from_row_slice(&self.covariance),
        })
    }
}

impl MapRecord {
    pub(crate) fn saved(self) -> PyResult<SavedMap> {
        let objects = self.objects.into_iter().map(ObjectRecord::saved).collect::<PyResult<_>>()?;
        Ok(SavedMap { frame_id: self.frame_id, objects })
    }
}

/// The text of a map file.
#[pyfunction]
pub(crate) fn map_json(map: MapRecord) -> PyResult<String> {
    io::map_json(&map.saved()?).map_err(errors::map)
}

/// Writes a map file, whole or not at all.
#[pyfunction]
pub(crate) fn write_map(py: Python<'_>, path: PathBuf, map: MapRecord) -> PyResult<()> {
    let map = map.saved()?;
    py.detach(|| io::save_map(&path, &map).map_err(|why| errors::map_file(&path, &why)))
}

/// A map from the text of a file.
#[pyfunction]
pub(crate) fn parse_map(text: &str) -> PyResult<MapRecord> {
    Ok((&io::read_map(text).map_err(errors::map)?).into())
}

/// A map from a file.
#[pyfunction]
pub(crate) fn read_map(py: Python<'_>, path: PathBuf) -> PyResult<MapRecord> {
    // Who gives a link means what it points to.
    let file = std::fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
    let map = py.detach(|| io::load_saved_map(&file));
    Ok((&map.map_err(|why| errors::map_file(&path, &why))?).into())
}

/// Position and quaternion of a matrix of 4 x 4.
#[pyfunction]
pub(crate) fn pose_from_matrix(rows: [[f64; 4]; 4]) -> PyResult<PoseParts> {
    Ok(parts(&pose_of_matrix(&rows)?))
}
