//! What Python hands over: cameras, poses, depth as bytes, and boxes.

use crate::errors;
use ellipsoid_slam::{
    geometry::{Camera, Distortion, Pose, Rect, pose_from_xyzw},
    nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion},
    perception::{DepthError, DepthImage, Detection, DetectionError},
};
use pyo3::{FromPyObject, PyErr, PyResult, pybacked::PyBackedBytes};

/// `ellipsoid_slam.Camera`.
#[derive(FromPyObject)]
pub(crate) struct CameraArgument {
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    distortion: Vec<f64>,
}

impl TryFrom<CameraArgument> for Camera {
    type Error = PyErr;

    fn try_from(given: CameraArgument) -> PyResult<Self> {
        let distortion = match *given.distortion.as_slice() {
            [] => Distortion::None,
            [k1, k2, p1, p2] => Distortion::PlumbBob([k1, k2, p1, p2, 0.0]),
            [k1, k2, p1, p2, k3] => Distortion::PlumbBob([k1, k2, p1, p2, k3]),
            [k1, k2, p1, p2, k3, k4, k5, k6] => {
                Distortion::Rational([k1, k2, p1, p2, k3, k4, k5, k6])
            }
            _ => {
                let count = given.distortion.len();
                let why = "4 (k1, k2, p1, p2), 5 (k3) and 8 (k4, k5, k6) are known";
                return Err(errors::frame(format!("{count} coefficients of distortion: {why}")));
            }
        };
        let (size, focal) = ((given.width, given.height), (given.fx, given.fy));
        Self::new(size, focal, (given.cx, given.cy), distortion).map_err(errors::frame)
    }
}

/// `ellipsoid_slam.Pose`.
#[derive(FromPyObject)]
pub(crate) struct PoseArgument {
    position: [f64; 3],
    orientation: [f64; 4],
}

impl TryFrom<PoseArgument> for Pose {
    type Error = PyErr;

    fn try_from(given: PoseArgument) -> PyResult<Self> {
        let PoseArgument { position, orientation } = given;
        let why = "a pose needs a finite position and a quaternion x, y, z, w of unit length";
        let pose = pose_from_xyzw(position, orientation).ok_or_else(|| errors::frame(why))?;
        // To the last digit, as in messages: the same data give the same map.
        let rotation = UnitQuaternion::new_normalize(pose.rotation.into_inner());
        Ok(Self::from_parts(pose.translation, rotation))
    }
}

/// A pose from a matrix of 4 x 4, row by row.
pub(crate) fn pose_of_matrix(rows: &[[f64; 4]; 4]) -> PyResult<Pose> {
    /// How far rotations are off that were stored with few digits.
    const TOLERANCE: f64 = 1e-3;
    let [[a, b, c, x], [d, e, f, y], [g, h, i, z], last] = *rows;
    let turn = Matrix3::new(a, b, c, d, e, f, g, h, i);
    let is_finite = rows.iter().flatten().all(|number| number.is_finite());
    let off = (turn * turn.transpose() - Matrix3::identity()).amax();
    if !is_finite || off > TOLERANCE || turn.determinant() < 0.0 || last != [0.0, 0.0, 0.0, 1.0] {
        return Err(errors::frame(
            "the matrix is no pose: it needs a rotation, a position and a last row of 0, 0, 0, 1",
        ));
    }
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
    let rotation = UnitQuaternion::new_normalize(rotation.into_inner());
    Ok(Pose::from_parts(Translation3::new(x, y, z), rotation))
}

/// Position and quaternion xyzw.
pub(crate) type PoseParts = ([f64; 3], [f64; 4]);

/// A pose as Python gets it.
pub(crate) fn parts(pose: &Pose) -> PoseParts {
    let q = pose.rotation;
    (pose.translation.vector.into(), [q.i, q.j, q.k, q.w])
}

/// `ellipsoid_slam.Box`.
#[derive(FromPyObject)]
pub(crate) struct BoxArgument {
    corners: [f64; 4],
    hypotheses: Vec<(String, f64)>,
}

/// A detector's boxes.
pub(crate) fn detections(given: Vec<BoxArgument>) -> PyResult<Vec<Detection>> {
    let of = |(at, given): (usize, BoxArgument)| {
        let [x_min, y_min, x_max, y_max] = given.corners;
        let rect = Rect::new(x_min, y_min, x_max, y_max).ok_or(DetectionError::BadBox);
        let detection = rect.and_then(|rect| Detection::new(rect, given.hypotheses));
        detection.map_err(|why| errors::frame(format!("box {at}: {why}")))
    };
    given.into_iter().enumerate().map(of).collect()
}

/// A depth image as the bytes of its array, row by row, in this machine's order.
#[derive(FromPyObject)]
pub(crate) struct DepthArgument {
    width: u32,
    height: u32,
    data: PyBackedBytes,
    /// Whether it is `uint16` and not `float32`, metres.
    is_millimetres: bool,
}

impl DepthArgument {
    /// In metres; what is none stays none.
    pub(crate) fn metres(&self) -> Vec<f32> {
        if self.is_millimetres {
            let all = self.data.as_chunks().0.iter().map(|two| u16::from_ne_bytes(*two));
            all.map(|millimetres| f32::from(millimetres) / 1000.0).collect()
        } else {
            self.data.as_chunks().0.iter().map(|four| f32::from_ne_bytes(*four)).collect()
        }
    }

    pub(crate) fn image(&self) -> Result<DepthImage, DepthError> {
        DepthImage::new(self.width, self.height, self.metres())
    }

    /// Depth of another shape would be taken for an image that is turned.
    pub(crate) fn check_size(&self, camera: &Camera) -> PyResult<()> {
        let (own, other) = ((self.width, self.height), (camera.width(), camera.height()));
        if own == other {
            return Ok(());
        }
        let ((width, height), (columns, rows)) = (own, other);
        Err(errors::frame(format!("depth is {width}x{height}, but the camera {columns}x{rows}")))
    }
}
