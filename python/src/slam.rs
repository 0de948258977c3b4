//! A run behind a lock: calls of several threads come one after the other, and none keeps the interpreter waiting.

use crate::{
    arguments::{BoxArgument, CameraArgument, DepthArgument, PoseArgument, detections},
    errors,
    map::{MapRecord, ObjectRecord},
    run::{LatestPose, Run, StampedPose},
    settings::SettingsArgument,
    update::UpdateRecord,
};
use ellipsoid_slam::{
    geometry::{Camera, Pose},
    pipeline::{
        CameraMessage, CameraRole, DepthMessage, DetectionsMessage, Input, OdometryMessage,
        RgbdFrame, StampedTransform,
    },
    time::Stamp,
};
use pyo3::{FromPyObject, PyResult, Python, pyclass, pymethods};
use std::{
    path::PathBuf,
    sync::{Mutex, PoisonError},
};

/// What `ellipsoid_slam.ObjectSlam` holds.
#[pyclass(frozen, module = "ellipsoid_slam._native")]
pub(crate) struct Slam {
    run: Mutex<Run>,
}

/// A frame and its child.
#[derive(FromPyObject)]
struct Frames(String, String);

/// A camera and `odom_from_camera`.
#[derive(FromPyObject)]
struct View(CameraArgument, PoseArgument);

impl Slam {
    pub(crate) fn of(run: Run) -> Self {
        Self { run: Mutex::new(run) }
    }

    /// Works on the run without the interpreter. A panic in it is a bug, and one that does not lock the others out.
    fn with<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut Run) -> T + Send) -> T {
        py.detach(|| work(&mut self.run.lock().unwrap_or_else(PoisonError::into_inner)))
    }

    fn hear(&self, py: Python<'_>, input: Input) -> UpdateRecord {
        self.with(py, |run| (&run.handle(input)).into())
    }
}

#[pymethods]
impl Slam {
    #[new]
    fn new(
        settings: SettingsArgument,
        map: Option<MapRecord>,
        start: Option<[f64; 3]>,
    ) -> PyResult<Self> {
        let map = map.map(MapRecord::saved).transpose()?;
        Ok(Self::of(Run::new(settings.parameters()?, map, start)?))
    }

    /// A frame with its pose and its boxes.
    fn see(
        &self,
        py: Python<'_>,
        stamp_ns: i64,
        view: View,
        depth: DepthArgument,
        boxes: Vec<BoxArgument>,
    ) -> PyResult<UpdateRecord> {
        let (camera, pose) = (Camera::try_from(view.0)?, Pose::try_from(view.1)?);
        let boxes = detections(boxes)?;
        depth.check_size(&camera)?;
        let update = self.with(py, |run| {
            let stamp = Stamp::from_nanos(stamp_ns);
            let frame = RgbdFrame::new(stamp, &camera, &pose, &depth.metres());
            frame.map(|frame| run.see(frame.with_boxes(boxes)))
        });
        Ok((&update.map_err(errors::frame)?).into())
    }

    /// A camera's calibration.
    fn add_camera(
        &self,
        py: Python<'_>,
        stamp_ns: i64,
        camera: CameraArgument,
        frame_id: String,
        is_depth: bool,
    ) -> PyResult<UpdateRecord> {
        let role = if is_depth { CameraRole::Depth } else { CameraRole::Color };
        let (stamp, camera) = (Stamp::from_nanos(stamp_ns), Camera::try_from(camera)?);
        Ok(self.hear(py, Input::Camera(CameraMessage { role, stamp, frame_id, camera })))
    }

    /// A reading of odometry, and its covariance as `nav_msgs/Odometry` has it.
    fn add_odometry(
        &self,
        py: Python<'_>,
        stamp_ns: i64,
        odom_from_base: PoseArgument,
        frames: Frames,
        covariance: Option<[f64; 36]>,
    ) -> PyResult<UpdateRecord> {
        let reading = OdometryMessage {
            stamp: Stamp::from_nanos(stamp_ns),
            frame_id: frames.0,
            child_frame_id: frames.1,
            odom_from_base: odom_from_base.try_into()?,
            covariance: covariance.map(Box::new),
        };
        Ok(self.hear(py, Input::Odometry(reading)))
    }

    /// A transform, for all time or for its stamp.
    fn add_transform(
        &self,
        py: Python<'_>,
        stamp_ns: i64,
        parent_from_child: PoseArgument,
        frames: Frames,
        is_static: bool,
    ) -> PyResult<UpdateRecord> {
        let transform = StampedTransform {
            stamp: Stamp::from_nanos(stamp_ns),
            frame_id: frames.0,
            child_frame_id: frames.1,
            parent_from_child: parent_from_child.try_into()?,
        };
        Ok(self.hear(py, Input::Transforms { is_static, transforms: vec![transform] }))
    }

    /// A depth image.
    fn add_depth(
        &self,
        py: Python<'_>,
        stamp_ns: i64,
        depth: DepthArgument,
        frame_id: String,
    ) -> PyResult<UpdateRecord> {
        let image = py.detach(|| depth.image());
        let (stamp, image) = (Stamp::from_nanos(stamp_ns), image.map_err(errors::frame)?);
        Ok(self.hear(py, Input::Depth(DepthMessage { stamp, frame_id, image })))
    }

    /// The boxes of one image.
    fn add_boxes(
        &self,
        py: Python<'_>,
        stamp_ns: i64,
        boxes: Vec<BoxArgument>,
        frame_id: String,
    ) -> PyResult<UpdateRecord> {
        let (stamp, detections) = (Stamp::from_nanos(stamp_ns), detections(boxes)?);
        Ok(self.hear(py, Input::Detections(DetectionsMessage { stamp, frame_id, detections })))
    }

    /// Works off what waits.
    fn finish(&self, py: Python<'_>) -> UpdateRecord {
        self.with(py, |run| (&run.finish()).into())
    }

    fn objects(&self, py: Python<'_>) -> Vec<ObjectRecord> {
        self.with(py, |run| run.objects())
    }

    /// What `map.json` would be now.
    fn map(&self, py: Python<'_>) -> MapRecord {
        self.with(py, |run| (&run.maps().map).into())
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<Option<PathBuf>> {
        self.with(py, |run| run.save(&path))
    }

    fn waits_because(&self, py: Python<'_>) -> Option<String> {
        self.with(py, |run| run.waits_because())
    }

    fn trajectory(&self, py: Python<'_>) -> Vec<StampedPose> {
        self.with(py, |run| run.trajectory())
    }

    fn latest_pose(&self, py: Python<'_>) -> Option<LatestPose> {
        self.with(py, |run| run.latest_pose())
    }
}
