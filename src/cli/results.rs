//! The files of a replay.

use super::{Failure, annotated, report};
use crate::{
    config::NodeSettings,
    geometry::Pose,
    io::{BagError, BagWriter, map_json, trajectory_text, write_atomically},
    mapping::SavedMap,
    msg::{convert::tf_message, sensor_msgs::CompressedImage},
    pipeline::{FramePose, Input, ObjectSlam, Update},
    publication::{Outgoing, OutputTopic, Publication, base_transform},
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
    publication: Publication,
    map_frame: String,
    children: BTreeSet<String>,
}

/// What the results say, for who shows it.
pub(super) struct Finished {
    /// The map that was made, in a frame of its own if the place in the saved one was not recognised.
    pub(super) map: SavedMap,
    /// The base after all optimisation.
    pub(super) trajectory: Vec<(Stamp, Pose)>,
}

/// Refuses to overwrite an earlier result.
pub(super) fn check_overwrite(folder: &Path, force: bool) -> Result<(), Failure> {
    match FILES
        .iter()
        .chain(&report::FILES)
        .map(|name| folder.join(name))
        .find(|file| file.exists())
    {
        Some(file) if !force => Err(Failure::Usage(format!(
            "{} exists already; give another folder with --output, or --force to overwrite",
            file.display()
        ))),
        _ => Ok(()),
    }
}

impl Results {
    /// Prepares the folder; the bag grows under a temporary name.
    pub(super) fn create(folder: &Path, node: &NodeSettings) -> anyhow::Result<Self> {
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot create the folder {}", folder.display()))?;
        let mut bag = BagWriter::create(&folder.join("result.mcap"))?;
        let latched = OutputTopic::ALL.into_iter().filter(|topic| topic.is_latched());
        latched.for_each(|topic| bag.latch(topic.default_name()));
        Ok(Self {
            folder: folder.to_owned(),
            bag,
            poses: Vec::new(),
            publication: Publication::new(node.publish, &node.map_frame),
            map_frame: node.map_frame.clone(),
            children: BTreeSet::new(),
        })
    }

    /// Transforms of the bag are passed on, so that the result can be looked at without the bag.
    pub(super) fn pass_on(&mut self, input: &Input) -> Result<(), BagError> {
        self.publication.hear(input);
        let Input::Transforms { is_static, transforms } = input else { return Ok(()) };
        let Some(stamp) = transforms.iter().map(|t| t.stamp).max() else { return Ok(()) };
        self.children.extend(transforms.iter().map(|t| t.child_frame_id.clone()));
        let topic = if *is_static { "/tf_static" } else { "/tf" };
        self.bag.write(topic, &tf_message(transforms), stamp)
    }

    /// What a live node would publish now.
    pub(super) fn take(&mut self, update: &Update, slam: &ObjectSlam) -> anyhow::Result<()> {
        for pose in &update.poses {
            self.poses.push(*pose);
            if !self.children.contains(slam.frames().1) {
                let message = tf_message(&[base_transform(pose, slam)]);
                self.bag.write("/tf", &message, pose.stamp)?;
            }
        }
        let out = self.publication.update(update, slam);
        self.write(&out)
    }

    fn write(&mut self, messages: &[(Stamp, Outgoing)]) -> anyhow::Result<()> {
        for (stamp, message) in messages {
            let topic = message.topic().default_name();
            let (type_name, data) = message.cdr()?;
            self.bag.write_raw(&topic, type_name, &data, *stamp)?;
        }
        Ok(())
    }

    /// An image with boxes and outlines drawn into it.
    pub(super) fn annotated(
        &mut self,
        stamp: Stamp,
        image: &CompressedImage,
    ) -> anyhow::Result<()> {
        Ok(self.bag.write(annotated::TOPIC, image, stamp)?)
    }

    /// Stamp of the latest pose.
    pub(super) fn latest(&self) -> Option<Stamp> {
        self.poses.last().map(|pose| pose.stamp)
    }

    /// The poses as they were published at the time.
    fn live(&self) -> Vec<(Stamp, Pose)> {
        self.poses.iter().map(|pose| (pose.stamp, pose.map_from_base)).collect()
    }

    /// Writes all files.
    pub(super) fn finish(
        mut self,
        slam: &ObjectSlam,
        timing_csv: &str,
        summary_json: &str,
    ) -> anyhow::Result<Finished> {
        let poses = self.poses.iter().map(|pose| (pose.stamp, slam.map_from_base(pose)));
        let trajectory: Vec<(Stamp, Pose)> = poses.collect();
        let last = self.publication.finish(slam);
        self.write(&last)?;
        let frame = if slam.waiting().is_some() { "local_map" } else { &self.map_frame };
        let map = SavedMap::of(slam.objects(), frame);
        let mut texts = match slam.waiting() {
            None => vec![("map.json", map_json(&map)?)],
            Some(waiting) => {
                vec![("map.json", map_json(waiting.saved())?), (LOCAL_MAP, map_json(&map)?)]
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
        Ok(Finished { map, trajectory })
    }
}
