//! The files of a replay.

use super::Failure;
use crate::{
    geometry::Pose,
    io::{BagError, BagWriter, map_json, trajectory_text, write_atomically},
    mapping::{MapObject, SavedMap},
    msg::{
        convert::{detections_3d, object_markers, odometry_message, path, tf_message},
        tf2_msgs::TFMessage,
    },
    pipeline::{FramePose, Input, Keyframe, ObjectSlam, OdometryMessage, StampedTransform},
    time::Stamp,
};
use anyhow::Context;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// Everything a replay writes into its folder.
const FILES: [&str; 7] = [
    "map.json",
    LOCAL_MAP,
    "trajectory.tum",
    "trajectory_live.tum",
    "result.mcap",
    "timing.csv",
    "summary.json",
];

/// What was seen when the place in the saved map was not recognised.
const LOCAL_MAP: &str = "local_map.json";

/// Frame of the map.
pub(super) const MAP_FRAME: &str = "map";

/// The output of a replay on its way to the disk: nothing has its final name before everything is there.
pub(super) struct Results {
    folder: PathBuf,
    bag: BagWriter,
    poses: Vec<FramePose>,
    path_length_written: usize,
    children: BTreeSet<String>,
}

/// Refuses to overwrite an earlier result.
pub(super) fn check_overwrite(folder: &Path, force: bool) -> Result<(), Failure> {
    match FILES.iter().map(|name| folder.join(name)).find(|file| file.exists()) {
        Some(file) if !force => Err(Failure::Usage(format!(
            "{} exists already; give another folder with --output, or --force to overwrite",
            file.display()
        ))),
        _ => Ok(()),
    }
}

impl Results {
    /// Prepares the folder; the bag grows under a temporary name.
    pub(super) fn create(folder: &Path) -> anyhow::Result<Self> {
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot create the folder {}", folder.display()))?;
        Ok(Self {
            folder: folder.to_owned(),
            bag: BagWriter::create(&folder.join("result.mcap"))?,
            poses: Vec::new(),
            path_length_written: 0,
            children: BTreeSet::new(),
        })
    }

    /// Transforms of the bag are passed on, so that the result can be looked at without the bag.
    pub(super) fn pass_on(&mut self, input: &Input) -> Result<(), BagError> {
        let Input::Transforms { is_static, transforms } = input else { return Ok(()) };
        let Some(stamp) = transforms.iter().map(|t| t.stamp).max() else { return Ok(()) };
        self.children.extend(transforms.iter().map(|t| t.child_frame_id.clone()));
        let topic = if *is_static { "/tf_static" } else { "/tf" };
        self.bag.write(topic, &tf_message(transforms), stamp)
    }

    /// Where the base was.
    pub(super) fn pose(
        &mut self,
        pose: &FramePose,
        odom_frame: &str,
        base_frame: &str,
    ) -> Result<(), BagError> {
        self.poses.push(*pose);
        let transform = |frame_id: &str, child: &str, parent_from_child: Pose| StampedTransform {
            stamp: pose.stamp,
            frame_id: frame_id.into(),
            child_frame_id: child.into(),
            parent_from_child,
        };
        let map_from_odom = pose.map_from_base * pose.odom_from_base.inverse();
        let mut transforms = vec![transform(MAP_FRAME, odom_frame, map_from_odom)];
        if !self.children.contains(base_frame) {
            transforms.push(transform(odom_frame, base_frame, pose.odom_from_base));
        }
        let message: TFMessage = tf_message(&transforms);
        self.bag.write("/tf", &message, pose.stamp)?;
        let reading = OdometryMessage {
            stamp: pose.stamp,
            frame_id: MAP_FRAME.into(),
            child_frame_id: base_frame.into(),
            odom_from_base: pose.map_from_base,
            covariance: None,
        };
        self.bag.write("/ellipsoid_slam/odometry", &odometry_message(&reading), pose.stamp)?;
        // A path grows with the drive: written at every pose it would grow with its square.
        if self.poses.len() >= self.path_length_written + self.path_length_written / 4 + 10 {
            self.write_path(pose.stamp)?;
        }
        Ok(())
    }

    /// Stamp of the latest pose.
    pub(super) fn latest(&self) -> Option<Stamp> {
        self.poses.last().map(|pose| pose.stamp)
    }

    /// The poses as they were published at the time.
    fn live(&self) -> Vec<(Stamp, Pose)> {
        self.poses.iter().map(|pose| (pose.stamp, pose.map_from_base)).collect()
    }

    fn write_path(&mut self, stamp: Stamp) -> Result<(), BagError> {
        self.path_length_written = self.poses.len();
        let message = path(&self.live(), stamp, MAP_FRAME);
        self.bag.write("/ellipsoid_slam/path", &message, stamp)
    }

    /// What changed in the map: markers of the objects that this keyframe saw, and all boxes.
    pub(super) fn keyframe(
        &mut self,
        keyframe: &Keyframe,
        slam: &ObjectSlam,
    ) -> Result<(), BagError> {
        let seen: BTreeSet<_> = keyframe.boxes.iter().filter_map(|b| b.object).collect();
        let objects: Vec<&MapObject> = slam.objects().collect();
        let changed = objects.iter().copied().filter(|o| seen.contains(&o.id));
        let markers = object_markers(changed, keyframe.stamp, MAP_FRAME);
        if !markers.markers.is_empty() {
            self.bag.write("/ellipsoid_slam/markers", &markers, keyframe.stamp)?;
        }
        let boxes = detections_3d(objects, keyframe.stamp, MAP_FRAME);
        self.bag.write("/ellipsoid_slam/objects", &boxes, keyframe.stamp)
    }

    /// Writes all files.
    pub(super) fn finish(
        mut self,
        slam: &ObjectSlam,
        timing_csv: &str,
        summary_json: &str,
    ) -> anyhow::Result<()> {
        let poses = self.poses.iter().map(|pose| (pose.stamp, slam.map_from_base(pose)));
        let trajectory: Vec<(Stamp, Pose)> = poses.collect();
        if let Some((stamp, _)) = trajectory.last().copied() {
            self.bag.write("/ellipsoid_slam/path", &path(&trajectory, stamp, MAP_FRAME), stamp)?;
            let markers = object_markers(slam.objects(), stamp, MAP_FRAME);
            self.bag.write("/ellipsoid_slam/markers", &markers, stamp)?;
        }
        let seen = SavedMap::of(slam.objects(), MAP_FRAME);
        let mut texts = match slam.waiting() {
            None => vec![("map.json", map_json(&seen)?)],
            Some(waiting) => {
                let local = SavedMap { frame_id: "local_map".into(), ..seen };
                vec![("map.json", map_json(waiting.saved())?), (LOCAL_MAP, map_json(&local)?)]
            }
        };
        texts.extend([
            ("trajectory.tum", trajectory_text(&trajectory)),
            ("trajectory_live.tum", trajectory_text(&self.live())),
            ("timing.csv", timing_csv.to_owned()),
            ("summary.json", summary_json.to_owned()),
        ]);
        self.bag.finish()?;
        if slam.waiting().is_none() {
            // Of an earlier replay into the same folder; fails where there is none.
            let _ = fs::remove_file(self.folder.join(LOCAL_MAP));
        }
        for (name, text) in texts {
            let path = self.folder.join(name);
            write_atomically(&path, text.as_bytes())
                .with_context(|| format!("cannot write {}", path.display()))?;
        }
        Ok(())
    }
}
