//! From topics to the worker's inbox.

use super::{
    color::ColorImages,
    detecting::NewestImage,
    inbox::Inbox,
    node::NotCreated,
    qos,
    status::Shared,
    transport::{Node, NotTaken, Subscription},
};
use crate::{
    config::{DepthTransport, DetectionsType, NodeSettings, Qos, RgbTransport, RosArguments},
    msg::{
        Message,
        convert::{self, ColorMessage, ConvertError, is_rectified, without_transport},
        nav_msgs::Odometry,
        sensor_msgs::{CameraInfo, CompressedImage, Image},
        tf2_msgs::TFMessage,
        vision_msgs::Detection2DArray,
        yolo_msgs::DetectionArray,
    },
    pipeline::{CameraRole, Input},
    time::Stamp,
};
use ros2_client::QosProfile;
use std::{cell::Cell, rc::Rc, sync::Arc};
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
    pub(super) listening: Vec<Listening>,
}

/// Images kept until they are read: enough for the time that a compressed one takes.
const IMAGE_DEPTH: usize = 10;
const SMALL_DEPTH: usize = 50;

impl Subscriptions<'_> {
    /// Subscribes to all inputs.
    pub(super) fn all(&mut self, settings: &NodeSettings) -> Result<(), NotCreated> {
        let topics = &settings.topics;
        let depth = self.arguments.resolve(&topics.depth);
        // Without colour images, boxes are taken to live in the depth images.
        let images = match topics.rgb.as_str() {
            "" => depth.clone(),
            rgb => self.arguments.resolve(rgb),
        };
        let sizes = self.cameras(settings, is_rectified(&images), is_rectified(&depth))?;
        let topic = depth_topic(&depth, topics.depth_transport);
        self.depth(topic, settings.qos.depth, sizes.clone())?;
        if !topics.odometry.is_empty() {
            let role = Role { role: "odometry", needed: true, is_present: true };
            let topic = self.arguments.resolve(&topics.odometry);
            let qos = qos::input(settings.qos.odometry, SMALL_DEPTH);
            self.listen(role, &topic, qos, |odometry: Odometry, _| {
                convert::odometry(&odometry).map(input(Input::Odometry))
            })?;
        }
        if self.detected.is_none() {
            self.detections(settings, sizes.color)?;
        }
        if self.detected.is_some() || self.drawn.is_some() {
            self.color(settings)?;
        }
        self.transforms("/tf", qos::tf(), false)?;
        self.transforms("/tf_static", qos::tf_static(), true)
    }

    fn depth(&mut self, topic: String, qos: Qos, sizes: ImageSizes) -> Result<(), NotCreated> {
        let role = Role { role: "depth", needed: true, is_present: true };
        let qos = qos::input(qos, IMAGE_DEPTH);
        if without_transport(&topic) == topic {
            self.listen(role, &topic, qos, move |image: Image, _| {
                convert::depth_image(&image, &sizes.of_depth()).map(input(Input::Depth))
            })
        } else {
            self.listen(role, &topic, qos, move |image: CompressedImage, _| {
                convert::compressed_depth_image(&image, &sizes.of_depth()).map(input(Input::Depth))
            })
        }
    }

    /// Colour images: boxes are found in them, and drawn into them.
    fn color(&mut self, settings: &NodeSettings) -> Result<(), NotCreated> {
        let topics = &settings.topics;
        if topics.rgb.is_empty() {
            let wanted = match self.detected {
                Some(_) => "detector.model",
                None => "publish.debug_image",
            };
            tracing::warn!("{wanted} needs colour images, but topics.rgb is empty");
            return Ok(());
        }
        let role = Role { role: "rgb", needed: true, is_present: false };
        let qos = qos::input(settings.qos.rgb, IMAGE_DEPTH);
        let (detected, drawn) = (self.detected.clone(), self.drawn.clone());
        let keep = move |image: ColorMessage| {
            let (stamp, image) = (image.stamp(), Arc::new(image));
            if let Some(detected) = &detected {
                detected.put(Arc::clone(&image));
            }
            if let Some(drawn) = &drawn {
                drawn.add(image);
            }
            Ok(Heard::Kept(stamp))
        };
        let raw = self.arguments.resolve(&topics.rgb);
        let is_raw = without_transport(&raw) == raw;
        match topics.rgb_transport {
            RgbTransport::Raw if is_raw => {
                self.listen(role, &raw, qos, move |image: Image, _| keep(ColorMessage::Raw(image)))
            }
            _ => {
                let topic = if is_raw { format!("{raw}/compressed") } else { raw };
                self.listen(role, &topic, qos, move |image: CompressedImage, _| {
                    keep(ColorMessage::Compressed(image))
                })
            }
        }
    }

    /// Both calibrations. Gives the sizes of the images, as soon as they are known.
    fn cameras(
        &mut self,
        settings: &NodeSettings,
        color_rectified: bool,
        depth_rectified: bool,
    ) -> Result<ImageSizes, NotCreated> {
        let color = ImageSize::default();
        let known = Rc::clone(&color);
        let qos = qos::input(settings.qos.camera_info, SMALL_DEPTH);
        let role = Role { role: "camera_info", needed: true, is_present: false };
        let topic = self.arguments.resolve(&settings.topics.camera_info);
        self.listen(role, &topic, qos.clone(), move |info: CameraInfo, _| {
            let message = convert::camera(&info, CameraRole::Color, color_rectified)?;
            known.set(Some((message.camera.width(), message.camera.height())));
            Ok(Heard::Input(Input::Camera(message)))
        })?;
        if settings.topics.depth_camera_info.is_empty() {
            return Ok(ImageSizes { color, depth: None });
        }
        let depth = ImageSize::default();
        let known = Rc::clone(&depth);
        let role = Role { role: "depth_camera_info", needed: true, is_present: false };
        let topic = self.arguments.resolve(&settings.topics.depth_camera_info);
        self.listen(role, &topic, qos, move |info: CameraInfo, _| {
            let message = convert::camera(&info, CameraRole::Depth, depth_rectified)?;
            known.set(Some((message.camera.width(), message.camera.height())));
            Ok(Heard::Input(Input::Camera(message)))
        })?;
        Ok(ImageSizes { color, depth: Some(depth) })
    }

    fn detections(&mut self, settings: &NodeSettings, size: ImageSize) -> Result<(), NotCreated> {
        let role = Role { role: "detections", needed: true, is_present: false };
        let topic = self.arguments.resolve(&settings.topics.detections);
        let qos = qos::input(settings.qos.detections, SMALL_DEPTH);
        match settings.topics.detections_type {
            DetectionsType::VisionMsgs => {
                self.listen(role, &topic, qos, move |boxes: Detection2DArray, left_out| {
                    let (boxes, bad) = convert::detections(&boxes, size.get());
                    left_out.extend(bad);
                    Ok(Heard::Input(Input::Detections(boxes)))
                })
            }
            DetectionsType::YoloMsgs => {
                self.listen(role, &topic, qos, move |boxes: DetectionArray, left_out| {
                    let (boxes, bad) = convert::yolo_detections(&boxes, size.get());
                    left_out.extend(bad);
                    Ok(Heard::Input(Input::Detections(boxes)))
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
        self.listening.push(Listening {
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

/// The topic of a transport; a name that has it already is taken as it is.
fn depth_topic(depth: &str, transport: DepthTransport) -> String {
    let end = match transport {
        DepthTransport::Raw => "",
        DepthTransport::Compressed => "/compressed",
        DepthTransport::CompressedDepth => "/compressedDepth",
    };
    if without_transport(depth) == depth { format!("{depth}{end}") } else { depth.to_owned() }
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
    }
}
