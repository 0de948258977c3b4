//! From updates to topics.

use super::{
    names::{parsed, type_name},
    node::NodeError,
    qos,
};
use crate::{
    config::{NodeSettings, RosArguments},
    geometry::Pose,
    mapping::MapObject,
    msg::{
        Message,
        convert::{detections_3d, header, object_markers, odometry_message, path},
        nav_msgs::{Odometry, Path},
        vision_msgs::Detection3DArray,
        visualization_msgs::{Marker, MarkerArray},
    },
    pipeline::{FramePose, ObjectSlam, OdometryMessage, Update},
    time::Stamp,
};
use ros2_client::{Node, Publisher, QosProfile};

/// A publisher of one of our message types.
pub(super) fn publisher<M: Message>(
    node: &mut Node,
    topic: &str,
    qos: QosProfile,
) -> Result<Publisher<M>, NodeError> {
    let failed = |e| NodeError::create(topic, e);
    let dds = node.create_topic(&parsed(topic)?, type_name(M::TYPE), &qos).map_err(failed)?;
    node.create_publisher(&dds, Some(qos)).map_err(failed)
}

/// All outputs that follow from an update.
pub(super) struct Outputs {
    map_frame: String,
    markers: Publisher<MarkerArray>,
    objects: Publisher<Detection3DArray>,
    odometry: Publisher<Odometry>,
    path: Publisher<Path>,
    poses: Vec<FramePose>,
    path_published: usize,
}

impl Outputs {
    pub(super) fn create(
        node: &mut Node,
        arguments: &RosArguments,
        settings: &NodeSettings,
    ) -> Result<Self, NodeError> {
        let topic = |name: &str| arguments.resolve(&format!("~/{name}"));
        Ok(Self {
            map_frame: settings.map_frame.clone(),
            markers: publisher(node, &topic("markers"), qos::latched())?,
            objects: publisher(node, &topic("objects"), qos::latched())?,
            odometry: publisher(node, &topic("odometry"), qos::stream(10))?,
            path: publisher(node, &topic("path"), qos::latched())?,
            poses: Vec::new(),
            path_published: 0,
        })
    }

    /// Publishes what an update changed.
    pub(super) fn publish(&mut self, update: &Update, slam: &ObjectSlam) {
        for pose in &update.poses {
            self.pose(pose, slam.frames().1);
        }
        if let Some(keyframe) = update.keyframes.last() {
            self.map(slam, keyframe.stamp);
        }
    }

    /// The map is empty again: everything that was marked goes.
    pub(super) fn clear(&mut self, stamp: Stamp) {
        self.poses.clear();
        self.path_published = 0;
        let everything = Marker {
            header: header(stamp, &self.map_frame),
            action: Marker::DELETEALL,
            ..Marker::default()
        };
        send(&self.markers, MarkerArray { markers: vec![everything] });
        send(&self.objects, detections_3d([], stamp, &self.map_frame));
        send(&self.path, path(&[], stamp, &self.map_frame));
    }

    fn pose(&mut self, pose: &FramePose, base_frame: &str) {
        self.poses.push(*pose);
        let reading = OdometryMessage {
            stamp: pose.stamp,
            frame_id: self.map_frame.clone(),
            child_frame_id: base_frame.into(),
            odom_from_base: pose.map_from_base,
            covariance: None,
        };
        send(&self.odometry, odometry_message(&reading));
        // A path grows with the drive: published at every pose it would cost the square of it.
        if self.poses.len() >= self.path_published + self.path_published / 4 + 10 {
            self.path_published = self.poses.len();
            let live: Vec<(Stamp, Pose)> =
                self.poses.iter().map(|pose| (pose.stamp, pose.map_from_base)).collect();
            send(&self.path, path(&live, pose.stamp, &self.map_frame));
        }
    }

    /// All objects: who comes late gets only the last message.
    fn map(&self, slam: &ObjectSlam, stamp: Stamp) {
        let objects: Vec<&MapObject> = slam.objects().collect();
        send(&self.markers, object_markers(objects.iter().copied(), false, stamp, &self.map_frame));
        send(&self.objects, detections_3d(objects, stamp, &self.map_frame));
    }
}

/// Publishes; a subscriber that is too slow must not stop the node.
pub(super) fn send<M: Message>(publisher: &Publisher<M>, message: M) {
    if let Err(e) = publisher.publish(message) {
        tracing::debug!("a {} was not sent: {}", M::TYPE, e.forget_data());
    }
}
