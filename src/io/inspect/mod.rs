//! What a bag holds, and whether that is enough.

mod frames;
mod report;
mod stamps;

pub use frames::{FrameLink, Frames};
pub use report::{BagReport, NO_ODOMETRY, Stream};
pub use stamps::{Coverage, Matching, Rhythm};

use super::{BagReader, BagWarning, Decoder, InputError, RawMessage, bag_input::check_usable};
use crate::{
    msg::{cdr::decode_header, std_msgs::Header},
    pipeline::{Input, SyncSettings},
    time::Stamp,
    topics::{Assigned, Remap, Role, RoleError, Roles},
};
use frames::FrameGraph;
use std::{collections::BTreeMap, path::Path};

/// Looks at a bag: what would be used, at what rate, how well stamps match and what is missing.
///
/// Stamps are paired as in a replay with the same settings. Where a detector `finds_boxes` in the colour images, those
/// must be there instead of boxes.
///
/// # Errors
/// When the bag cannot be read, or a remap does not fit. What is missing is in the report.
pub fn inspect(
    path: &Path,
    remaps: &[Remap],
    settings: &SyncSettings,
    finds_boxes: bool,
) -> Result<BagReport, InputError> {
    let (bag, slop_s) = (BagReader::open(path)?, settings.slop_s);
    let roles_error = |source| InputError::Roles { path: path.to_owned(), source };
    let assigned = Roles::assign_all(bag.topics(), remaps).map_err(roles_error)?;
    let assigned = if finds_boxes { assigned.for_detector() } else { assigned };
    let Assigned { roles, missing, choices } = assigned;
    let seen = Seen::read(&bag, &roles);
    let mut problems: Vec<String> = Vec::new();
    if missing.is_empty() {
        problems.extend(check_usable(&bag, &roles, path).err().map(|error| error.to_string()));
    } else {
        problems.push(RoleError::missing(missing, bag.topics()).to_string());
    }
    let is_usable = problems.is_empty();
    let warnings: Vec<String> =
        bag.warnings().chain(&seen.warnings).map(BagWarning::to_string).collect();
    let mut report = BagReport {
        path: path.to_owned(),
        duration_s: bag.time_range().map_or(0.0, |(first, last)| last.seconds_since(first)),
        messages: bag.message_count(),
        topics: bag.topics().to_vec(),
        streams: seen.streams(&bag, &roles),
        slop_s,
        detections_to_depth: seen.matching(Role::Detections, slop_s),
        rgb_to_depth: seen.matching(Role::Rgb, slop_s),
        odometry: seen.coverage(&roles),
        frames: seen.frames(&roles, settings),
        roles,
        choices,
        warnings,
        problems,
        can_be_replayed: false,
    };
    report.problems.extend(report.find_problems());
    report.can_be_replayed = is_usable && report.has_frames();
    Ok(report)
}

/// Headers of all messages that have a role.
#[derive(Default)]
struct Seen {
    by_role: BTreeMap<Role, SeenTopic>,
    base_frame: Option<String>,
    graph: FrameGraph,
    warnings: Vec<BagWarning>,
}

/// Headers of one topic.
#[derive(Default)]
struct SeenTopic {
    stamps: Vec<Stamp>,
    frames: Vec<String>,
    unreadable: u64,
}

impl Seen {
    fn read(bag: &BagReader, roles: &Roles) -> Self {
        let mut seen = Self::default();
        let mut decoder = Decoder::new(roles.clone());
        let topics = roles.core_topics().chain(roles.rgb.as_deref());
        let mut messages = bag.messages().only(topics);
        for message in messages.by_ref() {
            seen.note(&message, roles, &mut decoder);
        }
        seen.warnings = messages.warnings().to_vec();
        seen
    }

    fn note(&mut self, message: &RawMessage, roles: &Roles, decoder: &mut Decoder) {
        let Some(role) = roles.role_of(&message.topic) else {
            if let Ok(Some(Input::Transforms { is_static, transforms })) = decoder.decode(message) {
                self.graph.add(is_static, &transforms);
            }
            return;
        };
        let topic = self.by_role.entry(role).or_default();
        match decode_header(&message.data) {
            Ok(header) => topic.note(&header),
            Err(_) => topic.unreadable += 1,
        }
        if role == Role::Odometry
            && self.base_frame.is_none()
            && let Ok(Some(Input::Odometry(reading))) = decoder.decode(message)
        {
            self.base_frame = Some(reading.child_frame_id);
        }
    }

    fn stamps(&self, role: Role) -> &[Stamp] {
        self.by_role.get(&role).map_or(&[], |topic| &topic.stamps)
    }

    fn streams(&self, bag: &BagReader, roles: &Roles) -> Vec<Stream> {
        let used = Role::ALL.iter().filter_map(|role| Some((*role, roles.topic_of(*role)?)));
        used.filter_map(|(role, name)| {
            let topic = bag.topics().iter().find(|topic| topic.name == name)?;
            let seen = self.by_role.get(&role);
            Some(Stream {
                role,
                topic: topic.name.clone(),
                type_name: topic.type_name.clone(),
                messages: topic.messages,
                unreadable: seen.map_or(0, |seen| seen.unreadable),
                frames: seen.map_or(Vec::new(), |seen| seen.frames.clone()),
                rhythm: Rhythm::of(self.stamps(role)),
            })
        })
        .collect()
    }

    fn matching(&self, role: Role, slop_s: f64) -> Option<Matching> {
        Matching::of(self.stamps(role), self.stamps(Role::Depth), slop_s)
    }

    fn coverage(&self, roles: &Roles) -> Option<Coverage> {
        let measured = roles.detections_3d.as_ref().map_or(Role::Depth, |_| Role::Detections3d);
        Coverage::of(self.stamps(Role::Odometry), self.stamps(measured))
    }

    fn frames(&self, roles: &Roles, settings: &SyncSettings) -> Frames {
        let first_of = |role| self.by_role.get(&role)?.frames.first().cloned();
        let odometry = roles.odometry.as_ref().and_then(|_| self.base_frame.clone());
        let camera = roles.detections_3d.as_ref().map_or(Role::CameraInfo, |_| Role::Detections3d);
        let (camera, depth) = (first_of(camera), first_of(Role::Depth));
        let mut frames = self.graph.frames(odometry, camera, depth);
        if settings.camera_pose.base_from_camera().is_some() {
            frames.base_to_camera = Some(true);
            frames.camera_moves = self.graph.moves(&settings.base_frame);
        }
        frames
    }
}

impl SeenTopic {
    fn note(&mut self, header: &Header) {
        self.stamps.push(header.stamp.into());
        let frame = header.frame_id.trim_start_matches('/');
        if !self.frames.iter().any(|known| known == frame) {
            self.frames.push(frame.to_owned());
        }
    }
}
