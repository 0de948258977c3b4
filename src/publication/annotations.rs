//! Boxes and outlines as Foxglove draws them over an image.

use super::{View, outline_in_image};
use crate::{
    mapping::MapObject,
    msg::{
        builtin_interfaces::Time,
        convert::color_of,
        foxglove_msgs::{Color, ImageAnnotations, Point2, PointsAnnotation, TextAnnotation},
    },
    pipeline::{BoxResult, Keyframe},
};
use nalgebra as na;

/// The boxes of a keyframe with their labels, and the outlines of the objects of the map that are in its image. What gave no
/// measurement is gray, and the text says why.
pub fn image_annotations<'a>(
    keyframe: &Keyframe,
    objects: impl IntoIterator<Item = &'a MapObject>,
    view: &View,
) -> ImageAnnotations {
    let timestamp: Time = keyframe.stamp.into();
    let outlines = objects.into_iter().filter_map(|object| outline(object, view));
    let boxes = keyframe.boxes.iter().map(border);
    let points = outlines.chain(boxes).map(|drawn| PointsAnnotation { timestamp, ..drawn });
    let texts = keyframe.boxes.iter().map(|found| TextAnnotation { timestamp, ..name(found) });
    ImageAnnotations { circles: Vec::new(), points: points.collect(), texts: texts.collect() }
}

/// The lines of an object, if any of them is in the image.
fn outline(object: &MapObject, view: &View) -> Option<PointsAnnotation> {
    let lines = outline_in_image(&object.ellipsoid(), object.outline, view);
    let (width, height) = (f64::from(view.camera.width()), f64::from(view.camera.height()));
    let is_inside = |p: &na::Point2<f64>| p.x > 0.0 && p.x < width && p.y > 0.0 && p.y < height;
    if !lines.iter().flatten().any(is_inside) {
        return None;
    }
    Some(PointsAnnotation {
        kind: PointsAnnotation::LINE_LIST,
        points: lines.iter().flatten().map(|p| Point2 { x: p.x, y: p.y }).collect(),
        outline_color: color(object.label()),
        thickness: OUTLINE_PX,
        ..PointsAnnotation::default()
    })
}

fn border(found: &BoxResult) -> PointsAnnotation {
    let rect = &found.detection.rect;
    let corners = [
        (rect.x_min, rect.y_min),
        (rect.x_max, rect.y_min),
        (rect.x_max, rect.y_max),
        (rect.x_min, rect.y_max),
    ];
    PointsAnnotation {
        kind: PointsAnnotation::LINE_LOOP,
        points: corners.map(|(x, y)| Point2 { x, y }).to_vec(),
        outline_color: color_of_box(found),
        thickness: BOX_PX,
        ..PointsAnnotation::default()
    }
}

/// What a box says, above its upper left corner.
fn name(found: &BoxResult) -> TextAnnotation {
    let rect = &found.detection.rect;
    let label = found.detection.label();
    let text = match &found.measurement {
        Ok(_) => format!("{label} {:.2}", found.detection.probability()),
        Err(refused) => format!("{label}: {refused}"),
    };
    TextAnnotation {
        // Letters of a box that begins at the image's border would be outside.
        position: Point2 { x: rect.x_min, y: rect.y_min.max(LETTER_PX) },
        text,
        font_size: LETTER_PX,
        text_color: color_of_box(found),
        background_color: Color { a: 0.6, ..Color::default() },
        ..TextAnnotation::default()
    }
}

fn color_of_box(found: &BoxResult) -> Color {
    const GRAY: Color = Color { r: 0.6, g: 0.6, b: 0.6, a: 1.0 };
    if found.measurement.is_ok() { color(found.detection.label()) } else { GRAY }
}

fn color(label: &str) -> Color {
    let [r, g, b] = color_of(label).map(f64::from);
    Color { r, g, b, a: 1.0 }
}

const OUTLINE_PX: f64 = 2.0;
const BOX_PX: f64 = 1.0;
const LETTER_PX: f64 = 12.0;
