//! A run: the method, its way so far, and what Python asks of both.

use crate::{
    arguments::{PoseParts, parts},
    errors,
    map::ObjectRecord,
};
use ellipsoid_slam::{
    config::Parameters,
    io::save_maps,
    mapping::{SavedMap, SavedObject},
    pipeline::{FramePose, Input, MapsToSave, ObjectSlam, RgbdFrame, StartPose, Update},
};
use pyo3::PyResult;
use std::path::{Path, PathBuf};

/// A run and where the base was.
pub(crate) struct Run {
    slam: ObjectSlam,
    poses: Vec<FramePose>,
    map_frame: String,
}

/// Stamp (ns) and pose of the base in the map.
pub(crate) type StampedPose = (i64, PoseParts);
/// The same with the covariance of `[rotation, translation]`, row by row.
pub(crate) type LatestPose = (i64, PoseParts, Option<Vec<f64>>);

impl Run {
    /// With an empty map, or with one that is continued and that the base is in at about `start` = x, y (m), yaw (deg).
    pub(crate) fn new(
        parameters: Parameters,
        map: Option<SavedMap>,
        start: Option<[f64; 3]>,
    ) -> PyResult<Self> {
        let settings = parameters.slam;
        let slam = match map {
            None if start.is_some() => return Err(errors::settings("start is of a map: give one")),
            None => ObjectSlam::new(settings),
            Some(map) => ObjectSlam::continuing(settings, map, start_pose(start)?),
        };
        Ok(Self { slam, poses: Vec::new(), map_frame: parameters.node.map_frame })
    }

    pub(crate) fn see(&mut self, frame: RgbdFrame) -> Update {
        let update = self.slam.see(frame);
        self.noted(update)
    }

    pub(crate) fn handle(&mut self, input: Input) -> Update {
        let update = self.slam.handle(input, &mut ());
        self.noted(update)
    }

    pub(crate) fn finish(&mut self) -> Update {
        let update = self.slam.finish(&mut ());
        self.noted(update)
    }

    fn noted(&mut self, update: Update) -> Update {
        self.poses.extend(&update.poses);
        update
    }

    pub(crate) fn objects(&self) -> Vec<ObjectRecord> {
        self.slam.objects().map(|object| (&SavedObject::from(object)).into()).collect()
    }

    pub(crate) fn maps(&self) -> MapsToSave {
        self.slam.maps(&self.map_frame)
    }

    /// Saves what [`Run::maps`] says; the file beside, if there is one.
    pub(crate) fn save(&self, path: &Path) -> PyResult<Option<PathBuf>> {
        save_maps(path, &self.maps()).map_err(|why| errors::map_file(path, &why))
    }

    /// Why the place in the saved map is not known yet.
    pub(crate) fn waits_because(&self) -> Option<String> {
        self.slam.waiting().map(|waiting| waiting.why().to_string())
    }

    /// After all that is known now.
    pub(crate) fn trajectory(&self) -> Vec<StampedPose> {
        let pose = |p: &FramePose| (p.stamp.as_nanos(), parts(&self.slam.map_from_base(p)));
        self.poses.iter().map(pose).collect()
    }

    pub(crate) fn latest_pose(&self) -> Option<LatestPose> {
        let latest = self.poses.last()?;
        let covariance = self.slam.covariance(latest);
        // nalgebra stores columns.
        let covariance = covariance.map(|own| own.transpose().as_slice().to_vec());
        Some((latest.stamp.as_nanos(), parts(&self.slam.map_from_base(latest)), covariance))
    }
}

fn start_pose(start: Option<[f64; 3]>) -> PyResult<Option<ellipsoid_slam::geometry::Pose>> {
    let Some([x, y, yaw_deg]) = start else { return Ok(None) };
    let start: StartPose = format!("{x},{y},{yaw_deg}").parse().map_err(errors::settings)?;
    Ok(start.map_from_base())
}
