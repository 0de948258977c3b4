//! Settings at and beyond their limits: refused in a sentence, or worked with.

use super::{Run, at, camera_info, odometry_at, transform};
use crate::scene::{Scene, View, camera, detection, looking, standing};
use ellipsoid_slam::{
    config::{Key, Parameters, keys},
    geometry::Pose,
    perception::Detection,
    pipeline::{CameraRole, DepthMessage, DetectionsMessage, Input, Settings},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

fn value(parameters: &Parameters, key: &Key, number: f64) -> Value {
    let is_whole = parameters.get(key.path).unwrap().unwrap().is_u64();
    if is_whole && number >= 0.0 { json!(number as u64) } else { json!(number) }
}

/// Whether a setting is taken; one that is not is named, and changes nothing.
fn is_taken(parameters: &mut Parameters, path: &str, value: Value) -> bool {
    let before = parameters.clone();
    let Err(why) = parameters.set(path, value) else { return true };
    let why = why.to_string();
    assert!(!why.is_empty() && !why.contains('\n'), "{path}: {why}");
    assert_eq!(*parameters, before, "{path}");
    false
}

/// A cabinet, a chair and a cup on a table from two places, with the boxes round them.
struct Drive {
    views: Vec<(Pose, View, Vec<Detection>)>,
}

impl Drive {
    fn new() -> Self {
        let mut scene = Scene::with_floor();
        let things = [
            ("cabinet", scene.add(standing(0.3, [3.0, 0.8, 0.6], [0.4, 0.25, 0.6]))),
            ("chair", scene.add(standing(0.0, [2.5, -0.7, 0.45], [0.28, 0.25, 0.45]))),
            ("dining table", scene.add(standing(0.0, [4.2, -0.4, 0.37], [0.5, 0.4, 0.37]))),
            ("cup", scene.add(standing(0.0, [4.0, -0.3, 0.79], [0.06, 0.045, 0.05]))),
        ];
        scene.add(standing(0.0, [6.0, 0.0, 1.5], [0.1, 5.0, 1.5]));
        let views = [0.0, 0.4].map(|way| {
            let base = Pose::translation(way, 0.0, 0.0);
            let view = scene.seen_from(&(base * looking([0.0, 0.0, 1.0], 0.0, 15.0)));
            let boxes = things
                .iter()
                .filter_map(|(label, thing)| Some(detection(label, view.try_box_around(*thing)?)));
            let boxes = boxes.collect();
            (base, view, boxes)
        });
        Self { views: views.into() }
    }

    fn with(&self, settings: Settings) {
        let mut run = Run::new(settings);
        run.feed([
            camera_info(CameraRole::Color, "camera", camera()),
            transform(true, 0, ["base_link", "camera"], looking([0.0, 0.0, 1.0], 0.0, 15.0)),
        ]);
        for image in 0..4 {
            let (base, view, boxes) = &self.views[image % 2];
            let ms = 100 * (image as i64 + 1);
            let depth = view.depth.clone();
            run.feed([
                odometry_at(ms - 40, *base),
                odometry_at(ms + 40, *base),
                Input::Depth(DepthMessage {
                    stamp: at(ms),
                    frame_id: "camera".into(),
                    image: depth,
                }),
                Input::Detections(DetectionsMessage {
                    stamp: at(ms),
                    frame_id: "camera".into(),
                    detections: boxes.clone(),
                }),
            ]);
        }
        run.finish();
    }
}

#[test]
fn numbers_beyond_their_range_are_refused_and_limits_are_taken() {
    let defaults = Parameters::default();
    for key in keys() {
        let Some(range) = &key.range else { continue };
        let width = range.end() - range.start();
        for number in [range.start() - 1e-9 * width - 1e-9, range.end() + 1e-9 * width + 1e-9] {
            let mut changed = defaults.clone();
            assert!(!is_taken(&mut changed, key.path, json!(number)), "{} {number}", key.path);
        }
        for number in [*range.start(), *range.end()] {
            let taken = is_taken(&mut defaults.clone(), key.path, value(&defaults, key, number));
            let depends = key.path.contains("labels") || key.path.contains("detection_prob");
            assert!(taken || depends, "{} {number}", key.path);
        }
    }
}

#[test]
fn arrays_have_ranges_and_an_order() {
    let refused = [
        ("size_m", json!([0.13, 0.44, 0.03])),
        ("size_m", json!([-0.4, -0.5, 0.1])),
        ("size_m", json!([0.4, 0.0, 0.1])),
        ("size_m", json!([1e9, 0.5, 0.1])),
        ("size_m", json!([0.4, 0.1])),
        ("outline", json!({"superquadric": [0.0, 1.0]})),
        ("outline", json!({"superquadric": [1.2, 1.0]})),
        ("outline", json!({"superquadric": [0.5, 2.0]})),
    ];
    for (part, value) in refused {
        for class in ["listed.keyboard", "listed.new thing", "unlisted"] {
            let path = format!("perception.classes.{class}.{part}");
            assert!(!is_taken(&mut Parameters::default(), &path, value.clone()), "{path} {value}");
        }
    }
    let mut parameters = Parameters::default();
    assert!(is_taken(
        &mut parameters,
        "perception.classes.unlisted.size_m",
        json!([0.4, 0.4, 0.1])
    ));
}

/// Draws of settings at their limits, and numbers anywhere: what is taken does not end the program.
#[test]
fn whatever_is_taken_runs() {
    let drive = Drive::new();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for draw in 0..40 {
        let mut parameters = Parameters::default();
        let mut set = Vec::new();
        for key in keys() {
            let Some(range) = &key.range else { continue };
            if !rng.random_bool(if draw % 2 == 0 { 0.05 } else { 0.3 }) {
                continue;
            }
            let number = if rng.random_bool(0.5) { *range.start() } else { *range.end() };
            let value = value(&parameters, key, number);
            if is_taken(&mut parameters, key.path, value.clone()) {
                set.push(format!("{} = {value}", key.path));
            }
        }
        for class in ["cabinet", "chair", "cup"] {
            let size = [rng.random_range(-1.0..2.0), rng.random_range(-1.0..2.0), 1e-3];
            let path = format!("perception.classes.listed.{class}.size_m");
            if is_taken(&mut parameters, &path, json!(size)) {
                set.push(format!("{path} = {size:?}"));
            }
        }
        println!("draw {draw}: {}", set.join(", "));
        drive.with(parameters.slam);
    }
}
