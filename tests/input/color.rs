//! Each encoding of colour.

use crate::fixtures::header;
use ellipsoid_slam::msg::{
    convert::{
        RgbImage, color_image, color_image_message, compressed_color_image,
        compressed_color_message,
    },
    sensor_msgs::{CompressedImage, Image},
};

/// 2x2: orange, blue; dark green, gray.
const RGB: [[u8; 3]; 4] = [[250, 120, 10], [5, 6, 240], [1, 80, 2], [90, 90, 90]];

fn raw(encoding: &str, pixels: [Vec<u8>; 4], padding: usize) -> Image {
    let step = 2 * pixels[0].len() + padding;
    let mut data = Vec::new();
    for row in pixels.chunks(2) {
        data.extend(row.concat());
        data.resize(data.len() + padding, 0xee);
    }
    Image {
        header: header(0, "camera"),
        height: 2,
        width: 2,
        encoding: encoding.into(),
        is_bigendian: 0,
        step: step as u32,
        data,
    }
}

#[test]
fn every_encoding_gives_the_same_colours() {
    for padding in [0, 3] {
        let cases = [
            ("rgb8", RGB.map(|[r, g, b]| vec![r, g, b])),
            ("bgr8", RGB.map(|[r, g, b]| vec![b, g, r])),
            ("rgba8", RGB.map(|[r, g, b]| vec![r, g, b, 7])),
            ("bgra8", RGB.map(|[r, g, b]| vec![b, g, r, 7])),
        ];
        for (encoding, pixels) in cases {
            let image = color_image(&raw(encoding, pixels, padding)).unwrap();
            assert_eq!(image, RgbImage { width: 2, height: 2, data: RGB.concat() }, "{encoding}");
        }
        let gray = color_image(&raw("mono8", [1, 2, 3, 4].map(|v| vec![v]), padding)).unwrap();
        assert_eq!(gray.data, [1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4]);
    }
}

#[test]
fn unknown_and_short_images_are_refused() {
    let mut image = raw("yuv422", RGB.map(|p| p.to_vec()), 0);
    assert_eq!(color_image(&image).unwrap_err().reason(), "unknown_encoding");
    image.encoding = "rgb8".into();
    image.data.pop();
    assert_eq!(color_image(&image).unwrap_err().reason(), "size_mismatch");
}

fn png_of(color: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, 2, 2);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    out
}

fn decoded(format: &str, data: Vec<u8>) -> RgbImage {
    compressed_color_image(&CompressedImage { header: header(0, ""), format: format.into(), data })
        .unwrap()
}

#[test]
fn png_in_all_its_kinds() {
    use png::{
        BitDepth::{Eight, Sixteen},
        ColorType::{Grayscale, Rgb, Rgba},
    };
    let expected = RGB.concat();
    assert_eq!(decoded("png", png_of(Rgb, Eight, &expected)).data, expected);
    let rgba: Vec<u8> = RGB.iter().flat_map(|[r, g, b]| [*r, *g, *b, 9]).collect();
    assert_eq!(decoded("rgba8; png compressed", png_of(Rgba, Eight, &rgba)).data, expected);
    let wide: Vec<u8> = expected.iter().flat_map(|v| [*v, 0x55]).collect();
    assert_eq!(decoded("png", png_of(Rgb, Sixteen, &wide)).data, expected);
    assert_eq!(decoded("png", png_of(Grayscale, Eight, &[1, 2, 3, 4])).data[3..6], [2, 2, 2]);
}

#[test]
fn jpeg_in_colour_and_gray() {
    // 16x16 halves: JPEG blurs, but not across blocks.
    let pixel = |i: usize| if i % 16 < 8 { [250_u8, 20, 10] } else { [10, 30, 240] };
    let data: Vec<u8> = (0..256).flat_map(pixel).collect();
    let mut jpeg = Vec::new();
    let mut encoder = jpeg_encoder::Encoder::new(&mut jpeg, 95);
    encoder.set_sampling_factor(jpeg_encoder::SamplingFactor::F_1_1);
    encoder.encode(&data, 16, 16, jpeg_encoder::ColorType::Rgb).unwrap();
    let image = decoded("bgr8; jpeg compressed bgr8", jpeg);
    assert_eq!((image.width, image.height), (16, 16));
    let far = image.data.iter().zip(&data).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
    assert!(far < 12, "a channel is off by {far}");

    let mut gray = Vec::new();
    jpeg_encoder::Encoder::new(&mut gray, 95)
        .encode(&[77; 256], 16, 16, jpeg_encoder::ColorType::Luma)
        .unwrap();
    let image = decoded("jpeg", gray);
    assert_eq!(image.data.len(), 768);
    assert!(image.data.iter().all(|v| v.abs_diff(77) < 3));
}

#[test]
fn cut_or_foreign_data_is_refused() {
    let whole = png_of(png::ColorType::Rgb, png::BitDepth::Eight, &RGB.concat());
    for data in [whole[..50].to_vec(), vec![], b"GIF89a".to_vec(), vec![0xff, 0xd8, 0xff]] {
        let image = CompressedImage { header: header(0, ""), format: "jpeg".into(), data };
        assert_eq!(compressed_color_image(&image).unwrap_err().reason(), "bad_image");
    }
}

#[test]
fn what_is_written_is_read_again() {
    let image = RgbImage { width: 2, height: 2, data: RGB.concat() };
    assert_eq!(color_image(&color_image_message(header(4, "c"), &image)).unwrap(), image);
    let flat = RgbImage { width: 20, height: 10, data: [200, 100, 50].repeat(200) };
    let message = compressed_color_message(header(4, "c"), &flat, 90).unwrap();
    let again = compressed_color_image(&message).unwrap();
    assert_eq!((again.width, again.height, message.header), (20, 10, header(4, "c")));
    assert!(again.data.iter().zip(&flat.data).all(|(a, b)| a.abs_diff(*b) < 6));
    let wide = RgbImage { width: 70_000, height: 1, data: vec![0; 210_000] };
    assert_eq!(
        compressed_color_message(header(0, ""), &wide, 90).unwrap_err().reason(),
        "size_mismatch"
    );
}
