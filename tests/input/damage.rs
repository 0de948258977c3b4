//! Truncated and damaged files: whole messages stay, and a warning says what is missing.

use crate::fixtures::{Layout, PLAIN, bag, scene};
use ellipsoid_slam::io::{BagReader, BagWarning, Damage};
use mcap::Compression::{Lz4, Zstd};
use std::{fs, path::Path};

/// Number of messages that are read, in order, and all warnings.
fn read(path: &Path) -> (usize, Vec<BagWarning>) {
    let bag = BagReader::open(path).unwrap();
    let mut warnings: Vec<BagWarning> = bag.warnings().cloned().collect();
    let mut messages = bag.messages();
    let known: Vec<_> = scene().into_iter().map(|line| line.data).collect();
    let mut count = 0;
    for message in messages.by_ref() {
        assert!(known.contains(&message.data), "a message that was never written");
        count += 1;
    }
    warnings.extend_from_slice(messages.warnings());
    (count, warnings)
}

#[test]
fn cut_anywhere_keeps_all_whole_messages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    for (compression, chunks) in
        [(None, false), (None, true), (Some(Zstd), true), (Some(Lz4), true)]
    {
        let whole = bag(&scene(), Layout { compression, chunks, summary: true });
        let mut last = 0;
        for cut in (8..whole.len()).step_by(7) {
            fs::write(&path, &whole[..cut]).unwrap();
            let (count, warnings) = read(&path);
            assert!(count >= last, "{count} messages of {cut} bytes, but {last} of fewer");
            if compression.is_none() {
                assert_eq!(count, whole_messages(&whole[..cut]), "cut at {cut}");
            }
            let [warning] = warnings.as_slice() else { panic!("cut at {cut}: {warnings:?}") };
            assert!(warning.to_string().contains("truncated"), "{warning}");
            last = count;
        }
        assert_eq!(last, 41);
        fs::write(&path, &whole).unwrap();
        assert_eq!(read(&path), (41, vec![]));
    }
}

/// Messages that lie in the bytes as a whole, counted by their data: uncompressed bags only.
fn whole_messages(bytes: &[u8]) -> usize {
    let mut from = 0;
    let mut count = 0;
    for line in scene() {
        match bytes[from..].windows(line.data.len()).position(|window| window == line.data) {
            Some(at) => (from, count) = (from + at + line.data.len(), count + 1),
            None => break,
        }
    }
    count
}

#[test]
fn the_warning_says_how_much_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let whole = bag(&scene(), Layout { chunks: false, ..PLAIN });
    let data = scene().pop().unwrap().data;
    let end = whole.windows(data.len()).rposition(|window| window == data).unwrap() + data.len();
    for (cut, expected) in
        [(end - 10, Damage::CutRecord { missing_bytes: 10 }), (end, Damage::NoFooter)]
    {
        fs::write(&path, &whole[..cut]).unwrap();
        let (_, warnings) = read(&path);
        assert_eq!(warnings, [BagWarning { path: path.clone(), damage: expected }]);
    }
}

/// The last of two chunks, because the first one also says which channel is which.
#[test]
fn a_damaged_chunk_costs_only_itself() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    for summary in [true, false] {
        let mut bytes = bag(&scene(), Layout { compression: Some(Zstd), chunks: true, summary });
        let at = bytes.windows(4).rposition(|w| w == [0x28, 0xb5, 0x2f, 0xfd]).unwrap();
        bytes[at..at + 40].fill(0x55);
        fs::write(&path, &bytes).unwrap();
        let (count, warnings) = read(&path);
        assert!((20..41).contains(&count), "{count}");
        let [BagWarning { damage: Damage::Corrupt { .. }, .. }] = warnings.as_slice() else {
            panic!("{warnings:?}")
        };
    }
}

#[test]
fn a_flipped_bit_of_the_index_loses_nothing_and_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let whole = bag(&scene(), Layout { compression: Some(Zstd), chunks: true, summary: true });
    let footer = whole.len() - 8 - 20;
    let summary = u64::from_le_bytes(whole[footer..footer + 8].try_into().unwrap()) as usize;
    assert!((1..footer).contains(&summary));
    for at in summary..footer - 9 {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        fs::write(&path, &bytes).unwrap();
        let (count, warnings) = read(&path);
        assert_eq!(count, 41, "bit {} of byte {at}", at % 8);
        assert_eq!(warnings, [BagWarning { path: path.clone(), damage: Damage::Index }]);
    }
}

#[test]
fn unknown_compression_is_named_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut bytes = bag(&scene(), Layout { compression: Some(Zstd), chunks: true, summary: false });
    let name = [&4_u32.to_le_bytes()[..], b"zstd"].concat();
    let places: Vec<usize> =
        (0..bytes.len() - 8).filter(|at| bytes[*at..*at + 8] == name).collect();
    assert!(places.len() > 1, "several chunks");
    places.iter().for_each(|at| bytes[*at + 4..*at + 8].copy_from_slice(b"br99"));
    fs::write(&path, &bytes).unwrap();
    let damage = Damage::Compression { name: "br99".into() };
    assert_eq!(read(&path), (0, vec![BagWarning { path: path.clone(), damage }]));
}

#[test]
fn any_damaged_byte_is_survived() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    for (compression, chunks) in [(None, false), (Some(Zstd), true), (Some(Lz4), true)] {
        let whole = bag(&scene(), Layout { compression, chunks, summary: true });
        for at in (8..whole.len()).step_by(11) {
            for value in [0x00, 0x7f, 0xff] {
                let mut bytes = whole.clone();
                bytes[at] = value;
                fs::write(&path, &bytes).unwrap();
                let bag = BagReader::open(&path).unwrap();
                assert!(bag.messages().count() <= 41);
            }
        }
    }
}
