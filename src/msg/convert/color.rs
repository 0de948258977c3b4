//! Colour images; nothing calls these unless a picture is to be drawn.

use super::{
    ConvertError,
    compressed::{Pixels, bad, decoded_jpeg, decoded_png, jpeg_head},
    depth::rows,
    shown,
};
use crate::msg::{
    sensor_msgs::{CompressedImage, Image},
    std_msgs::Header,
};

/// A colour image of 8 bits a channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbImage {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue of each pixel, row-major without padding.
    pub data: Vec<u8>,
}

/// Colours of an image in `rgb8`, `bgr8`, `rgba8`, `bgra8` or `mono8`.
///
/// # Errors
/// When the encoding is another one or the data does not fit the size.
pub fn color_image(image: &Image) -> Result<RgbImage, ConvertError> {
    // Position of red, green and blue within a pixel.
    let (pixel_bytes, [r, g, b]) = match image.encoding.as_str() {
        "rgb8" | "8UC3" => (3, [0, 1, 2]),
        "bgr8" => (3, [2, 1, 0]),
        "rgba8" => (4, [0, 1, 2]),
        "bgra8" => (4, [2, 1, 0]),
        "mono8" | "8UC1" => (1, [0, 0, 0]),
        other => {
            return Err(ConvertError::UnknownEncoding {
                encoding: shown(other),
                known: "rgb8, bgr8, rgba8, bgra8 and mono8 for colour",
            });
        }
    };
    let mut data = Vec::with_capacity(image.data.len() / pixel_bytes * 3);
    for row in rows(image, pixel_bytes)? {
        data.extend(row.chunks_exact(pixel_bytes).flat_map(|p| [p[r], p[g], p[b]]));
    }
    Ok(RgbImage { width: image.width, height: image.height, data })
}

/// Colours of a JPEG or PNG image; the data says which it is.
///
/// # Errors
/// When it is neither or does not decode.
pub fn compressed_color_image(image: &CompressedImage) -> Result<RgbImage, ConvertError> {
    let format = image.format.as_str();
    let pixels = match image.data.as_slice() {
        [0xff, 0xd8, ..] => decoded_jpeg(format, &image.data)?,
        [0x89, b'P', b'N', b'G', ..] => decoded_png(format, &image.data)?,
        _ => return Err(bad(format, "the data is neither JPEG nor PNG".into())),
    };
    Ok(rgb_of(pixels))
}

/// The same picture as `rgb8`.
pub fn color_image_message(header: Header, image: &RgbImage) -> Image {
    Image {
        header,
        height: image.height,
        width: image.width,
        encoding: "rgb8".into(),
        is_bigendian: 0,
        step: 3 * image.width,
        data: image.data.clone(),
    }
}

/// The same picture as a JPEG of `quality` 1 to 100.
///
/// # Errors
/// When a side is longer than the 65,535 pixels that JPEG allows.
pub fn compressed_color_message(
    header: Header,
    image: &RgbImage,
    quality: u8,
) -> Result<CompressedImage, ConvertError> {
    const FORMAT: &str = "rgb8; jpeg compressed bgr8";
    Ok(CompressedImage { header, format: FORMAT.into(), data: jpeg(image, quality)? })
}

/// A JPEG file of `quality` 1 to 100, in one interleaved scan with the usual Huffman tables: zune-jpeg 0.5.15 decodes the
/// three scans that tables of its own would bring as stripes where chroma is subsampled.
///
/// # Errors
/// When a side is longer than the 65,535 pixels that JPEG allows.
pub fn jpeg(image: &RgbImage, quality: u8) -> Result<Vec<u8>, ConvertError> {
    let (Ok(width), Ok(height)) = (u16::try_from(image.width), u16::try_from(image.height)) else {
        return Err(ConvertError::ImageTooLarge {
            width: image.width.into(),
            height: image.height.into(),
        });
    };
    let mut file = Vec::new();
    jpeg_encoder::Encoder::new(&mut file, quality)
        .encode(&image.data, width, height, jpeg_encoder::ColorType::Rgb)
        .map_err(|e| bad("jpeg", e.to_string()))?;
    Ok(file)
}

/// Whether the head of a JPEG file can be read; the rest is not looked at.
///
/// # Errors
/// When it cannot, or says a size that no camera has.
pub fn check_jpeg_head(file: &[u8]) -> Result<(), ConvertError> {
    jpeg_head("jpeg", file).map(drop)
}

/// A PNG file.
///
/// # Errors
/// When the data does not fit the size.
pub fn png(image: &RgbImage) -> Result<Vec<u8>, ConvertError> {
    let problem = |e: png::EncodingError| bad("png", e.to_string());
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, image.width, image.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fast);
    encoder.write_header().and_then(|mut w| w.write_image_data(&image.data)).map_err(problem)?;
    Ok(file)
}

/// Three samples of 8 bits a pixel: alpha and low bytes are dropped, gray is repeated.
fn rgb_of(pixels: Pixels) -> RgbImage {
    let Pixels { width, height, channels, bits, data } = pixels;
    if channels == 3 && bits == 8 {
        return RgbImage { width, height, data };
    }
    let sample_bytes = usize::from(bits / 8);
    let colors = if channels < 3 { [0, 0, 0] } else { [0, 1, 2] };
    let pixels = data.chunks_exact(channels * sample_bytes);
    let data = pixels.flat_map(|p| colors.map(|channel| p[channel * sample_bytes])).collect();
    RgbImage { width, height, data }
}
