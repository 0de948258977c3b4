//! Each encoding of depth.

use crate::fixtures::{depth, header};
use ellipsoid_slam::{
    msg::{
        convert::{
            compressed_depth_image, compressed_depth_message, depth_image, depth_image_message,
        },
        sensor_msgs::{CompressedImage, Image},
    },
    perception::DepthImage,
};

/// What [`depth`] shows [m]; NaN where there is no reading.
const METRES: [f32; 6] = [1.0, 2.0, f32::NAN, 0.258, 3.0, 65.535];

#[track_caller]
fn check(image: &DepthImage, expected: [f32; 6], tolerance: f32) {
    assert_eq!((image.width(), image.height()), (3, 2));
    for (got, expected) in image.metres().iter().zip(expected) {
        let same = (got - expected).abs() <= tolerance || (got.is_nan() && expected.is_nan());
        assert!(same, "got {:?}, expected {expected:?}", image.metres());
    }
}

/// `depth` with other bytes a pixel, and padding.
fn with_pixels(encoding: &str, big: bool, pixels: [&[u8]; 6], padding: usize) -> Image {
    let step = 3 * pixels[0].len() + padding;
    let mut data = Vec::new();
    for row in pixels.chunks(3) {
        row.iter().for_each(|pixel| data.extend_from_slice(pixel));
        data.resize(data.len() + padding, 0xee);
    }
    Image {
        encoding: encoding.into(),
        is_bigendian: big.into(),
        step: step as u32,
        data,
        ..depth(0)
    }
}

#[test]
fn every_encoding_byte_order_and_padding_gives_the_same_metres() {
    let millimetres = [1000_u16, 2000, 0, 258, 3000, 65535];
    let metres = [1.0_f32, 2.0, f32::INFINITY, 0.258, 3.0, 65.535];
    for padding in [0, 1, 2, 7] {
        for (encoding, big) in
            [("16UC1", false), ("16UC1", true), ("mono16", false), ("mono16", true)]
        {
            let bytes = millimetres.map(|z| if big { z.to_be_bytes() } else { z.to_le_bytes() });
            let image = with_pixels(encoding, big, bytes.each_ref().map(|b| b.as_slice()), padding);
            check(&depth_image(&image, &[]).unwrap().image, METRES, 0.0);
        }
        for big in [false, true] {
            let bytes = metres.map(|z| if big { z.to_be_bytes() } else { z.to_le_bytes() });
            let image = with_pixels("32FC1", big, bytes.each_ref().map(|b| b.as_slice()), padding);
            check(&depth_image(&image, &[]).unwrap().image, METRES, 0.0);
        }
    }
}

#[test]
fn a_last_row_without_padding_is_whole() {
    let mut image = depth(0);
    image.data.truncate(14);
    check(&depth_image(&image, &[]).unwrap().image, METRES, 0.0);
}

#[test]
fn header_is_kept_and_a_leading_slash_dropped() {
    let mut image = depth(7);
    image.header.frame_id = "/camera".into();
    let message = depth_image(&image, &[]).unwrap();
    assert_eq!(
        (message.stamp.as_nanos(), message.frame_id.as_str()),
        (1_700_000_000_700_000_000, "camera")
    );
}

#[test]
fn refusals_name_the_reason() {
    let changed = |change: &dyn Fn(&mut Image)| {
        let mut image = depth(0);
        change(&mut image);
        depth_image(&image, &[]).unwrap_err()
    };
    type Change<'a> = &'a dyn Fn(&mut Image);
    let cases: &[(&str, Change)] = &[
        ("unknown_encoding", &|image| image.encoding = "rgb8".into()),
        ("unknown_encoding", &|image| image.encoding = String::new()),
        ("size_mismatch", &|image| image.data.truncate(13)),
        ("size_mismatch", &|image| image.step = 5),
        ("size_mismatch", &|image| image.step = 0),
        ("size_mismatch", &|image| image.width = u32::MAX),
        ("size_mismatch", &|image| (image.height, image.step) = (u32::MAX, u32::MAX)),
        ("size_mismatch", &|image| image.height = 0),
        ("size_mismatch", &|image| image.width = 0),
    ];
    for (reason, change) in cases {
        assert_eq!(changed(change).reason(), *reason, "{}", changed(change));
    }
    let says = changed(&|image| image.encoding = "64FC1".into()).to_string();
    assert!(says.contains("64FC1") && says.contains("32FC1"), "{says}");
}

fn png16(samples: [u16; 6]) -> Vec<u8> {
    let mut data = Vec::new();
    let mut encoder = png::Encoder::new(&mut data, 3, 2);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&samples.map(u16::to_be_bytes).concat()).unwrap();
    writer.finish().unwrap();
    data
}

fn compressed(format: &str, head: &[u8], png: &[u8]) -> CompressedImage {
    CompressedImage {
        header: header(0, "camera"),
        format: format.into(),
        data: [head, png].concat(),
    }
}

#[test]
fn compressed_depth_is_read_in_both_forms() {
    let millimetres = png16([1000, 2000, 0, 258, 3000, 65535]);
    for (format, head) in [
        ("16UC1; compressedDepth", 12),
        ("16UC1; compressedDepth png", 12),
        ("16UC1; png compressed", 0),
        ("png", 0),
    ] {
        let image = compressed(format, &vec![0; head], &millimetres);
        check(&compressed_depth_image(&image, &[]).unwrap().image, METRES, 0.0);
    }
}

/// As the encoder of image_transport_plugins computes it, with its defaults: 10 m at most, 100 quantisation steps.
#[test]
fn inverse_depth_is_read_with_its_parameters() {
    let (depth_max, quantization) = (10.0_f32, 100.0_f32);
    let a = quantization * (quantization + 1.0);
    let b = 1.0 - a / depth_max;
    let metres = [1.0_f32, 2.0, f32::NAN, 0.5, 3.0, 9.0];
    let inverse = metres.map(|z| if z.is_nan() { 0 } else { (a / z + b) as u16 });
    let head = [&0_i32.to_le_bytes()[..], &a.to_le_bytes(), &b.to_le_bytes()].concat();
    let image = compressed("32FC1; compressedDepth png", &head, &png16(inverse));
    // One step of the quantisation at 9 m is 9² / a = 8 mm.
    check(&compressed_depth_image(&image, &[]).unwrap().image, metres, 0.01);
}

#[test]
fn bad_compressed_depth_is_refused() {
    let png = png16([1; 6]);
    let cases = [
        ("bad_image", compressed("16UC1; compressedDepth", &[0; 12], &png[..png.len() / 2])),
        ("bad_image", compressed("16UC1; compressedDepth", &[0; 5], &[])),
        ("bad_image", compressed("jpeg", &[0xff, 0xd8], &[0; 40])),
        ("unknown_encoding", compressed("16UC1; compressedDepth rvl", &[0; 12], &[1, 2, 3])),
        ("unknown_encoding", compressed("64FC1; compressedDepth", &[0; 12], &png)),
    ];
    for (reason, image) in cases {
        let error = compressed_depth_image(&image, &[]).unwrap_err();
        assert_eq!(error.reason(), reason, "{error}");
    }
}

#[test]
fn a_damaged_png_size_claims_no_memory() {
    let mut png = png16([1; 6]);
    png[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    let crc = crc_of(&png[12..29]).to_be_bytes();
    png[29..33].copy_from_slice(&crc);
    let error = compressed_depth_image(&compressed("16UC1; compressedDepth", &[0; 12], &png), &[])
        .unwrap_err();
    assert_eq!(error.reason(), "size_mismatch", "{error}");
}

/// The checksum of a PNG chunk.
fn crc_of(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1)))
    };
    !bytes.iter().fold(u32::MAX, step)
}

#[test]
fn what_is_written_is_read_again() {
    let message = depth_image(&depth(3), &[]).unwrap();
    let raw = depth_image(&depth_image_message(&message), &[]).unwrap();
    let png = compressed_depth_image(&compressed_depth_message(&message).unwrap(), &[]).unwrap();
    for again in [raw, png] {
        assert_eq!((again.stamp, &again.frame_id), (message.stamp, &message.frame_id));
        check(&again.image, METRES, 0.0);
    }
}

/// A gray PNG of 16 bits in which nothing is to be seen: a few kilobytes for any size.
fn dark_png(width: u32, height: u32) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&vec![0; 2 * (width * height) as usize]).unwrap();
    writer.finish().unwrap();
    file
}

#[test]
fn a_small_file_of_a_large_image_is_refused_before_it_is_decoded() {
    for (size, sizes) in [((5000, 5000), &[][..]), ((64, 48), &[(3, 2), (6, 4)])] {
        let png = dark_png(size.0, size.1);
        for image in
            [compressed("16UC1; compressedDepth", &[0; 12], &png), compressed("png", &[], &png)]
        {
            let error = compressed_depth_image(&image, sizes).unwrap_err();
            assert_eq!(error.reason(), "size_mismatch", "{error}");
        }
    }
    // Whether it was decoded shows in a file that cannot be.
    let cut = &dark_png(5000, 5000)[..200];
    let error = compressed_depth_image(&compressed("png", &[], cut), &[]).unwrap_err();
    assert!(error.to_string().contains("5000x5000"), "{error}");
    let raw = depth_image(&depth(0), &[(3, 3)]).unwrap_err();
    assert_eq!(raw.to_string(), "the depth image is 3x2, the camera info says 3x3");
}
