//! Networks that segment give masks. Prototypes are made by hand so that each mask is half of its box, cut by a line.

use crate::onnx::model;
use ellipsoid_slam::{
    config::{DetectorSettings, ModelForm},
    detector::{Detector, Labels},
    geometry::Rect,
    io::{BagReader, BagWriter},
    msg::{
        Message, cdr,
        convert::{RgbImage, header, yolo_detections},
        sensor_msgs::Image,
        yolo_msgs,
    },
    perception::Detection,
    time::Stamp,
};
use std::{fs, process::Command};

const IMAGE: &[u64] = &[1, 3, 64, 96];
/// Cells of the grids over 96x64 pixels: 12x8, 6x4 and 3x2.
const CELLS: usize = 126;
const PROTOTYPES: &[u64] = &[1, 3, 16, 24];
const LABELS: &str = "cup\nchair\nlamp";
/// The same box twice, centre and size in the network's input, of a lamp and a chair: score, class, parts of the prototypes.
const BODY: [f32; 4] = [36.0, 32.0, 48.0, 36.0];
const LAMP: (f32, usize, [f32; 3]) = (0.9, 2, [-1.0, 0.5, 20.1]);
const CHAIR: (f32, usize, [f32; 3]) = (0.6, 1, [1.0, 2.0, -97.2]);

/// Scaled by three fourths, with gray bars of 8 pixels above and below.
fn image() -> RgbImage {
    RgbImage { width: 128, height: 64, data: vec![90; 128 * 64 * 3] }
}

/// The box in the image.
fn rect() -> Rect {
    Rect::new(16.0, 8.0, 80.0, 56.0).unwrap()
}

/// Their values at each place of the input are its x, its y and one.
fn prototypes() -> Vec<f32> {
    let middles = |count: u64| (0..count).map(|at| 4.0 * at as f32 + 2.0);
    let places = || middles(16).flat_map(move |y| middles(24).map(move |x| [x, y]));
    let across = places().map(|[x, _]| x);
    across.chain(places().map(|[_, y]| y)).chain(places().map(|_| 1.0)).collect()
}

/// Whether a pixel of the image is on the inner side of the line.
fn is_inside((_, _, [a, b, c]): (f32, usize, [f32; 3]), u: u32, v: u32) -> bool {
    let [x, y] = [0.75 * (u as f32 + 0.5), 0.75 * (v as f32 + 0.5) + 8.0];
    a * x + b * y + c > 0.0
}

/// What a network of YOLOv8's form says of the lamp and of the chair, each in a column.
fn yolov8(found: &[(f32, usize, [f32; 3])]) -> Vec<f32> {
    let mut data = vec![0.0; 10 * CELLS];
    for (at, (score, class, parts)) in found.iter().enumerate() {
        let mut set = |row: usize, value| data[row * CELLS + 50 * at + 5] = value;
        BODY.into_iter().enumerate().for_each(|(row, value)| set(row, value));
        set(4 + class, *score);
        parts.iter().enumerate().for_each(|(row, value)| set(7 + row, *value));
    }
    data
}

fn segmenting(found: &[(f32, usize, [f32; 3])], shape: &[u64], masks: Vec<f32>) -> Vec<u8> {
    model(IMAGE, &[(&[1, 10, CELLS as u64], yolov8(found)), (shape, masks)])
}

/// Lamp and chair in each form that has masks.
fn in_each_form() -> Vec<(ModelForm, Vec<u8>)> {
    let mut yolov5 = vec![0.0; 3 * CELLS * 11];
    let mut ready = vec![0.0; 10 * 9];
    for (at, (score, class, parts)) in [LAMP, CHAIR].into_iter().enumerate() {
        let row = &mut yolov5[100 * at * 11..][..11];
        row[..4].copy_from_slice(&BODY);
        (row[4], row[5 + class]) = (1.0, score);
        row[8..].copy_from_slice(&parts);
        let row = &mut ready[5 * at * 9..][..9];
        row[..6].copy_from_slice(&[12.0, 14.0, 60.0, 50.0, score, class as f32]);
        row[6..].copy_from_slice(&parts);
    }
    let anchors: &[u64] = &[1, 3 * CELLS as u64, 11];
    let of = |shape, data| model(IMAGE, &[(shape, data), (PROTOTYPES, prototypes())]);
    vec![
        (ModelForm::Yolov5, of(anchors, yolov5)),
        (ModelForm::Yolov8, segmenting(&[LAMP, CHAIR], PROTOTYPES, prototypes())),
        (ModelForm::EndToEnd, of(&[1, 10, 9], ready)),
    ]
}

fn detector(onnx: Vec<u8>) -> Detector {
    Detector::new(onnx, Some(Labels::from_lines(LABELS)), &DetectorSettings::default()).unwrap()
}

fn assert_mask(found: &Detection, what: (f32, usize, [f32; 3])) {
    assert_eq!(Some(found.label()), LABELS.lines().nth(what.1));
    let mask = found.mask.as_ref().unwrap();
    for (u, v) in (0..64).flat_map(|v| (0..128).map(move |u| (u, v))) {
        let expected = rect().contains(u.into(), v.into()) && is_inside(what, u, v);
        assert_eq!(mask.contains(u.into(), v.into()), expected, "{} at {u}, {v}", found.label());
    }
}

#[test]
fn a_box_has_the_mask_that_its_network_gives_it() {
    for (form, onnx) in in_each_form() {
        let detector = detector(onnx);
        assert_eq!((detector.form(), detector.has_masks()), (form, true));
        let found = detector.detect(&image()).unwrap();
        assert_eq!(found.len(), 2, "{form}: {found:?}");
        assert_mask(&found[0], LAMP);
        assert_mask(&found[1], CHAIR);
    }
}

#[test]
fn a_mask_that_is_none_leaves_its_box() {
    let with = |a: f32, c: f32| (LAMP.0, LAMP.1, [a, 0.5, c]);
    let mut broken = prototypes();
    broken[8 * 24 + 9] = f32::NAN;
    for (lamp, shape, masks, has_masks) in [
        (with(f32::NAN, 20.1), PROTOTYPES, prototypes(), true),
        (with(-1.0, f32::INFINITY), PROTOTYPES, prototypes(), true),
        // Nothing is inside, or but a corner of the box.
        (with(-1.0, -100.0), PROTOTYPES, prototypes(), true),
        (with(-1.0, 0.0), PROTOTYPES, prototypes(), true),
        (LAMP, PROTOTYPES, broken, true),
        // Of an input that is higher than wide, of two images, finer than the input.
        (LAMP, &[1, 3, 24, 16], prototypes(), false),
        (LAMP, &[2, 3, 16, 12], prototypes(), false),
        (LAMP, &[1, 3, 128, 192], vec![1.0; 3 * 128 * 192], false),
    ] {
        let detector = detector(segmenting(&[lamp], shape, masks));
        assert_eq!(detector.has_masks(), has_masks, "{shape:?}");
        let found = detector.detect(&image()).unwrap();
        let [one] = found.as_slice() else { panic!("{shape:?}: {found:?}") };
        assert_eq!((one.label(), one.rect, &one.mask), ("lamp", rect(), &None), "{lamp:?}");
    }
}

#[test]
fn detect_writes_masks_into_the_bag() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (bag, boxes, onnx) = (path("bag.mcap"), path("boxes.mcap"), path("model.onnx"));
    let made = segmenting(&[LAMP, CHAIR], PROTOTYPES, prototypes());
    fs::write(&onnx, &made).unwrap();
    fs::write(path("labels"), LABELS).unwrap();
    let RgbImage { width, height, data } = image();
    let at = Stamp::from_nanos(5_000_000_000);
    let (header, encoding) = (header(at, "camera"), "rgb8".into());
    let color = Image { header, height, width, encoding, is_bigendian: 0, step: 3 * width, data };
    let mut writer = BagWriter::create(&bag).unwrap();
    writer.write("/camera/color/image_raw", &color, at).unwrap();
    writer.finish().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"))
        .args(["detect".as_ref(), bag.as_os_str(), "--model".as_ref(), onnx.as_os_str()])
        .args(["--labels".as_ref(), path("labels").as_os_str()])
        .args(["--output".as_ref(), boxes.as_os_str()])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("yolov8 with masks"), "{output:?}");
    let written = BagReader::open(&boxes).unwrap();
    let message = written.messages().find(|m| *m.topic == *"/detections").unwrap();
    assert_eq!(&*message.type_name, yolo_msgs::DetectionArray::TYPE);
    let (read, bad) = yolo_detections(&cdr::decode(&message.data).unwrap(), Some((width, height)));
    assert!(bad.is_empty() && read.stamp == at, "{bad:?}");
    assert_mask(&read.detections[0], LAMP);
    assert_mask(&read.detections[1], CHAIR);
}
