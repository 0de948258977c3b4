//! The map as planners want it.

use super::{header, pose_covariance, pose_message};
use crate::{
    geometry::{GroundGrid, OrientedBox, Outline, Pose},
    mapping::MapObject,
    msg::{
        ellipsoid_slam::{LabelBelief, Object, ObjectArray},
        geometry_msgs::{self, PoseStamped, PoseWithCovariance, Vector3},
        nav_msgs::{MapMetaData, OccupancyGrid, Path},
        vision_msgs::{
            BoundingBox3D, Detection3D, Detection3DArray, ObjectHypothesis,
            ObjectHypothesisWithPose,
        },
    },
    time::Stamp,
};
use nalgebra::SMatrix;

/// The objects with all that is known of them.
pub fn object_array<'a>(
    objects: impl IntoIterator<Item = &'a MapObject>,
    stamp: Stamp,
    frame_id: &str,
) -> ObjectArray {
    ObjectArray {
        header: header(stamp, frame_id),
        objects: objects.into_iter().map(object_message).collect(),
    }
}

fn object_message(object: &MapObject) -> Object {
    let ellipsoid = object.ellipsoid();
    let [x, y, z]: [f64; 3] = ellipsoid.semi_axes.into();
    let (outline, profile_exponent, footprint_exponent) = match object.outline {
        Outline::Ellipsoid => (Object::ELLIPSOID, 1.0, 1.0),
        Outline::Cuboid => (Object::CUBOID, 0.0, 0.0),
        Outline::Cylinder => (Object::CYLINDER, 0.0, 1.0),
        Outline::Superquadric(e1, e2) => (Object::SUPERQUADRIC, e1, e2),
    };
    let labels = object.labels().into_iter();
    Object {
        id: object.id.0,
        label: object.label().to_owned(),
        name: object.name().to_owned(),
        locked: object.is_locked(),
        labels: labels.map(|(label, probability)| LabelBelief { label, probability }).collect(),
        existence: object.existence(),
        observations: object.observations,
        first_seen: object.first_seen.into(),
        last_seen: object.last_seen.into(),
        pose: pose_message(&ellipsoid.pose),
        semi_axes: Vector3 { x, y, z },
        covariance: rows(&object.covariance()),
        outline,
        profile_exponent,
        footprint_exponent,
        support_height: object.support_height_m.unwrap_or(f64::NAN),
    }
}

/// Labels with their probabilities: many who read `vision_msgs` take the first for the object's own.
fn most_probable_first(object: &MapObject) -> Vec<(String, f64)> {
    let mut labels: Vec<(String, f64)> = object.labels().into_iter().collect();
    labels.sort_by(|a, b| b.1.total_cmp(&a.1));
    labels
}

/// A matrix in the order of the wire.
pub(super) fn rows(matrix: &SMatrix<f64, 9, 9>) -> [[f64; 9]; 9] {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)]))
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
            covariance: pose_covariance(
                &ellipsoid.pose,
                &object.covariance().fixed_view::<6, 6>(0, 0).into_owned(),
            ),
        };
        let results = most_probable_first(object)
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

/// Covered cells as occupied ones. Of the others nothing is known: where there is no object there may be anything else.
pub fn occupancy_grid(grid: &GroundGrid, stamp: Stamp, frame_id: &str) -> OccupancyGrid {
    let mut origin = geometry_msgs::Pose::default();
    (origin.position.x, origin.position.y) = (grid.origin.x, grid.origin.y);
    let cell = |covered: &bool| match covered {
        true => OccupancyGrid::OCCUPIED,
        false => OccupancyGrid::UNKNOWN,
    };
    OccupancyGrid {
        header: header(stamp, frame_id),
        info: MapMetaData {
            map_load_time: stamp.into(),
            resolution: grid.cell_m as f32,
            width: u32::try_from(grid.width).unwrap_or(u32::MAX),
            height: u32::try_from(grid.height).unwrap_or(u32::MAX),
            origin,
        },
        data: grid.covered.iter().map(cell).collect(),
    }
}
