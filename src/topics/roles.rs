//! Which topic is used for what.

use super::{Choice, Remap, Role, RoleError, Topic, choice::choose, error::available};
use crate::msg::convert::is_rectified;
use serde::Serialize;

/// Topics under this name hold the truth and are never input.
const GROUND_TRUTH: &str = "/ground_truth/";

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
    /// Objects in space; where this is used, depth, boxes and calibrations are not.
    pub detections_3d: Option<String>,
    /// Moving transforms.
    pub tf: Vec<String>,
    /// Fixed transforms.
    pub tf_static: Vec<String>,
}

/// Topics with their roles, and how that came.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Assigned {
    /// The roles; empty names where nothing fits.
    pub roles: Roles,
    /// Roles that must be filled and are not.
    pub missing: Vec<Role>,
    /// What was not given by hand, and what it was preferred to.
    pub choices: Vec<Choice>,
}

impl Assigned {
    /// The same where a detector finds the boxes in the colour images: no others are used, and those images are needed.
    #[must_use]
    pub fn for_detector(mut self) -> Self {
        self.roles.detections.clear();
        if self.roles.detections_3d.take().is_some() {
            self.missing.extend([Role::Depth, Role::CameraInfo]);
        }
        let of_another = [Role::Detections, Role::Detections3d];
        self.choices.retain(|choice| !of_another.contains(&choice.role));
        self.missing.retain(|role| *role != Role::Detections);
        self.missing.extend(self.roles.rgb.is_none().then_some(Role::Rgb));
        self
    }
}

impl Roles {
    /// Assigns topics to roles: by hand where `remaps` says so, otherwise by type, format and name.
    ///
    /// # Errors
    /// When there is nothing for depth, camera info or detections, or a remap does not fit.
    pub fn assign(topics: &[Topic], remaps: &[Remap]) -> Result<Self, RoleError> {
        let Assigned { roles, missing, .. } = Self::assign_all(topics, remaps)?;
        if !missing.is_empty() {
            return Err(RoleError::missing(missing, topics));
        }
        Ok(roles)
    }

    /// As [`Roles::assign`], but with the roles that nothing fits and what was chosen beside the others.
    ///
    /// # Errors
    /// When a remap does not fit.
    pub fn assign_all(topics: &[Topic], remaps: &[Remap]) -> Result<Assigned, RoleError> {
        for remap in remaps {
            check_remap(topics, remap)?;
        }
        let assigned = choose(topics, remaps, "/");
        assigned.roles.check_encodings(topics)?;
        Ok(assigned)
    }

    /// As [`Roles::assign`] for a bag whose boxes a detector finds in its colour images: boxes that it has are not
    /// used.
    ///
    /// # Errors
    /// When there is nothing for depth, camera info or colour images, or a remap does not fit.
    pub fn assign_for_detector(topics: &[Topic], remaps: &[Remap]) -> Result<Self, RoleError> {
        let Assigned { roles, missing, .. } = Self::assign_all(topics, remaps)?.for_detector();
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
        let assigned = Self::assign_all(topics, remaps)?;
        assigned.roles.rgb.ok_or_else(|| RoleError::missing(vec![Role::Rgb], topics))
    }

    /// Topics that the core needs: all but colour.
    pub fn core_topics(&self) -> impl Iterator<Item = &str> {
        let required = [&self.depth, &self.camera_info, &self.detections];
        let optional = [&self.depth_camera_info, &self.odometry, &self.detections_3d];
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
            Role::Detections3d => self.detections_3d.as_deref(),
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

fn check_remap(topics: &[Topic], remap: &Remap) -> Result<(), RoleError> {
    let Remap { role, topic } = remap.clone();
    if topic.is_empty() {
        return Ok(());
    }
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
