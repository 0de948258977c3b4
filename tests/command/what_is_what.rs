//! Which topic and frame is what, said by hand or found, in `replay` and `inspect` alike.

use crate::run::{CAMERA_POSE, Flaw, run, stderr, truth, write_bag};
use ellipsoid_slam::{
    io::{BagReader, load_saved_map},
    pipeline::CameraPose,
};
use nalgebra::Vector3;
use std::{fs, process::Output};

/// What a command says of a bag with a flaw.
fn said(command: &str, flaw: Flaw, more: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    let (bag, out) = (folder.path().join("box.mcap"), folder.path().join("out"));
    write_bag(&bag, flaw);
    let mut args = vec![command, bag.to_str().unwrap()];
    if command == "replay" {
        args.extend(["--output", out.to_str().unwrap()]);
    }
    args.extend(more);
    run(&args)
}

#[test]
fn inspect_fails_where_replay_does() {
    let all = [
        (Flaw::None, &[][..], true),
        (Flaw::NanPose, &[], true),
        (Flaw::NoDepth, &[], false),
        (Flaw::NoCameraInfo, &[], false),
        (Flaw::NoDetections, &[], false),
        (Flaw::SizesDiffer, &[], false),
        (Flaw::NoPose, &[], false),
        (Flaw::NoTransforms, &[], false),
        (Flaw::NoTransforms, &["--camera-pose", CAMERA_POSE], true),
        (Flaw::None, &["--set", "topics.detections=/nonexistent"], false),
        (Flaw::None, &["--set", "topics.detections=/detections"], true),
        (Flaw::None, &["-r", "detections:=/nonexistent"], false),
        (Flaw::None, &["-r", "depth/image:=/camera/depth/image"], true),
    ];
    for (flaw, more, works) in all {
        for command in ["inspect", "replay"] {
            let output = said(command, flaw, more);
            let status = if works { 0 } else { 1 };
            assert_eq!(
                output.status.code(),
                Some(status),
                "{command} {flaw:?} {more:?}: {}",
                stderr(&output)
            );
            if more.iter().any(|word| word.contains("/nonexistent")) {
                let says = stderr(&output);
                assert!(
                    says.contains(
                        "no topic /nonexistent for detections; it has /camera/camera_info"
                    ),
                    "{says}"
                );
            }
        }
    }
}

#[test]
fn a_parameter_file_says_which_topics_are_meant() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("topics.yaml");
    let text = "/**:\n  ros__parameters:\n    topics: {depth: /camera/depth/image, odometry: ''}\n";
    fs::write(&file, text).unwrap();
    // Without odometry there is no pose.
    let output = said("inspect", Flaw::None, &["--config", file.to_str().unwrap()]);
    assert!(stderr(&output).contains("there is no odometry"), "{}", stderr(&output));
    let output =
        said("inspect", Flaw::None, &["--config", file.to_str().unwrap(), "-r", "odom:=/odom"]);
    assert!(output.status.success(), "{}", stderr(&output));
}

#[test]
fn a_parameter_file_says_what_a_result_holds() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, out) = (folder.path().join("box.mcap"), folder.path().join("out"));
    write_bag(&bag, Flaw::None);
    let published = |setting: &str| {
        let args = ["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap(), "--force"];
        assert!(run(&[&args[..], &["--set", setting]].concat()).status.success());
        let result = BagReader::open(&out.join("result.mcap")).unwrap();
        result.topics().iter().any(|topic| topic.name == "/ellipsoid_slam/landmarks")
    };
    assert!(published("publish.landmarks=true") && !published("publish.landmarks=false"));
}

#[test]
fn a_bag_without_odometry_is_told_what_gives_it() {
    for command in ["inspect", "replay"] {
        let says = stderr(&said(command, Flaw::NoPose, &[]));
        for words in ["rtabmap_odom rgbd_odometry", "visual-inertial", "wheels", "ros2 bag record"]
        {
            assert!(says.contains(words), "{command}: {says}");
        }
    }
}

#[test]
fn the_camera_s_place_stands_in_for_transforms() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, out) = (folder.path().join("box.mcap"), folder.path().join("out"));
    write_bag(&bag, Flaw::NoTransforms);
    let replay = |more: &[&str]| {
        let args = ["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap(), "--force"];
        run(&[&args[..], more].concat())
    };
    let says = stderr(&replay(&[]));
    assert!(says.contains("no transform connects") && says.contains("--camera-pose"), "{says}");
    let output = replay(&["--camera-pose", CAMERA_POSE]);
    assert!(output.status.success(), "{}", stderr(&output));
    let map = load_saved_map(&out.join("map.json")).unwrap();
    assert_eq!(map.objects.len(), 1);
    let off = map.objects[0].ellipsoid.center() - truth().0;
    assert!(off.norm() < 0.03, "{off}");
    let setting = format!("sync.camera_pose='{CAMERA_POSE}'");
    let by_parameter = fs::read(out.join("map.json")).unwrap();
    assert!(replay(&["--set", &setting]).status.success());
    assert!(fs::read(out.join("map.json")).unwrap() == by_parameter);
    let wrong = run(&["replay", "x.mcap", "--camera-pose", "0,0,1"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(stderr(&wrong).contains("expected six numbers"), "{}", stderr(&wrong));
}

/// On paper: 30 degrees down is forward by cos 30 and down by sin 30; 90 degrees to the left is along y.
#[test]
fn a_camera_s_pose_is_of_its_body_and_in_degrees() {
    let cases = [
        ("0,0,0,0,0,0", Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, -1.0, 0.0)),
        ("0,0,0,0,30,0", Vector3::new(0.866_025_4, 0.0, -0.5), Vector3::new(0.0, -1.0, 0.0)),
        ("0,0,0,0,0,90", Vector3::new(0.0, 1.0, 0.0), Vector3::new(1.0, 0.0, 0.0)),
        ("0,0,0,90,0,0", Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, -1.0)),
    ];
    for (text, forward, right) in cases {
        let pose: CameraPose = text.parse().unwrap();
        let optical = pose.base_from_camera().unwrap().rotation;
        assert!((optical * Vector3::z() - forward).norm() < 1e-6, "{text}");
        assert!((optical * Vector3::x() - right).norm() < 1e-6, "{text}");
    }
    assert_eq!("0.1,0,1.2,0,30,0".parse::<CameraPose>().unwrap().to_string(), "0.1,0,1.2,0,30,0");
    assert_eq!("".parse::<CameraPose>().unwrap().base_from_camera(), None);
}
