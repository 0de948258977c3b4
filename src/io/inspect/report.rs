//! What was found, in words to act on.

use super::{Coverage, Frames, Matching, Rhythm};
use crate::topics::{Choice, Role, Roles, Topic};
use serde::Serialize;
use std::{fmt, path::PathBuf};

/// What a bag holds. Its [`fmt::Display`] is meant for people, its serialised form for machines.
#[derive(Clone, Debug, Serialize)]
pub struct BagReport {
    /// The bag.
    pub path: PathBuf,
    /// Time from the first to the last message in seconds.
    pub duration_s: f64,
    /// Number of messages.
    pub messages: u64,
    /// All topics.
    pub topics: Vec<Topic>,
    /// Which topic would be used for what; empty names where nothing fits.
    pub roles: Roles,
    /// What was chosen, and what else could serve.
    pub choices: Vec<Choice>,
    /// The topics that would be used.
    pub streams: Vec<Stream>,
    /// Largest difference between stamps that are paired, in seconds.
    pub slop_s: f64,
    /// How the detections' stamps match those of the depth images.
    pub detections_to_depth: Option<Matching>,
    /// How the colour images' stamps match those of the depth images.
    pub rgb_to_depth: Option<Matching>,
    /// How much of the depth images the odometry covers.
    pub odometry: Option<Coverage>,
    /// Frames and the transforms between them.
    pub frames: Frames,
    /// Damage of the bag's files.
    pub warnings: Vec<String>,
    /// What is missing or wrong, and what to do; empty if the bag can be replayed as it is.
    pub problems: Vec<String>,
    /// Whether a replay would make a map, perhaps a poor one.
    pub can_be_replayed: bool,
}

/// A topic that would be used.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stream {
    /// For what.
    pub role: Role,
    /// Name.
    pub topic: String,
    /// Type.
    pub type_name: String,
    /// Number of messages.
    pub messages: u64,
    /// Messages whose header cannot be read.
    pub unreadable: u64,
    /// Frames that the headers name.
    pub frames: Vec<String>,
    /// How regularly it is stamped.
    pub rhythm: Rhythm,
}

/// What to do where nothing says how the robot moved.
pub const NO_ODOMETRY: &str = "there is no odometry, neither as nav_msgs/msg/Odometry (name it with `-r odometry:=/topic`) nor \
    as a moving transform on /tf that leads to the camera: the robot's wheels give it, a visual-inertial odometry does (of a ZED, a \
    RealSense T265, OpenVINS), or rtabmap's from the images alone (`ros2 run rtabmap_odom rgbd_odometry`); record it with \
    `ros2 bag record /odom /tf /tf_static` and the camera's topics";

/// A part of a topic's messages without a depth image that is lost in any recording, at its ends for example.
const USUAL_LOSS: f64 = 0.1;

impl BagReport {
    /// Whether some depth images have boxes and a pose, as far as stamps and frames tell.
    pub(super) fn has_frames(&self) -> bool {
        let has_pose = match &self.roles.odometry {
            Some(_) => {
                let covered = self.odometry.as_ref().is_some_and(|covered| covered.share > 0.0);
                covered && self.frames.base_to_camera != Some(false)
            }
            None => self.frames.camera_moves,
        };
        let boxes = self.detections_to_depth.as_ref();
        let has_boxes = boxes.is_none_or(|boxes| boxes.within_slop_share > 0.0);
        has_pose && has_boxes && self.frames.depth_to_camera != Some(false)
    }

    /// What the numbers mean for a replay.
    pub(super) fn find_problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        let pairs =
            [(Role::Detections, &self.detections_to_depth), (Role::Rgb, &self.rgb_to_depth)];
        for (role, matching) in pairs {
            problems.extend(matching.as_ref().and_then(|m| self.stamp_problem(role, m)));
        }
        for stream in &self.streams {
            let Stream { topic, unreadable, rhythm, .. } = stream;
            if *unreadable > 0 {
                problems.push(format!("{unreadable} messages on {topic} cannot be read"));
            }
            if rhythm.backwards > 0 {
                let times = rhythm.backwards;
                problems.push(format!("stamps on {topic} go backwards ({times} times)"));
            }
        }
        problems.extend(self.odometry_problem());
        problems.extend(self.frame_problems());
        problems
    }

    fn stamp_problem(&self, role: Role, matching: &Matching) -> Option<String> {
        if matching.within_slop_share >= 1.0 - USUAL_LOSS {
            return None;
        }
        let of = self.roles.topic_of(role).unwrap_or_default();
        Some(format!(
            "only {:.0} % of the messages on {of} are stamped within {} s of a depth image on {} (the median is {:.3} s \
             away): {of} must carry the stamps of the images it belongs to, from the same clock, or `sync.slop_s` must \
             be larger",
            100.0 * matching.within_slop_share,
            self.slop_s,
            self.roles.depth,
            matching.median_offset_s
        ))
    }

    fn odometry_problem(&self) -> Option<String> {
        match (&self.roles.odometry, &self.odometry) {
            (None, _) if !self.frames.camera_moves => Some(NO_ODOMETRY.to_owned()),
            (Some(topic), Some(Coverage { share })) if *share < 0.999 => Some(format!(
                "{topic} covers only {:.0} % of the {}; the others cannot be used",
                100.0 * share,
                self.measured()
            )),
            _ => None,
        }
    }

    /// What tells where things are.
    fn measured(&self) -> &'static str {
        self.roles.detections_3d.as_ref().map_or("depth images", |_| "detections")
    }

    fn frame_problems(&self) -> Vec<String> {
        let Frames { base, camera, depth, base_to_camera, depth_to_camera, .. } = &self.frames;
        let name = |frame: &Option<String>| frame.clone().unwrap_or_default();
        let mut problems = Vec::new();
        if *base_to_camera == Some(false) {
            problems.push(format!(
                "no transforms connect the base `{}` with the camera `{}`: record /tf and /tf_static, or say where \
                 the camera is with `--camera-pose X,Y,Z,ROLL,PITCH,YAW`",
                name(base),
                name(camera)
            ));
        }
        if *depth_to_camera == Some(false) {
            problems.push(format!(
                "no transforms connect the depth camera `{}` with the colour camera `{}`: record /tf_static, or use \
                 depth that is registered to colour",
                name(depth),
                name(camera)
            ));
        }
        problems
    }

    fn write_streams(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "\nUsed as input:")?;
        for Stream { role, topic, messages, frames, rhythm, .. } in &self.streams {
            writeln!(
                f,
                "  {:<18} {topic} ({messages} messages, {:.1} Hz, longest gap {:.3} s, frame {})",
                role.name(),
                rhythm.rate_hz,
                rhythm.max_gap_s,
                frames.join(", ")
            )?;
            let chosen = self.choices.iter().find(|choice| choice.role == *role);
            if let Some(choice) = chosen.filter(|choice| !choice.rather_than.is_empty()) {
                writeln!(f, "  {:<18} is {choice}", "")?;
            }
        }
        for (name, topics) in [("tf", &self.roles.tf), ("tf_static", &self.roles.tf_static)] {
            if !topics.is_empty() {
                writeln!(f, "  {name:<18} {}", topics.join(", "))?;
            }
        }
        Ok(())
    }

    fn write_stamps(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pairs = [("detections", &self.detections_to_depth), ("rgb", &self.rgb_to_depth)];
        writeln!(f, "\nStamps:")?;
        for (name, matching) in pairs {
            if let Some(matching) = matching {
                let Matching { median_offset_s, max_offset_s, .. } = matching;
                let exact = 100.0 * matching.exact_share;
                let paired = 100.0 * matching.within_slop_share;
                writeln!(
                    f,
                    "  {exact:.0} % of {name} have the stamp of a depth image, {paired:.0} % one within {} s; the nearest is \
                     {median_offset_s:.3} s away in the median and {max_offset_s:.3} s at most",
                    self.slop_s
                )?;
            }
        }
        if let Some(Coverage { share }) = &self.odometry {
            writeln!(f, "  odometry covers {:.0} % of the {}", 100.0 * share, self.measured())?;
        }
        Ok(())
    }
}

impl fmt::Display for BagReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, duration_s, messages, .. } = self;
        writeln!(f, "{}: {messages} messages in {duration_s:.1} s", path.display())?;
        writeln!(f, "\nTopics:")?;
        for Topic { name, type_name, messages, .. } in &self.topics {
            writeln!(f, "  {name} ({type_name}, {messages} messages)")?;
        }
        self.write_streams(f)?;
        self.write_stamps(f)?;
        if !self.frames.links.is_empty() {
            writeln!(f, "\nTransforms:")?;
        }
        for link in &self.frames.links {
            let kind = if link.is_static { "fixed" } else { "moving" };
            writeln!(f, "  {} -> {} ({kind})", link.parent, link.child)?;
        }
        for (title, lines) in [("Damage", &self.warnings), ("Problems", &self.problems)] {
            if !lines.is_empty() {
                writeln!(f, "\n{title}:")?;
            }
            lines.iter().try_for_each(|line| writeln!(f, "  - {line}"))?;
        }
        let verdict =
            if self.problems.is_empty() { "\nThis bag can be replayed as it is." } else { "" };
        f.write_str(verdict)
    }
}
