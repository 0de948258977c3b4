//! The same recording in each storage of rosbag2: MCAP, SQLite, compressed with zstd as a whole or message by message.

use crate::{
    run::{Flaw, run, stderr, write_bag},
    sqlite::{TABLES, write_sqlite},
};
use ellipsoid_slam::{
    io::{BagReader, BagWriter, RawMessage},
    time::Stamp,
};
use rusqlite::Connection;
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

fn recording(folder: &Path) -> (PathBuf, Vec<RawMessage>) {
    let mcap = folder.join("box.mcap");
    write_bag(&mcap, Flaw::None);
    let messages = BagReader::open(&mcap).unwrap().messages().collect();
    (mcap, messages)
}

/// A number as SQLite's records have it: seven bits a byte, all but the last marked (file format, 2.1).
fn varint(number: u64) -> Vec<u8> {
    let bytes: Vec<u8> = (0..5).rev().map(|at| (number >> (7 * at)) as u8 | 0x80).collect();
    let (last, first) = bytes.split_last().unwrap();
    [first, &[last & 0x7f]].concat()
}

/// A bag whose one message says that it has a gigabyte.
fn write_claim(path: &Path) {
    let database = Connection::open(path).unwrap();
    database.execute_batch(TABLES).unwrap();
    database
        .execute_batch(
            "INSERT INTO topics VALUES (1, '/odom', 'nav_msgs/msg/Odometry', 'cdr', ''); \
             INSERT INTO messages VALUES (1, 1, 5, zeroblob(100)); \
             INSERT INTO messages VALUES (2, 1, 6, zeroblob(9));",
        )
        .unwrap();
    drop(database);
    let mut bytes = fs::read(path).unwrap();
    // A row: its length, its number, and its header: length, kinds of the columns (a blob of n bytes is 2 n + 12).
    let honest = [107, 1, 6, 0, 9, 1, 0x81, 0x54];
    let at = bytes.windows(honest.len()).position(|row| row == honest).unwrap();
    let claimed = 1_000_000_000;
    let header = [&[1, 9, 0, 9, 1][..], &varint(2 * claimed + 12)].concat();
    let row = [varint(claimed + 10), header].concat();
    // It is put into the empty space of the page, whose list of rows begins with where the first one is.
    let page = at / 4096 * 4096;
    bytes[page + 1000..page + 1000 + row.len()].copy_from_slice(&row);
    let found = u16::from_be_bytes([bytes[page + 8], bytes[page + 9]]);
    assert_eq!(usize::from(found), at % 4096);
    bytes[page + 8..page + 10].copy_from_slice(&1000_u16.to_be_bytes());
    fs::write(path, bytes).unwrap();
}

#[test]
fn a_message_that_claims_a_gigabyte_takes_no_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("claim.db3");
    write_claim(&path);
    let program = env!("CARGO_BIN_EXE_ellipsoid_slam");
    let inspect = format!("ulimit -v 700000; exec {program} inspect {}", path.display());
    let output = Command::new("sh").args(["-c", &inspect]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &stderr(&output);
    assert!(said.contains("claim.db3 is damaged") && said.contains("no topic for depth"), "{said}");
    let bag = BagReader::open(&path).unwrap();
    let mut messages = bag.messages();
    let sizes: Vec<usize> = messages.by_ref().map(|message| message.data.len()).collect();
    assert_eq!(sizes, [9], "the one after it is read");
    assert_eq!(bag.warnings().count() + messages.warnings().len(), 1);
}

fn zstd_of(data: &[u8]) -> Vec<u8> {
    zstd::encode_all(data, 3).unwrap()
}

fn map_of(bag: &Path, folder: &Path) -> String {
    let out = folder.join("out");
    let output =
        run(&["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap(), "--force"]);
    assert!(output.status.success(), "{}: {}", bag.display(), stderr(&output));
    assert!(!stderr(&output).contains("warning"), "{}", stderr(&output));
    fs::read_to_string(out.join("map.json")).unwrap()
}

#[test]
fn each_storage_gives_the_same_map() {
    let folder = tempfile::tempdir().unwrap();
    let (mcap, messages) = recording(folder.path());
    let at = |name: &str| folder.path().join(name);
    write_sqlite(&at("plain.db3"), &messages, <[u8]>::to_vec);
    write_sqlite(&at("messages.db3"), &messages, zstd_of);
    for name in ["plain.db3", "box.mcap"] {
        let packed = zstd_of(&fs::read(at(name)).unwrap());
        fs::write(at(&format!("{name}.zstd")), packed).unwrap();
    }
    let mut packed = BagWriter::create(&at("messages.mcap")).unwrap();
    for RawMessage { topic, type_name, log_time, data } in &messages {
        packed.write_raw(topic, type_name, &zstd_of(data), *log_time).unwrap();
    }
    packed.finish().unwrap();
    // Compressed as a whole, under the names of before.
    fs::create_dir(at("whole")).unwrap();
    fs::copy(at("plain.db3.zstd"), at("whole/plain.db3.zstd")).unwrap();
    let listed = "rosbag2_bagfile_information:\n  relative_file_paths: [plain.db3]\n  compression_mode: FILE\n";
    fs::write(at("whole/metadata.yaml"), listed).unwrap();
    // A folder of rosbag2, whose parts are in the order of its list.
    fs::create_dir(at("folder")).unwrap();
    let (first, second) = messages.split_at(messages.len() / 2);
    write_sqlite(&at("folder/part_0.db3"), first, <[u8]>::to_vec);
    write_sqlite(&at("folder/part_1.db3"), second, <[u8]>::to_vec);
    let listed = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  \
                  relative_file_paths: [part_0.db3, part_1.db3]\n  compression_mode: \"\"\n";
    fs::write(at("folder/metadata.yaml"), listed).unwrap();

    let expected = map_of(&mcap, folder.path());
    assert!(expected.contains("label"), "the bag has an object");
    let single = ["plain.db3", "messages.db3", "messages.mcap", "plain.db3.zstd", "box.mcap.zstd"];
    for name in single.into_iter().chain(["whole", "folder"]) {
        assert_eq!(map_of(&at(name), folder.path()), expected, "{name}");
        let read: Vec<RawMessage> = BagReader::open(&at(name)).unwrap().messages().collect();
        assert!(read == messages, "{name}");
    }
}

#[test]
fn a_damaged_database_gives_what_is_whole_and_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let (_, messages) = recording(folder.path());
    let path = folder.path().join("bag.db3");
    write_sqlite(&path, &messages, <[u8]>::to_vec);
    let whole = fs::read(&path).unwrap();
    for part in 1..24 {
        // Cut, or with a page overwritten; the size of a page is 4096 bytes.
        let at = whole.len() * part / 24;
        let mut scarred = whole.clone();
        let page = at / 4096 * 4096;
        scarred[page..page + 4096].fill(0xff);
        for damaged in [&whole[..at], &scarred[..]] {
            fs::write(&path, damaged).unwrap();
            let bag = match BagReader::open(&path) {
                Ok(bag) => bag,
                Err(why) => {
                    assert_eq!(why.to_string().lines().count(), 1, "{why}");
                    continue;
                }
            };
            let mut read = bag.messages();
            let kept = read.by_ref().count();
            assert!(kept <= messages.len());
            let warnings = bag.warnings().chain(read.warnings()).count();
            assert!(kept == messages.len() || warnings > 0, "{kept} messages at byte {at}");
        }
    }
}

#[test]
fn a_damaged_page_costs_what_is_on_it_and_little_more() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag.db3");
    let message = |i: usize| RawMessage {
        topic: "/odom".into(),
        type_name: "nav_msgs/msg/Odometry".into(),
        log_time: Stamp::from_nanos(i as i64),
        data: vec![i as u8; 100],
    };
    write_sqlite(&path, &(0..2000).map(message).collect::<Vec<_>>(), <[u8]>::to_vec);
    let whole = fs::read(&path).unwrap();
    // A page of rows begins with 13, and with how many there are.
    let page = |page: &usize| whole[4096 * page] == 13 && whole[4096 * page + 4] > 20;
    let pages: Vec<usize> = (1..whole.len() / 4096).filter(page).collect();
    assert!(pages.len() > 20);
    let mut scarred = whole.clone();
    scarred[4096 * pages[pages.len() / 2]..][..4096].fill(0xff);
    fs::write(&path, scarred).unwrap();
    let bag = BagReader::open(&path).unwrap();
    let kept = bag.messages().count();
    assert!((1900..2000).contains(&kept), "{kept}");
    assert_eq!(bag.warnings().count(), 1);
}

#[test]
fn what_is_no_recording_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    Connection::open(at("other.db3")).unwrap().execute_batch("CREATE TABLE a(b)").unwrap();
    fs::write(at("old.bag"), b"#ROSBAG V2.0\nand more than sixteen bytes").unwrap();
    fs::write(at("cut.db3.zstd"), &zstd_of(&[7; 1000])[..10]).unwrap();
    // Sixteen megabytes of nothing in a few hundred bytes.
    let endless = zstd_of(&vec![0; 1 << 24]);
    fs::write(at("bomb.mcap.zstd"), endless).unwrap();
    // Kept to itself by a recorder.
    write_sqlite(&at("busy.db3"), &recording(folder.path()).1, <[u8]>::to_vec);
    let recorder = Connection::open(at("busy.db3")).unwrap();
    recorder.execute_batch("BEGIN EXCLUSIVE").unwrap();
    fs::create_dir(at("ros1")).unwrap();
    fs::copy(at("old.bag"), at("ros1/old.bag")).unwrap();
    for (name, sentence) in [
        ("busy.db3", "is being written by another program"),
        ("ros1", "rosbags-convert --src"),
        ("other.db3", "no tables `topics` and `messages`"),
        ("old.bag", "rosbags-convert --src"),
        ("cut.db3.zstd", "cannot be decompressed"),
        ("bomb.mcap.zstd", "far larger"),
    ] {
        let says = BagReader::open(&at(name)).unwrap_err().to_string();
        assert!(says.contains(sentence) && says.contains(name), "{says}");
    }
}
