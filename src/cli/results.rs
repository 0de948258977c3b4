//! The files of a replay.

use super::{Failure, annotated::Annotated, report};
use crate::{
    config::NodeSettings,
    geometry::Pose,
    io::{BagWriter, disk_problem, map_json, trajectory_text, write_atomically},
    mapping::SavedMap,
    msg::convert::{header, point_cloud, tf_message},
    pipeline::{
        FramePose, Input, LOCAL_MAP, MAX_FRAMES, MapsToSave, ObjectSlam, SET_ASIDE_MAP, Update,
    },
    publication::{Outgoing, OutputTopic, Publication, Room, base_transform},
    report::Placed,
    time::Stamp,
};
use anyhow::{Context, anyhow};
use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
};

/// Everything a replay writes into its folder.
const FILES: [&str; 8] = [
    "map.json",
    LOCAL_MAP,
    SET_ASIDE_MAP,
    "trajectory.tum",
    "trajectory_live.tum",
    "result.mcap",
    "timing.csv",
    "summary.json",
];

/// Coloured points of what was seen.
const POINTS: &str = "/ellipsoid_slam/points";

/// Frame of the map.
pub(super) const MAP_FRAME: &str = "map";

/// The output of a replay on its way to the disk. Each file gets its name when it is whole; the map comes first.
pub(super) struct Results {
    folder: PathBuf,
    /// `result.mcap`, or why there will be none: the map is worth more.
    bag: Result<BagWriter, anyhow::Error>,
    poses: Vec<FramePose>,
    publication: Publication,
    room: Room,
    map_frame: String,
    children: BTreeSet<String>,
}

/// What the results say, for who shows it.
pub(super) struct Finished {
    /// The map that was made, in a frame of its own if the place in the saved one was not recognised.
    pub(super) map: SavedMap,
    /// The base after all optimisation.
    pub(super) trajectory: Vec<(Stamp, Pose)>,
    /// Whether all files could be written.
    pub(super) complete: anyhow::Result<()>,
}

/// Refuses to overwrite an earlier result.
pub(super) fn check_overwrite(folder: &Path, force: bool) -> Result<(), Failure> {
    let own = FILES.iter().map(|name| folder.join(name));
    match own.chain(report::files(folder)).find(|file| file.exists()) {
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
        bag.latch(POINTS.into());
        Ok(Self {
            folder: folder.to_owned(),
            bag: Ok(bag),
            poses: Vec::new(),
            publication: Publication::new(node),
            room: Room::default(),
            map_frame: node.map_frame.clone(),
            children: BTreeSet::new(),
        })
    }

    /// Transforms of the bag are passed on, so that the result can be looked at without the bag.
    pub(super) fn pass_on(&mut self, input: &Input) {
        self.publication.hear(input);
        let Input::Transforms { is_static, transforms } = input else { return };
        let Some(stamp) = transforms.iter().map(|t| t.stamp).max() else { return };
        for child in transforms.iter().map(|t| &t.child_frame_id) {
            if self.children.len() < MAX_FRAMES && !self.children.contains(child) {
                self.children.insert(child.clone());
            }
        }
        let topic = if *is_static { "/tf_static" } else { "/tf" };
        self.write(|bag| Ok(bag.write(topic, &tf_message(transforms), stamp)?));
    }

    /// What a live node would publish now.
    pub(super) fn take(&mut self, update: &Update, slam: &ObjectSlam) {
        for pose in &update.poses {
            self.poses.push(*pose);
            if !self.children.contains(slam.frames().1) {
                let message = tf_message(&[base_transform(pose, slam)]);
                self.write(|bag| Ok(bag.write("/tf", &message, pose.stamp)?));
            }
        }
        let out = self.publication.update(update, slam);
        self.write_messages(&out, false);
    }

    /// Writes messages for which there is room, or all.
    fn write_messages(&mut self, messages: &[(Stamp, Outgoing)], all: bool) {
        for (stamp, message) in messages {
            let topic = message.topic();
            match message.cdr() {
                Ok((type_name, data)) => {
                    if self.room.takes(topic, data.len(), *stamp) || all {
                        let name = topic.default_name();
                        self.write(|bag| Ok(bag.write_raw(&name, type_name, &data, *stamp)?));
                    }
                }
                Err(why) => self.write(|_| Err(why.into())),
            }
        }
    }

    /// Writes into the bag, as long as that works. A bag that is given up leaves its room to the map.
    fn write(&mut self, to: impl FnOnce(&mut BagWriter) -> anyhow::Result<()>) {
        if let Ok(bag) = &mut self.bag
            && let Err(why) = to(bag)
        {
            self.bag = Err(why);
        }
    }

    /// An image with what is known of it.
    pub(super) fn annotated(&mut self, image: &Annotated) {
        self.write(|bag| Ok(image.write(bag)?));
    }

    /// What was seen, as coloured points in the map.
    pub(super) fn points(&mut self, points: &Placed) {
        let (Some(stamp), points) = (self.latest(), points.colored()) else { return };
        if !points.is_empty() {
            let cloud = point_cloud(header(stamp, &self.map_frame), points);
            self.write(|bag| Ok(bag.write(POINTS, &cloud, stamp)?));
        }
    }

    /// Stamp of the latest pose.
    pub(super) fn latest(&self) -> Option<Stamp> {
        self.poses.last().map(|pose| pose.stamp)
    }

    /// The poses as they were published at the time.
    fn live(&self) -> Vec<(Stamp, Pose)> {
        self.poses.iter().map(|pose| (pose.stamp, pose.map_from_base)).collect()
    }

    /// Writes all files that can be written, the map before all others.
    ///
    /// # Errors
    /// When the map has no text, which would be a bug. What could not be written is in [`Finished::complete`].
    pub(super) fn finish(
        mut self,
        slam: &ObjectSlam,
        timing_csv: &str,
        summary_json: &str,
    ) -> anyhow::Result<Finished> {
        let last = self.publication.finish(slam);
        self.write_messages(&last, true);
        let poses = self.poses.iter().map(|pose| (pose.stamp, slam.map_from_base(pose)));
        let trajectory: Vec<(Stamp, Pose)> = poses.collect();
        let maps = slam.maps(&self.map_frame);
        let mut texts = self.maps(&maps)?;
        texts.extend([
            ("trajectory.tum", trajectory_text(&trajectory)),
            ("trajectory_live.tum", trajectory_text(&self.live())),
            ("timing.csv", timing_csv.to_owned()),
            ("summary.json", summary_json.to_owned()),
        ]);
        let mut failures = Vec::new();
        for (name, text) in texts {
            let path = self.folder.join(name);
            if let Err(why) = self.write_text(&path, &text) {
                let why = disk_problem(&why);
                failures.push(anyhow!("{} cannot be written: {why}", path.display()));
            }
        }
        let bag = self.bag.and_then(|bag| Ok(bag.finish()?));
        failures.extend(bag.err());
        let missing = format!("the results in {} are not complete", self.folder.display());
        let complete = match failures.into_iter().next() {
            None => Ok(()),
            Some(first) => Err(first.context(missing)),
        };
        // What was seen, in a frame of its own where the place in the saved map was not recognised.
        let map = match maps.beside {
            Some((LOCAL_MAP, seen)) => seen,
            _ => maps.map,
        };
        Ok(Finished { map, trajectory, complete })
    }

    /// Writes a text; where there is no room, in that of the unfinished bag.
    fn write_text(&mut self, path: &Path, text: &str) -> io::Result<()> {
        let written = write_atomically(path, text.as_bytes());
        match written {
            Err(why) if why.kind() == io::ErrorKind::StorageFull && self.bag.is_ok() => {
                let bag = self.folder.join("result.mcap");
                let why = disk_problem(&why);
                self.bag = Err(anyhow!("{} cannot be written: {why}", bag.display()));
                write_atomically(path, text.as_bytes())
            }
            written => written,
        }
    }

    /// The map, and the one beside it where there are two.
    fn maps(&self, maps: &MapsToSave) -> anyhow::Result<Vec<(&'static str, String)>> {
        for other in [LOCAL_MAP, SET_ASIDE_MAP] {
            // Of an earlier replay into the same folder; fails where there is none.
            let _ = fs::remove_file(self.folder.join(other));
        }
        let mut texts = vec![("map.json", map_json(&maps.map)?)];
        if let Some((name, map)) = &maps.beside {
            texts.push((name, map_json(map)?));
        }
        Ok(texts)
    }
}
