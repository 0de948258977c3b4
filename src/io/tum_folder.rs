//! Folders in the form of the TUM RGB-D benchmark (Sturm et al. 2012), with boxes.

use super::{TrajectoryError, read_trajectory, trajectory::parse_stamp};
use crate::{
    geometry::{Camera, CameraError, Distortion, Pose, Rect},
    msg::coco,
    perception::Detection,
    time::Stamp,
};
use serde::Deserialize;
use std::{
    fs, io,
    path::{Path, PathBuf},
};
use thiserror::Error;

/// Where the parts are that the folder does not have, or has under another name.
#[derive(Clone, Debug, Default)]
pub struct TumOptions {
    /// Calibration; `camera.yaml` of the folder otherwise.
    pub camera: Option<PathBuf>,
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
    #[error("{}, line {line}: expected `colour_stamp colour_path depth_stamp depth_path`", path.display())]
    Associate {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
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

/// `camera.yaml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    #[serde(default)]
    distortion_model: String,
    #[serde(default)]
    distortion: Vec<f64>,
    depth_units_per_metre: f64,
}

impl TumFolder {
    /// Reads everything but the images.
    ///
    /// # Errors
    /// When a file is missing or is not what it should be. Single bad boxes become warnings.
    pub fn open(folder: &Path, options: &TumOptions) -> Result<Self, TumError> {
        let camera_file = options.camera.clone().unwrap_or_else(|| folder.join("camera.yaml"));
        let (camera, depth_units_per_metre) = read_camera(&camera_file)?;
        let mut frames = read_associations(folder)?;
        let mut warnings = Vec::new();
        add_boxes(&folder.join("bbox"), &mut frames, &mut warnings)?;
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

fn read_text(path: &Path) -> Result<String, TumError> {
    fs::read_to_string(path).map_err(|source| TumError::Io { path: path.to_owned(), source })
}

fn read_camera(path: &Path) -> Result<(Camera, f64), TumError> {
    let text = read_text(path)?;
    let bad = |why: String| TumError::Camera { path: path.to_owned(), why };
    let file: CameraFile = serde_saphyr::from_str(&text)
        .map_err(|e| bad(e.to_string().lines().next().unwrap_or_default().to_owned()))?;
    let d = &file.distortion;
    let at = |i: usize| d.get(i).copied().unwrap_or(0.0);
    let distortion = match file.distortion_model.as_str() {
        "" | "none" => Distortion::None,
        "plumb_bob" => Distortion::PlumbBob(std::array::from_fn(at)),
        "rational_polynomial" => Distortion::Rational(std::array::from_fn(at)),
        other => return Err(bad(format!("unknown distortion model \"{other}\""))),
    };
    let units = file.depth_units_per_metre;
    if !(units.is_finite() && units > 0.0) {
        return Err(bad(format!("depth_units_per_metre is {units}")));
    }
    let size = (file.width, file.height);
    Camera::new(size, (file.fx, file.fy), (file.cx, file.cy), distortion)
        .map(|camera| (camera, units))
        .map_err(|e: CameraError| bad(e.to_string()))
}

fn read_associations(folder: &Path) -> Result<Vec<TumFrame>, TumError> {
    let path = folder.join("associate.txt");
    let mut frames = Vec::new();
    for (i, line) in read_text(&path)?.lines().enumerate() {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        let frame = parse_association(folder, line);
        frames.push(frame.ok_or_else(|| TumError::Associate { path: path.clone(), line: i + 1 })?);
    }
    if frames.is_empty() {
        return Err(TumError::Empty { path });
    }
    frames.sort_by_key(|f| f.depth_stamp);
    Ok(frames)
}

fn parse_association(folder: &Path, line: &str) -> Option<TumFrame> {
    let mut words = line.split_whitespace();
    let color_stamp = parse_stamp(words.next()?)?;
    let color = folder.join(words.next()?);
    let depth_stamp = parse_stamp(words.next()?)?;
    let depth = folder.join(words.next()?);
    let (detections, instances) = (None, Vec::new());
    Some(TumFrame { color_stamp, color, depth_stamp, depth, detections, instances })
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
            && distance(*stamp) <= MAX_BOX_DISTANCE_S
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

/// Boxes belong to the image whose stamp is within this of theirs (s).
const MAX_BOX_DISTANCE_S: f64 = 0.02;
