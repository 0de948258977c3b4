//! The map as RViz, Foxglove and planners want it.

use super::{header, pose_message};
use crate::{
    geometry::{OrientedBox, Pose},
    mapping::MapObject,
    msg::{
        builtin_interfaces::Duration,
        geometry_msgs::{PoseStamped, PoseWithCovariance, Vector3},
        nav_msgs::Path,
        std_msgs::ColorRGBA,
        vision_msgs::{
            BoundingBox3D, Detection3D, Detection3DArray, ObjectHypothesis,
            ObjectHypothesisWithPose,
        },
        visualization_msgs::{Marker, MarkerArray},
    },
    time::Stamp,
};

/// A sphere marker stretched to each ellipsoid and a text above it, in the frame of the map.
///
/// Ids are the objects' own, in the namespaces `ellipsoids` and `labels`.
pub fn object_markers<'a>(
    objects: impl IntoIterator<Item = &'a MapObject>,
    stamp: Stamp,
    frame_id: &str,
) -> MarkerArray {
    let markers = objects.into_iter().flat_map(|object| {
        let ellipsoid = object.ellipsoid();
        let mut pose = pose_message(&ellipsoid.pose);
        let [x, y, z]: [f64; 3] = (ellipsoid.semi_axes * 2.0).into();
        let [r, g, b] = color_of(object.label());
        let body = Marker {
            header: header(stamp, frame_id),
            ns: "ellipsoids".into(),
            id: marker_id(object),
            kind: Marker::SPHERE,
            action: Marker::ADD,
            pose,
            scale: Vector3 { x, y, z },
            color: ColorRGBA { r, g, b, a: 0.6 },
            lifetime: Duration::default(),
            ..Marker::default()
        };
        pose.position.z += ellipsoid.semi_axes.z + 0.5 * TEXT_HEIGHT_M;
        let text = Marker {
            ns: "labels".into(),
            kind: Marker::TEXT_VIEW_FACING,
            pose,
            scale: Vector3 { x: 0.0, y: 0.0, z: TEXT_HEIGHT_M },
            color: ColorRGBA { r: 1.0, g: 1.0, b: 1.0, a: 1.0 },
            text: format!("{} {}", object.label(), object.id),
            ..body.clone()
        };
        [body, text]
    });
    MarkerArray { markers: markers.collect() }
}

/// The objects as oriented boxes with stable ids, their labels with probabilities and the covariance of the pose.
pub fn detections_3d<'a>(
    objects: impl IntoIterator<Item = &'a MapObject>,
    stamp: Stamp,
    frame_id: &str,
) -> Detection3DArray {
    let detections = objects.into_iter().map(|object| {
        let ellipsoid = object.ellipsoid();
        let [x, y, z]: [f64; 3] = (ellipsoid.semi_axes * 2.0).into();
        let pose = PoseWithCovariance {
            pose: pose_message(&ellipsoid.pose),
            covariance: fixed_axes_covariance(object),
        };
        let results = object
            .labels()
            .into_iter()
            .map(|(class_id, score)| ObjectHypothesisWithPose {
                hypothesis: ObjectHypothesis { class_id, score },
                pose,
            })
            .collect();
        Detection3D {
            header: header(stamp, frame_id),
            results,
            bbox: BoundingBox3D { center: pose.pose, size: Vector3 { x, y, z } },
            id: object.id.to_string(),
        }
    });
    Detection3DArray { header: header(stamp, frame_id), detections: detections.collect() }
}

/// Boxes with an id and a label each, which are certain.
pub fn boxes_3d<'a>(
    boxes: impl IntoIterator<Item = (u64, &'a str, OrientedBox)>,
    stamp: Stamp,
    frame_id: &str,
) -> Detection3DArray {
    let detections = boxes.into_iter().map(|(id, label, body)| {
        let center = pose_message(&body.pose);
        let [x, y, z]: [f64; 3] = (body.half_extents * 2.0).into();
        let hypothesis = ObjectHypothesis { class_id: label.to_owned(), score: 1.0 };
        let pose = PoseWithCovariance { pose: center, ..PoseWithCovariance::default() };
        Detection3D {
            header: header(stamp, frame_id),
            results: vec![ObjectHypothesisWithPose { hypothesis, pose }],
            bbox: BoundingBox3D { center, size: Vector3 { x, y, z } },
            id: id.to_string(),
        }
    });
    Detection3DArray { header: header(stamp, frame_id), detections: detections.collect() }
}

/// A path through stamped poses.
pub fn path(poses: &[(Stamp, Pose)], stamp: Stamp, frame_id: &str) -> Path {
    let poses = poses
        .iter()
        .map(|(at, pose)| PoseStamped { header: header(*at, frame_id), pose: pose_message(pose) })
        .collect();
    Path { header: header(stamp, frame_id), poses }
}

/// From `[rotation, translation]` in the object's frame to ROS's translation then rotation about fixed axes.
fn fixed_axes_covariance(object: &MapObject) -> [[f64; 6]; 6] {
    let own = object.covariance();
    let rotation = object.ellipsoid().pose.rotation.to_rotation_matrix().into_inner();
    let turn = |row: usize, column: usize| {
        rotation * own.fixed_view::<3, 3>(row, column) * rotation.transpose()
    };
    let blocks = [[turn(3, 3), turn(3, 0)], [turn(0, 3), turn(0, 0)]];
    std::array::from_fn(|i| std::array::from_fn(|j| blocks[i / 3][j / 3][(i % 3, j % 3)]))
}

/// Marker ids are 32 bits wide; object ids count up from one.
fn marker_id(object: &MapObject) -> i32 {
    (object.id.0 % (1 << 31)) as i32
}

/// A colour that stays with the class: hues by a hash of the name, so that any class has one.
fn color_of(label: &str) -> [f32; 3] {
    // FNV-1a: spreads short names well and is the same everywhere.
    let hash = label
        .bytes()
        .fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    let hue = f64::from(hash % 360) / 60.0;
    let channel = |offset: f64| {
        let k = (offset + hue) % 6.0;
        (0.95 - 0.75 * k.min(4.0 - k).clamp(0.0, 1.0)) as f32
    };
    [channel(5.0), channel(3.0), channel(1.0)]
}

const TEXT_HEIGHT_M: f64 = 0.12;
