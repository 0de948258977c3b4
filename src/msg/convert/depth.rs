//! Depth images.

use super::{
    ConvertError,
    compressed::{check_size, compressed_depth, decoded_gray16},
    frame, header, shown,
};
use crate::{
    msg::sensor_msgs::{CompressedImage, Image},
    perception::DepthImage,
    pipeline::DepthMessage,
};

/// A depth image from `16UC1` or `mono16` (millimetres, 0 = none) or `32FC1` (metres, NaN and infinity = none).
///
/// Only images of one of `sizes` = `(width, height)` are good, those of the calibrations; empty: these are not known.
///
/// # Errors
/// When the encoding is another one or the data does not fit the size.
pub fn depth_image(image: &Image, sizes: &[(u32, u32)]) -> Result<DepthMessage, ConvertError> {
    let big = image.is_bigendian != 0;
    let metres: Vec<f32> =
        match image.encoding.as_str() {
            "16UC1" | "mono16" => pixels(image, |bytes: [u8; 2]| {
                metres_of(if big { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
            })?,
            "32FC1" => pixels(image, |bytes: [u8; 4]| {
                if big { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) }
            })?,
            _ => return Err(unknown(&image.encoding)),
        };
    check_size((image.width, image.height), sizes)?;
    Ok(DepthMessage {
        stamp: image.header.stamp.into(),
        frame_id: frame(&image.header.frame_id)?,
        image: DepthImage::new(image.width, image.height, metres)?,
    })
}

/// A depth image from a `compressedDepth` message, or from one whose data is a PNG of 16-bit millimetres.
///
/// # Errors
/// When the format is another one, the data does not decode, or the size is not that of its calibration, as in
/// [`depth_image`]; sizes are looked at before anything is decoded.
pub fn compressed_depth_image(
    image: &CompressedImage,
    sizes: &[(u32, u32)],
) -> Result<DepthMessage, ConvertError> {
    let image_in = if !image.data.starts_with(PNG_MAGIC) {
        compressed_depth(image, sizes)?
    } else {
        let png = decoded_gray16(&image.format, &image.data, sizes)?;
        let metres = png.gray16().map(metres_of).collect();
        DepthImage::new(png.width, png.height, metres)?
    };
    Ok(DepthMessage {
        stamp: image.header.stamp.into(),
        frame_id: frame(&image.header.frame_id)?,
        image: image_in,
    })
}

/// The same depth as `16UC1`, rounded to the millimetre; what is farther than 65.5 m is lost.
pub fn depth_image_message(depth: &DepthMessage) -> Image {
    let (width, height) = (depth.image.width(), depth.image.height());
    let millimetres = depth.image.metres().iter().map(|z| millimetres_of(*z));
    Image {
        header: header(depth.stamp, &depth.frame_id),
        height,
        width,
        encoding: "16UC1".into(),
        is_bigendian: 0,
        step: 2 * width,
        data: millimetres.flat_map(u16::to_le_bytes).collect(),
    }
}

/// Metres of a reading in millimetres; 0 means none and stays 0, which the core takes as none.
pub(super) fn metres_of(millimetres: u16) -> f32 {
    f32::from(millimetres) / 1000.0
}

/// Millimetres of a depth; 0 where there is none or it does not fit.
pub(super) fn millimetres_of(metres: f32) -> u16 {
    let millimetres = (metres * 1000.0).round();
    if millimetres >= 1.0 && millimetres <= f32::from(u16::MAX) { millimetres as u16 } else { 0 }
}

/// First bytes of a PNG file; `compressedDepth` data begins with a header instead.
const PNG_MAGIC: &[u8] = b"\x89PNG";

fn unknown(encoding: &str) -> ConvertError {
    ConvertError::UnknownEncoding {
        encoding: shown(encoding),
        known: "16UC1, mono16 and 32FC1 for depth",
    }
}

/// Pixels of `N` bytes each, row by row without the padding at the rows' ends.
fn pixels<const N: usize>(
    image: &Image,
    value: impl Fn([u8; N]) -> f32,
) -> Result<Vec<f32>, ConvertError> {
    let mut out = Vec::with_capacity(image.data.len() / N);
    for row in rows(image, N)? {
        out.extend(row.as_chunks::<N>().0.iter().map(|bytes| value(*bytes)));
    }
    Ok(out)
}

/// The rows of an image with `pixel_bytes` bytes a pixel, without padding.
pub(super) fn rows(
    image: &Image,
    pixel_bytes: usize,
) -> Result<impl Iterator<Item = &[u8]>, ConvertError> {
    let (width, height) = (image.width as usize, image.height as usize);
    let step = image.step as usize;
    // Products of two 32-bit sizes fit into 64 bits.
    let row = width * pixel_bytes;
    let needed = (height.saturating_sub(1) * step).saturating_add(row);
    if step < row || row == 0 || height == 0 || image.data.len() < needed {
        return Err(ConvertError::ImageSize {
            width: image.width,
            height: image.height,
            encoding: shown(&image.encoding),
            step: image.step,
            got: image.data.len(),
        });
    }
    Ok(image.data.chunks(step).take(height).map(move |bytes| &bytes[..row]))
}
