//! What bad input gets: one sentence that names what is wrong and what to do, and nothing half-written.

use crate::run::{Flaw, replayed, run, stderr, write_bag};
use std::{fs, path::Path};

/// Replays and expects exit status 1, a sentence with all of `words`, and no output.
fn refused(bag: &Path, words: &[&str]) {
    let out = bag.with_extension("out");
    let output = run(&["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap()]);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    let errors = text.lines().filter(|line| line.starts_with("error: ")).count();
    assert_eq!(errors, 1, "{text}");
    for word in words {
        assert!(text.contains(word), "`{word}` is not in: {text}");
    }
    let left: Vec<_> = fs::read_dir(&out).into_iter().flatten().collect();
    assert!(left.is_empty(), "{left:?} was left behind");
}

#[test]
fn flaws_of_bags() {
    let cases: &[(Flaw, &[&str])] = &[
        (Flaw::NoDepth, &["depth", "/camera/camera_info", "-r depth:=/topic"]),
        (Flaw::NoCameraInfo, &["camera_info", "/camera/depth/image", "-r camera_info:=/topic"]),
        (Flaw::NoDetections, &["detections", "/odom", "-r detections:=/topic"]),
        (Flaw::SizesDiffer, &["/camera/depth/image", "160x120", "320x240"]),
        (Flaw::NoPose, &["odom", "base_link", "no transform"]),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (flaw, words) in cases {
        let bag = folder.path().join(format!("{flaw:?}.mcap"));
        write_bag(&bag, *flaw);
        refused(&bag, words);
    }
}

#[test]
fn streams_that_stop_or_go_back_are_warnings() {
    let cases = [
        (Flaw::DepthDies, "no depth image came in the last 7.4 s of the bag, after 1700000000.6"),
        (Flaw::ClockGoesBack, "the clock went back by 89.8 s"),
    ];
    for (flaw, words) in cases {
        let (_folder, output, _) = replayed(flaw);
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let warnings: Vec<&str> =
            summary["warnings"].as_array().unwrap().iter().filter_map(|w| w.as_str()).collect();
        assert_eq!(warnings.iter().filter(|w| w.contains(words)).count(), 1, "{warnings:#?}");
    }
    let (_folder, output, _) = replayed(Flaw::None);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["warnings"].as_array().unwrap().len(), 0, "{summary:#}");
}

#[test]
fn nothing_is_said_twice() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("no_depth.mcap");
    write_bag(&bag, Flaw::NoDepth);
    let (bag, folder) = (bag.to_str().unwrap(), folder.path().to_str().unwrap());
    for (args, words) in [
        (vec!["replay", bag, "--output", "/proc/no"], "no topic for depth"),
        (vec!["replay", folder, "--config", folder], "directory"),
        (vec!["replay", "bags/desk.mcap", "--map", folder], "no regular file"),
    ] {
        let said = stderr(&run(&args));
        assert_eq!(said.matches(words).count(), 1, "{said}");
    }
}

#[test]
fn what_a_cut_or_oddly_compressed_bag_lacks_is_explained() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole.mcap");
    write_bag(&whole, Flaw::None);
    let bytes = fs::read(&whole).unwrap();
    let cut = folder.path().join("cut.mcap");
    fs::write(&cut, &bytes[..200]).unwrap();
    refused(&cut, &["no topic", "is truncated"]);
    let odd = folder.path().join("odd.mcap");
    let name = [&4_u32.to_le_bytes()[..], b"zstd"].concat();
    let mut bytes = bytes;
    let places: Vec<usize> =
        (0..bytes.len() - 8).filter(|at| bytes[*at..*at + 8] == name).collect();
    places.iter().for_each(|at| bytes[*at + 4..*at + 8].copy_from_slice(b"br99"));
    fs::write(&odd, &bytes).unwrap();
    refused(&odd, &["is compressed with `br99`, which is not supported"]);
}

#[test]
fn files_that_are_no_bags() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.mcap");
    refused(&missing, &["missing.mcap"]);
    let text = folder.path().join("text.mcap");
    fs::write(&text, "this is not a bag, though it is long enough to be looked at").unwrap();
    refused(&text, &["text.mcap", "neither an MCAP file nor"]);
    let empty = folder.path().join("empty.mcap");
    fs::write(&empty, "").unwrap();
    refused(&empty, &["empty.mcap"]);
}

#[test]
fn boxes_outside_the_image_are_refused_one_by_one() {
    let (_folder, output, _) = replayed(Flaw::BoxesOutside);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["objects"], 0);
    assert_eq!(summary["skipped_messages"]["/detections"]["box_outside"], 6, "{summary:#}");
}

#[test]
fn a_truncated_bag_gives_what_is_whole_and_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole.mcap");
    write_bag(&whole, Flaw::None);
    let bytes = fs::read(&whole).unwrap();
    let bag = folder.path().join("cut.mcap");
    fs::write(&bag, &bytes[..bytes.len() * 9 / 10]).unwrap();
    let output = run(&["inspect", bag.to_str().unwrap()]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &stderr(&output);
    assert!(text.contains("truncated") || text.contains("missing"), "{text}");
}

#[test]
fn wrong_usage_has_status_2() {
    for args in [
        &["replay"][..],
        &["replay", "x.mcap", "-r", "lidar:=/scan"],
        &["replay", "x.mcap", "-r", "depth=/d"],
        &["fly"],
    ] {
        let output = run(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", stderr(&output));
    }
}

#[test]
fn a_node_without_security_does_not_start_where_security_is_enforced() {
    let node = |strategy: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"));
        command.arg("node").env("ROS_SECURITY_ENABLE", "true");
        // Another mistake, so that it never runs.
        command.env("ROS_SECURITY_STRATEGY", strategy).env("ROS_DOMAIN_ID", "none");
        command.output().unwrap()
    };
    let refused = node("Enforce");
    assert_eq!(refused.status.code(), Some(1));
    assert!(stderr(&refused).contains("this program has no security"), "{}", stderr(&refused));
    assert!(stderr(&node("Permissive")).contains("ROS_DOMAIN_ID"));
}
