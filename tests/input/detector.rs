//! What a network gives becomes boxes in the image. The networks here are made by hand.

use crate::onnx::{claiming, model, reshaped_image, with_metadata};
use ellipsoid_slam::{
    config::{DetectorSettings, ModelForm},
    detector::{Detector, Labels},
    msg::convert::RgbImage,
    perception::Detection,
};

/// Cells of the grids over 64x64 pixels: 8x8, 4x4 and 2x2.
const CELLS: usize = 84;
const IMAGE: &[u64] = &[1, 3, 64, 64];

/// Twice as wide as the network's input and as high: scaled by a half, half of the input stays gray.
fn image() -> RgbImage {
    RgbImage { width: 128, height: 64, data: vec![90; 128 * 64 * 3] }
}

fn labels() -> Option<Labels> {
    Some(Labels::from_lines("cup\nchair\nlamp\n"))
}

fn settings(form: ModelForm) -> DetectorSettings {
    DetectorSettings { form, ..DetectorSettings::default() }
}

fn found(onnx: &[u8], settings: &DetectorSettings) -> Vec<Detection> {
    Detector::new(onnx.to_vec(), labels(), settings).unwrap().detect(&image()).unwrap()
}

fn refused(onnx: Vec<u8>, labels: Option<Labels>) -> String {
    match Detector::new(onnx, labels, &DetectorSettings::default()) {
        Ok(detector) => panic!("taken as {}", detector.form()),
        Err(why) => why.to_string(),
    }
}

fn assert_box(found: &Detection, label: &str, score: f64, sides: [f64; 4]) {
    let rect = found.rect;
    assert_eq!(found.label(), label);
    assert!((found.probability() - score).abs() < 1e-6, "{found:?}");
    let got = [rect.x_min, rect.y_min, rect.x_max, rect.y_max];
    // A network's numbers have 24 bits.
    assert!(got.iter().zip(sides).all(|(a, b)| (a - b).abs() < 1e-4), "{got:?}, not {sides:?}");
}

/// Of YOLOv8's form, a column each: centre, size, probabilities of three classes.
fn yolov8(columns: &[[f32; 7]]) -> Vec<u8> {
    let mut data = vec![0.0; 7 * CELLS];
    for (column, values) in columns.iter().enumerate() {
        values.iter().enumerate().for_each(|(row, value)| data[row * CELLS + column] = *value);
    }
    model(IMAGE, &[(&[1, 7, CELLS as u64], data)])
}

/// The same in each form: a chair with its centre at (20, 20) of the network's input, 16 wide and 8 high; and its upper
/// and lower side in the image.
fn in_each_form() -> Vec<(ModelForm, Vec<u8>, [f64; 2])> {
    // The centre is in the middle of the third cell of the third line of the first grid.
    let mut yolox = vec![0.0; CELLS * 8];
    yolox[(2 * 8 + 2) * 8..][..8].copy_from_slice(&[
        0.5,
        0.5,
        2_f32.ln(),
        0.0,
        0.8,
        0.1,
        0.75,
        0.0,
    ]);
    let mut yolov5 = vec![0.0; 3 * CELLS * 8];
    yolov5[100 * 8..][..8].copy_from_slice(&[20.0, 20.0, 16.0, 8.0, 0.8, 0.1, 0.75, 0.0]);
    let mut ready = vec![0.0; 10 * 6];
    ready[6..12].copy_from_slice(&[12.0, 16.0, 28.0, 24.0, 0.6, 1.0]);
    let body = [20.0, 20.0, 16.0, 8.0].map(|pixels| pixels / 64.0);
    let mut queries = vec![0.0; 10 * 7];
    queries[7..11].copy_from_slice(&body);
    queries[11..14].copy_from_slice(&[0.1, 0.6, 0.0]);
    let (mut boxes, mut logits) = (vec![0.0; 10 * 4], vec![-9.0; 10 * 3]);
    boxes[4..8].copy_from_slice(&body);
    logits[4] = 1.5_f32.ln();
    let cells = CELLS as u64;
    let turned = yolov8(&[[20.0, 20.0, 16.0, 8.0, 0.1, 0.6, 0.0]]);
    let split: &[(&[u64], _)] = &[(&[1, 10, 3], logits), (&[1, 10, 4], boxes)];
    // The image is in the upper half of the input, in the middle, or stretched over all of it.
    let (corner, middle, stretched) = ([32.0, 48.0], [0.0, 16.0], [16.0, 24.0]);
    vec![
        (ModelForm::Yolox, model(IMAGE, &[(&[1, cells, 8], yolox)]), corner),
        (ModelForm::Yolov5, model(IMAGE, &[(&[1, 3 * cells, 8], yolov5)]), middle),
        (ModelForm::Yolov8, turned, middle),
        (ModelForm::EndToEnd, model(IMAGE, &[(&[1, 10, 6], ready)]), middle),
        (ModelForm::Rtdetr, model(IMAGE, &[(&[1, 10, 7], queries)]), stretched),
        (ModelForm::Rtdetr, model(IMAGE, split), stretched),
    ]
}

#[test]
fn the_form_of_an_output_is_told_from_its_shape() {
    for (form, onnx, [top, bottom]) in in_each_form() {
        let detector = Detector::new(onnx, labels(), &settings(ModelForm::Auto)).unwrap();
        assert_eq!((detector.form(), detector.input_size()), (form, [64, 64]));
        let found = detector.detect(&image()).unwrap();
        assert_eq!(found.len(), 1, "{form}: {found:?}");
        assert_box(&found[0], "chair", 0.6, [24.0, top, 56.0, bottom]);
    }
}

#[test]
fn a_form_that_does_not_fit_is_refused() {
    for (form, onnx, _) in in_each_form() {
        assert!(Detector::new(onnx.clone(), labels(), &settings(form)).is_ok());
        let other = if form == ModelForm::Yolox { ModelForm::Yolov8 } else { ModelForm::Yolox };
        let why = Detector::new(onnx, labels(), &settings(other)).err().unwrap().to_string();
        assert!(why.contains(&format!("not of the form {other}")), "{why}");
    }
}

#[test]
fn of_boxes_of_one_class_that_overlap_the_best_is_kept() {
    let onnx = yolov8(&[
        [20.0, 24.0, 16.0, 8.0, 0.0, 0.6, 0.0],
        // Shifted by a quarter: an overlap of three fifths.
        [24.0, 24.0, 16.0, 8.0, 0.0, 0.7, 0.0],
        // The same place, but another class.
        [20.0, 24.0, 16.0, 8.0, 0.5, 0.0, 0.0],
        // Far away.
        [50.0, 40.0, 16.0, 8.0, 0.0, 0.3, 0.0],
    ]);
    let with = |max_overlap| DetectorSettings { max_overlap, ..settings(ModelForm::Auto) };
    let kept = |max_overlap| -> Vec<(String, f64)> {
        let found = found(&onnx, &with(max_overlap));
        let rounded = |d: &Detection| (d.label().to_owned(), (d.probability() * 10.0).round());
        found.iter().map(rounded).collect()
    };
    let named =
        |list: &[(&str, f64)]| list.iter().map(|(l, s)| ((*l).into(), *s)).collect::<Vec<_>>();
    assert_eq!(kept(0.5), named(&[("chair", 7.0), ("cup", 5.0), ("chair", 3.0)]));
    assert_eq!(kept(0.7), named(&[("chair", 7.0), ("chair", 6.0), ("cup", 5.0), ("chair", 3.0)]));
}

#[test]
fn scores_and_classes_that_are_not_wanted_are_left_out() {
    let onnx = yolov8(&[
        [20.0, 24.0, 8.0, 8.0, 0.0, 0.6, 0.0],
        [40.0, 24.0, 8.0, 8.0, 0.3, 0.0, 0.0],
        // No probability, no size, no number, outside the image: not boxes.
        [20.0, 40.0, 8.0, 8.0, 0.0, 7.0, 0.0],
        [20.0, 40.0, 0.0, 8.0, 0.0, 0.9, 0.0],
        [f32::NAN, 40.0, 8.0, 8.0, 0.0, 0.9, 0.0],
        [20.0, 5.0, 8.0, 8.0, 0.0, 0.9, 0.0],
    ]);
    let labels_of = |min_score, classes: &str| -> Vec<String> {
        let classes = classes.to_owned();
        let settings = DetectorSettings { min_score, classes, ..settings(ModelForm::Auto) };
        found(&onnx, &settings).iter().map(|d| d.label().to_owned()).collect()
    };
    assert_eq!(labels_of(0.25, ""), ["chair", "cup"]);
    assert_eq!(labels_of(0.4, ""), ["chair"]);
    assert_eq!(labels_of(0.25, "lamp, cup"), ["cup"]);
}

#[test]
fn colours_come_as_the_network_wants_them() {
    // The network gives its input as rows of six: of the first row of red, the first is a box, and no other is.
    let onnx = reshaped_image(32, &[1, 512, 6]);
    let mut image = RgbImage { width: 32, height: 32, data: vec![0; 32 * 32 * 3] };
    for (x, red) in [0, 0, 255, 255, 128, 255].into_iter().enumerate() {
        image.data[3 * x] = red;
    }
    let detector = Detector::new(onnx, labels(), &DetectorSettings::default()).unwrap();
    let found = detector.detect(&image).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert_box(&found[0], "chair", 128.0 / 255.0, [0.0, 0.0, 1.0, 1.0]);
}

#[test]
fn classes_have_names() {
    let onnx = yolov8(&[[20.0, 24.0, 8.0, 8.0, 0.0, 0.6, 0.0]]);
    let named = with_metadata(onnx.clone(), "names", "{0: 'cup', 1: 'arm chair', 2: 'lamp'}");
    let detector = Detector::new(named, None, &DetectorSettings::default()).unwrap();
    assert_eq!(detector.detect(&image()).unwrap()[0].label(), "arm chair");

    let two = Some(Labels::from_lines("cup\nchair"));
    let says = refused(onnx.clone(), two);
    assert!(says.contains("3 classes, but there are 2 labels"), "{says}");
    let says = refused(onnx, None);
    assert!(says.contains("3 classes, which are not the 80 of COCO"), "{says}");
}

#[test]
fn what_is_no_detector_is_refused_with_a_sentence() {
    let good = yolov8(&[[20.0, 24.0, 8.0, 8.0, 0.0, 0.6, 0.0]]);
    let classifier = model(IMAGE, &[(&[1, 1000], vec![0.0; 1000])]);
    let of_shape = |shape: &[u64]| model(shape, &[(&[1, 10, 6], vec![0.0; 60])]);
    for (onnx, sentence) in [
        (b"not a model".to_vec(), "no ONNX model"),
        (Vec::new(), "no ONNX model"),
        (classifier, "[1, 1000] for an input of 64x64, is not of the form"),
        (of_shape(&[1, 1, 64, 64]), "but is [1, 1, 64, 64]"),
        (of_shape(&[1, 3, 64]), "but is [1, 3, 64]"),
        (of_shape(&[1, 3, 1 << 20, 1 << 20]), "but is [1, 3, 1048576, 1048576]"),
        (claiming(&[1 << 15, 1 << 15]), "no ONNX model"),
        (claiming(&[1 << 40, 1 << 40]), "no ONNX model"),
    ] {
        let says = refused(onnx, labels());
        assert!(says.contains(sentence) && says.lines().count() == 1, "{says}");
    }
    // Cut anywhere, a model is refused, or what is left of it still is one.
    for part in 1..64 {
        let cut = good[..good.len() * part / 64].to_vec();
        if let Err(why) = Detector::new(cut, labels(), &DetectorSettings::default()) {
            assert_eq!(why.to_string().lines().count(), 1, "{why}");
        }
    }
}
