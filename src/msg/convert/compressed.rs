//! PNG, JPEG and `compressedDepth` data.

use super::{
    ConvertError,
    depth::{metres_of, millimetres_of},
    header, shown,
};
use crate::{msg::sensor_msgs::CompressedImage, perception::DepthImage, pipeline::DepthMessage};
use std::io::Cursor;
use zune_jpeg::{
    JpegDecoder,
    zune_core::{colorspace::ColorSpace, options::DecoderOptions},
};

/// No camera that sees depth takes more; a damaged size must not claim memory.
const MAX_PIXELS: u64 = 1 << 24;
/// `compressedDepth` data begins with an `int32` format and two `float32` parameters of the quantisation.
const DEPTH_HEADER_BYTES: usize = 12;

/// A decoded picture.
pub(super) struct Pixels {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Samples a pixel: 1 gray, 2 gray and alpha, 3 RGB, 4 RGB and alpha.
    pub(super) channels: usize,
    /// 8 or 16; samples of 16 bits have the high byte first.
    pub(super) bits: u8,
    pub(super) data: Vec<u8>,
}

impl Pixels {
    /// Samples of a gray picture of 16 bits.
    pub(super) fn gray16(&self) -> impl Iterator<Item = u16> + '_ {
        self.data.as_chunks().0.iter().map(|bytes| u16::from_be_bytes(*bytes))
    }
}

/// A picture from a PNG file.
pub(super) fn decoded_png(format: &str, data: &[u8]) -> Result<Pixels, ConvertError> {
    decoded_if(format, data, |info| check_size((info.width, info.height), &[]))
}

/// A gray picture of 16 bits from a PNG file, of one of the sizes, where these are known.
pub(super) fn decoded_gray16(
    format: &str,
    data: &[u8],
    sizes: &[(u32, u32)],
) -> Result<Pixels, ConvertError> {
    decoded_if(format, data, |png| {
        let (channels, bits) = (png.color_type.samples(), png.bit_depth as u8);
        if (channels, bits) != (1, 16) {
            let got = format!("{channels} channels of {bits} bits");
            return Err(bad(format, format!("depth needs one channel of 16 bits, got {got}")));
        }
        check_size((png.width, png.height), sizes)
    })
}

/// A picture from a PNG file of which the first bytes are as they have to be: 37 kB can claim gigabytes.
fn decoded_if(
    format: &str,
    data: &[u8],
    check: impl Fn(&png::Info<'_>) -> Result<(), ConvertError>,
) -> Result<Pixels, ConvertError> {
    let problem = |e: png::DecodingError| bad(format, e.to_string());
    let mut decoder = png::Decoder::new(Cursor::new(data));
    // Palettes and single bits become samples of 8 bits; 16 bits stay.
    decoder.set_transformations(png::Transformations::EXPAND);
    check(decoder.read_header_info().map_err(problem)?)?;
    let mut reader = decoder.read_info().map_err(problem)?;
    let bytes = reader.output_buffer_size().ok_or_else(|| bad(format, "no size".into()))?;
    let mut data = vec![0; bytes];
    let frame = reader.next_frame(&mut data).map_err(problem)?;
    data.truncate(frame.buffer_size());
    Ok(Pixels {
        width: frame.width,
        height: frame.height,
        channels: frame.color_type.samples(),
        bits: if frame.bit_depth == png::BitDepth::Sixteen { 16 } else { 8 },
        data,
    })
}

/// A picture of three channels from a JPEG file.
pub(super) fn decoded_jpeg(format: &str, data: &[u8]) -> Result<Pixels, ConvertError> {
    let mut decoder = jpeg_head(format, data)?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    let data = decoder.decode().map_err(|e| bad(format, e.to_string()))?;
    Ok(Pixels { width: width as u32, height: height as u32, channels: 3, bits: 8, data })
}

/// A JPEG file of which the head has been read, with a size that is not too large.
pub(super) fn jpeg_head<'a>(
    format: &str,
    data: &'a [u8],
) -> Result<JpegDecoder<Cursor<&'a [u8]>>, ConvertError> {
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(data), options);
    decoder.decode_headers().map_err(|e| bad(format, e.to_string()))?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    check_size((width as u32, height as u32), &[])?;
    Ok(decoder)
}

/// Depth from `compressedDepth` data: image_transport_plugins, `compressed_depth_image_transport/codec.cpp`.
pub(super) fn compressed_depth(
    image: &CompressedImage,
    sizes: &[(u32, u32)],
) -> Result<DepthImage, ConvertError> {
    let format = image.format.as_str();
    if format.contains("rvl") {
        return Err(ConvertError::UnknownEncoding {
            encoding: shown(format),
            known: "compressedDepth with PNG",
        });
    }
    let Some((head, png)) = image.data.split_first_chunk::<DEPTH_HEADER_BYTES>() else {
        return Err(bad(format, "the data is shorter than its header of 12 bytes".into()));
    };
    let png = decoded_gray16(format, png, sizes)?;
    let samples = png.gray16();
    let metres = match format.split(';').next().unwrap_or_default().trim() {
        "32FC1" => {
            let [a, b] = [4, 8].map(|at| f32_at(head, at));
            samples.map(|inverse| metres_of_inverse(inverse, a, b)).collect()
        }
        "16UC1" | "mono16" => samples.map(metres_of).collect(),
        other => {
            return Err(ConvertError::UnknownEncoding {
                encoding: shown(other),
                known: "16UC1, mono16 and 32FC1 for compressedDepth",
            });
        }
    };
    Ok(DepthImage::new(png.width, png.height, metres)?)
}

/// Depth from a PNG file of 16 bits, in which one metre is `units_per_metre`.
///
/// # Errors
/// When the file is not such a PNG.
pub fn png_depth(png: &[u8], units_per_metre: f64) -> Result<DepthImage, ConvertError> {
    const FORMAT: &str = "16-bit PNG";
    let image = decoded_gray16(FORMAT, png, &[])?;
    let metres = image.gray16().map(|z| (f64::from(z) / units_per_metre) as f32).collect();
    Ok(DepthImage::new(image.width, image.height, metres)?)
}

/// The same depth as `compressedDepth` of `16UC1`, rounded to the millimetre.
///
/// # Errors
/// When the PNG encoder refuses the image.
pub fn compressed_depth_message(depth: &DepthMessage) -> Result<CompressedImage, ConvertError> {
    const FORMAT: &str = "16UC1; compressedDepth";
    let problem = |e: png::EncodingError| bad(FORMAT, e.to_string());
    let mut data = vec![0; DEPTH_HEADER_BYTES];
    let mut encoder = png::Encoder::new(&mut data, depth.image.width(), depth.image.height());
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    // Noise in the low byte of two makes differences of neighbours less regular than the samples themselves:
    // without a filter a real or simulated Kinect's image is 7 to 20 % smaller than with the best one.
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header().map_err(problem)?;
    let samples = depth.image.metres().iter().map(|z| millimetres_of(*z));
    let samples: Vec<u8> = samples.flat_map(u16::to_be_bytes).collect();
    writer.write_image_data(&samples).map_err(problem)?;
    writer.finish().map_err(problem)?;
    let header = header(depth.stamp, &depth.frame_id);
    Ok(CompressedImage { header, format: FORMAT.into(), data })
}

pub(super) fn bad(format: &str, problem: String) -> ConvertError {
    ConvertError::BadCompressedImage { format: shown(format), problem }
}

/// Depth of a quantised inverse depth: `inverse = a / depth + b`, and 0 where there is no reading.
fn metres_of_inverse(inverse: u16, a: f32, b: f32) -> f32 {
    if inverse == 0 { f32::NAN } else { a / (f32::from(inverse) - b) }
}

fn f32_at(bytes: &[u8; DEPTH_HEADER_BYTES], at: usize) -> f32 {
    f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// Whether a size `(width, height)` can be: one of the calibrations' where these are known, or any camera's.
pub(super) fn check_size(got: (u32, u32), sizes: &[(u32, u32)]) -> Result<(), ConvertError> {
    let (width, height) = (u64::from(got.0), u64::from(got.1));
    match sizes.first() {
        Some(info) if !sizes.contains(&got) => Err(ConvertError::SizesDiffer { got, info: *info }),
        // Products of two 32-bit sizes fit into 64 bits.
        _ if width * height > MAX_PIXELS => Err(ConvertError::ImageTooLarge { width, height }),
        _ => Ok(()),
    }
}
