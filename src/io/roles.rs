//! Which topic of a bag is used for what.

use super::Topic;
use crate::msg::{
    Message,
    convert::{is_rectified, without_transport},
    nav_msgs::Odometry,
    sensor_msgs::{CameraInfo, CompressedImage, Image},
    tf2_msgs::TFMessage,
    vision_msgs::Detection2DArray,
    yolo_msgs::DetectionArray,
};
use serde::Serialize;
use std::{fmt, str::FromStr};
use thiserror::Error;

/// Topics under this name hold the truth and are never input.
const GROUND_TRUTH: &str = "/ground_truth/";

/// How a bag without boxes is used.
const FIND_BOXES: &str = ", or find the boxes in its colour images with `--model FILE.onnx`";

/// What a topic can be used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Colour images.
    Rgb,
    /// Depth images.
    Depth,
    /// Calibration of the colour camera.
    CameraInfo,
    /// Calibration of the depth camera, where it is another one.
    DepthCameraInfo,
    /// Odometry.
    Odometry,
    /// 2D boxes.
    Detections,
}

/// Which topic is used for what.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Roles {
    /// Colour images; only drawn, never needed.
    pub rgb: Option<String>,
    /// Depth images.
    pub depth: String,
    /// Calibration of the colour camera, and of the depth camera where that has none of its own.
    pub camera_info: String,
    /// Calibration of the depth camera.
    pub depth_camera_info: Option<String>,
    /// Odometry; without it, TF says where the base is.
    pub odometry: Option<String>,
    /// 2D boxes.
    pub detections: String,
    /// Moving transforms.
    pub tf: Vec<String>,
    /// Fixed transforms.
    pub tf_static: Vec<String>,
}

/// A role given by hand: `depth:=/topic`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remap {
    /// The role.
    pub role: Role,
    /// The topic for it.
    pub topic: String,
}

/// Why topics cannot be assigned.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum RoleError {
    /// Not of the form `role:=/topic`.
    #[error("`{given}` is not of the form role:=/topic")]
    BadRemap {
        /// What was given.
        given: String,
    },
    /// A role that does not exist.
    #[error("there is no role `{given}`; the roles are {}", names(Role::ALL))]
    UnknownRole {
        /// What was given.
        given: String,
    },
    /// A topic given by hand that the bag does not have.
    #[error("the bag has no topic {topic} for {role}; it has {}", listed(available))]
    NoSuchTopic {
        /// The role.
        role: Role,
        /// What was given.
        topic: String,
        /// Topics with their types.
        available: Vec<(String, String)>,
    },
    /// A topic given by hand of the wrong type.
    #[error("{topic} is a {got}, but {role} needs a {}", role.types().join(" or "))]
    WrongType {
        /// The role.
        role: Role,
        /// What was given.
        topic: String,
        /// Its type.
        got: String,
    },
    /// The truth given by hand as input.
    #[error("{topic} cannot be used for {role}: topics under /ground_truth/ are never input")]
    GroundTruth {
        /// The role.
        role: Role,
        /// What was given.
        topic: String,
    },
    /// Nothing in the bag fits the roles that must be filled.
    #[error(
        "the bag has no topic for {}; it has {}; name one with `-r {}:=/topic`{}",
        names(missing),
        listed(available),
        missing.first().unwrap_or(&Role::Depth),
        if missing.contains(&Role::Detections) { FIND_BOXES } else { "" }
    )]
    Missing {
        /// Roles that must be filled.
        missing: Vec<Role>,
        /// Topics with their types.
        available: Vec<(String, String)>,
    },
    /// A topic in an encoding of another system.
    #[error("{topic} is encoded as `{encoding}`, but ROS 2 bags hold `cdr`")]
    NotCdr {
        /// The topic.
        topic: String,
        /// Its encoding.
        encoding: String,
    },
}

impl Roles {
    /// Assigns topics to roles: by hand where `remaps` says so, otherwise by type and name.
    ///
    /// # Errors
    /// When there is nothing for depth, camera info or detections, or a remap does not fit.
    pub fn assign(topics: &[Topic], remaps: &[Remap]) -> Result<Self, RoleError> {
        let (roles, missing) = Self::assign_all(topics, remaps)?;
        if !missing.is_empty() {
            return Err(RoleError::missing(missing, topics));
        }
        Ok(roles)
    }

    /// As [`Roles::assign`], but with the roles that nothing fits beside the others.
    ///
    /// # Errors
    /// When a remap does not fit.
    pub fn assign_all(topics: &[Topic], remaps: &[Remap]) -> Result<(Self, Vec<Role>), RoleError> {
        for remap in remaps {
            check_remap(topics, remap)?;
        }
        let given = |role| {
            let found = remaps.iter().rev().find(|remap| remap.role == role);
            found.map(|remap| remap.topic.clone())
        };
        let found = Candidates { topics };
        let depth = given(Role::Depth).or_else(|| found.depth());
        let rgb = given(Role::Rgb).or_else(|| found.rgb());
        let camera_info = given(Role::CameraInfo).or_else(|| {
            let of_rgb = rgb.as_deref().and_then(|rgb| found.sibling_info(rgb));
            let of_depth = || depth.as_deref().and_then(|depth| found.sibling_info(depth));
            of_rgb.or_else(|| found.any_info()).or_else(of_depth)
        });
        let depth_camera_info = given(Role::DepthCameraInfo)
            .or_else(|| found.sibling_info(depth.as_deref()?))
            .filter(|own| Some(own) != camera_info.as_ref());
        let detections = given(Role::Detections).or_else(|| found.best(Role::Detections, |_| 0));
        let filled = [
            (Role::Depth, &depth),
            (Role::CameraInfo, &camera_info),
            (Role::Detections, &detections),
        ];
        let missing = filled.iter().filter(|(_, topic)| topic.is_none()).map(|(role, _)| *role);
        let missing = missing.collect();
        let roles = Self {
            rgb,
            depth: depth.unwrap_or_default(),
            camera_info: camera_info.unwrap_or_default(),
            depth_camera_info,
            odometry: given(Role::Odometry).or_else(|| found.odometry()),
            detections: detections.unwrap_or_default(),
            tf: found.transforms("tf"),
            tf_static: found.transforms("tf_static"),
        };
        roles.check_encodings(topics)?;
        Ok((roles, missing))
    }

    /// As [`Roles::assign`] for a bag whose boxes a detector finds in its colour images: boxes that it has are not
    /// used.
    ///
    /// # Errors
    /// When there is nothing for depth, camera info or colour images, or a remap does not fit.
    pub fn assign_for_detector(topics: &[Topic], remaps: &[Remap]) -> Result<Self, RoleError> {
        let (mut roles, mut missing) = Self::assign_all(topics, remaps)?;
        roles.detections.clear();
        missing.retain(|role| *role != Role::Detections);
        missing.extend(roles.rgb.is_none().then_some(Role::Rgb));
        if !missing.is_empty() {
            return Err(RoleError::missing(missing, topics));
        }
        Ok(roles)
    }

    /// The topic of the colour images alone.
    ///
    /// # Errors
    /// When there is none, or a remap does not fit.
    pub fn color_topic(topics: &[Topic], remaps: &[Remap]) -> Result<String, RoleError> {
        let (roles, _) = Self::assign_all(topics, remaps)?;
        roles.rgb.ok_or_else(|| RoleError::missing(vec![Role::Rgb], topics))
    }

    /// Topics that the core needs: all but colour.
    pub fn core_topics(&self) -> impl Iterator<Item = &str> {
        let required = [&self.depth, &self.camera_info, &self.detections];
        let optional = [&self.depth_camera_info, &self.odometry];
        let optional = optional.into_iter().flatten();
        let all = required.into_iter().chain(optional).chain(&self.tf).chain(&self.tf_static);
        all.map(String::as_str)
    }

    /// The topic for a role.
    pub fn topic_of(&self, role: Role) -> Option<&str> {
        let topic = match role {
            Role::Rgb => self.rgb.as_deref(),
            Role::Depth => Some(self.depth.as_str()),
            Role::CameraInfo => Some(self.camera_info.as_str()),
            Role::DepthCameraInfo => self.depth_camera_info.as_deref(),
            Role::Odometry => self.odometry.as_deref(),
            Role::Detections => Some(self.detections.as_str()),
        };
        topic.filter(|name| !name.is_empty())
    }

    /// The role of a topic; transforms have none of these.
    pub fn role_of(&self, topic: &str) -> Option<Role> {
        Role::ALL.iter().copied().find(|role| self.topic_of(*role) == Some(topic))
    }

    /// Whether the boxes live in rectified images; without colour images, they are taken to live in the depth images.
    pub fn is_color_rectified(&self) -> bool {
        is_rectified(self.rgb.as_deref().unwrap_or(&self.depth))
    }

    /// Whether the depth images are rectified.
    pub fn is_depth_rectified(&self) -> bool {
        is_rectified(&self.depth)
    }

    fn check_encodings(&self, topics: &[Topic]) -> Result<(), RoleError> {
        let used = |topic: &&Topic| self.core_topics().any(|name| name == topic.name);
        match topics.iter().filter(used).find(|topic| topic.encoding != "cdr") {
            Some(Topic { name, encoding, .. }) => {
                Err(RoleError::NotCdr { topic: name.clone(), encoding: encoding.clone() })
            }
            None => Ok(()),
        }
    }
}

impl RoleError {
    /// Roles that nothing of these topics fits.
    pub(super) fn missing(missing: Vec<Role>, topics: &[Topic]) -> Self {
        Self::Missing { missing, available: available(topics) }
    }
}

impl Role {
    /// All roles.
    pub const ALL: &'static [Self] = &[
        Self::Rgb,
        Self::Depth,
        Self::CameraInfo,
        Self::DepthCameraInfo,
        Self::Odometry,
        Self::Detections,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rgb => "rgb",
            Self::Depth => "depth",
            Self::CameraInfo => "camera_info",
            Self::DepthCameraInfo => "depth_camera_info",
            Self::Odometry => "odometry",
            Self::Detections => "detections",
        }
    }

    /// Message types that fit.
    fn types(self) -> &'static [&'static str] {
        match self {
            Self::Rgb | Self::Depth => &[Image::TYPE, CompressedImage::TYPE],
            Self::CameraInfo | Self::DepthCameraInfo => &[CameraInfo::TYPE],
            Self::Odometry => &[Odometry::TYPE],
            Self::Detections => &[Detection2DArray::TYPE, DetectionArray::TYPE],
        }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Remap {
    type Err = RoleError;

    fn from_str(given: &str) -> Result<Self, RoleError> {
        let bad = || RoleError::BadRemap { given: given.to_owned() };
        let (role, topic) = given.split_once(":=").ok_or_else(bad)?;
        if topic.is_empty() {
            return Err(bad());
        }
        let unknown = || RoleError::UnknownRole { given: role.to_owned() };
        let role = Role::ALL.iter().find(|known| known.name() == role).ok_or_else(unknown)?;
        let slash = if topic.starts_with('/') { "" } else { "/" };
        Ok(Self { role: *role, topic: format!("{slash}{topic}") })
    }
}

/// The bag's topics, searched by type and name.
struct Candidates<'a> {
    topics: &'a [Topic],
}

impl Candidates<'_> {
    /// The topic of a fitting type with the lowest penalty, then the first by name.
    fn best(&self, role: Role, penalty: impl Fn(&str) -> u32) -> Option<String> {
        let usable = |topic: &&Topic| {
            let never = topic.name.starts_with(GROUND_TRUTH);
            !never && topic.messages > 0 && role.types().contains(&topic.type_name.as_str())
        };
        let best = self.topics.iter().filter(usable);
        best.min_by_key(|topic| (penalty(&topic.name), &topic.name)).map(|t| t.name.clone())
    }

    fn depth(&self) -> Option<String> {
        let best = self.best(Role::Depth, |name| {
            let not_depth = !is_depth(name);
            let not_aligned = !(name.contains("aligned") || name.contains("registered"));
            32 * u32::from(not_depth)
                + 16 * u32::from(is_byproduct(name))
                + 4 * u32::from(not_aligned)
                + 2 * u32::from(name.ends_with("/compressed"))
                + u32::from(is_compressed(name))
        });
        best.filter(|name| is_depth(name))
    }

    fn rgb(&self) -> Option<String> {
        let best = self.best(Role::Rgb, |name| {
            let named = ["color", "colour", "rgb"].iter().any(|word| name.contains(word));
            32 * u32::from(is_depth(name))
                + 16 * u32::from(is_byproduct(name))
                + 2 * u32::from(!named)
                + u32::from(is_compressed(name))
        });
        best.filter(|name| !is_depth(name) && !is_byproduct(name))
    }

    fn odometry(&self) -> Option<String> {
        self.best(Role::Odometry, |name| {
            u32::from(name != "/odom") + u32::from(!name.contains("odom"))
        })
    }

    /// `camera_info` in the namespace of an image.
    fn sibling_info(&self, image: &str) -> Option<String> {
        let sibling = format!("{}/camera_info", namespace(without_transport(image)));
        self.best(Role::CameraInfo, |name| u32::from(name != sibling)).filter(|n| *n == sibling)
    }

    /// The calibration of a camera that is not named as a depth camera.
    fn any_info(&self) -> Option<String> {
        let unfit = |name: &str| is_depth(name) || is_byproduct(name);
        self.best(Role::CameraInfo, |name| u32::from(unfit(name))).filter(|name| !unfit(name))
    }

    fn transforms(&self, last_part: &str) -> Vec<String> {
        let fits = |topic: &&Topic| {
            let name = topic.name.as_str();
            let last = name.rsplit('/').next() == Some(last_part);
            last && topic.type_name == TFMessage::TYPE && !name.starts_with(GROUND_TRUTH)
        };
        self.topics.iter().filter(fits).map(|topic| topic.name.clone()).collect()
    }
}

fn check_remap(topics: &[Topic], remap: &Remap) -> Result<(), RoleError> {
    let Remap { role, topic } = remap.clone();
    if topic.starts_with(GROUND_TRUTH) {
        return Err(RoleError::GroundTruth { role, topic });
    }
    match topics.iter().find(|known| known.name == topic) {
        None => Err(RoleError::NoSuchTopic { role, topic, available: available(topics) }),
        Some(known) if !role.types().contains(&known.type_name.as_str()) => {
            Err(RoleError::WrongType { role, topic, got: known.type_name.clone() })
        }
        Some(_) => Ok(()),
    }
}

fn is_depth(name: &str) -> bool {
    name.contains("depth")
}

/// Images that are neither colour nor depth, though of the same type.
fn is_byproduct(name: &str) -> bool {
    let words = ["infra", "confidence", "disparity", "mask", "debug", "annotated", "detection"];
    words.iter().any(|word| name.contains(word)) || name.split('/').any(|part| part == "ir")
}

fn is_compressed(name: &str) -> bool {
    without_transport(name) != name
}

fn namespace(name: &str) -> &str {
    name.rsplit_once('/').map_or("", |(namespace, _)| namespace)
}

fn available(topics: &[Topic]) -> Vec<(String, String)> {
    let kind = |topic: &Topic| match topic.messages {
        0 => format!("{}, no messages", topic.type_name),
        _ => topic.type_name.clone(),
    };
    topics.iter().map(|topic| (topic.name.clone(), kind(topic))).collect()
}

fn listed(topics: &[(String, String)]) -> String {
    if topics.is_empty() {
        return "no topics at all".to_owned();
    }
    let listed: Vec<String> =
        topics.iter().map(|(name, kind)| format!("{name} ({kind})")).collect();
    listed.join(", ")
}

fn names(roles: &[Role]) -> String {
    roles.iter().map(|role| role.name()).collect::<Vec<_>>().join(", ")
}
