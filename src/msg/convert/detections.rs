//! 2D detections.

use super::{ConvertError, RgbImage, checked_name, frame, header};
use crate::{
    geometry::Rect,
    msg::{
        coco,
        std_msgs::Header,
        vision_msgs::{
            BoundingBox2D, Detection2D, Detection2DArray, ObjectHypothesis,
            ObjectHypothesisWithPose, Point2D, Pose2D,
        },
        yolo_msgs,
    },
    perception::{Detection, DetectionError, Mask},
    pipeline::DetectionsMessage,
};

/// A detector of our own: the boxes of an image, or a sentence that says why there are none.
pub type FindBoxes = Box<dyn FnMut(&RgbImage) -> Result<Vec<Detection>, String> + Send>;

/// The boxes of an image, and why some of them were left out.
///
/// Where `image_size` = `(width, height)` is known, boxes without any pixel of the image are left out too.
/// The turn of a box is ignored: detectors that matter here draw upright boxes.
pub fn detections(
    message: &Detection2DArray,
    image_size: Option<(u32, u32)>,
) -> (DetectionsMessage, Vec<ConvertError>) {
    let boxes = message.detections.iter().map(|wire| {
        let BoundingBox2D { center: Pose2D { position, .. }, size_x, size_y } = wire.bbox;
        let classes = wire.results.iter().map(|result| &result.hypothesis);
        let classes = classes.map(|h| (coco::label(&h.class_id).to_owned(), h.score)).collect();
        detection([position.x, position.y], [size_x, size_y], classes, image_size)
    });
    collected(&message.header, boxes.map(|found| Ok((found?, None))))
}

/// The same from what `yolo_ros` sends, with masks where there are any. A class without a name is named by its index in COCO; of a
/// mask that cannot be used, the box stays.
pub fn yolo_detections(
    message: &yolo_msgs::DetectionArray,
    image_size: Option<(u32, u32)>,
) -> (DetectionsMessage, Vec<ConvertError>) {
    let boxes = message.detections.iter().map(|wire| {
        let yolo_msgs::BoundingBox2D { center: yolo_msgs::Pose2D { position, .. }, size } =
            wire.bbox;
        let index = wire.class_id.to_string();
        let name = if wire.class_name.is_empty() { &index } else { &wire.class_name };
        let classes = vec![(coco::label(name).to_owned(), wire.score)];
        let mut found = detection([position.x, position.y], [size.x, size.y], classes, image_size)?;
        let unused = match mask(&found.rect, &wire.mask, image_size) {
            Ok(mask) => {
                found.mask = mask;
                None
            }
            Err(why) => Some(why),
        };
        Ok((found, unused))
    });
    collected(&message.header, boxes)
}

/// The mask of a box; nothing where the network gives none.
fn mask(
    rect: &Rect,
    wire: &yolo_msgs::Mask,
    image_size: Option<(u32, u32)>,
) -> Result<Option<Mask>, ConvertError> {
    let yolo_msgs::Mask { width, height, data } = wire;
    if data.is_empty() {
        return Ok(None);
    }
    let is_of = |(columns, rows): (u32, u32)| {
        (i64::from(*width), i64::from(*height)) == (columns.into(), rows.into())
    };
    if let Some(info) = image_size.filter(|size| !is_of(*size)) {
        return Err(ConvertError::MaskSize { got: (*width, *height), info });
    }
    let corners: Vec<[f64; 2]> = data.iter().map(|corner| [corner.x, corner.y]).collect();
    Ok(Some(Mask::from_outline(rect, &corners)?))
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

/// The same as `yolo_ros` sends it: the most probable class alone, and masks in images of a size.
pub fn yolo_detection_array(
    message: &DetectionsMessage,
    image_size: (u32, u32),
) -> yolo_msgs::DetectionArray {
    let of_size = |mask: &Mask| {
        let data = mask.outline().into_iter().map(|[x, y]| yolo_msgs::Point2D { x, y });
        let (width, height) = image_size;
        yolo_msgs::Mask { height: height as i32, width: width as i32, data: data.collect() }
    };
    let detections = message.detections.iter().map(|detection| {
        let (x, y) = detection.rect.center();
        let position = yolo_msgs::Point2D { x, y };
        let size = yolo_msgs::Vector2 { x: detection.rect.width(), y: detection.rect.height() };
        yolo_msgs::Detection {
            class_name: detection.label().to_owned(),
            score: detection.probability(),
            bbox: yolo_msgs::BoundingBox2D {
                center: yolo_msgs::Pose2D { position, theta: 0.0 },
                size,
            },
            mask: detection.mask.as_ref().map_or_else(Default::default, of_size),
            ..yolo_msgs::Detection::default()
        }
    });
    let header = header(message.stamp, &message.frame_id);
    yolo_msgs::DetectionArray { detections: detections.collect(), header }
}

fn collected(
    header: &Header,
    boxes: impl Iterator<Item = Result<(Detection, Option<ConvertError>), ConvertError>>,
) -> (DetectionsMessage, Vec<ConvertError>) {
    let (mut detections, mut bad) = (Vec::new(), Vec::new());
    for detection in boxes {
        match detection {
            Ok((detection, less)) => {
                detections.push(detection);
                bad.extend(less);
            }
            Err(why) => bad.push(why),
        }
    }
    // Nothing follows from the frame of boxes.
    let frame_id = frame(&header.frame_id).unwrap_or_else(|why| {
        bad.push(why);
        String::new()
    });
    (DetectionsMessage { stamp: header.stamp.into(), frame_id, detections }, bad)
}

fn detection(
    [x, y]: [f64; 2],
    [width, height]: [f64; 2],
    classes: Vec<(String, f64)>,
    image_size: Option<(u32, u32)>,
) -> Result<Detection, ConvertError> {
    for (name, _) in &classes {
        checked_name("class", name)?;
    }
    let (half_x, half_y) = (0.5 * width, 0.5 * height);
    let rect =
        Rect::new(x - half_x, y - half_y, x + half_x, y + half_y).ok_or(DetectionError::BadBox)?;
    if let Some((width, height)) = image_size
        && rect.clipped(width, height).is_none()
    {
        return Err(ConvertError::BoxOutside { width, height });
    }
    Ok(Detection::new(rect, classes)?)
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
