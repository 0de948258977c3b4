//! From updates to topics.

use super::{
    broadcast::Broadcast,
    color::ColorImages,
    node::NotCreated,
    qos,
    topic::{Latched, send},
    transport::{Node, Publisher},
};
use crate::{
    config::{NodeSettings, RosArguments},
    geometry::Pose,
    mapping::MapObject,
    msg::{
        Message,
        convert::{color_image_message, header},
        ellipsoid_slam::{EllipsoidMeasurementArray, ObjectArray},
        nav_msgs::{OccupancyGrid, Odometry, Path},
        rtabmap_msgs::LandmarkDetections,
        sensor_msgs::Image,
        vision_msgs::Detection3DArray,
        visualization_msgs::MarkerArray,
    },
    pipeline::{Input, Keyframe, ObjectSlam, Update},
    publication::{Outgoing, OutputTopic, Publication, View, Whereabouts, draw_debug_image},
    time::Stamp,
};
use tokio::sync::watch;

/// All outputs that follow from an update.
pub(super) struct Outputs {
    publication: Publication,
    topics: Topics,
    color: ColorImages,
    draws: bool,
}

/// The map and the latest view of it, as services tell of them: a copy, so that nobody waits for an image in work.
#[derive(Clone, Default)]
pub(super) struct Known {
    pub(super) objects: Vec<MapObject>,
    pub(super) view: Option<View>,
    pub(super) whereabouts: Whereabouts,
}

/// Where messages go.
struct Topics {
    /// `map -> odom` is said steadily, so that it is there when somebody asks: by `broadcast.rs`.
    transforms: watch::Sender<Broadcast>,
    odometry: Publisher<Odometry>,
    path: Latched<Path>,
    markers: Latched<MarkerArray>,
    boxes: Latched<Detection3DArray>,
    objects: Latched<ObjectArray>,
    costmap: Latched<OccupancyGrid>,
    measurements: Publisher<EllipsoidMeasurementArray>,
    measurement_markers: Publisher<MarkerArray>,
    landmarks: Publisher<LandmarkDetections>,
    debug_image: Publisher<Image>,
}

impl Outputs {
    pub(super) fn create(
        node: &mut Node,
        arguments: &RosArguments,
        settings: &NodeSettings,
        transforms: watch::Sender<Broadcast>,
        color: ColorImages,
    ) -> Result<Self, NotCreated> {
        Ok(Self {
            publication: Publication::new(settings),
            topics: Topics::create(node, arguments, transforms)?,
            color,
            draws: settings.publish.debug_image,
        })
    }

    /// Takes note of what later messages need from the input.
    pub(super) fn hear(&mut self, input: &Input) {
        self.publication.hear(input);
    }

    /// From now on.
    pub(super) fn change_settings(&mut self, settings: &NodeSettings) {
        self.publication.change_settings(settings);
    }

    /// Publishes what an update changed.
    pub(super) fn publish(&mut self, update: &Update, slam: &ObjectSlam) {
        let messages = self.publication.update(update, slam);
        self.topics.send_all(messages);
        if self.draws {
            for keyframe in &update.keyframes {
                self.draw(keyframe, slam);
            }
        }
    }

    /// Publishes the complete map.
    pub(super) fn finish(&mut self, slam: &ObjectSlam) {
        let messages = self.publication.finish(slam);
        self.topics.send_all(messages);
    }

    /// Another map takes the place of the one before.
    pub(super) fn reset(&mut self, stamp: Stamp, slam: &ObjectSlam) {
        self.topics.transforms.send_replace(Broadcast::default());
        let messages = self.publication.reset(stamp, slam);
        self.topics.send_all(messages);
    }

    /// Publishes the map that somebody has edited.
    pub(super) fn edited(&mut self, stamp: Stamp, slam: &ObjectSlam) {
        let messages = self.publication.edited(stamp, slam);
        self.topics.send_all(messages);
    }

    /// What services tell of the map as it is now.
    pub(super) fn known(&self, slam: &ObjectSlam) -> Known {
        let walls = slam.map().wall_ends().collect();
        Known {
            objects: slam.objects().cloned().collect(),
            view: self.publication.view().cloned(),
            whereabouts: Whereabouts { base: self.publication.base(slam), walls },
        }
    }

    /// Where the base is in the map as it is now.
    pub(super) fn base(&self, slam: &ObjectSlam) -> Option<Pose> {
        self.publication.base(slam)
    }

    fn draw(&mut self, keyframe: &Keyframe, slam: &ObjectSlam) {
        let Some(view) = self.publication.view() else { return };
        let (frame_id, mut image) = match self.color.at(keyframe.stamp) {
            Ok(found) => found,
            Err(why) => return tracing::debug!("no debug image: {why}"),
        };
        draw_debug_image(&mut image, keyframe, slam.objects(), view);
        let message = color_image_message(header(keyframe.stamp, &frame_id), &image);
        self.topics.send(Outgoing::DebugImage(message));
    }
}

impl Topics {
    fn create(
        node: &mut Node,
        arguments: &RosArguments,
        transforms: watch::Sender<Broadcast>,
    ) -> Result<Self, NotCreated> {
        let mut on = On { node, arguments };
        Ok(Self {
            transforms,
            odometry: on.stream(OutputTopic::Odometry)?,
            path: on.latched(OutputTopic::Path)?,
            markers: on.latched(OutputTopic::Markers)?,
            boxes: on.latched(OutputTopic::Boxes)?,
            objects: on.latched(OutputTopic::Objects)?,
            costmap: on.latched(OutputTopic::Costmap)?,
            measurements: on.stream(OutputTopic::Measurements)?,
            measurement_markers: on.stream(OutputTopic::MeasurementMarkers)?,
            landmarks: on.stream(OutputTopic::Landmarks)?,
            debug_image: on.stream(OutputTopic::DebugImage)?,
        })
    }

    fn send_all(&mut self, messages: Vec<(Stamp, Outgoing)>) {
        for (_, message) in messages {
            self.send(message);
        }
        self.path.send_waiting();
        self.markers.send_waiting();
        self.boxes.send_waiting();
        self.objects.send_waiting();
        self.costmap.send_waiting();
    }

    fn send(&mut self, message: Outgoing) {
        match message {
            Outgoing::Transforms(message) => {
                self.transforms.send_modify(|all| all.correction = Some(message));
            }
            Outgoing::ObjectFrames(message) => {
                self.transforms.send_modify(|all| all.objects = message);
            }
            Outgoing::Odometry(message) => send(&self.odometry, *message),
            Outgoing::Path(message) => self.path.send(message),
            Outgoing::Markers(message) => self.markers.send(message),
            Outgoing::Boxes(message) => self.boxes.send(message),
            Outgoing::Objects(message) => self.objects.send(message),
            Outgoing::Costmap(message) => self.costmap.send(message),
            Outgoing::Measurements(message) => send(&self.measurements, message),
            Outgoing::MeasurementMarkers(message) => send(&self.measurement_markers, message),
            Outgoing::Landmarks(message) => send(&self.landmarks, message),
            Outgoing::DebugImage(message) => send(&self.debug_image, message),
        }
    }
}

/// Where publishers are made.
struct On<'a> {
    node: &'a mut Node,
    arguments: &'a RosArguments,
}

impl On<'_> {
    fn stream<M: Message>(&mut self, topic: OutputTopic) -> Result<Publisher<M>, NotCreated> {
        self.node.publisher(&self.arguments.resolve(topic.name()), &qos::stream(STREAM_DEPTH))
    }

    fn latched<M: Message>(&mut self, topic: OutputTopic) -> Result<Latched<M>, NotCreated> {
        let publisher =
            self.node.publisher(&self.arguments.resolve(topic.name()), &qos::latched())?;
        Ok(Latched::new(publisher))
    }
}

/// Messages of a stream kept for a reader that has to ask again.
const STREAM_DEPTH: usize = 10;
