//! Colour images made small.

use crate::{
    geometry::Rect,
    msg::convert::{ConvertError, RgbImage, jpeg},
};
use base64::{Engine, prelude::BASE64_STANDARD};

/// Quality of the page's JPEGs: blocks begin to show below.
const QUALITY: u8 = 72;

/// A part of an image, at most `max_side` pixels long or high, as a JPEG in base64.
pub(super) fn thumbnail(
    image: &RgbImage,
    part: &Rect,
    max_side: u32,
) -> Result<String, ConvertError> {
    Ok(BASE64_STANDARD.encode(jpeg(&scaled(image, part, max_side), QUALITY)?))
}

/// The whole of an image.
pub(super) fn whole(image: &RgbImage) -> Rect {
    Rect { x_min: 0.0, y_min: 0.0, x_max: image.width.into(), y_max: image.height.into() }
}

/// Each pixel is the mean of those that it stands for. The part is inside the image.
fn scaled(image: &RgbImage, part: &Rect, max_side: u32) -> RgbImage {
    let (left, top) = (part.x_min.floor() as u32, part.y_min.floor() as u32);
    let right = (part.x_max.ceil() as u32).min(image.width).max(left + 1);
    let bottom = (part.y_max.ceil() as u32).min(image.height).max(top + 1);
    let (from_width, from_height) = (right - left, bottom - top);
    let shrink = (f64::from(max_side) / f64::from(from_width.max(from_height))).min(1.0);
    let side = |pixels: u32| ((f64::from(pixels) * shrink).round() as u32).max(1);
    let (width, height) = (side(from_width), side(from_height));
    let mut data = Vec::with_capacity(3 * width as usize * height as usize);
    for y in 0..height {
        let rows = range(y, height, top, from_height);
        for x in 0..width {
            let columns = range(x, width, left, from_width);
            data.extend(mean(image, &columns, &rows));
        }
    }
    RgbImage { width, height, data }
}

/// The pixels that pixel `at` of `count` stands for.
fn range(at: u32, count: u32, first: u32, from: u32) -> std::ops::Range<u32> {
    let edge = |at: u32| first + (u64::from(at) * u64::from(from) / u64::from(count)) as u32;
    edge(at)..edge(at + 1).max(edge(at) + 1)
}

fn mean(image: &RgbImage, columns: &std::ops::Range<u32>, rows: &std::ops::Range<u32>) -> [u8; 3] {
    let mut sum = [0_u32; 3];
    for row in rows.clone() {
        let first = 3 * (row as usize * image.width as usize + columns.start as usize);
        let pixels = image.data.get(first..first + 3 * columns.len()).unwrap_or_default();
        for pixel in pixels.as_chunks::<3>().0 {
            sum.iter_mut().zip(pixel).for_each(|(sum, part)| *sum += u32::from(*part));
        }
    }
    let count = (columns.len() * rows.len()).max(1) as u32;
    sum.map(|sum| (sum / count) as u8)
}
