//! Folders in the form of the TUM RGB-D benchmark (Sturm et al. 2012), as they are downloaded or with boxes.

use super::{
    TrajectoryError, TumCamera, read_trajectory, trajectory::parse_stamp, tum_camera::read_camera,
};
use crate::{
    geometry::{Camera, Pose, Rect},
    msg::coco,
    perception::Detection,
    time::Stamp,
};
use std::{
    fs, io,
    path::{Path, PathBuf},
};
use thiserror::Error;

/// Where the parts are that the folder does not have, or has under another name.
#[derive(Clone, Debug, Default)]
pub struct TumOptions {
    /// Calibration; otherwise `camera.yaml` of the folder, or the benchmark's that the folder's name says.
    pub camera: Option<TumCamera>,
    /// Poses that become odometry and TF; `groundtruth.txt` of the folder otherwise.
    pub odometry: Option<PathBuf>,
}

/// A folder of images with poses and boxes.
#[derive(Debug)]
pub struct TumFolder {
    /// Calibration of both images: depth is registered to colour.
    pub camera: Camera,
    /// What a depth of one metre is in the images.
    pub depth_units_per_metre: f64,
    /// Colour and depth images with their boxes, in the order of the depth stamps.
    pub frames: Vec<TumFrame>,
    /// `world_from_camera` as odometry says.
    pub odometry: Vec<(Stamp, Pose)>,
    /// `world_from_camera` in truth, if the folder has it.
    pub ground_truth: Option<Vec<(Stamp, Pose)>>,
    /// Sentences about what was passed over.
    pub warnings: Vec<String>,
}

/// One pair of images.
#[derive(Clone, Debug, PartialEq)]
pub struct TumFrame {
    /// Stamp of the colour image.
    pub color_stamp: Stamp,
    /// Path of the colour image.
    pub color: PathBuf,
    /// Stamp of the depth image.
    pub depth_stamp: Stamp,
    /// Path of the depth image.
    pub depth: PathBuf,
    /// Boxes in the colour image; nothing if no file belongs to it.
    pub detections: Option<Vec<Detection>>,
    /// For each box the object it shows in truth, or -1: never input.
    pub instances: Vec<i64>,
}

/// Why a folder cannot be imported.
#[derive(Debug, Error)]
pub enum TumError {
    /// A file cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// No calibration.
    #[error(
        "{} has no camera.yaml: say which camera of the benchmark it is with `--camera fr1`, `fr2` or `fr3`, or give a file",
        folder.display()
    )]
    NoCamera {
        /// The folder.
        folder: PathBuf,
    },
    /// The calibration is not what is expected.
    #[error(
        "{}: {why}; expected width, height, fx, fy, cx, cy, distortion_model, distortion and \
         depth_units_per_metre", path.display()
    )]
    Camera {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// A line that names images.
    #[error("{}, line {line}: expected `{form}`", path.display())]
    Images {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// What a line has.
        form: &'static str,
    },
    /// No images at all.
    #[error("{}: names no images", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The poses.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
}

impl TumFolder {
    /// Reads everything but the images.
    ///
    /// # Errors
    /// When a file is missing or is not what it should be. Single bad boxes become warnings.
    pub fn open(folder: &Path, options: &TumOptions) -> Result<Self, TumError> {
        let given = options.camera.clone().or_else(|| TumCamera::of_folder(folder));
        let given = given.ok_or_else(|| TumError::NoCamera { folder: folder.to_owned() })?;
        let (camera, depth_units_per_metre) = read_camera(&given)?;
        let mut frames = match folder.join("associate.txt") {
            associated if associated.exists() => read_associations(&associated, folder)?,
            _ => associate(folder)?,
        };
        let mut warnings = Vec::new();
        let boxes = folder.join("bbox");
        if boxes.exists() {
            add_boxes(&boxes, &mut frames, &mut warnings)?;
        }
        let truth_file = folder.join("groundtruth.txt");
        let ground_truth =
            if truth_file.exists() { Some(read_trajectory(&truth_file)?) } else { None };
        let odometry = match (&options.odometry, &ground_truth) {
            (Some(path), _) => read_trajectory(path)?,
            (None, Some(truth)) => truth.clone(),
            (None, None) => read_trajectory(&truth_file)?,
        };
        Ok(Self { camera, depth_units_per_metre, frames, odometry, ground_truth, warnings })
    }
}

pub(super) fn read_text(path: &Path) -> Result<String, TumError> {
    fs::read_to_string(path).map_err(|source| TumError::Io { path: path.to_owned(), source })
}

fn read_associations(path: &Path, folder: &Path) -> Result<Vec<TumFrame>, TumError> {
    let form = "colour_stamp colour_path depth_stamp depth_path";
    let mut frames = read_lines(path, form, |words| {
        let [color_stamp, color, depth_stamp, depth] = words else { return None };
        let (color, depth) = (folder.join(color), folder.join(depth));
        Some(frame((parse_stamp(color_stamp)?, color), (parse_stamp(depth_stamp)?, depth)))
    })?;
    frames.sort_by_key(|f| f.depth_stamp);
    Ok(frames)
}

/// What `parse` makes of the words of each line; lines that are empty or begin with `#` are passed over.
fn read_lines<T>(
    path: &Path,
    form: &'static str,
    parse: impl Fn(&[&str]) -> Option<T>,
) -> Result<Vec<T>, TumError> {
    let mut found = Vec::new();
    for (i, line) in read_text(path)?.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.first().is_none_or(|word| word.starts_with('#')) {
            continue;
        }
        let bad = || TumError::Images { path: path.to_owned(), line: i + 1, form };
        found.push(parse(&words).ok_or_else(bad)?);
    }
    if found.is_empty() {
        return Err(TumError::Empty { path: path.to_owned() });
    }
    Ok(found)
}

fn frame(
    (color_stamp, color): (Stamp, PathBuf),
    (depth_stamp, depth): (Stamp, PathBuf),
) -> TumFrame {
    let (detections, instances) = (None, Vec::new());
    TumFrame { color_stamp, color, depth_stamp, depth, detections, instances }
}

/// Pairs the images of `rgb.txt` and `depth.txt` as the benchmark's own script does: the nearest stamps first, each image
/// once.
fn associate(folder: &Path) -> Result<Vec<TumFrame>, TumError> {
    let listed = |name: &str| {
        read_lines(&folder.join(name), "stamp path", |words| {
            let [stamp, path] = words else { return None };
            Some((parse_stamp(stamp)?, folder.join(path)))
        })
    };
    let (mut colors, mut depths) = (listed("rgb.txt")?, listed("depth.txt")?);
    colors.sort();
    depths.sort();
    let mut near: Vec<(i64, usize, usize)> = Vec::new();
    for (d, (stamp, _)) in depths.iter().enumerate() {
        let first = colors.partition_point(|(color, _)| *color < stamp.shifted(-MAX_DISTANCE_S));
        let within = colors.iter().enumerate().skip(first);
        let distance = |color: Stamp| (color.as_nanos() - stamp.as_nanos()).abs();
        near.extend(
            within
                .take_while(|(_, (color, _))| *color <= stamp.shifted(MAX_DISTANCE_S))
                .map(|(c, (color, _))| (distance(*color), d, c)),
        );
    }
    near.sort_unstable();
    let mut color_of: Vec<Option<usize>> = vec![None; depths.len()];
    let mut taken = vec![false; colors.len()];
    for (_, d, c) in near {
        if color_of[d].is_none() && !taken[c] {
            (color_of[d], taken[c]) = (Some(c), true);
        }
    }
    let pairs = depths.into_iter().zip(color_of);
    let frames: Vec<TumFrame> =
        pairs.filter_map(|(depth, color)| Some(frame(colors[color?].clone(), depth))).collect();
    if frames.is_empty() {
        return Err(TumError::Empty { path: folder.join("depth.txt") });
    }
    Ok(frames)
}

/// Gives each colour image the box file whose name is the nearest stamp.
fn add_boxes(
    folder: &Path,
    frames: &mut [TumFrame],
    warnings: &mut Vec<String>,
) -> Result<(), TumError> {
    let unreadable = |source| TumError::Io { path: folder.to_owned(), source };
    let mut files: Vec<(Stamp, PathBuf)> = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        match parse_stamp(&stem) {
            Some(stamp) => files.push((stamp, path)),
            None => warnings.push(format!("{}: the name is not a stamp", path.display())),
        }
    }
    files.sort();
    for frame in frames {
        let distance = |stamp: Stamp| stamp.seconds_since(frame.color_stamp).abs();
        let nearest = files.iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
        if let Some((stamp, path)) = nearest
            && distance(*stamp) <= MAX_DISTANCE_S
        {
            let (detections, instances) = read_boxes(path, warnings)?;
            frame.detections = Some(detections);
            frame.instances = instances;
        }
    }
    Ok(())
}

/// Lines `id x1 y1 x2 y2 label probability instance`.
fn read_boxes(
    path: &Path,
    warnings: &mut Vec<String>,
) -> Result<(Vec<Detection>, Vec<i64>), TumError> {
    let (mut detections, mut instances) = (Vec::new(), Vec::new());
    for (i, line) in read_text(path)?.lines().enumerate() {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        match parse_box(line) {
            Some((detection, instance)) => {
                detections.push(detection);
                instances.push(instance);
            }
            None => warnings.push(format!(
                "{}, line {}: expected `id x1 y1 x2 y2 label probability instance`, passed over",
                path.display(),
                i + 1
            )),
        }
    }
    Ok((detections, instances))
}

fn parse_box(line: &str) -> Option<(Detection, i64)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |i: usize| words.get(i)?.parse::<f64>().ok();
    let rect = Rect::new(number(1)?, number(2)?, number(3)?, number(4)?)?;
    let label = coco::label(words.get(5)?).replace('_', " ");
    let detection = Detection::new(rect, vec![(label, number(6)?)]).ok()?;
    let instance = words.get(7).and_then(|w| w.parse().ok()).unwrap_or(-1);
    Some((detection, instance))
}

/// Images belong together, and boxes to an image, whose stamps differ by at most this (s).
const MAX_DISTANCE_S: f64 = 0.02;
