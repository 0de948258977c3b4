//! Detections in space.

use super::{ConvertError, checked_name, frame, header, pose::pose, pose_message};
use crate::{
    geometry::Pose,
    msg::{
        coco,
        geometry_msgs::{Point, Quaternion, Vector3},
        vision_msgs::{
            BoundingBox3D, Detection3D, Detection3DArray, ObjectHypothesis,
            ObjectHypothesisWithPose,
        },
        yolo_msgs,
    },
    perception::{Detection3d, DetectionError},
    pipeline::Detections3dMessage,
    time::Stamp,
};

/// The objects of a message, and why some of them were left out. Where a detection names a frame of its own, that counts.
///
/// A box of no size is only a place. So is one of depthai's, which has the box in the image, in pixels, where that in space should be, and
/// the place in the pose of the hypothesis.
pub fn found_in_space(message: &Detection3DArray) -> (Detections3dMessage, Vec<ConvertError>) {
    let found = message.detections.iter().map(|wire| {
        let own = &wire.header.frame_id;
        let frame_id = if own.is_empty() { &message.header.frame_id } else { own };
        let classes = wire.results.iter().map(|result| &result.hypothesis);
        let classes = classes.map(|h| (coco::label(&h.class_id).to_owned(), h.score)).collect();
        let BoundingBox3D { center, size } = wire.bbox;
        let other = wire.results.first().map(|result| result.pose.pose);
        let is_at_zero = |at: Point| at.x == 0.0 && at.y == 0.0 && at.z == 0.0;
        let is_depthai = center.position.z == 0.0 && size.z == DEPTHAI_THICKNESS;
        match other {
            Some(place) if is_depthai && !is_at_zero(place.position) => {
                detection(frame_id, place.position, place.orientation, None, classes)
            }
            Some(place) if is_none(size) && is_at_zero(center.position) => {
                detection(frame_id, place.position, place.orientation, None, classes)
            }
            _ => detection(frame_id, center.position, center.orientation, Some(size), classes),
        }
    });
    collected(message.header.stamp.into(), found)
}

/// The same from what the 3D node of `yolo_ros` sends.
pub fn yolo_found_in_space(
    message: &yolo_msgs::DetectionArray,
) -> (Detections3dMessage, Vec<ConvertError>) {
    let found = message.detections.iter().map(|wire| {
        let yolo_msgs::BoundingBox3D { center, size, frame_id } = &wire.bbox3d;
        let index = wire.class_id.to_string();
        let name = if wire.class_name.is_empty() { &index } else { &wire.class_name };
        let classes = vec![(coco::label(name).to_owned(), wire.score)];
        detection(frame_id, center.position, center.orientation, Some(*size), classes)
    });
    collected(message.header.stamp.into(), found)
}

/// Detections as the wire knows them.
pub fn detection_3d_array(message: &Detections3dMessage) -> Detection3DArray {
    let detections = message.detections.iter().map(|detection| {
        let [x, y, z] = detection.extents_m.map_or([0.0; 3], Into::into);
        let hypothesis = |(class_id, score): &(String, f64)| ObjectHypothesisWithPose {
            hypothesis: ObjectHypothesis { class_id: class_id.clone(), score: *score },
            ..ObjectHypothesisWithPose::default()
        };
        Detection3D {
            header: header(message.stamp, &detection.frame_id),
            results: detection.hypotheses().iter().map(hypothesis).collect(),
            bbox: BoundingBox3D {
                center: pose_message(&detection.frame_from_object),
                size: Vector3 { x, y, z },
            },
            id: String::new(),
        }
    });
    let frame_id = message.detections.first().map_or("", |detection| &detection.frame_id);
    Detection3DArray { header: header(message.stamp, frame_id), detections: detections.collect() }
}

fn collected(
    stamp: Stamp,
    found: impl Iterator<Item = Result<Detection3d, ConvertError>>,
) -> (Detections3dMessage, Vec<ConvertError>) {
    let (mut detections, mut bad) = (Vec::new(), Vec::new());
    for detection in found {
        match detection {
            Ok(detection) => detections.push(detection),
            Err(why) => bad.push(why),
        }
    }
    (Detections3dMessage { stamp, detections }, bad)
}

fn detection(
    frame_id: &str,
    at: Point,
    turn: Quaternion,
    size: Option<Vector3>,
    classes: Vec<(String, f64)>,
) -> Result<Detection3d, ConvertError> {
    for (name, _) in &classes {
        checked_name("class", name)?;
    }
    // What was not filled in is not turned.
    let is_unset = [turn.x, turn.y, turn.z, turn.w].iter().all(|part| *part == 0.0);
    let turn = if is_unset { Quaternion { w: 1.0, ..turn } } else { turn };
    let placed: Option<Pose> = pose([at.x, at.y, at.z], turn);
    let extents = size.filter(|size| !is_none(*size)).map(|Vector3 { x, y, z }| [x, y, z].into());
    let placed = placed.ok_or(DetectionError::BadPlace)?;
    Ok(Detection3d::new(frame(frame_id)?, placed, extents, classes)?)
}

fn is_none(size: Vector3) -> bool {
    size.x == 0.0 && size.y == 0.0 && size.z == 0.0
}

/// How thick depthai says that everything is (m).
const DEPTHAI_THICKNESS: f64 = 0.01;
