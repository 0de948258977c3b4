//! The map file, `map.json`.

use crate::{geometry::Outline, mapping::MapObject};
use serde::Serialize;
use std::collections::BTreeMap;

/// The format's version; readers refuse others.
const VERSION: u32 = 1;

#[derive(Serialize)]
struct MapFile<'a> {
    version: u32,
    frame_id: &'a str,
    objects: Vec<ObjectRecord<'a>>,
}

/// An object as the file has it: metres, seconds, quaternion xyzw.
#[derive(Serialize)]
struct ObjectRecord<'a> {
    id: u64,
    label: &'a str,
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

/// The text of a map file with these objects.
///
/// # Errors
/// When a number is not finite, which would be a bug of the estimation.
pub fn map_json<'a>(
    objects: impl IntoIterator<Item = &'a MapObject>,
    frame_id: &str,
) -> serde_json::Result<String> {
    let objects = objects.into_iter().map(record).collect();
    let mut text = serde_json::to_string_pretty(&MapFile { version: VERSION, frame_id, objects })?;
    text.push('\n');
    Ok(text)
}

fn record(object: &MapObject) -> ObjectRecord<'_> {
    let ellipsoid = object.ellipsoid();
    let q = ellipsoid.pose.rotation;
    // Row-major; nalgebra stores columns.
    let covariance = object.covariance().transpose().as_slice().to_vec();
    ObjectRecord {
        id: object.id.0,
        label: object.label(),
        labels: object.labels(),
        existence: object.existence(),
        observations: object.observations,
        first_seen: object.first_seen.as_secs(),
        last_seen: object.last_seen.as_secs(),
        position: ellipsoid.pose.translation.vector.into(),
        orientation: [q.i, q.j, q.k, q.w],
        semi_axes: ellipsoid.semi_axes.into(),
        outline: object.outline,
        support_height: object.support_height_m,
        covariance,
    }
}
