//! Camera calibration.

use super::{ConvertError, frame, header, shown};
use crate::{
    geometry::{Camera, CameraError, Distortion},
    msg::sensor_msgs::CameraInfo,
    pipeline::{CameraMessage, CameraRole},
};

/// The calibration of the camera in `role`; of its rectified images if `rectified`.
///
/// Raw images obey `k` and `d`, rectified ones `p`; `p` is ignored where it was not filled in.
/// Binning and the region of interest are applied as image_geometry does.
///
/// # Errors
/// When the camera is not calibrated or its distortion model is not known here.
pub fn camera(
    info: &CameraInfo,
    role: CameraRole,
    rectified: bool,
) -> Result<CameraMessage, ConvertError> {
    let [fx, _, cx, _, fy, cy, ..] = info.k;
    let [p_fx, _, p_cx, _, _, p_fy, p_cy, ..] = info.p;
    let (focal, principal) = if rectified && p_fx > 0.0 && p_fy > 0.0 {
        ((p_fx, p_fy), (p_cx, p_cy))
    } else {
        ((fx, fy), (cx, cy))
    };
    let distortion = if rectified { Distortion::None } else { distortion_of(info)? };
    Ok(CameraMessage {
        role,
        stamp: info.header.stamp.into(),
        frame_id: frame(&info.header.frame_id)?,
        camera: read_out(info, focal, principal, distortion)?,
    })
}

/// Calibration as the wire knows it, of a raw image if the camera distorts and of a rectified one otherwise.
pub fn camera_info(message: &CameraMessage) -> CameraInfo {
    let camera = &message.camera;
    let ((fx, fy), (cx, cy)) = (camera.focal(), camera.principal());
    let (model, d) = match camera.distortion() {
        Distortion::None => ("plumb_bob", vec![0.0; 5]),
        Distortion::PlumbBob(d) => ("plumb_bob", d.to_vec()),
        Distortion::Rational(d) => ("rational_polynomial", d.to_vec()),
    };
    CameraInfo {
        header: header(message.stamp, &message.frame_id),
        height: camera.height(),
        width: camera.width(),
        distortion_model: model.into(),
        d,
        k: [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p: [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
        ..CameraInfo::default()
    }
}

/// The camera of the pixels that were read out: cut to the region of interest, then binned.
fn read_out(
    info: &CameraInfo,
    (fx, fy): (f64, f64),
    (cx, cy): (f64, f64),
    distortion: Distortion,
) -> Result<Camera, CameraError> {
    let roi = info.roi;
    let whole = roi.width == 0 || roi.height == 0;
    let (width, height) = if whole { (info.width, info.height) } else { (roi.width, roi.height) };
    let (bin_x, bin_y) = (info.binning_x.max(1), info.binning_y.max(1));
    let (by_x, by_y) = (f64::from(bin_x), f64::from(bin_y));
    let principal = ((cx - f64::from(roi.x_offset)) / by_x, (cy - f64::from(roi.y_offset)) / by_y);
    Camera::new((width / bin_x, height / bin_y), (fx / by_x, fy / by_y), principal, distortion)
}

/// The distortion; a model without coefficients or with zeros only is none, except for fisheye lenses, which bend
/// rays without any.
fn distortion_of(info: &CameraInfo) -> Result<Distortion, ConvertError> {
    let used = info.d.iter().rposition(|k| *k != 0.0).map_or(0, |last| last + 1);
    // The two models list their coefficients in the same order; the shorter one ends after k3.
    let coefficients = |n: usize| (0..n).map(|i| info.d.get(i).copied().unwrap_or(0.0));
    let mut out = [0.0; 8];
    out.iter_mut().zip(coefficients(8)).for_each(|(to, k)| *to = k);
    match (info.distortion_model.as_str(), used) {
        (model, 0) if !matches!(model, "equidistant" | "fisheye") => Ok(Distortion::None),
        ("plumb_bob", 1..=5) => {
            let [k1, k2, p1, p2, k3, ..] = out;
            Ok(Distortion::PlumbBob([k1, k2, p1, p2, k3]))
        }
        ("plumb_bob" | "rational_polynomial", 1..=8) => Ok(Distortion::Rational(out)),
        (model, _) => {
            Err(ConvertError::UnknownDistortion { model: shown(model), coefficients: info.d.len() })
        }
    }
}
