//! Topics of the output and the messages on them.

use crate::msg::{
    Message,
    cdr::{self, CdrError},
    ellipsoid_slam::{EllipsoidMeasurementArray, ObjectArray},
    nav_msgs::{OccupancyGrid, Odometry, Path},
    rtabmap_msgs::LandmarkDetections,
    sensor_msgs::Image,
    tf2_msgs::TFMessage,
    vision_msgs::Detection3DArray,
    visualization_msgs::MarkerArray,
};

/// A topic of the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OutputTopic {
    /// `map -> odom`.
    Transforms,
    /// The base in the map at each RGB-D frame, with its covariance.
    Odometry,
    /// Where the base was, after all that is known now.
    Path,
    /// All objects as shapes and labels.
    Markers,
    /// All objects as boxes that other programs know.
    Boxes,
    /// All objects with all that is known of them.
    Objects,
    /// The ground that objects cover.
    Costmap,
    /// Where a robot stands before the object that was asked for: the node's alone.
    ApproachPose,
    /// What one image says.
    Measurements,
    /// The same as shapes.
    MeasurementMarkers,
    /// What one image says, as landmarks for RTAB-Map.
    Landmarks,
    /// The colour image with boxes and outlines.
    DebugImage,
}

impl OutputTopic {
    /// All topics.
    pub const ALL: [Self; 12] = [
        Self::Transforms,
        Self::Odometry,
        Self::Path,
        Self::Markers,
        Self::Boxes,
        Self::Objects,
        Self::Costmap,
        Self::ApproachPose,
        Self::Measurements,
        Self::MeasurementMarkers,
        Self::Landmarks,
        Self::DebugImage,
    ];

    /// The name, where `~` stands for the node.
    pub fn name(self) -> &'static str {
        match self {
            Self::Transforms => "/tf",
            Self::Odometry => "~/odometry",
            Self::Path => "~/path",
            Self::Markers => "~/markers",
            Self::Boxes => "~/objects",
            Self::Objects => "~/object_map",
            Self::Costmap => "~/costmap",
            Self::ApproachPose => "~/approach_pose",
            Self::Measurements => "~/measurements",
            Self::MeasurementMarkers => "~/measurement_markers",
            Self::Landmarks => "~/landmarks",
            Self::DebugImage => "~/debug_image",
        }
    }

    /// The name for the node with the default name.
    pub fn default_name(self) -> String {
        self.name().replace('~', "/ellipsoid_slam")
    }

    /// Whether the latest message holds all there is: reliable and transient local with depth 1, so that who comes
    /// later gets it. The others are streams.
    pub fn is_latched(self) -> bool {
        matches!(
            self,
            Self::Path
                | Self::Markers
                | Self::Boxes
                | Self::Objects
                | Self::Costmap
                | Self::ApproachPose
        )
    }
}

/// A message for a topic.
#[derive(Clone, Debug)]
pub enum Outgoing {
    /// For [`OutputTopic::Transforms`].
    Transforms(TFMessage),
    /// For [`OutputTopic::Transforms`], too: a frame for each object.
    ObjectFrames(TFMessage),
    /// For [`OutputTopic::Odometry`].
    Odometry(Box<Odometry>),
    /// For [`OutputTopic::Path`].
    Path(Path),
    /// For [`OutputTopic::Markers`].
    Markers(MarkerArray),
    /// For [`OutputTopic::Boxes`].
    Boxes(Detection3DArray),
    /// For [`OutputTopic::Objects`].
    Objects(ObjectArray),
    /// For [`OutputTopic::Costmap`].
    Costmap(OccupancyGrid),
    /// For [`OutputTopic::Measurements`].
    Measurements(EllipsoidMeasurementArray),
    /// For [`OutputTopic::MeasurementMarkers`].
    MeasurementMarkers(MarkerArray),
    /// For [`OutputTopic::Landmarks`].
    Landmarks(LandmarkDetections),
    /// For [`OutputTopic::DebugImage`].
    DebugImage(Image),
}

impl Outgoing {
    /// Where it goes.
    pub fn topic(&self) -> OutputTopic {
        match self {
            Self::Transforms(_) | Self::ObjectFrames(_) => OutputTopic::Transforms,
            Self::Odometry(_) => OutputTopic::Odometry,
            Self::Path(_) => OutputTopic::Path,
            Self::Markers(_) => OutputTopic::Markers,
            Self::Boxes(_) => OutputTopic::Boxes,
            Self::Objects(_) => OutputTopic::Objects,
            Self::Costmap(_) => OutputTopic::Costmap,
            Self::Measurements(_) => OutputTopic::Measurements,
            Self::MeasurementMarkers(_) => OutputTopic::MeasurementMarkers,
            Self::Landmarks(_) => OutputTopic::Landmarks,
            Self::DebugImage(_) => OutputTopic::DebugImage,
        }
    }

    /// Its type's name and its bytes.
    ///
    /// # Errors
    /// When a string or sequence is longer than CDR can say.
    pub fn cdr(&self) -> Result<(&'static str, Vec<u8>), CdrError> {
        fn of<M: Message>(message: &M) -> Result<(&'static str, Vec<u8>), CdrError> {
            Ok((M::TYPE, cdr::encode(message)?))
        }
        match self {
            Self::Transforms(message) | Self::ObjectFrames(message) => of(message),
            Self::Odometry(message) => of(message.as_ref()),
            Self::Path(message) => of(message),
            Self::Markers(message) | Self::MeasurementMarkers(message) => of(message),
            Self::Boxes(message) => of(message),
            Self::Objects(message) => of(message),
            Self::Costmap(message) => of(message),
            Self::Measurements(message) => of(message),
            Self::Landmarks(message) => of(message),
            Self::DebugImage(message) => of(message),
        }
    }
}
