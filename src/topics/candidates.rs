//! The topics there are, searched by type and name.

use super::{
    Choice, Passed, Role, Topic,
    names::{
        is_aligned, is_byproduct, is_compressed, is_grey, is_named_color, is_named_depth,
        is_never_input, is_one_eye, may_be_color, may_be_depth, namespace, root,
    },
};
use crate::msg::{
    Message, convert::without_transport, tf2_msgs::TFMessage, yolo_msgs::DetectionArray,
};

/// Where topics are looked for.
#[derive(Clone, Copy)]
pub(super) struct Candidates<'a> {
    pub(super) topics: &'a [Topic],
    /// Of the node: topics in it are preferred.
    pub(super) namespace: &'a str,
}

/// Why another topic is better than one that has this.
type Defect<'a> = (&'static str, &'a dyn Fn(&Topic) -> bool);

impl Candidates<'_> {
    /// The topic of a fitting type, among those that are `eligible`, with the least of the defects, of which the first
    /// weigh most; then the first by name.
    fn best(
        &self,
        role: Role,
        eligible: impl Fn(&Topic) -> bool,
        defects: &[Defect<'_>],
    ) -> Option<Choice> {
        let home = format!("{}/", self.namespace.trim_end_matches('/'));
        let elsewhere = |topic: &Topic| !topic.name.starts_with(&home);
        let all: Vec<Defect<'_>> =
            [("is in another namespace", &elsewhere as &dyn Fn(&Topic) -> bool)]
                .into_iter()
                .chain(defects.iter().copied())
                .collect();
        let usable = |topic: &&Topic| {
            let fits = role.types().contains(&topic.type_name.as_str());
            fits && topic.messages > 0 && !is_never_input(&topic.name) && eligible(topic)
        };
        let rank = |topic: &Topic| all.iter().map(|(_, has)| has(topic)).collect::<Vec<bool>>();
        let mut found: Vec<(Vec<bool>, &Topic)> =
            self.topics.iter().filter(usable).map(|topic| (rank(topic), topic)).collect();
        found.sort_by(|(a, at), (b, bt)| (a, &at.name).cmp(&(b, &bt.name)));
        let ((ranked, taken), others) = found.split_first()?;
        let passed = others.iter().map(|(rank, other)| {
            let first = rank.iter().zip(ranked).position(|(other, taken)| other != taken);
            let why = first.map_or("comes later by name", |at| all[at].0);
            Passed { topic: other.name.clone(), why }
        });
        Some(Choice { role, topic: taken.name.clone(), rather_than: passed.collect() })
    }

    pub(super) fn depth(&self) -> Option<Choice> {
        let eligible = |topic: &Topic| {
            may_be_depth(topic) && (is_named_depth(&topic.name) || !is_byproduct(&topic.name))
        };
        self.best(
            Role::Depth,
            eligible,
            &[
                ("is not what the camera measured", &|topic| is_byproduct(&topic.name)),
                ("is not called depth", &|topic| !is_named_depth(&topic.name)),
                ("is not aligned to colour", &|topic| !is_aligned(&topic.name)),
                ("is compressed as pictures are", &|topic| topic.name.ends_with("/compressed")),
                ("is compressed", &|topic| is_compressed(&topic.name)),
            ],
        )
    }

    /// The colour images, of the camera of these depth images if there are several.
    pub(super) fn rgb(&self, depth: Option<&str>) -> Option<Choice> {
        let is_other = |topic: &Topic| Some(topic.name.as_str()) != depth;
        let eligible =
            |topic: &Topic| may_be_color(topic) && !is_byproduct(&topic.name) && is_other(topic);
        self.best(
            Role::Rgb,
            eligible,
            &[
                ("is of another camera", &|topic| {
                    depth.is_some_and(|depth| root(depth) != root(&topic.name))
                }),
                ("is of one eye of a stereo camera", &|topic| is_one_eye(&topic.name)),
                ("is not called colour", &|topic| !is_named_color(&topic.name)),
                ("is grey", &is_grey),
                ("is compressed", &|topic| is_compressed(&topic.name)),
            ],
        )
    }

    pub(super) fn odometry(&self) -> Option<Choice> {
        self.best(
            Role::Odometry,
            |_| true,
            &[
                ("is not called odom", &|topic| topic.name.rsplit('/').next() != Some("odom")),
                ("is not named as odometry", &|topic| !topic.name.contains("odom")),
            ],
        )
    }

    pub(super) fn detections(&self) -> Option<Choice> {
        self.best(
            Role::Detections,
            |_| true,
            &[
                ("has boxes in space", &|topic| topic.name.contains("3d")),
                ("has tracks", &|topic| topic.name.contains("track")),
            ],
        )
    }

    /// Objects in space. What `yolo_ros` sends has the same type with and without them.
    pub(super) fn detections_3d(&self) -> Option<Choice> {
        self.best(
            Role::Detections3d,
            |topic| topic.type_name != DetectionArray::TYPE || topic.name.contains("3d"),
            &[("has tracks", &|topic| topic.name.contains("track"))],
        )
    }

    /// `camera_info` in the namespace of an image.
    pub(super) fn sibling_info(&self, role: Role, image: &str) -> Option<Choice> {
        let sibling = format!("{}/camera_info", namespace(without_transport(image)));
        self.best(role, |topic| topic.name == sibling, &[])
    }

    /// The calibration of a camera that is not named as a depth camera.
    pub(super) fn any_info(&self) -> Option<Choice> {
        let fits = |topic: &Topic| {
            let name = &topic.name;
            !(is_named_depth(name) || name.contains("depth") || is_byproduct(name))
        };
        self.best(Role::CameraInfo, fits, &[])
    }

    pub(super) fn transforms(&self, last_part: &str) -> Vec<String> {
        let fits = |topic: &&Topic| {
            let last = topic.name.rsplit('/').next() == Some(last_part);
            last && topic.type_name == TFMessage::TYPE && !is_never_input(&topic.name)
        };
        self.topics.iter().filter(fits).map(|topic| topic.name.clone()).collect()
    }
}
