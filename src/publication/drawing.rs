//! Boxes and outlines drawn into the colour image.

use super::View;
use crate::{
    geometry::{Ellipsoid, Outline, Rect},
    mapping::{MapObject, SavedMap},
    msg::convert::{RgbImage, color_of},
    pipeline::Keyframe,
};
use embedded_graphics::{
    mono_font::{MonoTextStyle, ascii::FONT_7X13},
    pixelcolor::Rgb888,
    prelude::*,
    primitives::{Line, PrimitiveStyle, Rectangle},
    text::{Baseline, Text},
};
use nalgebra::{Point2, Point3, Unit, Vector3};
use std::convert::Infallible;

/// Draws the boxes of a keyframe with their labels, and the outlines of the objects of the map that the camera sees.
/// What gave no measurement is gray.
pub fn draw_debug_image<'a>(
    image: &mut RgbImage,
    keyframe: &Keyframe,
    objects: impl IntoIterator<Item = &'a MapObject>,
    view: &View,
) {
    draw_objects(image, objects.into_iter().map(|o| (o.label(), o.ellipsoid(), o.outline)), view);
    let mut canvas = Canvas(image);
    for found in &keyframe.boxes {
        let label = found.detection.label();
        let color = if found.measurement.is_ok() { color(label) } else { Rgb888::CSS_GRAY };
        let Rect { x_min, y_min, x_max, y_max } = found.detection.rect;
        let corners = Rectangle::with_corners(pixel(x_min, y_min), pixel(x_max, y_max));
        let Ok(()) = corners.into_styled(PrimitiveStyle::with_stroke(color, 1)).draw(&mut canvas);
        let words = match &found.measurement {
            Ok(_) => format!("{label} {:.2}", found.detection.probability()),
            Err(refused) => format!("{label}: {}", refused.reason()),
        };
        let style = MonoTextStyle::new(&FONT_7X13, color);
        let text =
            Text::with_baseline(&words, pixel(x_min + 3.0, y_min + 2.0), style, Baseline::Top);
        let Ok(_) = text.draw(&mut canvas);
    }
}

/// Draws the outlines of bodies in the map with the colours of their labels.
fn draw_objects<'a>(
    image: &mut RgbImage,
    bodies: impl IntoIterator<Item = (&'a str, Ellipsoid, Outline)>,
    view: &View,
) {
    let mut canvas = Canvas(image);
    for (label, body, outline) in bodies {
        let style = PrimitiveStyle::with_stroke(color(label), 2);
        for [from, to] in outline_in_image(&body, outline, view) {
            let line = Line::new(pixel(from.x, from.y), pixel(to.x, to.y));
            let Ok(()) = line.into_styled(style).draw(&mut canvas);
        }
    }
}

/// Draws the outlines of the objects of a saved map.
pub fn draw_saved_objects(image: &mut RgbImage, map: &SavedMap, view: &View) {
    let objects = map.objects.iter();
    draw_objects(image, objects.map(|o| (o.label.as_str(), o.ellipsoid, o.outline)), view);
}

/// Lines (px) that show a body of the map in the image: edges of a cuboid, the rims of a
/// cylinder, the contour of anything else. Nothing for a body
/// that reaches behind the camera.
pub fn outline_in_image(body: &Ellipsoid, outline: Outline, view: &View) -> Vec<[Point2<f64>; 2]> {
    let in_camera = body.transformed(&view.map_from_camera.inverse());
    let strokes = match outline {
        Outline::Cuboid => edges(&in_camera),
        Outline::Cylinder => rims(&in_camera),
        Outline::Ellipsoid | Outline::Superquadric(..) => contour(&in_camera).into_iter().collect(),
    };
    let project = |points: &Vec<Point3<f64>>| {
        let pixels = points.iter().map(|p| view.camera.project(p).filter(|_| p.z > NEAR_M));
        pixels.collect::<Option<Vec<Point2<f64>>>>()
    };
    let projected: Option<Vec<Vec<Point2<f64>>>> = strokes.iter().map(project).collect();
    let strokes = projected.unwrap_or_default();
    let lines = strokes.iter().flat_map(|stroke| stroke.windows(2).map(|two| [two[0], two[1]]));
    lines.collect()
}

/// The twelve edges, in pieces so that lens distortion bends them.
fn edges(body: &Ellipsoid) -> Vec<Vec<Point3<f64>>> {
    let mut strokes = Vec::new();
    for along in 0..3 {
        for (first, second) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let at = |piece: u32| {
                let mut corner = Vector3::zeros();
                corner[along] = 2.0 * f64::from(piece) / f64::from(EDGE_PIECES) - 1.0;
                corner[(along + 1) % 3] = first;
                corner[(along + 2) % 3] = second;
                body.pose * Point3::from(corner.component_mul(&body.semi_axes))
            };
            strokes.push((0..=EDGE_PIECES).map(at).collect());
        }
    }
    strokes
}

/// The rims of an upright cylinder, and the lines between them where rays from the camera touch its side.
fn rims(body: &Ellipsoid) -> Vec<Vec<Point3<f64>>> {
    let at = |angle: f64, z: f64| {
        let (sin, cos) = angle.sin_cos();
        body.pose * Point3::from(Vector3::new(cos, sin, z).component_mul(&body.semi_axes))
    };
    let turn = |piece: u32| std::f64::consts::TAU * f64::from(piece) / f64::from(CONTOUR_PIECES);
    let rim = |z: f64| (0..=CONTOUR_PIECES).map(|piece| at(turn(piece), z)).collect();
    let mut strokes = vec![rim(-1.0), rim(1.0)];
    let eye = body.pose.inverse_transform_point(&Point3::origin());
    let eye = eye.coords.component_div(&body.semi_axes);
    let distance = eye.xy().norm();
    if distance > 1.0 {
        let (middle, half) = (eye.y.atan2(eye.x), (1.0 / distance).acos());
        strokes.extend([middle - half, middle + half].map(|a| vec![at(a, -1.0), at(a, 1.0)]));
    }
    strokes
}

/// Where rays from the camera touch an ellipsoid. In coordinates that make it the unit sphere, these are the points with
/// `p · eye = 1`: a circle.
fn contour(body: &Ellipsoid) -> Option<Vec<Point3<f64>>> {
    let eye = body.pose.inverse_transform_point(&Point3::origin());
    let eye = eye.coords.component_div(&body.semi_axes);
    let distance = eye.norm();
    if distance <= 1.0 {
        return None;
    }
    let axis = Unit::new_unchecked(eye / distance);
    let across = Unit::new_normalize(axis.cross(&if axis.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    }));
    let up = axis.cross(&across);
    let (center, radius) = (axis.into_inner() / distance, (1.0 - distance.powi(-2)).sqrt());
    let at = |piece: u32| {
        let angle = std::f64::consts::TAU * f64::from(piece) / f64::from(CONTOUR_PIECES);
        let on_sphere = center + (across.into_inner() * angle.cos() + up * angle.sin()) * radius;
        body.pose * Point3::from(on_sphere.component_mul(&body.semi_axes))
    };
    Some((0..=CONTOUR_PIECES).map(at).collect())
}

fn color(label: &str) -> Rgb888 {
    let [r, g, b] = color_of(label).map(|part| (255.0 * part) as u8);
    Rgb888::new(r, g, b)
}

/// Far outside of any image it does not matter where.
fn pixel(x: f64, y: f64) -> embedded_graphics::prelude::Point {
    let bounded = |v: f64| v.clamp(-10_000.0, 10_000.0).round() as i32;
    embedded_graphics::prelude::Point::new(bounded(x), bounded(y))
}

/// An image that can be drawn into; what is outside of it is left out.
struct Canvas<'a>(&'a mut RgbImage);

impl OriginDimensions for Canvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.0.width, self.0.height)
    }
}

impl DrawTarget for Canvas<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        for Pixel(at, color) in pixels {
            let (Ok(x), Ok(y)) = (u32::try_from(at.x), u32::try_from(at.y)) else { continue };
            if x >= self.0.width || y >= self.0.height {
                continue;
            }
            let first = 3 * (y as usize * self.0.width as usize + x as usize);
            if let Some(bytes) = self.0.data.get_mut(first..first + 3) {
                bytes.copy_from_slice(&[color.r(), color.g(), color.b()]);
            }
        }
        Ok(())
    }
}

const NEAR_M: f64 = 0.05;
const EDGE_PIECES: u32 = 8;
const CONTOUR_PIECES: u32 = 64;
