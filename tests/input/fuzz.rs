//! Whatever bytes come in, a sentence comes out, and never a panic: bags, messages, maps and parameters. Packets are
//! the business of `tests/ros/packets.rs`.
//!
//! `tests/corpus` has what the mutants start from, beside what is made here. Bytes that failed are written to a file,
//! which the failure names: put them there.

use crate::{
    fixtures::{self, Layout, bag, scene},
    mutants::{Mutants, cases},
    sqlite::write_sqlite,
};
use ellipsoid_slam::{
    config::{Parameters, parameters_from_yaml, parameters_to_yaml},
    io::{BagInput, BagReader, load_saved_map, map_json, read_map},
    msg::{
        cdr::{self, decode, decode_header, decode_request},
        convert::{self, found_in_space, yolo_found_in_space},
        ellipsoid_slam::{LoadMap, QueryObjects, QueryObjectsRequest, SaveMap},
        lifecycle_msgs::ChangeState,
        nav_msgs::Odometry,
        sensor_msgs::{CameraInfo, CompressedImage, Image},
        std_srvs::{SetBool, Trigger},
        tf2_msgs::TFMessage,
        vision_msgs::{Detection2DArray, Detection3DArray},
        yolo_msgs::DetectionArray,
    },
    pipeline::CameraRole,
};
use mcap::Compression::{Lz4, Zstd};
use std::{
    fs,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

/// Feeds mutants of `seeds` to `target`; keeps the bytes that it fails on.
fn fuzz(name: &str, seeds: &[Vec<u8>], usual: u64, target: impl Fn(&[u8], &mut Mutants<'_>)) {
    seeds.iter().for_each(|seed| target(seed, &mut Mutants::of(seeds)));
    let mut mutants = Mutants::of(seeds);
    for case in 0..cases(usual) {
        let bytes = mutants.next();
        if catch_unwind(AssertUnwindSafe(|| target(&bytes, &mut mutants))).is_err() {
            let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}_{case}"));
            fs::write(&kept, bytes).unwrap();
            panic!("case {case} of {name} failed; its bytes are in {}", kept.display());
        }
    }
}

/// All files of a folder of the corpus.
fn corpus(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(name);
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// One line, and not a book.
fn is_sentence(said: &str) {
    assert!(!said.is_empty() && said.len() < 2000, "{} bytes: {said:.300}", said.len());
}

#[test]
fn bytes_of_bags() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let layouts = [
        (None, false, false),
        (None, true, true),
        (Some(Zstd), true, true),
        (Some(Lz4), true, false),
    ];
    let mut seeds: Vec<Vec<u8>> = layouts
        .map(|(compression, chunks, summary)| {
            bag(&scene()[..16], Layout { compression, chunks, summary })
        })
        .into();
    fs::write(&path, &seeds[0]).unwrap();
    let messages: Vec<_> = BagReader::open(&path).unwrap().messages().collect();
    let database = folder.path().join("a.db3");
    write_sqlite(&database, &messages, <[u8]>::to_vec);
    seeds.push(fs::read(&database).unwrap());
    seeds.push(zstd::encode_all(seeds[0].as_slice(), 3).unwrap());
    fuzz("bag", &seeds, 60, |bytes, _| {
        fs::write(&path, bytes).unwrap();
        match BagReader::open(&path) {
            Ok(bag) => {
                let mut messages = bag.messages();
                assert!(messages.by_ref().count() < 10_000);
                messages
                    .warnings()
                    .iter()
                    .chain(bag.warnings())
                    .for_each(|w| is_sentence(&w.to_string()));
            }
            Err(why) => is_sentence(&why.to_string()),
        }
        match BagInput::open(&path, &[]) {
            Ok(input) => assert!(input.inputs().count() < 10_000),
            Err(why) => is_sentence(&why.to_string()),
        }
    });
}

#[test]
fn bytes_of_messages() {
    let compressed = CompressedImage {
        header: fixtures::header(0, "camera"),
        format: "16UC1; compressedDepth".into(),
        data: fixtures::depth(0).data,
    };
    let question =
        QueryObjectsRequest { labels: vec!["chair".into()], ..QueryObjectsRequest::default() };
    let seeds = [
        cdr::encode(&fixtures::odometry(0)),
        cdr::encode(&fixtures::transforms(0)),
        cdr::encode(&fixtures::depth(0)),
        cdr::encode(&compressed),
        cdr::encode(&fixtures::camera_info(0)),
        cdr::encode(&fixtures::detections(0)),
        cdr::encode_response::<QueryObjects>(&Default::default()),
    ]
    .map(Result::unwrap);
    let question = [
        &[0, 1, 0, 0][..],
        &cdr_encoding::to_vec::<_, byteorder::LittleEndian>(&question).unwrap(),
    ]
    .concat();
    let seeds = [&seeds[..], &[question]].concat();
    fuzz("message", &seeds, 20_000, |bytes, mutants| {
        let size = [None, Some((3, 2))][mutants.any(2)];
        let sizes: Vec<(u32, u32)> = size.into_iter().collect();
        let errors = [
            decode_header(bytes).map(drop).map_err(Into::into),
            decode::<Odometry>(bytes)
                .map_err(Into::into)
                .and_then(|m| convert::odometry(&m).map(drop)),
            decode::<TFMessage>(bytes).map(|m| drop(convert::transforms(&m))).map_err(Into::into),
            decode::<Image>(bytes).map_err(Into::into).and_then(|m| {
                let _ = convert::color_image(&m);
                convert::depth_image(&m, &sizes).map(drop)
            }),
            decode::<CompressedImage>(bytes).map_err(Into::into).and_then(|m| {
                let _ = convert::compressed_color_image(&m);
                convert::compressed_depth_image(&m, &sizes).map(drop)
            }),
            decode::<CameraInfo>(bytes).map_err(Into::into).and_then(|m| {
                convert::camera(&m, CameraRole::Color, mutants.any(2) == 0).map(drop)
            }),
            decode::<Detection2DArray>(bytes)
                .map(|m| drop(convert::detections(&m, size)))
                .map_err(Into::into),
            decode::<DetectionArray>(bytes).map(|m| of_yolo(&m, size)).map_err(Into::into),
            decode::<Detection3DArray>(bytes).map(|m| drop(found_in_space(&m))).map_err(Into::into),
            decode_request::<QueryObjects>(bytes).map(drop).map_err(Into::into),
            decode_request::<SaveMap>(bytes).map(drop).map_err(Into::into),
            decode_request::<LoadMap>(bytes).map(drop).map_err(Into::into),
            decode_request::<ChangeState>(bytes).map(drop).map_err(Into::into),
            decode_request::<SetBool>(bytes).map(drop).map_err(Into::into),
            decode_request::<Trigger>(bytes).map(drop).map_err(Into::into),
        ];
        let refused = errors.into_iter().filter_map(Result::err);
        refused.for_each(|why: convert::ConvertError| is_sentence(&why.to_string()));
    });
}

#[test]
fn bytes_of_maps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    fuzz("map", &corpus("maps"), 5000, |bytes, _| {
        fs::write(&path, bytes).unwrap();
        match load_saved_map(&path) {
            Ok(map) => {
                // What is loaded can be saved and loaded again.
                let text = map_json(&map).unwrap();
                assert_eq!(map_json(&read_map(&text).unwrap()).unwrap(), text);
            }
            Err(why) => is_sentence(&why.to_string()),
        }
    });
}

#[test]
fn bytes_of_parameters() {
    let mut seeds = corpus("parameters");
    seeds.push(parameters_to_yaml(&Parameters::default()).unwrap().into_bytes());
    fuzz("parameters", &seeds, 300, |bytes, _| {
        match parameters_from_yaml(&String::from_utf8_lossy(bytes)) {
            Ok(parameters) => {
                let text = parameters_to_yaml(&parameters).unwrap();
                assert_eq!(
                    parameters_to_yaml(&parameters_from_yaml(&text).unwrap()).unwrap(),
                    text
                );
            }
            Err(why) => is_sentence(&why.to_string()),
        }
    });
}

/// Boxes with masks in the image, and boxes in space.
fn of_yolo(message: &DetectionArray, size: Option<(u32, u32)>) {
    drop(convert::yolo_detections(message, size));
    drop(yolo_found_in_space(message));
}
