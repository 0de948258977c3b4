//! Messages and bags that the tests start from.

use ellipsoid_slam::{
    msg::{
        Message,
        builtin_interfaces::Time,
        cdr,
        geometry_msgs::{self as geometry, TransformStamped},
        nav_msgs::Odometry,
        sensor_msgs::{CameraInfo, Image},
        std_msgs::Header,
        tf2_msgs::TFMessage,
        vision_msgs::{
            BoundingBox2D, Detection2D, Detection2DArray, ObjectHypothesis,
            ObjectHypothesisWithPose, Point2D, Pose2D,
        },
    },
    time::Stamp,
};
use std::{
    collections::BTreeMap,
    io::{BufWriter, Cursor},
};

/// Stamp of the first frame [s].
pub(crate) const START_S: i32 = 1_700_000_000;

pub(crate) fn header(tenths: u32, frame_id: &str) -> Header {
    let stamp = Time { sec: START_S + (tenths / 10) as i32, nanosec: tenths % 10 * 100_000_000 };
    Header { stamp, frame_id: frame_id.into() }
}

pub(crate) fn stamp(tenths: u32) -> Stamp {
    header(tenths, "").stamp.into()
}

/// A 3x2 depth image of 16 bits with two bytes of padding a row: 1.000 m, 2.000 m, none; 0.258 m, 3.000 m, 65.535 m.
pub(crate) fn depth(tenths: u32) -> Image {
    let rows = [[1000_u16, 2000, 0], [258, 3000, 65535]];
    let row = |row: [u16; 3]| {
        row.into_iter().flat_map(u16::to_le_bytes).chain([0xaa, 0xbb]).collect::<Vec<u8>>()
    };
    Image {
        header: header(tenths, "camera"),
        height: 2,
        width: 3,
        encoding: "16UC1".into(),
        is_bigendian: 0,
        step: 8,
        data: rows.into_iter().flat_map(row).collect(),
    }
}

pub(crate) fn camera_info(tenths: u32) -> CameraInfo {
    CameraInfo {
        header: header(tenths, "camera"),
        height: 2,
        width: 3,
        distortion_model: "plumb_bob".into(),
        d: vec![0.1, -0.2, 0.001, -0.002, 0.03],
        k: [500.0, 0.0, 1.5, 0.0, 510.0, 0.5, 0.0, 0.0, 1.0],
        r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p: [450.0, 0.0, 1.25, 0.0, 0.0, 460.0, 0.75, 0.0, 0.0, 0.0, 1.0, 0.0],
        ..CameraInfo::default()
    }
}

pub(crate) fn detection(
    center: (f64, f64),
    size: (f64, f64),
    classes: &[(&str, f64)],
) -> Detection2D {
    let result = |(class_id, score): &(&str, f64)| ObjectHypothesisWithPose {
        hypothesis: ObjectHypothesis { class_id: (*class_id).into(), score: *score },
        ..ObjectHypothesisWithPose::default()
    };
    let position = Point2D { x: center.0, y: center.1 };
    Detection2D {
        header: Header::default(),
        results: classes.iter().map(result).collect(),
        bbox: BoundingBox2D {
            center: Pose2D { position, theta: 0.0 },
            size_x: size.0,
            size_y: size.1,
        },
        id: String::new(),
    }
}

pub(crate) fn detections(tenths: u32) -> Detection2DArray {
    let detections = vec![detection((1.0, 1.0), (1.0, 0.5), &[("62", 0.75)])];
    Detection2DArray { header: header(tenths, "camera"), detections }
}

pub(crate) fn odometry(tenths: u32) -> Odometry {
    let mut odometry = Odometry {
        header: header(tenths, "odom"),
        child_frame_id: "base_link".into(),
        ..Odometry::default()
    };
    odometry.pose.pose.position = geometry::Point { x: 1.0, y: 2.0, z: 3.0 };
    odometry
}

pub(crate) fn transforms(tenths: u32) -> TFMessage {
    let transform = geometry::Transform {
        translation: geometry::Vector3 { x: 0.1, y: 0.2, z: 0.3 },
        rotation: geometry::Quaternion::default(),
    };
    let child_frame_id = "camera".to_owned();
    TFMessage {
        transforms: vec![TransformStamped {
            header: header(tenths, "base_link"),
            child_frame_id,
            transform,
        }],
    }
}

/// A message for [`bag`].
pub(crate) struct Line {
    pub(crate) topic: String,
    pub(crate) type_name: &'static str,
    pub(crate) log_time: Stamp,
    pub(crate) data: Vec<u8>,
}

pub(crate) fn line<T: Message>(topic: &str, tenths: u32, message: &T) -> Line {
    let data = cdr::encode(message).unwrap();
    Line { topic: topic.into(), type_name: T::TYPE, log_time: stamp(tenths), data }
}

/// Ten frames of everything, a tenth of a second apart.
pub(crate) fn scene() -> Vec<Line> {
    let mut lines = vec![line("/tf_static", 0, &transforms(0))];
    for at in 0..10 {
        lines.push(line("/odom", at, &odometry(at)));
        lines.push(line("/camera/depth/image", at, &depth(at)));
        lines.push(line("/camera/camera_info", at, &camera_info(at)));
        lines.push(line("/detections", at, &detections(at)));
    }
    lines
}

/// How a bag is laid out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    pub(crate) compression: Option<mcap::Compression>,
    pub(crate) chunks: bool,
    pub(crate) summary: bool,
}

pub(crate) const PLAIN: Layout = Layout { compression: None, chunks: true, summary: true };

/// An MCAP file with the lines in the order given.
pub(crate) fn bag(lines: &[Line], layout: Layout) -> Vec<u8> {
    let options = mcap::WriteOptions::new()
        .profile("ros2")
        .compression(layout.compression)
        .compression_threads(0)
        .use_chunks(layout.chunks)
        // Small, so that a short bag has several.
        .chunk_size(Some(600))
        .emit_summary_records(layout.summary)
        .emit_summary_offsets(layout.summary);
    let mut writer = options.create(BufWriter::new(Cursor::new(Vec::new()))).unwrap();
    for line in lines {
        let schema = writer.add_schema(line.type_name, "ros2msg", b"").unwrap();
        let channel = writer.add_channel(schema, &line.topic, "cdr", &BTreeMap::new()).unwrap();
        let time = line.log_time.as_nanos() as u64;
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: time,
            publish_time: time,
        };
        writer.write_to_known_channel(&header, &line.data).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner().unwrap().into_inner()
}
