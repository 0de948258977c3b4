//! CDR in both byte orders, and bytes that are none.

use crate::fixtures;
use byteorder::BigEndian;
use ellipsoid_slam::msg::{
    Message,
    cdr::{self, decode, decode_header, encode},
    geometry_msgs::PoseStamped,
    nav_msgs::{Odometry, Path},
    schema_text,
    sensor_msgs::{CameraInfo, CompressedImage, Image},
    tf2_msgs::TFMessage,
    vision_msgs::{Detection2DArray, Detection3DArray},
    visualization_msgs::{Marker, MarkerArray},
};
use proptest::prelude::*;

fn big_endian<T: Message>(message: &T) -> Vec<u8> {
    let mut bytes = vec![0, 0, 0, 0];
    bytes.extend(cdr_encoding::to_vec::<T, BigEndian>(message).unwrap());
    bytes
}

#[test]
fn bytes_are_as_the_standard_lays_them_out() {
    let mut image = fixtures::depth(3);
    (image.header.frame_id, image.data) = ("ab".into(), vec![1, 2]);
    let expected = [
        0, 1, 0, 0, // low byte first
        0x00, 0xf1, 0x53, 0x65, // 1 700 000 000 s
        0x00, 0xa3, 0xe1, 0x11, // 300 000 000 ns
        3, 0, 0, 0, b'a', b'b', 0, 0, // frame, its end, padding to four
        2, 0, 0, 0, 3, 0, 0, 0, // height, width
        6, 0, 0, 0, b'1', b'6', b'U', b'C', b'1', 0, // encoding
        0, 0, // is_bigendian, padding
        8, 0, 0, 0, // step
        2, 0, 0, 0, 1, 2, // data
    ];
    assert_eq!(encode(&image).unwrap(), expected);
    assert_eq!(decode::<Image>(&expected).unwrap(), image);
}

#[test]
fn both_byte_orders_say_the_same() {
    fn check<T: Message + PartialEq + std::fmt::Debug>(message: &T) {
        assert_eq!(&decode::<T>(&encode(message).unwrap()).unwrap(), message);
        assert_eq!(&decode::<T>(&big_endian(message)).unwrap(), message);
    }
    check(&fixtures::depth(3));
    check(&fixtures::camera_info(3));
    check(&fixtures::detections(3));
    check(&fixtures::odometry(3));
    check(&fixtures::transforms(3));
    check(&CompressedImage {
        header: fixtures::header(1, "c"),
        format: "png".into(),
        data: vec![1, 2, 3],
    });
    check(&MarkerArray { markers: vec![Marker { text: "chair".into(), ..Marker::default() }] });
    assert_eq!(
        decode_header(&big_endian(&fixtures::odometry(3))).unwrap(),
        fixtures::header(3, "odom")
    );
}

#[test]
fn what_is_no_message_is_refused_in_a_sentence() {
    let whole = encode(&fixtures::detections(3)).unwrap();
    for cut in 0..whole.len() {
        let error = decode::<Detection2DArray>(&whole[..cut]).unwrap_err();
        let says = error.to_string();
        assert!(
            says.contains("too short") || says.contains("vision_msgs/msg/Detection2DArray"),
            "{says}"
        );
    }
    let other = [&[0, 7, 0, 0], &whole[4..]].concat();
    assert!(decode::<Detection2DArray>(&other).unwrap_err().to_string().contains("0x0007"));
}

/// Decodes the bytes as everything that a bag may hold.
fn decode_all(bytes: &[u8]) {
    let _ = (decode::<Image>(bytes), decode::<CompressedImage>(bytes), decode::<CameraInfo>(bytes));
    let _ =
        (decode::<Odometry>(bytes), decode::<TFMessage>(bytes), decode::<Detection2DArray>(bytes));
    let _ = (decode::<MarkerArray>(bytes), decode::<Path>(bytes), decode_header(bytes));
}

#[test]
fn length_fields_are_not_trusted() {
    let messages = [
        encode(&fixtures::depth(0)),
        encode(&fixtures::detections(0)),
        encode(&fixtures::transforms(0)),
        encode(&fixtures::camera_info(0)),
    ];
    for whole in messages.map(Result::unwrap) {
        for at in (4..whole.len() - 3).step_by(4) {
            for length in [u32::MAX, u32::MAX - 7, 0x7fff_ffff, 0x4000_0000] {
                let mut bytes = whole.clone();
                bytes[at..at + 4].copy_from_slice(&length.to_le_bytes());
                decode_all(&bytes);
            }
        }
    }
    // Believing one of these lengths would have claimed at least 4 GB.
    assert!(claimed_kb() < 3_000_000, "{} kB were claimed", claimed_kb());
}

/// The most address space that this process ever had [kB]: it counts memory that was claimed but never touched.
fn claimed_kb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmPeak")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

proptest! {
    #[test]
    fn random_bytes_never_panic(mut bytes in proptest::collection::vec(any::<u8>(), 0..600), order in 0..2_u8) {
        if let Some(kind) = bytes.get_mut(..2) {
            kind.copy_from_slice(&[0, order]);
        }
        decode_all(&bytes);
    }
}

#[test]
fn every_type_has_a_complete_definition() {
    let separator = "=".repeat(80);
    let types = [
        Image::TYPE,
        CompressedImage::TYPE,
        CameraInfo::TYPE,
        Odometry::TYPE,
        TFMessage::TYPE,
        Detection2DArray::TYPE,
        Detection3DArray::TYPE,
        MarkerArray::TYPE,
        Path::TYPE,
        PoseStamped::TYPE,
    ];
    for type_name in types {
        let text = schema_text(type_name).unwrap();
        let parts: Vec<&str> = text.split(&format!("{separator}\n")).collect();
        let heads: Vec<&str> = parts[1..].iter().map(|part| part.lines().next().unwrap()).collect();
        assert!(
            heads.contains(&"MSG: std_msgs/Header")
                && heads.contains(&"MSG: builtin_interfaces/Time"),
            "{text}"
        );
        let mut sorted = heads.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), heads.len(), "a definition is there twice");
    }
    assert_eq!(schema_text("foo_msgs/msg/Bar"), None);
}

#[test]
fn errors_of_the_writer_name_the_type() {
    let error = cdr::CdrError::NotWritable { type_name: Image::TYPE, problem: "why".into() };
    assert_eq!(error.to_string(), "a sensor_msgs/msg/Image cannot be written: why");
}
