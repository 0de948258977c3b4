//! Who interrupts a command finds no half-written files.

use std::{
    fs,
    os::unix::process::ExitStatusExt,
    path::Path,
    process::{Command, Stdio},
    thread,
    time::Duration,
};

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
}

#[test]
fn an_interrupted_replay_leaves_nothing_half_written() {
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let mut replay = Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"))
            .args(["replay", "bags/desk.mcap", "--output", out.to_str().unwrap()])
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        while !names(&out).iter().any(|name| name.ends_with(".part")) {
            assert!(replay.try_wait().unwrap().is_none(), "it ended before it was interrupted");
            thread::sleep(Duration::from_millis(1));
        }
        let id = replay.id().to_string();
        assert!(
            Command::new("kill").args([&format!("-{signal}"), &id]).status().unwrap().success()
        );
        let status = replay.wait().unwrap();
        assert_eq!(status.signal(), Some(number), "{status}");
        assert_eq!(names(&out), Vec::<String>::new(), "after {signal}");
    }
}

#[test]
fn an_interrupted_replay_of_a_compressed_bag_leaves_nothing_in_the_temporary_folder() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, scratch) = (folder.path().join("desk.mcap.zstd"), folder.path().join("scratch"));
    fs::create_dir(&scratch).unwrap();
    let whole = Path::new(env!("CARGO_MANIFEST_DIR")).join("bags/desk.mcap");
    fs::write(&bag, zstd::encode_all(fs::File::open(whole).unwrap(), 1).unwrap()).unwrap();
    let out = folder.path().join("out");
    let mut replay = Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"))
        .args(["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap()])
        .env("TMPDIR", &scratch)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while names(&out).is_empty() {
        assert!(replay.try_wait().unwrap().is_none(), "it ended before it was interrupted");
        thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(names(&scratch).len(), 1, "the bag as it was before it was compressed");
    let id = replay.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert_eq!(replay.wait().unwrap().signal(), Some(2));
    assert_eq!(names(&scratch), Vec::<String>::new());
}
