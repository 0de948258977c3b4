//! The map from above as SVG, to scale.

use crate::{
    geometry::{Outline, Pose},
    mapping::{SavedMap, SavedObject},
    msg::convert::color_of,
};
use nalgebra::{Point2, Point3};
use std::{f64::consts::TAU, fmt::Write};

/// Longer side of the drawing (px).
const LONGER_PX: f64 = 960.0;
/// Scale, at most (px/m).
const MAX_SCALE: f64 = 260.0;
/// Round what is drawn (m).
const MARGIN_M: f64 = 0.6;
/// Height of letters and width of one, about (px).
const LETTER: (f64, f64) = (13.0, 6.9);
/// Corners of what is round.
const ROUND_CORNERS: usize = 48;

/// Metres to pixels: x to the right, y upwards.
struct Sheet {
    low: Point2<f64>,
    size_px: (f64, f64),
    scale: f64,
}

impl Sheet {
    fn over(points: impl Iterator<Item = Point2<f64>>) -> Self {
        let (mut low, mut high) =
            (Point2::new(f64::MAX, f64::MAX), Point2::new(f64::MIN, f64::MIN));
        for point in points {
            (low, high) = (low.inf(&point), high.sup(&point));
        }
        if low.x > high.x {
            (low, high) = (Point2::new(-1.0, -1.0), Point2::new(1.0, 1.0));
        }
        low -= nalgebra::Vector2::repeat(MARGIN_M);
        high += nalgebra::Vector2::repeat(MARGIN_M);
        let extent = high - low;
        let scale = (LONGER_PX / extent.max()).min(MAX_SCALE);
        Self { low, size_px: (extent.x * scale, extent.y * scale), scale }
    }

    fn at(&self, point: &Point2<f64>) -> (f64, f64) {
        let from_low = (point - self.low) * self.scale;
        (from_low.x, self.size_px.1 - from_low.y)
    }

    fn path(&self, points: impl IntoIterator<Item = Point2<f64>>) -> String {
        let mut text = String::new();
        for point in points {
            let (x, y) = self.at(&point);
            let command = if text.is_empty() { 'M' } else { 'L' };
            let _ = write!(text, "{command}{x:.1} {y:.1}");
        }
        text
    }
}

/// The objects with their names and sizes, the walls and the way of the base, on a grid of one metre.
pub fn plan(map: &SavedMap, way: &[Pose], walls: &[[Point2<f64>; 2]]) -> String {
    let feet: Vec<Vec<Point2<f64>>> = map.objects.iter().map(footprint).collect();
    let base = || way.iter().map(|pose| Point2::from(pose.translation.vector.xy()));
    // Walls end where the sheet does: they are longer than what is of interest.
    let sheet = Sheet::over(feet.iter().flatten().copied().chain(base()));
    let (width, height) = sheet.size_px;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    grid(&mut svg, &sheet);
    for wall in walls {
        let _ = writeln!(
            svg,
            "<path d=\"{}\" stroke=\"#8a93a0\" stroke-width=\"6\" stroke-linecap=\"round\"/>",
            sheet.path(*wall)
        );
    }
    let _ = writeln!(
        svg,
        "<path d=\"{}\" fill=\"none\" stroke=\"#2b6cb0\" stroke-width=\"2\" stroke-linejoin=\"round\" opacity=\"0.7\"/>",
        sheet.path(base())
    );
    for (object, foot) in map.objects.iter().zip(&feet) {
        body(&mut svg, &sheet, object, foot);
    }
    names(&mut svg, &sheet, &map.objects, &feet);
    svg.push_str("</svg>\n");
    svg
}

fn grid(svg: &mut String, sheet: &Sheet) {
    let (width, height) = sheet.size_px;
    let lines = |low: f64, pixels: f64| {
        let high = low + pixels / sheet.scale;
        (low.ceil() as i64..=high.floor() as i64).map(|metre| metre as f64)
    };
    for x in lines(sheet.low.x, width) {
        let (at, _) = sheet.at(&Point2::new(x, 0.0));
        let _ = writeln!(svg, "<path d=\"M{at:.1} 0V{height:.0}\" stroke=\"#e6e9ee\"/>");
    }
    for y in lines(sheet.low.y, height) {
        let (_, at) = sheet.at(&Point2::new(0.0, y));
        let _ = writeln!(svg, "<path d=\"M0 {at:.1}H{width:.0}\" stroke=\"#e6e9ee\"/>");
    }
    let (left, low) = (14.0, height - 14.0);
    let right = left + sheet.scale;
    let middle = 0.5 * (left + right);
    let _ = writeln!(
        svg,
        "<path d=\"M{left} {low:.1}H{right:.1}M{left} {:.1}v8M{right:.1} {:.1}v8\" stroke=\"#222222\" stroke-width=\"1.5\"/>\
         <text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#222222\">1 m</text>",
        low - 4.0,
        low - 4.0,
        low - 7.0
    );
}

fn body(svg: &mut String, sheet: &Sheet, object: &SavedObject, foot: &[Point2<f64>]) {
    let color = hex(&object.label);
    let _ = writeln!(
        svg,
        "<path d=\"{}Z\" fill=\"{color}\" fill-opacity=\"0.45\" stroke=\"{color}\" stroke-width=\"1.6\"/>",
        sheet.path(foot.iter().copied())
    );
    // Two standard deviations of the place.
    let across = object.covariance.fixed_view::<2, 2>(3, 3).into_owned().symmetric_eigen();
    let radii = across.eigenvalues.map(|variance| 2.0 * variance.max(0.0).sqrt());
    let ring = (0..ROUND_CORNERS).map(|k| {
        let angle = TAU * k as f64 / ROUND_CORNERS as f64;
        let own = across.eigenvectors.column(0) * (radii.x * angle.cos())
            + across.eigenvectors.column(1) * (radii.y * angle.sin());
        (object.ellipsoid.pose * Point3::new(own.x, own.y, 0.0)).xy()
    });
    let _ = writeln!(
        svg,
        "<path d=\"{}Z\" fill=\"none\" stroke=\"#222222\" stroke-width=\"0.8\" stroke-dasharray=\"2 2\"/>",
        sheet.path(ring)
    );
}

/// The border of what an object covers of the ground.
fn footprint(object: &SavedObject) -> Vec<Point2<f64>> {
    let (pose, half) = (&object.ellipsoid.pose, object.ellipsoid.semi_axes);
    let corner = |x: f64, y: f64| (pose * Point3::new(half.x * x, half.y * y, 0.0)).xy();
    let exponent = match object.outline {
        Outline::Cuboid => {
            return [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
                .map(|(x, y)| corner(x, y))
                .to_vec();
        }
        Outline::Ellipsoid | Outline::Cylinder => 1.0,
        Outline::Superquadric(_, footprint) => footprint,
    };
    let at = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / ROUND_CORNERS as f64).sin_cos();
        corner(cos.signum() * cos.abs().powf(exponent), sin.signum() * sin.abs().powf(exponent))
    };
    (0..ROUND_CORNERS).map(at).collect()
}

/// Names with sizes, each beside its object and none over another one.
fn names(svg: &mut String, sheet: &Sheet, objects: &[SavedObject], feet: &[Vec<Point2<f64>>]) {
    let mut placed: Vec<[f64; 4]> = Vec::new();
    let mut smallest_first: Vec<usize> = (0..objects.len()).collect();
    let area = |at: usize| objects[at].ellipsoid.semi_axes.xy().product();
    smallest_first.sort_by(|a, b| area(*a).total_cmp(&area(*b)));
    for (object, foot) in smallest_first.into_iter().map(|at| (&objects[at], &feet[at])) {
        let name = format!("{} {}", object.name(), object.id);
        let [x, y, z]: [f64; 3] = (object.ellipsoid.semi_axes * 2.0).into();
        let size = format!("{x:.2} × {y:.2} × {z:.2} m");
        let letters = name.chars().count().max(size.chars().count());
        let extent = (LETTER.1 * letters as f64, 2.0 * LETTER.0);
        let center = sheet.at(&object.ellipsoid.center().xy());
        let reach = foot.iter().map(|p| {
            let (x, y) = sheet.at(p);
            (x - center.0).hypot(y - center.1)
        });
        let reach = reach.fold(0.0, f64::max);
        let at = free_place(center, reach, extent, sheet.size_px, &placed);
        placed.push(at);
        let (left, top) = (at[0], at[1]);
        let end = (center.0.clamp(at[0], at[2]), center.1.clamp(at[1], at[3]));
        if (end.0 - center.0).hypot(end.1 - center.1) > reach {
            let _ = writeln!(
                svg,
                "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#555555\" stroke-width=\"0.7\"/>",
                center.0, center.1, end.0, end.1
            );
        }
        let _ = writeln!(
            svg,
            "<g stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\" fill=\"#111111\">\
             <text x=\"{left:.1}\" y=\"{:.1}\" font-weight=\"bold\">{}</text>\
             <text x=\"{left:.1}\" y=\"{:.1}\" fill=\"#444444\" font-size=\"11\">{size}</text></g>",
            top + 0.8 * LETTER.0,
            escaped(&name),
            top + 1.8 * LETTER.0,
        );
    }
}

/// The nearest place for a text round a point that no other text has.
fn free_place(
    center: (f64, f64),
    reach: f64,
    (width, height): (f64, f64),
    sheet: (f64, f64),
    placed: &[[f64; 4]],
) -> [f64; 4] {
    let rect = |x: f64, y: f64| {
        let left = (x - 0.5 * width).clamp(2.0, (sheet.0 - width - 2.0).max(2.0));
        let top = (y - 0.5 * height).clamp(2.0, (sheet.1 - height - 2.0).max(2.0));
        [left, top, left + width, top + height]
    };
    let is_free = |r: &[f64; 4]| {
        placed.iter().all(|o| r[2] < o[0] || o[2] < r[0] || r[3] < o[1] || o[3] < r[1])
    };
    let inside = rect(center.0, center.1);
    if 2.0 * reach > width && is_free(&inside) {
        return inside;
    }
    let rings = (0..12).flat_map(|ring| (0..16).map(move |turn| (ring, turn)));
    let mut places = rings.map(|(ring, turn)| {
        let (sin, cos) = (TAU * f64::from(turn) / 16.0).sin_cos();
        let away = reach + 4.0 + 14.0 * f64::from(ring);
        rect(center.0 + cos * (away + 0.5 * width), center.1 - sin * (away + 0.5 * height))
    });
    places.find(is_free).unwrap_or(inside)
}

pub(super) fn hex(label: &str) -> String {
    let [r, g, b] = color_of(label).map(|part| (255.0 * part).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text that is text wherever it comes from.
fn escaped(text: &str) -> String {
    let mut safe = String::new();
    for letter in text.chars() {
        match letter {
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '&' => safe.push_str("&amp;"),
            '"' => safe.push_str("&quot;"),
            letter if letter.is_control() => safe.push('\u{fffd}'),
            letter => safe.push(letter),
        }
    }
    safe
}
