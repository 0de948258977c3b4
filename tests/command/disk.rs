//! A disk without room: what is worth most is written first, and the error says what is missing.

use crate::run::stderr;
use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

const FOLDER: &str = env!("CARGO_MANIFEST_DIR");

fn replay(before: &str, out: &Path) -> Output {
    let program = env!("CARGO_BIN_EXE_ellipsoid_slam");
    let line = format!("{before} exec {program} replay bags/desk.mcap --output {}", out.display());
    Command::new("bash").args(["-c", &line]).current_dir(FOLDER).output().unwrap()
}

/// The map and the trajectories are those of a replay with room enough, and the bag is named.
fn the_map_is_there(output: &Output, out: &Path, words: &str) {
    let said = stderr(output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    let errors: Vec<&str> = said.lines().filter(|line| line.starts_with("error: ")).collect();
    let [error] = errors.as_slice() else { panic!("{said}") };
    assert!(error.contains("result.mcap") && error.contains(words), "{error}");
    let whole = tempfile::tempdir().unwrap();
    assert!(replay("", &whole.path().join("out")).status.success());
    for name in ["map.json", "trajectory.tum", "trajectory_live.tum"] {
        let [wanted, got] =
            [&whole.path().join("out"), out].map(|folder| fs::read(folder.join(name)).unwrap());
        assert!(wanted == got, "{name} differs");
    }
    let left: Vec<String> = fs::read_dir(out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".part") || name == "result.mcap")
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_bag_that_grows_too_large_costs_only_itself() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    // Of the files of this replay only the bag is larger than 60 kB.
    let output = replay("trap '' XFSZ; ulimit -f 60;", &out);
    the_map_is_there(&output, &out, "the disk takes no larger file");
}

/// A small disk of its own; who may not mount one cannot run the test.
struct SmallDisk(tempfile::TempDir);

impl SmallDisk {
    fn mounted(size: &str) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let options = format!("size={size}");
        let mount = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &options, "tmpfs"])
            .arg(folder.path())
            .output();
        let mounted = mount.is_ok_and(|output| output.status.success());
        mounted.then_some(Self(folder))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).status();
    }
}

/// Room for all but the report, which is written last.
#[test]
fn a_report_that_finds_no_room_costs_only_itself() {
    let whole = tempfile::tempdir().unwrap();
    let expected = whole.path().join("out");
    assert!(replay("", &expected).status.success());
    let names = ["map.json", "trajectory.tum", "trajectory_live.tum", "result.mcap"];
    let bytes: u64 = names.iter().map(|n| expected.join(n).metadata().unwrap().len()).sum();
    let Some(disk) = SmallDisk::mounted(&format!("{}k", bytes / 1024 + 600)) else {
        println!("no disk may be mounted here");
        return;
    };
    let out = disk.0.path().join("out");
    let output = replay("", &out);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    let errors: Vec<&str> = said.lines().filter(|line| line.starts_with("error: ")).collect();
    let [error] = errors.as_slice() else { panic!("{said}") };
    assert!(error.contains("report.html") && error.contains("the disk is full"), "{error}");
    for name in names {
        let [wanted, got] = [&expected, &out].map(|folder| fs::read(folder.join(name)).unwrap());
        assert!(wanted == got, "{name} differs");
    }
    let left = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name());
    let left: Vec<String> = left.map(|name| name.to_string_lossy().into_owned()).collect();
    assert!(left.contains(&"summary.json".to_owned()), "{left:?}");
    assert!(!left.iter().any(|name| name.ends_with(".part") || name == "report.html"), "{left:?}");
}

#[test]
fn a_read_only_disk_is_said_in_a_sentence() {
    let Some(disk) = SmallDisk::mounted("160k") else {
        println!("no disk may be mounted here");
        return;
    };
    let read_only = Command::new("mount").args(["-o", "remount,ro"]).arg(disk.0.path()).status();
    assert!(read_only.unwrap().success());
    let said = stderr(&replay("", &disk.0.path().join("out")));
    let errors: Vec<&str> = said.lines().filter(|line| line.starts_with("error: ")).collect();
    assert!(errors.len() == 1 && errors[0].contains("ead-only"), "{said}");
}

#[test]
fn a_full_disk_loses_no_map() {
    let Some(disk) = SmallDisk::mounted("160k") else {
        println!("no disk may be mounted here: only the test with a limit on files says something");
        return;
    };
    let out = disk.0.path().join("out");
    the_map_is_there(&replay("", &out), &out, "the disk is full");
}
