//! Calibrations of recordings in the form of the TUM RGB-D benchmark.

use super::{TumError, tum_folder::read_text};
use crate::geometry::{Camera, CameraError, Distortion};
use serde::Deserialize;
use std::{
    convert::Infallible,
    path::{Path, PathBuf},
    str::FromStr,
};

/// Which camera a recording is of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TumCamera {
    /// The benchmark's camera of the sequences `freiburg1`.
    Fr1,
    /// The one of `freiburg2`.
    Fr2,
    /// The one of `freiburg3`, whose images are rectified.
    Fr3,
    /// As a file says.
    File(PathBuf),
}

/// What a metre is in the benchmark's depth images.
const UNITS_PER_METRE: f64 = 5000.0;

impl TumCamera {
    /// `camera.yaml` of a folder, or the camera that its name says, as `rgbd_dataset_freiburg1_desk` does.
    pub(super) fn of_folder(folder: &Path) -> Option<Self> {
        let file = folder.join("camera.yaml");
        if file.exists() {
            return Some(Self::File(file));
        }
        let name = folder.file_name()?.to_string_lossy().into_owned();
        [("freiburg1", Self::Fr1), ("freiburg2", Self::Fr2), ("freiburg3", Self::Fr3)]
            .into_iter()
            .find_map(|(word, camera)| name.contains(word).then_some(camera))
    }
}

impl FromStr for TumCamera {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "fr1" => Self::Fr1,
            "fr2" => Self::Fr2,
            "fr3" => Self::Fr3,
            file => Self::File(file.into()),
        })
    }
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

/// A calibration, and what a depth of one metre is in the images.
pub(super) fn read_camera(camera: &TumCamera) -> Result<(Camera, f64), TumError> {
    // Of the colour cameras, to which depth is registered, as the benchmark publishes them.
    let (focal, centre, distortion) = match camera {
        TumCamera::Fr1 => {
            ((517.3, 516.5), (318.6, 255.3), [0.2624, -0.9531, -0.0054, 0.0026, 1.1633])
        }
        TumCamera::Fr2 => {
            ((520.9, 521.0), (325.1, 249.7), [0.2312, -0.7849, -0.0033, -0.0001, 0.9172])
        }
        TumCamera::Fr3 => ((535.4, 539.2), (320.1, 247.6), [0.0; 5]),
        TumCamera::File(path) => return read_file(path),
    };
    let camera = Camera::new((640, 480), focal, centre, Distortion::PlumbBob(distortion));
    let wrong =
        |e: CameraError| TumError::Camera { path: "the benchmark".into(), why: e.to_string() };
    Ok((camera.map_err(wrong)?, UNITS_PER_METRE))
}

fn read_file(path: &Path) -> Result<(Camera, f64), TumError> {
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
