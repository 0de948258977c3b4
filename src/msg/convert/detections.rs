//! 2D detections.

use super::{ConvertError, frame, header};
use crate::{
    geometry::Rect,
    msg::{
        coco,
        vision_msgs::{
            BoundingBox2D, Detection2D, Detection2DArray, ObjectHypothesis,
            ObjectHypothesisWithPose, Point2D, Pose2D,
        },
    },
    perception::{Detection, DetectionError},
    pipeline::DetectionsMessage,
};

/// The boxes of an image, and why some of them were left out.
///
/// Where `image_size` = `(width, height)` is known, boxes without any pixel of the image are left out too.
/// The turn of a box is ignored: detectors that matter here draw upright boxes.
pub fn detections(
    message: &Detection2DArray,
    image_size: Option<(u32, u32)>,
) -> (DetectionsMessage, Vec<ConvertError>) {
    let (mut good, mut bad) = (Vec::new(), Vec::new());
    for wire in &message.detections {
        match detection(wire, image_size) {
            Ok(detection) => good.push(detection),
            Err(why) => bad.push(why),
        }
    }
    let stamp = message.header.stamp.into();
    let frame_id = frame(&message.header.frame_id);
    (DetectionsMessage { stamp, frame_id, detections: good }, bad)
}

/// Boxes as the wire knows them.
pub fn detection_array(message: &DetectionsMessage) -> Detection2DArray {
    let header = header(message.stamp, &message.frame_id);
    let detections = message.detections.iter().map(|detection| Detection2D {
        header: header.clone(),
        results: detection.hypotheses().iter().map(hypothesis).collect(),
        bbox: bounding_box(&detection.rect),
        id: String::new(),
    });
    Detection2DArray { detections: detections.collect(), header: header.clone() }
}

fn detection(
    wire: &Detection2D,
    image_size: Option<(u32, u32)>,
) -> Result<Detection, ConvertError> {
    let BoundingBox2D { center: Pose2D { position, .. }, size_x, size_y } = wire.bbox;
    let (half_x, half_y) = (0.5 * size_x, 0.5 * size_y);
    let rect = Rect::new(
        position.x - half_x,
        position.y - half_y,
        position.x + half_x,
        position.y + half_y,
    )
    .ok_or(DetectionError::BadBox)?;
    if let Some((width, height)) = image_size
        && rect.clipped(width, height).is_none()
    {
        return Err(ConvertError::BoxOutside { width, height });
    }
    let hypotheses = wire.results.iter().map(|result| &result.hypothesis);
    let hypotheses = hypotheses.map(|h| (coco::label(&h.class_id).to_owned(), h.score)).collect();
    Ok(Detection::new(rect, hypotheses)?)
}

fn hypothesis((class_id, score): &(String, f64)) -> ObjectHypothesisWithPose {
    ObjectHypothesisWithPose {
        hypothesis: ObjectHypothesis { class_id: class_id.clone(), score: *score },
        ..ObjectHypothesisWithPose::default()
    }
}

fn bounding_box(rect: &Rect) -> BoundingBox2D {
    let (x, y) = rect.center();
    BoundingBox2D {
        center: Pose2D { position: Point2D { x, y }, theta: 0.0 },
        size_x: rect.width(),
        size_y: rect.height(),
    }
}
