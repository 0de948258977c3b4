//! `simulate`, `import tum`, `replay` and `eval` as a user calls them.

use ellipsoid_slam::{
    eval::GroundTruth,
    io::BagReader,
    msg::{cdr::decode, sensor_msgs::CameraInfo},
};
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Command, Output},
};

pub(crate) fn call(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap()
}

pub(crate) fn succeeds(folder: &Path, arguments: &str) -> String {
    let output = call(folder, arguments);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments}: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// The one sentence with which a call ends.
pub(crate) fn fails(folder: &Path, arguments: &str, status: i32) -> String {
    let output = call(folder, arguments);
    assert_eq!(output.status.code(), Some(status), "{arguments}");
    let says = String::from_utf8(output.stderr).unwrap();
    assert!(says.starts_with("error: "), "{says}");
    says
}

fn message_counts(bag: &Path) -> BTreeMap<String, u64> {
    let bag = BagReader::open(bag).unwrap();
    bag.topics().iter().map(|topic| (topic.name.clone(), topic.messages)).collect()
}

const SIMULATE: &str = "simulate --scene desk --trajectory orbit --set camera.width=320 \
                        --set camera.height=240 --set camera.focal_px=262";

#[test]
fn a_simulated_bag_is_replayed_and_measured() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    succeeds(folder, &format!("{SIMULATE} --frames 12 --perfect --output a.mcap"));
    succeeds(folder, "replay a.mcap --output result");
    let measured = "eval result --ground-truth a.gt.json --trajectory a.gt.tum";
    let json: Value =
        serde_json::from_str(&succeeds(folder, &format!("{measured} --json --csv a.csv"))).unwrap();
    assert!(json["objects"]["recall"].as_f64().unwrap() >= 0.5, "{json}");
    assert!(json["objects"]["translation_m"].as_f64().unwrap() < 0.2, "{json}");
    assert_eq!(json["trajectory"]["poses"], 12);
    // Perfect odometry claims nothing of it, so what is seen corrects it by some millimetres.
    assert!(json["trajectory"]["ate_m"]["max"].as_f64().unwrap() < 0.02, "{json}");
    let table = succeeds(folder, measured);
    assert!(table.contains("keyboard") && table.contains("ATE [m]"), "{table}");
    let csv = fs::read_to_string(folder.join("a.csv")).unwrap();
    let columns = csv.lines().map(|line| line.split(',').count());
    assert!(csv.lines().count() > 5 && columns.clone().all(|n| n == 12), "{csv}");

    assert!(fails(folder, &format!("{measured} --csv a.csv"), 2).contains("--force"));
    assert!(fails(folder, "eval nowhere --ground-truth a.gt.json", 1).contains("map.json"));
    assert!(fails(folder, "eval result --ground-truth b.gt.json", 1).contains("b.gt.json"));
    fs::write(folder.join("b.gt.json"), r#"{"frame_id": "odom", "objects": []}"#).unwrap();
    let says = fails(folder, "eval result --ground-truth b.gt.json", 1);
    assert!(says.contains("\"map\"") && says.contains("\"odom\""), "{says}");
}

#[test]
fn a_bag_has_what_a_robot_records_and_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    succeeds(folder, &format!("{SIMULATE} --frames 3 --output a.mcap"));
    let counts = message_counts(&folder.join("a.mcap"));
    let expected = [
        ("/camera/aligned_depth_to_color/image_raw/compressedDepth", 3),
        ("/camera/color/camera_info", 3),
        ("/camera/color/image_raw/compressed", 3),
        ("/detections", 3),
        ("/ground_truth/detections", 3),
        ("/ground_truth/objects", 1),
        ("/ground_truth/odom", 3),
        // 30 Hz over two thirds of a second.
        ("/odom", 21),
        ("/tf", 21),
        ("/tf_static", 1),
    ];
    assert_eq!(counts, expected.map(|(name, count)| (name.to_owned(), count)).into());
    let truth = fs::read_to_string(folder.join("a.gt.json")).unwrap();
    let truth = GroundTruth::from_json(&truth).unwrap();
    assert!(truth.objects.iter().any(|o| o.label == "keyboard" && o.observations == 3));

    succeeds(folder, &format!("{SIMULATE} --frames 3 --output b.mcap"));
    let bytes = |name: &str| fs::read(folder.join(name)).unwrap();
    assert_eq!(bytes("a.mcap"), bytes("b.mcap"), "the same settings give the same bytes");
    succeeds(folder, &format!("{SIMULATE} --frames 3 --raw --no-color --output c.mcap"));
    let raw = message_counts(&folder.join("c.mcap"));
    assert_eq!(raw.get("/camera/aligned_depth_to_color/image_raw"), Some(&3));
    assert!(!raw.keys().any(|name| name.starts_with("/camera/color/image_raw")));
}

#[test]
fn bad_arguments_get_a_sentence_and_status_2() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let cases = [
        ("--set detector.miss=1.5", "detector.miss is 1.5"),
        ("--set detector.mis=0.5", "detector.mis"),
        ("--set detector.miss", "GROUP.NAME=VALUE"),
        ("--set detector=3", "detector"),
        ("--set frames=many", "many"),
        ("--scene moon", "moon"),
        ("--jpeg-quality 0", "0"),
    ];
    for (arguments, expected) in cases {
        let flags = "simulate --scene desk --trajectory orbit --output a.mcap";
        let flags = if arguments.starts_with("--scene") {
            "simulate --trajectory orbit --output a.mcap"
        } else {
            flags
        };
        let says = fails(folder, &format!("{flags} {arguments}"), 2);
        assert!(says.contains(expected), "{arguments}: {says}");
    }
    fails(folder, "simulate --output a.mcap", 2);
    fs::write(folder.join("bad.yaml"), "detector: {mis: 1}").unwrap();
    fails(folder, "simulate --settings bad.yaml --output a.mcap", 2);
    fs::write(folder.join("a.gt.json"), "mine").unwrap();
    let says = fails(folder, &format!("{SIMULATE} --frames 1 --output a.mcap"), 2);
    assert!(says.contains("a.gt.json") && says.contains("--force"), "{says}");
    assert_eq!(fs::read_dir(folder).unwrap().count(), 2, "nothing was left behind");
    succeeds(folder, &format!("{SIMULATE} --frames 1 --force --output a.mcap"));
}

#[test]
fn printed_settings_are_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let changed = "simulate --scene home --trajectory loop --seed 5 --perfect --set detector.miss=0.25 --print-settings";
    let text = succeeds(folder, changed);
    fs::write(folder.join("a.yaml"), &text).unwrap();
    assert_eq!(succeeds(folder, "simulate --settings a.yaml --print-settings"), text);
    assert!(text.contains("scene: home") && text.contains("miss: 0.25"), "{text}");
}

#[test]
fn a_download_of_the_benchmark_is_imported_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let tum = folder.join("tum");
    fs::create_dir_all(&tum).unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(tum.join(name), bytes).unwrap();
    write("depth.png", &grey_png(640, 480));
    write("color.png", &grey_png(640, 480));
    // Both depth images are nearest to the second colour image, which belongs to the second; the third has none.
    write("rgb.txt", b"# color images\n1.00 color.png\n1.02 color.png\n");
    write("depth.txt", b"# depth maps\n1.015 depth.png\n1.022 depth.png\n1.50 depth.png\n");
    write("groundtruth.txt", b"# ground truth\n0.9 0 0 1 0 0 0 1\n1.6 0 0 1 0 0 0 1\n");
    let says = fails(folder, "import tum tum --output a.mcap", 1);
    assert!(says.contains("no camera.yaml") && says.contains("--camera fr1"), "{says}");
    let says = succeeds(folder, "import tum tum --camera fr2 --output a.mcap");
    assert!(says.contains("2 RGB-D frames, 0 boxes") && says.contains("--model"), "{says}");
    // The name of the folder says as much.
    fs::rename(&tum, folder.join("rgbd_dataset_freiburg2_desk")).unwrap();
    succeeds(folder, "import tum rgbd_dataset_freiburg2_desk --output b.mcap");
    let [a, b] = ["a.mcap", "b.mcap"].map(|bag| fs::read(folder.join(bag)).unwrap());
    assert!(a == b);
    let bag = BagReader::open(&folder.join("a.mcap")).unwrap();
    let infos = bag.messages().only(["/camera/color/camera_info"]);
    let infos: Vec<CameraInfo> = infos.map(|m| decode(&m.data).unwrap()).collect();
    let stamps: Vec<u32> = infos.iter().map(|info| info.header.stamp.nanosec).collect();
    assert_eq!(stamps, [0, 20_000_000]);
    assert_eq!((infos[0].k[0], infos[0].k[5], infos[0].d[4]), (520.9, 249.7, 0.9172));
}

/// A picture of 16-bit grey.
fn grey_png(width: u32, height: u32) -> Vec<u8> {
    let mut picture = Vec::new();
    let mut encoder = png::Encoder::new(&mut picture, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let pixels = vec![20; 2 * width as usize * height as usize];
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    picture
}

#[test]
fn an_imported_folder_keeps_its_truth() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let tum = folder.join("tum");
    fs::create_dir_all(tum.join("bbox")).unwrap();
    let depth = grey_png(4, 2);
    let write = |name: &str, bytes: &[u8]| fs::write(tum.join(name), bytes).unwrap();
    write("depth.png", &depth);
    write("color.png", &depth);
    write("associate.txt", b"1.0 color.png 1.0 depth.png\n");
    write("groundtruth.txt", b"1.0 0 0 1 0 0 0 1\n");
    write("bbox/1.0.txt", b"0 0 0 3 1 chair 0.9 7\n");
    let camera =
        "width: 4\nheight: 2\nfx: 4\nfy: 4\ncx: 1.5\ncy: 0.5\ndepth_units_per_metre: 5000\n";
    write("camera.yaml", camera.as_bytes());
    succeeds(folder, "import tum tum --output without.mcap");
    assert!(!folder.join("without.gt.json").exists());

    let truth = r#"{"frame_id": "map", "objects": [{"id": 7, "label": "chair", "position": [0, 0, 2],
        "orientation": [0, 0, 0, 1], "size": [1, 1, 1], "observations": 1}]}"#;
    write("objects.gt.json", truth.as_bytes());
    succeeds(folder, "import tum tum --output with.mcap");
    let kept = fs::read_to_string(folder.join("with.gt.json")).unwrap();
    assert_eq!(GroundTruth::from_json(&kept).unwrap(), GroundTruth::from_json(truth).unwrap());
    let counts = message_counts(&folder.join("with.mcap"));
    assert_eq!((counts["/ground_truth/objects"], counts["/ground_truth/odom"]), (1, 1));

    write("objects.gt.json", truth.replace("[1, 1, 1]", "[1, 0, 1]").as_bytes());
    let says = fails(folder, "import tum tum --output bad.mcap", 1);
    assert!(says.contains("objects.gt.json") && says.contains("not positive"), "{says}");
    assert!(!folder.join("bad.mcap").exists());
}
