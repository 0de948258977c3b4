//! From topics to the worker's inbox.

use super::{
    color::ColorImages,
    detecting::NewestImage,
    finding::Sources,
    inbox::Inbox,
    node::NotCreated,
    qos,
    status::Shared,
    transport::{Node, NotTaken, Subscription},
};
use crate::{
    config::{DetectionsType, NodeSettings, Qos, RosArguments},
    msg::{
        Message,
        convert::{self, ColorMessage, ConvertError, without_transport},
        nav_msgs::Odometry,
        sensor_msgs::{CameraInfo, CompressedImage, Image},
        tf2_msgs::TFMessage,
        vision_msgs::{Detection2DArray, Detection3DArray},
        yolo_msgs::DetectionArray,
    },
    pipeline::{CameraRole, Input},
    time::Stamp,
};
use ros2_client::QosProfile;
use std::{
    cell::{Cell, RefCell},
    rc::Rc,
    sync::Arc,
};
use tokio::task::LocalSet;

/// A topic that the node listens to.
#[derive(Clone, Debug)]
pub(super) struct Listening {
    /// What for, as in the parameter file.
    pub(super) role: &'static str,
    /// Absolute name.
    pub(super) topic: String,
    /// `package/msg/Name`.
    pub(super) type_name: &'static str,
    /// What was asked for.
    pub(super) qos: QosProfile,
    /// Whether nothing works without it.
    pub(super) needed: bool,
}

/// What the node listens to, and what it could not find yet.
pub(super) type Inputs = Rc<RefCell<KnownInputs>>;

#[derive(Debug, Default)]
pub(super) struct KnownInputs {
    pub(super) listening: Vec<Listening>,
    /// A sentence on the roles for which there is no topic.
    pub(super) missing: Option<String>,
}

/// Everything that a subscription needs.
pub(super) struct Subscriptions<'a> {
    pub(super) node: &'a mut Node,
    pub(super) arguments: &'a RosArguments,
    pub(super) inbox: &'a Arc<Inbox>,
    pub(super) status: &'a Shared,
    pub(super) tasks: &'a LocalSet,
    /// Where colour images go for a detector of our own; boxes come from it then.
    pub(super) detected: Option<Arc<NewestImage>>,
    /// Where they go to be drawn into.
    pub(super) drawn: Option<ColorImages>,
    pub(super) inputs: &'a Inputs,
}

/// Images kept until they are read: enough for the time that a compressed one takes.
const IMAGE_DEPTH: usize = 10;
const SMALL_DEPTH: usize = 50;

impl Subscriptions<'_> {
    /// Subscribes to all inputs.
    pub(super) fn all(
        &mut self,
        settings: &NodeSettings,
        sources: &Sources,
    ) -> Result<(), NotCreated> {
        let roles = &sources.roles;
        if let Some(topic) = &roles.odometry {
            self.odometry(topic, settings.qos.odometry)?;
        }
        if let Some(topic) = &roles.detections_3d {
            self.detections_3d(settings, sources, topic)?;
        } else {
            let sizes = self.cameras(settings, sources)?;
            self.depth(sources, settings.qos.depth, sizes.clone())?;
            if self.detected.is_none() {
                self.detections(settings, sources, sizes.color)?;
            }
        }
        if self.detected.is_some() || self.drawn.is_some() {
            self.color(settings, sources)?;
        }
        self.transforms("/tf", qos::tf(), false)?;
        self.transforms("/tf_static", qos::tf_static(), true)
    }

    pub(super) fn odometry(&mut self, topic: &str, qos: Qos) -> Result<(), NotCreated> {
        let role = Role { role: "odometry", needed: true, is_present: true };
        let qos = qos::input(qos, SMALL_DEPTH);
        self.listen(role, topic, qos, |odometry: Odometry, _| {
            convert::odometry(&odometry).map(input(Input::Odometry))
        })
    }

    fn depth(&mut self, sources: &Sources, qos: Qos, sizes: ImageSizes) -> Result<(), NotCreated> {
        let role = Role { role: "depth", needed: true, is_present: true };
        let (qos, topic) = (qos::input(qos, IMAGE_DEPTH), &sources.roles.depth);
        if sources.is_raw(topic) {
            self.listen(role, topic, qos, move |image: Image, _| {
                convert::depth_image(&image, &sizes.of_depth()).map(input(Input::Depth))
            })
        } else {
            self.listen(role, topic, qos, move |image: CompressedImage, _| {
                convert::compressed_depth_image(&image, &sizes.of_depth()).map(input(Input::Depth))
            })
        }
    }

    /// Colour images: boxes are found in them, and drawn into them.
    fn color(&mut self, settings: &NodeSettings, sources: &Sources) -> Result<(), NotCreated> {
        let Some(topic) = &sources.roles.rgb else {
            tracing::warn!(
                "publish.debug_image needs colour images, but there are none: name their topic in topics.rgb"
            );
            return Ok(());
        };
        let role = Role { role: "rgb", needed: true, is_present: false };
        let qos = qos::input(settings.qos.rgb, IMAGE_DEPTH);
        let (detected, drawn) = (self.detected.clone(), self.drawn.clone());
        let name: Arc<str> = topic.as_str().into();
        let keep = move |image: ColorMessage| {
            let (stamp, image) = (image.stamp(), Arc::new(image));
            if let Some(detected) = &detected {
                detected.put(&name, Arc::clone(&image));
            }
            if let Some(drawn) = &drawn {
                drawn.add(image);
            }
            Ok(Heard::Kept(stamp))
        };
        if sources.is_raw(topic) {
            self.listen(role, topic, qos, move |image: Image, _| keep(ColorMessage::Raw(image)))
        } else {
            self.listen(role, topic, qos, move |image: CompressedImage, _| {
                keep(ColorMessage::Compressed(image))
            })
        }
    }

    /// Both calibrations. Gives the sizes of the images, as soon as they are known.
    fn cameras(
        &mut self,
        settings: &NodeSettings,
        sources: &Sources,
    ) -> Result<ImageSizes, NotCreated> {
        let roles = &sources.roles;
        let (color_rectified, depth_rectified) =
            (roles.is_color_rectified(), roles.is_depth_rectified());
        let color = ImageSize::default();
        let known = Rc::clone(&color);
        let qos = qos::input(settings.qos.camera_info, SMALL_DEPTH);
        let role = Role { role: "camera_info", needed: true, is_present: false };
        self.listen(role, &roles.camera_info, qos.clone(), move |info: CameraInfo, _| {
            let message = convert::camera(&info, CameraRole::Color, color_rectified)?;
            known.set(Some((message.camera.width(), message.camera.height())));
            Ok(Heard::Input(Input::Camera(message)))
        })?;
        let Some(topic) = &roles.depth_camera_info else {
            return Ok(ImageSizes { color, depth: None });
        };
        let depth = ImageSize::default();
        let known = Rc::clone(&depth);
        let role = Role { role: "depth_camera_info", needed: true, is_present: false };
        self.listen(role, topic, qos, move |info: CameraInfo, _| {
            let message = convert::camera(&info, CameraRole::Depth, depth_rectified)?;
            known.set(Some((message.camera.width(), message.camera.height())));
            Ok(Heard::Input(Input::Camera(message)))
        })?;
        Ok(ImageSizes { color, depth: Some(depth) })
    }

    fn detections(
        &mut self,
        settings: &NodeSettings,
        sources: &Sources,
        size: ImageSize,
    ) -> Result<(), NotCreated> {
        let role = Role { role: "detections", needed: true, is_present: false };
        let topic = &sources.roles.detections;
        let qos = qos::input(settings.qos.detections, SMALL_DEPTH);
        match sources.detections_type(topic, settings.topics.detections_type) {
            DetectionsType::VisionMsgs => {
                self.listen(role, topic, qos, move |boxes: Detection2DArray, left_out| {
                    let (boxes, bad) = convert::detections(&boxes, size.get());
                    left_out.extend(bad);
                    Ok(Heard::Input(Input::Detections(boxes)))
                })
            }
            DetectionsType::YoloMsgs => {
                self.listen(role, topic, qos, move |boxes: DetectionArray, left_out| {
                    let (boxes, bad) = convert::yolo_detections(&boxes, size.get());
                    left_out.extend(bad);
                    Ok(Heard::Input(Input::Detections(boxes)))
                })
            }
        }
    }

    fn detections_3d(
        &mut self,
        settings: &NodeSettings,
        sources: &Sources,
        topic: &str,
    ) -> Result<(), NotCreated> {
        let role = Role { role: "detections_3d", needed: true, is_present: true };
        let qos = qos::input(settings.qos.detections, SMALL_DEPTH);
        match sources.detections_type(topic, settings.topics.detections_type) {
            DetectionsType::VisionMsgs => {
                self.listen(role, topic, qos, |found: Detection3DArray, left_out| {
                    let (found, bad) = convert::found_in_space(&found);
                    left_out.extend(bad);
                    Ok(Heard::Input(Input::Detections3d(found)))
                })
            }
            DetectionsType::YoloMsgs => {
                self.listen(role, topic, qos, |found: DetectionArray, left_out| {
                    let (found, bad) = convert::yolo_found_in_space(&found);
                    left_out.extend(bad);
                    Ok(Heard::Input(Input::Detections3d(found)))
                })
            }
        }
    }

    fn transforms(
        &mut self,
        topic: &'static str,
        qos: QosProfile,
        is_static: bool,
    ) -> Result<(), NotCreated> {
        let role = Role { role: "transforms", needed: false, is_present: false };
        let resolved = self.arguments.resolve(topic);
        self.listen(role, &resolved, qos, move |message: TFMessage, left_out| {
            let (transforms, bad) = convert::transforms(&message);
            left_out.extend(bad);
            Ok(Heard::Input(Input::Transforms { is_static, transforms }))
        })
    }

    /// Subscribes and starts the task that passes messages on.
    fn listen<M: Message + 'static>(
        &mut self,
        role: Role,
        topic: &str,
        qos: QosProfile,
        convert: impl FnMut(M, &mut Vec<ConvertError>) -> Result<Heard, ConvertError> + 'static,
    ) -> Result<(), NotCreated> {
        let subscription = self.node.subscription(topic, &qos)?;
        self.inputs.borrow_mut().listening.push(Listening {
            role: role.role,
            topic: topic.to_owned(),
            type_name: M::TYPE,
            qos,
            needed: role.needed,
        });
        let (inbox, status) = (Arc::clone(self.inbox), self.status.clone());
        let passing = Passing { topic: topic.to_owned(), role, inbox, status };
        self.tasks.spawn_local(passing.on(subscription, convert));
        Ok(())
    }
}

/// `(width, height)` of images, once a calibration said so.
type ImageSize = Rc<Cell<Option<(u32, u32)>>>;

/// Of both cameras, where the depth camera has a calibration of its own.
#[derive(Clone)]
struct ImageSizes {
    color: ImageSize,
    depth: Option<ImageSize>,
}

impl ImageSizes {
    /// What depth images can have, once all calibrations have come: depth may be registered to colour.
    fn of_depth(&self) -> Vec<(u32, u32)> {
        let all = self.depth.iter().chain([&self.color]).map(|size| size.get());
        all.collect::<Option<_>>().unwrap_or_default()
    }
}

impl Sources {
    /// Whether a topic has images as they are: as it was found, or by its name.
    fn is_raw(&self, topic: &str) -> bool {
        match self.types.get(topic) {
            Some(found) => found == Image::TYPE,
            None => without_transport(topic) == topic,
        }
    }

    /// Whose boxes these are: as they were found, or as the settings say.
    fn detections_type(&self, topic: &str, named: DetectionsType) -> DetectionsType {
        match self.types.get(topic).map(String::as_str) {
            Some(DetectionArray::TYPE) => DetectionsType::YoloMsgs,
            Some(_) => DetectionsType::VisionMsgs,
            None => named,
        }
    }
}

/// What a topic is for.
#[derive(Clone, Copy)]
struct Role {
    role: &'static str,
    needed: bool,
    /// Whether its stamps say what time it is in the data.
    is_present: bool,
}

/// The way from one topic to the inbox.
struct Passing {
    topic: String,
    role: Role,
    inbox: Arc<Inbox>,
    status: Shared,
}

impl Passing {
    async fn on<M: Message + 'static>(
        self,
        subscription: Subscription<M>,
        mut convert: impl FnMut(M, &mut Vec<ConvertError>) -> Result<Heard, ConvertError>,
    ) {
        loop {
            let mut left_out = Vec::new();
            let converted = match subscription.take().await {
                Ok(message) => convert(message, &mut left_out),
                Err(NotTaken::BadBytes(why)) => Err(why.into()),
                Err(NotTaken::Failed(why)) => {
                    tracing::warn!("{}: {why}", self.topic);
                    continue;
                }
            };
            for why in left_out {
                self.status.skipped(&self.topic, why);
            }
            match converted {
                Ok(Heard::Input(input)) => {
                    let stamp = stamp_of(&input);
                    self.status.received(&self.topic, stamp, self.role.is_present);
                    self.inbox.put(input);
                }
                Ok(Heard::Kept(stamp)) => self.status.received(&self.topic, Some(stamp), false),
                Err(why) => {
                    self.status.received(&self.topic, None, false);
                    self.status.skipped(&self.topic, why);
                }
            }
            // A flood on one topic must not keep the others waiting.
            tokio::task::yield_now().await;
        }
    }
}

/// What a message is good for.
enum Heard {
    /// The worker takes it.
    Input(Input),
    /// It was kept, for what may follow from others.
    Kept(Stamp),
}

fn input<T>(of: impl Fn(T) -> Input) -> impl Fn(T) -> Heard {
    move |message| Heard::Input(of(message))
}

fn stamp_of(input: &Input) -> Option<Stamp> {
    match input {
        Input::Depth(depth) => Some(depth.stamp),
        Input::Camera(camera) => Some(camera.stamp),
        Input::Odometry(odometry) => Some(odometry.stamp),
        Input::Transforms { transforms, .. } => transforms.iter().map(|t| t.stamp).max(),
        Input::Detections(detections) => Some(detections.stamp),
        Input::Detections3d(detections) => Some(detections.stamp),
    }
}
