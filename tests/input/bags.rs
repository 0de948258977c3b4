//! Bags of every layout, and writing one.

use crate::fixtures::{self, Layout, Line, PLAIN, bag, line, scene, stamp};
use ellipsoid_slam::io::{BagError, BagReader, BagWriter, RawMessage, write_atomically};
use mcap::Compression::{Lz4, Zstd};
use std::{fs, path::Path};

/// Everything that distinguishes messages, in a form that can be compared.
fn key(topic: &str, log_time: ellipsoid_slam::time::Stamp, data: &[u8]) -> (i64, String, Vec<u8>) {
    (log_time.as_nanos(), topic.to_owned(), data.to_vec())
}

fn read(path: &Path) -> Vec<RawMessage> {
    let bag = BagReader::open(path).unwrap();
    assert_eq!(bag.warnings().count(), 0);
    let mut messages = bag.messages();
    let all: Vec<RawMessage> = messages.by_ref().collect();
    assert!(messages.warnings().is_empty(), "{:?}", messages.warnings());
    assert_eq!(all.len() as u64, bag.message_count());
    all
}

#[track_caller]
fn check(path: &Path, lines: &[Line]) {
    let got: Vec<_> = read(path).iter().map(|m| key(&m.topic, m.log_time, &m.data)).collect();
    let mut expected: Vec<_> = lines.iter().map(|l| key(&l.topic, l.log_time, &l.data)).collect();
    // Stable: lines of the same time keep the file's order.
    expected.sort_by_key(|(time, ..)| *time);
    assert!(got == expected, "{} messages, expected {}", got.len(), expected.len());
}

fn layouts() -> Vec<Layout> {
    let mut all = Vec::new();
    for compression in [None, Some(Zstd), Some(Lz4)] {
        for summary in [true, false] {
            all.push(Layout { compression, chunks: true, summary });
        }
    }
    for summary in [true, false] {
        all.push(Layout { compression: None, chunks: false, summary });
    }
    all
}

#[test]
fn every_layout_gives_the_same_messages_in_log_time_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut shuffled = scene();
    // As recorders write them: what was logged earlier lies later in the file, also across chunks.
    shuffled.swap(3, 17);
    shuffled.swap(20, 38);
    for lines in [scene(), shuffled, vec![]] {
        for layout in layouts() {
            fs::write(&path, bag(&lines, layout)).unwrap();
            check(&path, &lines);
        }
    }
}

#[test]
fn topics_have_types_and_counts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    for layout in layouts() {
        fs::write(&path, bag(&scene(), layout)).unwrap();
        let bag = BagReader::open(&path).unwrap();
        let topics: Vec<_> = bag
            .topics()
            .iter()
            .map(|t| (t.name.as_str(), t.type_name.as_str(), t.messages))
            .collect();
        let expected = [
            ("/camera/camera_info", "sensor_msgs/msg/CameraInfo", 10),
            ("/camera/depth/image", "sensor_msgs/msg/Image", 10),
            ("/detections", "vision_msgs/msg/Detection2DArray", 10),
            ("/odom", "nav_msgs/msg/Odometry", 10),
            ("/tf_static", "tf2_msgs/msg/TFMessage", 1),
        ];
        assert_eq!(topics, expected);
        assert_eq!(bag.time_range(), Some((stamp(0), stamp(9))));
        let only: Vec<_> =
            bag.messages().only(["/odom", "/tf_static"]).map(|m| m.topic.to_string()).collect();
        assert_eq!(only.len(), 11);
        assert!(only.iter().all(|topic| topic == "/odom" || topic == "/tf_static"));
    }
}

const METADATA: &str = "rosbag2_bagfile_information:
  version: 5
  storage_identifier: mcap
  duration:
    nanoseconds: 900000000
  message_count: 41
  topics_with_message_count: []
  compression_format: \"\"
  compression_mode: \"\"
  relative_file_paths:
    - b_1.mcap
    - b_0.mcap
  files: []
";

#[test]
fn splits_are_one_bag() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (scene(), scene());
    let (first, second) = (&first[..21], &second[19..]);
    fs::write(folder.path().join("b_0.mcap"), bag(first, PLAIN)).unwrap();
    fs::write(
        folder.path().join("b_1.mcap"),
        bag(second, Layout { compression: Some(Zstd), ..PLAIN }),
    )
    .unwrap();
    fs::write(folder.path().join("notes.txt"), "not a bag").unwrap();
    let both = || {
        first.iter().chain(second).map(|l| Line {
            data: l.data.clone(),
            topic: l.topic.clone(),
            ..*l
        })
    };
    check(folder.path(), &both().collect::<Vec<_>>());

    // With metadata, the order is that of the list; it decides between messages of the same time.
    fs::write(folder.path().join("metadata.yaml"), METADATA).unwrap();
    let listed: Vec<Line> = second
        .iter()
        .chain(first)
        .map(|l| Line { data: l.data.clone(), topic: l.topic.clone(), ..*l })
        .collect();
    check(folder.path(), &listed);
}

#[test]
fn what_is_no_bag_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let with = |name: &str, content: &[u8]| fs::write(at(name), content).unwrap();
    with("garbage.mcap", b"this is no bag, whatever its name says");
    with("empty.mcap", b"");
    with("whole.mcap.zstd", &[0x28, 0xb5, 0x2f, 0xfd, 0, 0, 0, 0, 0]);
    with("bag.db3", b"SQLite format 3");
    with("broken.db3", b"SQLite format 3\0 and then nothing of it");
    for (name, metadata) in [
        ("lost", METADATA.to_owned()),
        ("broken", "rosbag2_bagfile_information: [".to_owned()),
        ("none", METADATA.split("  relative").next().unwrap().to_owned()),
    ] {
        fs::create_dir(at(name)).unwrap();
        with(&format!("{name}/metadata.yaml"), metadata.as_bytes());
    }
    fs::create_dir(at("hollow")).unwrap();
    fs::create_dir(at("old")).unwrap();
    with("old/old_0.db3", b"SQLite format 3");
    let cases = [
        ("absent.mcap", "no such file or folder"),
        ("garbage.mcap", "is neither an MCAP file nor one in SQLite storage"),
        ("empty.mcap", "is neither an MCAP file nor one in SQLite storage"),
        ("whole.mcap.zstd", "cannot be decompressed"),
        ("bag.db3", "is neither an MCAP file nor one in SQLite storage"),
        ("broken.db3", "cannot be read as SQLite"),
        ("lost", "b_1.mcap: no such file"),
        ("broken", "metadata.yaml"),
        ("none", "contains no .mcap or .db3 file"),
        ("hollow", "contains no .mcap or .db3 file"),
        ("old", "neither an MCAP file"),
    ];
    for (name, expected) in cases {
        let says = BagReader::open(&at(name)).unwrap_err().to_string();
        assert!(
            says.contains(expected) && says.contains(name) && !says.contains('\n'),
            "{name}: {says}"
        );
    }
}

#[test]
fn a_written_bag_is_read_again_and_has_the_same_bytes_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["a.mcap", "b.mcap"].map(|name| folder.path().join(name));
    for path in &paths {
        let mut writer = BagWriter::create(path).unwrap();
        for at in 0..200 {
            writer.write("/odom", &fixtures::odometry(at), stamp(at)).unwrap();
            writer.write("/tf_static", &fixtures::transforms(at), stamp(at)).unwrap();
        }
        assert!(!path.exists(), "only a finished bag has its name");
        writer.finish().unwrap();
    }
    let lines: Vec<Line> = (0..200)
        .flat_map(|at| {
            [
                line("/odom", at, &fixtures::odometry(at)),
                line("/tf_static", at, &fixtures::transforms(at)),
            ]
        })
        .collect();
    check(&paths[0], &lines);
    assert!(fs::read(&paths[0]).unwrap() == fs::read(&paths[1]).unwrap());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "no temporary file stays");
}

#[test]
fn an_unfinished_bag_leaves_nothing_and_spares_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    fs::write(&path, "earlier").unwrap();
    let mut writer = BagWriter::create(&path).unwrap();
    writer.write("/odom", &fixtures::odometry(0), stamp(0)).unwrap();
    let error = writer.write("/odom", &fixtures::depth(0), stamp(0)).unwrap_err();
    assert!(
        matches!(&error, BagError::NotWritable { .. }) && error.to_string().contains("/odom"),
        "{error}"
    );
    drop(writer);
    assert_eq!(fs::read(&path).unwrap(), b"earlier");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    let error = BagWriter::create(&folder.path().join("no/such/a.mcap")).err().unwrap();
    assert!(error.to_string().contains("no/such/a.mcap"), "{error}");
}

#[test]
fn text_files_are_replaced_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    for text in ["one", "two"] {
        write_atomically(&path, text.as_bytes()).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
    assert!(write_atomically(&folder.path().join("no/map.json"), b"x").is_err());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
