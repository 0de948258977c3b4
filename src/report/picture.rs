//! Colour images made small.

use crate::{
    geometry::Rect,
    msg::convert::{ColorMessage, ConvertError, RgbImage, check_jpeg_head, jpeg},
};
use base64::{display::Base64Display, prelude::BASE64_STANDARD};
use serde::Serializer;
use std::ops::Range;

/// Quality of the page's JPEGs: blocks begin to show below.
const QUALITY: u8 = 72;

/// A part of an image, at most `max_side` pixels long or high, as a JPEG.
pub(super) fn thumbnail(
    image: &RgbImage,
    part: &Rect,
    max_side: u32,
) -> Result<Vec<u8>, ConvertError> {
    jpeg(&scaled(image, part, max_side), QUALITY)
}

/// The file of an image that came as a JPEG of no more than so many bytes, and has a head that can be read.
pub(super) fn small_jpeg(image: &ColorMessage, max_bytes: usize) -> Option<Vec<u8>> {
    let ColorMessage::Compressed(image) = image else { return None };
    let is_small = image.data.len() <= max_bytes && check_jpeg_head(&image.data).is_ok();
    is_small.then(|| image.data.clone())
}

/// Bytes as the page has them.
pub(super) fn as_base64<S: Serializer>(bytes: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&Base64Display::new(bytes, &BASE64_STANDARD))
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
    let columns: Vec<Range<usize>> =
        (0..width).map(|x| range(x, width, left, from_width)).collect();
    let mut data = Vec::with_capacity(3 * width as usize * height as usize);
    for y in 0..height {
        let rows = range(y, height, top, from_height);
        let mut sums = vec![[0_u32; 3]; columns.len()];
        for row in rows.clone() {
            let pixels = image.data.as_chunks::<3>().0;
            let first = row * image.width as usize;
            for (sum, columns) in sums.iter_mut().zip(&columns) {
                let of = pixels.get(first + columns.start..first + columns.end);
                for pixel in of.unwrap_or_default() {
                    sum.iter_mut().zip(pixel).for_each(|(sum, part)| *sum += u32::from(*part));
                }
            }
        }
        for (sum, columns) in sums.iter().zip(&columns) {
            let count = (columns.len() * rows.len()).max(1) as u32;
            data.extend(sum.map(|sum| (sum / count) as u8));
        }
    }
    RgbImage { width, height, data }
}

/// The pixels that pixel `at` of `count` stands for.
fn range(at: u32, count: u32, first: u32, from: u32) -> Range<usize> {
    let edge =
        |at: u32| first as usize + (u64::from(at) * u64::from(from) / u64::from(count)) as usize;
    edge(at)..edge(at + 1).max(edge(at) + 1)
}
