//! What the program promises on real recordings, which `ELLIPSOID_SLAM_DATA` names.
//!
//! `ELLIPSOID_SLAM_DATA=DIR cargo test --test acceptance`
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

#[cfg(feature = "detector")]
mod detector;

use ellipsoid_slam::{
    geometry::{Ellipsoid, OrientedBox, Pose, intersection_over_union},
    io::BagInput,
    pipeline::{Keyframe, ObjectSlam, Settings},
};
use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use serde_json::Value;
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

/// The published code takes this long a frame on the cabinet (ms); ours is to be five times faster.
const PUBLISHED_MS: f64 = 73.5;
const MAX_MEMORY_MB: f64 = 150.0;

/// A recording, imported and replayed.
struct Replayed {
    map: Value,
    summary: Value,
    keyframes: Vec<Keyframe>,
    truth: Vec<(i64, OrientedBox)>,
    _folder: tempfile::TempDir,
}

fn run(args: &[&Path]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam")).args(args).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn replayed(recording: &str) -> Replayed {
    let data = env::var("ELLIPSOID_SLAM_DATA").expect("ELLIPSOID_SLAM_DATA names the recordings");
    let source = PathBuf::from(data).join(recording);
    let folder = tempfile::tempdir().unwrap();
    let (bag, out) = (folder.path().join("bag.mcap"), folder.path().join("out"));
    run(&["import".as_ref(), "tum".as_ref(), &source, "--output".as_ref(), &bag]);
    print!("{recording}: {}", run(&["replay".as_ref(), &bag, "--output".as_ref(), &out]));
    let read = |path: PathBuf| -> Value {
        serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
    };
    let truth_file = source.join("objects.gt.json");
    let truth = if truth_file.exists() { truth_of(&read(truth_file)) } else { Vec::new() };
    let (map, summary) = (read(out.join("map.json")), read(out.join("summary.json")));
    Replayed { map, summary, keyframes: keyframes(&bag), truth, _folder: folder }
}

/// What each single frame gave.
fn keyframes(bag: &Path) -> Vec<Keyframe> {
    let input = BagInput::open(bag, &[]).unwrap();
    let mut slam = ObjectSlam::new(Settings::default());
    let mut keyframes = Vec::new();
    for message in input.inputs() {
        keyframes.extend(slam.handle(message, &mut ()).keyframes);
    }
    keyframes.extend(slam.finish(&mut ()).keyframes);
    keyframes
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().unwrap())
}

fn box_of(object: &Value, half_extents: [f64; 3]) -> OrientedBox {
    let [x, y, z, w] = numbers(&object["orientation"]);
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    let position: [f64; 3] = numbers(&object["position"]);
    let pose = Pose::from_parts(Translation3::from(Vector3::from(position)), rotation);
    OrientedBox { pose, half_extents: half_extents.into() }
}

fn truth_of(file: &Value) -> Vec<(i64, OrientedBox)> {
    let objects = file["objects"].as_array().unwrap().iter();
    objects
        .map(|o| {
            let half = numbers::<3>(&o["size"]).map(|size| 0.5 * size);
            (o["id"].as_i64().unwrap(), box_of(o, half))
        })
        .collect()
}

impl Replayed {
    fn objects(&self, label: &str) -> Vec<OrientedBox> {
        let all = self.map["objects"].as_array().unwrap().iter();
        all.filter(|o| o["label"] == label).map(|o| box_of(o, numbers(&o["semi_axes"]))).collect()
    }

    /// Best overlap of any object of the map with the true object.
    fn best_overlap(&self, label: &str, id: i64) -> f64 {
        let (_, truth) = self.truth.iter().find(|(other, _)| *other == id).unwrap();
        let overlaps = self.objects(label).into_iter().map(|o| intersection_over_union(&o, truth));
        overlaps.fold(0.0, f64::max)
    }

    /// Overlaps of the single-frame estimates with the only true object.
    fn single_frame_overlaps(&self) -> Vec<f64> {
        let (_, truth) = &self.truth[0];
        let mut overlaps = Vec::new();
        for keyframe in &self.keyframes {
            for found in keyframe.boxes.iter().filter_map(|b| b.measurement.as_ref().ok()) {
                let body: Ellipsoid = found.ellipsoid.transformed(&keyframe.map_from_camera);
                overlaps.push(intersection_over_union(&OrientedBox::from(&body), truth));
            }
        }
        overlaps
    }

    /// Of the published code's time a keyframe, at most such a share.
    fn is_fast_and_small(&self, share: f64) {
        let mean = self.summary["keyframe_time"]["mean_ms"].as_f64().unwrap();
        let memory = self.summary["peak_memory_mb"].as_f64().unwrap();
        println!("  {mean:.1} ms a keyframe, {memory:.0} MB");
        assert!(mean < share * PUBLISHED_MS && memory < MAX_MEMORY_MB);
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn the_cabinet_is_one_object_in_its_place() {
    let replay = replayed("tum_fr3_cabinet");
    let objects = replay.map["objects"].as_array().unwrap();
    assert_eq!(objects.len(), 1, "{:#}", replay.map);
    let overlap = replay.best_overlap("suitcase", 0);
    let single = median(replay.single_frame_overlaps());
    println!("  IoU {overlap:.2} (published code: 0.39), single frames {single:.2} (0.57)");
    assert!(overlap > 0.75 && single > 0.65);

    // Found from the first frame in which it can be: the first with a box.
    let first = replay.keyframes.iter().find(|k| !k.boxes.is_empty()).unwrap();
    let seen = objects[0]["first_seen"].as_f64().unwrap();
    assert!((seen - first.stamp.as_secs()).abs() < 1e-6);
    replay.is_fast_and_small(0.2);
}

#[test]
fn the_desk_has_its_things() {
    let replay = replayed("tum_fr1_rpy");
    // Sizes of the real things, to the third of a size that half-seen objects allow.
    for (label, width, height) in [("tv", 0.52, 0.45), ("keyboard", 0.5, 0.04), ("cup", 0.12, 0.11)]
    {
        let found = replay.objects(label);
        assert!(!found.is_empty(), "no {label} in {:#}", replay.map);
        let fits = found.iter().any(|o| {
            let size = o.half_extents * 2.0;
            (size.x / width).ln().abs() < 0.3 && (size.z - height).abs() < 0.35 * height + 0.01
        });
        println!("  {label}: {:?}", found.iter().map(|o| o.half_extents * 2.0).collect::<Vec<_>>());
        assert!(fits, "no {label} of its size");
    }
    // The desk top in most keyframes; the floor wherever it can be seen.
    let at = |height: f64| {
        let near = |k: &&Keyframe| k.support_heights_m.iter().any(|h| (h - height).abs() < 0.06);
        replay.keyframes.iter().filter(near).count()
    };
    println!("  desk top in {}, floor in {} of {}", at(0.75), at(0.02), replay.keyframes.len());
    assert!(at(0.75) * 10 > replay.keyframes.len() * 7 && at(0.02) >= 10);
    // Six times as many boxes as on the cabinet.
    replay.is_fast_and_small(0.4);
}

#[test]
fn the_kitchen_has_four_chairs_and_a_table() {
    let replay = replayed("house_kitchen");
    for (label, id) in
        [("chair", 7), ("chair", 8), ("chair", 9), ("chair", 10), ("dining table", 25)]
    {
        let overlap = replay.best_overlap(label, id);
        println!("  {label} {id}: IoU {overlap:.2}");
        assert!(overlap > 0.7, "{label} {id}");
    }
    let memory = replay.summary["peak_memory_mb"].as_f64().unwrap();
    assert!(memory < MAX_MEMORY_MB);
}
