//! A bag as the core's inputs.

use super::{BagError, BagReader, BagWarning, Damage, Decoder, FoundBoxes, Messages};
use crate::{
    msg::{SkipCount, Skipped, convert::FindBoxes},
    pipeline::{CameraRole, Input},
    time::Stamp,
    topics::{Remap, Role, RoleError, Roles},
};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A bag whose topics have roles and whose first images and calibrations fit each other.
#[derive(Debug)]
pub struct BagInput {
    bag: BagReader,
    roles: Roles,
}

/// Why a bag cannot be replayed.
#[derive(Debug, Error)]
pub enum InputError {
    /// It cannot be read.
    #[error(transparent)]
    Bag(#[from] BagError),
    /// Its topics do not fit.
    #[error("{}: {source}", path.display())]
    Roles {
        /// The bag.
        path: PathBuf,
        /// Why.
        source: RoleError,
    },
    /// A topic without a single usable message.
    #[error("{}: none of the messages on {topic} can be used for {role}: {why}", path.display())]
    NothingUsable {
        /// The bag.
        path: PathBuf,
        /// The role.
        role: Role,
        /// The topic.
        topic: String,
        /// What is wrong with the first of them.
        why: String,
    },
    /// Something is missing in a bag of which a part could not be read.
    #[error("{problem}; {damage}")]
    Damaged {
        /// What is missing.
        problem: Box<InputError>,
        /// What is wrong with the bag.
        damage: BagWarning,
    },
    /// Depth images and calibration of different cameras.
    #[error(
        "{}: depth images on {depth_topic} are {}x{}, but {info_topic} says {}x{}; \
         name the depth camera's calibration with `-r depth_camera_info:=/topic`",
        path.display(), depth.0, depth.1, info.0, info.1
    )]
    SizesDiffer {
        /// The bag.
        path: PathBuf,
        /// Topic of the depth images.
        depth_topic: String,
        /// Their size.
        depth: (u32, u32),
        /// Topic of the calibration.
        info_topic: String,
        /// The size it states.
        info: (u32, u32),
    },
}

impl BagInput {
    /// Opens a bag and assigns its topics to roles.
    ///
    /// # Errors
    /// When the bag cannot be read, lacks depth, calibration or detections, or has none that can be used.
    pub fn open(path: &Path, remaps: &[Remap]) -> Result<Self, InputError> {
        Self::open_as(path, |bag| Roles::assign(bag.topics(), remaps))
    }

    /// The same for a bag whose boxes [`Inputs::detecting`] is to find in its colour images.
    ///
    /// # Errors
    /// When the bag cannot be read, lacks depth, calibration or colour images, or has none that can be used.
    pub fn open_for_detector(path: &Path, remaps: &[Remap]) -> Result<Self, InputError> {
        Self::open_as(path, |bag| Roles::assign_for_detector(bag.topics(), remaps))
    }

    fn open_as(
        path: &Path,
        assign: impl FnOnce(&BagReader) -> Result<Roles, RoleError>,
    ) -> Result<Self, InputError> {
        let bag = BagReader::open(path)?;
        let roles =
            assign(&bag).map_err(|source| InputError::Roles { path: path.to_owned(), source });
        let checked = roles.and_then(|roles| {
            check_usable(&bag, &roles, path)?;
            Ok(roles)
        });
        // That the index is damaged is the least of what can be wrong.
        let worst = bag.warnings().find(|warning| warning.damage != Damage::Index);
        let damage = worst.or_else(|| bag.warnings().next()).cloned();
        match (checked, damage) {
            (Ok(roles), _) => Ok(Self { bag, roles }),
            (Err(problem), Some(damage)) if !matches!(problem, InputError::Damaged { .. }) => {
                Err(InputError::Damaged { problem: problem.into(), damage })
            }
            (Err(problem), _) => Err(problem),
        }
    }

    /// The bag.
    pub fn bag(&self) -> &BagReader {
        &self.bag
    }

    /// Which topic is used for what.
    pub fn roles(&self) -> &Roles {
        &self.roles
    }

    /// All inputs in the order of their log time.
    pub fn inputs(&self) -> Inputs<'_> {
        Inputs {
            messages: self.bag.messages().only(self.roles.core_topics()),
            decoder: Decoder::new(self.roles.clone()),
            color: None,
            messages_read: 0,
            log_time: Stamp::default(),
        }
    }

    /// Number of messages that [`BagInput::inputs`] reads, for a progress bar.
    pub fn message_count(&self) -> u64 {
        let used = |name: &str| self.roles.core_topics().any(|topic| topic == name);
        self.bag.topics().iter().filter(|topic| used(&topic.name)).map(|topic| topic.messages).sum()
    }
}

/// Whether every topic that must be there has a usable message, and whether the first depth image has the size that
/// the calibration it needs states.
pub(super) fn check_usable(bag: &BagReader, roles: &Roles, path: &Path) -> Result<(), InputError> {
    let info_size = |wanted: CameraRole| {
        move |input: Input| match input {
            Input::Camera(info) if info.role == wanted => {
                Some((info.camera.width(), info.camera.height()))
            }
            _ => None,
        }
    };
    let first = First { bag, roles, path };
    if roles.detections_3d.is_some() {
        return first.usable(Role::Detections3d, Some).map(drop);
    }
    let color = first.usable(Role::CameraInfo, info_size(CameraRole::Color))?;
    let (info_role, info) = match roles.depth_camera_info {
        Some(_) => {
            let own = first.usable(Role::DepthCameraInfo, info_size(CameraRole::Depth))?;
            (Role::DepthCameraInfo, own)
        }
        None => (Role::CameraInfo, color),
    };
    let depth = first.usable(Role::Depth, |input| match input {
        Input::Depth(depth) => Some((depth.image.width(), depth.image.height())),
        _ => None,
    })?;
    if roles.topic_of(Role::Detections).is_some() {
        first.usable(Role::Detections, Some)?;
    }
    if depth == info {
        return Ok(());
    }
    let (path, depth_topic) = (path.to_owned(), roles.depth.clone());
    let info_topic = roles.topic_of(info_role).unwrap_or_default().to_owned();
    Err(InputError::SizesDiffer { path, depth_topic, depth, info_topic, info })
}

/// Looks for the first usable message of a topic.
struct First<'a> {
    bag: &'a BagReader,
    roles: &'a Roles,
    path: &'a Path,
}

impl First<'_> {
    /// What `wanted` picks from the first usable message for a role.
    fn usable<T>(&self, role: Role, wanted: impl Fn(Input) -> Option<T>) -> Result<T, InputError> {
        let topic = self.roles.topic_of(role).unwrap_or_default();
        let mut decoder = Decoder::new(self.roles.clone());
        let mut first_problem: Option<Skipped> = None;
        let mut messages = self.bag.messages().only([topic]);
        for message in messages.by_ref() {
            match decoder.decode(&message) {
                Ok(input) => {
                    if let Some(found) = input.and_then(&wanted) {
                        return Ok(found);
                    }
                }
                Err(skipped) => {
                    first_problem.get_or_insert(skipped);
                }
            }
        }
        let why = first_problem.map_or("there are none".to_owned(), |s| s.why.to_string());
        let (path, topic) = (self.path.to_owned(), topic.to_owned());
        let problem = InputError::NothingUsable { path, role, topic, why };
        Err(match messages.warnings().first() {
            None => problem,
            Some(damage) => InputError::Damaged { problem: problem.into(), damage: damage.clone() },
        })
    }
}

/// The core's inputs from a bag. Messages that cannot be used are left out and counted.
#[derive(Debug)]
pub struct Inputs<'a> {
    messages: Messages<'a>,
    decoder: Decoder,
    /// The topic of the colour images, and what finds boxes in them.
    color: Option<(String, FoundBoxes)>,
    messages_read: u64,
    log_time: Stamp,
}

impl Inputs<'_> {
    /// Boxes come from a detector that looks at the colour images, of a bag that was opened for that. They follow
    /// their image at once.
    pub fn detecting(self, bag: &BagInput, find: FindBoxes) -> Self {
        let roles = bag.roles();
        let topics = roles.core_topics().chain(roles.rgb.as_deref());
        let color = roles.rgb.clone().map(|topic| (topic, FoundBoxes::new(find)));
        Self { messages: self.messages.only(topics), color, ..self }
    }

    /// What has been left out so far.
    pub fn skipped(&self) -> &SkipCount {
        self.decoder.skipped()
    }

    /// Damage that was found while reading, beyond what [`BagReader::warnings`] knew.
    pub fn warnings(&self) -> &[BagWarning] {
        self.messages.warnings()
    }

    /// Messages read so far, usable or not.
    pub fn messages_read(&self) -> u64 {
        self.messages_read
    }

    /// When the latest message was recorded.
    pub fn log_time(&self) -> Stamp {
        self.log_time
    }
}

impl Iterator for Inputs<'_> {
    type Item = Input;

    fn next(&mut self) -> Option<Input> {
        loop {
            let message = self.messages.next()?;
            self.messages_read += 1;
            self.log_time = message.log_time;
            let decoded = match &mut self.color {
                Some((topic, boxes)) if **topic == *message.topic => {
                    let found = boxes.of(&message).map(|(boxes, _)| boxes);
                    self.decoder.note(&message, found).map(Input::Detections).map(Some)
                }
                _ => self.decoder.decode(&message),
            };
            match decoded {
                Ok(Some(input)) => return Some(input),
                Ok(None) => (),
                Err(skipped) => tracing::debug!("skipped: {skipped}"),
            }
        }
    }
}
