//! The ellipsoid that one RGB-D frame shows. Liao et al. 2020, eq. (13).

use crate::{
    geometry::{Ellipsoid, FaceEvidence, Outline, Pose, rotation_log_derivative, skew},
    graph::{
        EllipsoidId, Factor, Kernel, Linearization, Noise, NoiseError, PoseId, Variable, VariableId,
    },
};
use nalgebra::{DVector, Matrix3, Quaternion, SMatrix, SVector, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_1_SQRT_2;

/// Ties an object to the pose it was measured from.
///
/// With `z` the measurement, `p = x^-1 l` the object in the same frame and `s` semi-axes, the residual is, before
/// whitening, `[log(R_z^T R_p), R_z^T (t_p - t_z), s_p - s_z]` (rad, m, m).
///
/// It differs from Liao et al. 2020, eq. (13) and (14), where Euler angles are subtracted:
/// - Rotation is compared by its rotation vector, so that nothing jumps where an angle wraps.
/// - A body stays the same when it is turned by quarter turns about its own z axis and its semi-axes are renamed, or
///   when it is turned over. Of these names for the object's axes, those count which make the residual smallest.
/// - A round footprint has no heading, see [`EllipsoidObservation::new`].
/// - Translation and semi-axes are compared along the axes of the measurement, not along the object's: what was
///   hidden was hidden in the direction the camera looked in, whatever heading the object has been given since.
///   Semi-axes are compared in metres, not by their logarithms, since the position of a hidden face is linear in
///   centre and semi-axis.
/// - Each face counts by itself, with a robust kernel of its own, and one that was not seen is only bounded
///   ([`EllipsoidObservation::of_faces`]); or all components together have one covariance and one kernel
///   ([`EllipsoidObservation::new`]).
/// - The covariance is the measurement's own. The factors `P_e` and `eps_z` of eq. (9) and (11) would count it a second
///   time; [`EllipsoidObservation::scaled`] is there for who wants them.
#[derive(Clone, Debug)]
pub struct EllipsoidObservation {
    variables: [VariableId; 2],
    measured: Ellipsoid,
    evidence: Evidence,
    kernel: Kernel,
}

/// What the measurement tells of the components of the residual.
#[derive(Clone, Debug)]
enum Evidence {
    /// All of them, with one covariance.
    Joint(Box<Noise<9>>),
    Faces(Box<FaceTerms>),
}

/// Nine scalars with a kernel each: three of the rotation, and the faces in the order -x, +x, -y, +y, -z, +z.
#[derive(Clone, Debug)]
struct FaceTerms {
    /// Inverse standard deviations of the rotation about the measured axes (1/rad).
    rotation: [f64; 3],
    faces: [FaceEvidence; 6],
    /// Root of the share of its information that the measurement has, outside the kernels.
    root_share: f64,
}

impl EllipsoidObservation {
    /// `measured` is in the frame of the pose; `covariance` is that of `[rotation, translation, log semi-axes]`
    /// (rad, m, 1), a right perturbation in the measured ellipsoid's own frame.
    ///
    /// Where the footprint is an ellipse, the standard deviation of the heading is divided by `|a^2-b^2| / (a^2+b^2)`
    /// of the measured semi-axes: a circle has no heading. A square has one, modulo a quarter turn.
    ///
    /// # Errors
    /// When the covariance is not finite, not symmetric or not positive definite.
    pub fn new(
        pose: PoseId,
        ellipsoid: EllipsoidId,
        measured: Ellipsoid,
        covariance: &SMatrix<f64, 9, 9>,
        outline: Outline,
    ) -> Result<Self, NoiseError> {
        let mut covariance = in_metres(covariance, &measured.semi_axes);
        let variance = &mut covariance[(HEADING, HEADING)];
        *variance = faded(*variance, heading_clarity(outline, &measured.semi_axes));
        Ok(Self {
            variables: [pose.into(), ellipsoid.into()],
            measured,
            evidence: Evidence::Joint(Box::new(Noise::from_covariance(&covariance)?)),
            kernel: Kernel::Quadratic,
        })
    }

    /// What was seen, face by face: `faces` are the measured box's in the order -x, +x, -y, +y, -z, +z, from its centre
    /// along its own axes, `rotation_sigmas` are those about its axes (rad). What `measured` says of faces that were not
    /// seen does not count. The heading of ellipses fades as for [`EllipsoidObservation::new`].
    ///
    /// # Errors
    /// When a standard deviation is not a positive finite number, or a position is not finite.
    pub fn of_faces(
        pose: PoseId,
        ellipsoid: EllipsoidId,
        measured: Ellipsoid,
        (rotation_sigmas, faces): ([f64; 3], [FaceEvidence; 6]),
        outline: Outline,
    ) -> Result<Self, NoiseError> {
        let mut sigmas = rotation_sigmas;
        let clarity = heading_clarity(outline, &measured.semi_axes);
        sigmas[HEADING] = faded(sigmas[HEADING].powi(2), clarity).sqrt();
        let mut rotation = [0.0; 3];
        for (index, sigma) in sigmas.into_iter().enumerate() {
            rotation[index] = NoiseError::inverse_of_sigma(index, sigma)?;
        }
        if let Some(index) = faces.iter().position(|face| !face.is_valid()) {
            return Err(NoiseError::Sigma { index: 3 + index, value: f64::NAN });
        }
        let terms = FaceTerms { rotation, faces, root_share: 1.0 };
        Ok(Self {
            variables: [pose.into(), ellipsoid.into()],
            measured,
            evidence: Evidence::Faces(Box::new(terms)),
            kernel: Kernel::Quadratic,
        })
    }

    /// The same with a robust kernel: one for each face, or one for all components together.
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }

    /// The same with `scale` times the information. With one covariance: the paper's `P_e eps_z`, but inside the robust
    /// kernel. Liao et al. 2020, eq. (11) and (13). Face by face: outside the kernels, which judge what the measurement
    /// claims, however much of it counts.
    ///
    /// # Errors
    /// When the scale is not a positive finite number.
    pub fn scaled(self, scale: f64) -> Result<Self, NoiseError> {
        let evidence = match self.evidence {
            Evidence::Joint(noise) => Evidence::Joint(Box::new(noise.scaled(scale)?)),
            Evidence::Faces(terms) => {
                let root_share = terms.root_share * NoiseError::root_of_scale(scale)?;
                Evidence::Faces(Box::new(FaceTerms { root_share, ..*terms }))
            }
        };
        Ok(Self { evidence, ..self })
    }

    /// The same measurement of another object: what was taken for two turned out to be one.
    pub fn of(self, ellipsoid: EllipsoidId) -> Self {
        Self { variables: [self.variables[0], ellipsoid.into()], ..self }
    }

    /// The measured ellipsoid in the frame of its pose.
    pub fn measured(&self) -> &Ellipsoid {
        &self.measured
    }

    /// The measurement and the object side by side.
    fn compare(&self, at: &[Variable]) -> Comparison {
        let object = at[1].known_ellipsoid();
        let pose_from_object = at[0].pose().inv_mul(&object.pose);
        let measured_from_object = self.measured.pose.inv_mul(&pose_from_object);
        let whitened = |names: Names| {
            let rotation = (measured_from_object.rotation * names.turn).scaled_axis();
            let shift = measured_from_object.translation.vector;
            let semi_axes = names.semi_axes(&object.semi_axes);
            let residual = self.whitened(&rotation, &shift, &semi_axes);
            (names, rotation, residual, residual.norm_squared())
        };
        let all = Names::upright(&measured_from_object.rotation);
        let first = whitened(all[0]);
        let (names, rotation, residual, _) = all[1..].iter().fold(first, |best, names| {
            let other = whitened(*names);
            if other.3 < best.3 { other } else { best }
        });
        Comparison {
            pose_from_object,
            shift: measured_from_object.translation.vector,
            semi_axes: object.semi_axes,
            names,
            rotation,
            residual,
        }
    }

    /// The residual of a body that is turned and moved against the measurement and has these semi-axes along its axes.
    fn whitened(
        &self,
        rotation: &Vector3<f64>,
        shift: &Vector3<f64>,
        semi_axes: &Vector3<f64>,
    ) -> SVector<f64, 9> {
        let mut residual = SVector::<f64, 9>::zeros();
        residual.fixed_rows_mut::<3>(0).copy_from(rotation);
        match &self.evidence {
            Evidence::Joint(noise) => {
                residual.fixed_rows_mut::<3>(3).copy_from(shift);
                residual.fixed_rows_mut::<3>(6).copy_from(&(semi_axes - self.measured.semi_axes));
                noise.whiten(&residual)
            }
            Evidence::Faces(terms) => {
                for (row, (value, _)) in terms.compared(rotation, shift, semi_axes).enumerate() {
                    residual[row] = terms.root_share * self.kernel.rooted(value).0;
                }
                residual
            }
        }
    }

    /// The derivative of the whitened residual; `raw` is that of rotation, shift and semi-axes along the measured axes.
    fn whitened_derivative(
        &self,
        raw: &SMatrix<f64, 9, 15>,
        compared: &Comparison,
    ) -> SMatrix<f64, 9, 15> {
        let terms = match &self.evidence {
            Evidence::Joint(noise) => return noise.whiten(raw),
            Evidence::Faces(terms) => terms,
        };
        let semi_axes = compared.names.semi_axes(&compared.semi_axes);
        let values = terms.compared(&compared.rotation, &compared.shift, &semi_axes);
        let mut out = SMatrix::<f64, 9, 15>::zeros();
        for (row, (value, slope)) in values.enumerate() {
            let slope = terms.root_share * slope * self.kernel.rooted(value).1;
            if row < 3 {
                out.set_row(row, &(raw.row(row) * slope));
            } else {
                let (axis, sign) = axis_of(row - 3);
                let face = raw.row(6 + axis) + raw.row(3 + axis) * sign;
                out.set_row(row, &(face * slope));
            }
        }
        out
    }
}

impl FaceTerms {
    /// Each component in standard deviations, and its derivative by what it compares (1/rad, 1/m).
    fn compared(
        &self,
        rotation: &Vector3<f64>,
        shift: &Vector3<f64>,
        semi_axes: &Vector3<f64>,
    ) -> impl Iterator<Item = (f64, f64)> {
        let turned = self.rotation.iter().zip(rotation.iter());
        let turned = turned.map(|(information, angle)| (information * angle, *information));
        let (shift, semi_axes) = (*shift, *semi_axes);
        let faces = self.faces.iter().enumerate().map(move |(face, evidence)| {
            let (axis, sign) = axis_of(face);
            evidence.whitened(semi_axes[axis] + sign * shift[axis])
        });
        turned.chain(faces)
    }
}

/// The axis of a face, and which way it looks along it.
fn axis_of(face: usize) -> (usize, f64) {
    (face / 2, if face.is_multiple_of(2) { -1.0 } else { 1.0 })
}

impl Factor for EllipsoidObservation {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        DVector::from_column_slice(self.compare(at).residual.as_slice())
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let compared = self.compare(at);
        let measured_from_pose = self.measured.pose.rotation.inverse().to_rotation_matrix();
        let measured_from_pose = measured_from_pose.into_inner();
        let pose_from_object = compared.pose_from_object.rotation.to_rotation_matrix();
        let pose_from_object = pose_from_object.into_inner();
        let renamed = compared.names.turn.to_rotation_matrix().into_inner();
        // Exp(d) on the right of the object's rotation is seen through its renamed axes.
        let rotation_by_object = rotation_log_derivative(compared.rotation) * renamed.transpose();
        let mut jacobian = SMatrix::<f64, 9, 15>::zeros();
        let mut set = |row: usize, column: usize, block: &Matrix3<f64>| {
            jacobian.fixed_view_mut::<3, 3>(row, column).copy_from(block);
        };
        set(0, 0, &(-rotation_by_object * pose_from_object.transpose()));
        let center = compared.pose_from_object.translation.vector;
        set(3, 0, &(measured_from_pose * skew(center)));
        set(3, 3, &-measured_from_pose);
        set(0, 6, &rotation_by_object);
        set(3, 9, &(measured_from_pose * pose_from_object));
        set(6, 12, &compared.names.size_by_log(&compared.semi_axes));
        let jacobian = self.whitened_derivative(&jacobian, &compared);
        Linearization::new(&compared.residual, &jacobian)
    }

    fn kernel(&self) -> Kernel {
        match self.evidence {
            Evidence::Joint(_) => self.kernel,
            // Each component has had its own.
            Evidence::Faces(_) => Kernel::Quadratic,
        }
    }
}

struct Comparison {
    pose_from_object: Pose,
    /// Of the object's centre, along the measured axes (m).
    shift: Vector3<f64>,
    /// The object's, as it names them (m).
    semi_axes: Vector3<f64>,
    names: Names,
    /// From the measured axes to the object's renamed ones (rad).
    rotation: Vector3<f64>,
    /// Whitened.
    residual: SVector<f64, 9>,
}

/// One of the ways to name the axes of the same body.
#[derive(Clone, Copy)]
struct Names {
    /// `object_from_renamed`.
    turn: UnitQuaternion<f64>,
    /// Whether x and y change places.
    swapped: bool,
}

impl Names {
    /// The four whose z axis points to the same side as the measured one.
    fn upright(measured_from_object: &UnitQuaternion<f64>) -> [Self; 4] {
        let upside_down = (measured_from_object * Vector3::z()).z < 0.0;
        let unit = |w, x, y, z| UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        let h = FRAC_1_SQRT_2;
        let turns = if upside_down {
            // Half turns about x, the diagonal, y and the other diagonal.
            [
                unit(0.0, 1.0, 0.0, 0.0),
                unit(0.0, h, h, 0.0),
                unit(0.0, 0.0, 1.0, 0.0),
                unit(0.0, h, -h, 0.0),
            ]
        } else {
            [
                unit(1.0, 0.0, 0.0, 0.0),
                unit(h, 0.0, 0.0, h),
                unit(0.0, 0.0, 0.0, 1.0),
                unit(h, 0.0, 0.0, -h),
            ]
        };
        std::array::from_fn(|i| Self { turn: turns[i], swapped: i % 2 == 1 })
    }

    fn semi_axes(&self, of_object: &Vector3<f64>) -> Vector3<f64> {
        if self.swapped { of_object.yxz() } else { *of_object }
    }

    /// Derivative of the renamed semi-axes by the logarithms of the object's.
    fn size_by_log(&self, s: &Vector3<f64>) -> Matrix3<f64> {
        if self.swapped {
            Matrix3::new(0.0, s.y, 0.0, s.x, 0.0, 0.0, 0.0, 0.0, s.z)
        } else {
            Matrix3::from_diagonal(s)
        }
    }
}

/// From logarithms of semi-axes to semi-axes (m).
fn in_metres(covariance: &SMatrix<f64, 9, 9>, semi_axes: &Vector3<f64>) -> SMatrix<f64, 9, 9> {
    let mut scale = SVector::<f64, 9>::repeat(1.0);
    scale.fixed_rows_mut::<3>(6).copy_from(semi_axes);
    SMatrix::from_fn(|i, j| covariance[(i, j)] * scale[i] * scale[j])
}

/// How clearly a footprint shows its heading: from 0 for a circle to 1 for a rectangle.
fn heading_clarity(outline: Outline, semi_axes: &Vector3<f64>) -> f64 {
    let roundness = match outline {
        Outline::Cuboid => 0.0,
        Outline::Ellipsoid | Outline::Cylinder => 1.0,
        Outline::Superquadric(_, footprint) => footprint.min(1.0),
    };
    let (a, b) = (semi_axes.x.powi(2), semi_axes.y.powi(2));
    1.0 - roundness * (1.0 - (a - b).abs() / (a + b))
}

/// The variance (rad^2) of a heading of which only so much shows.
fn faded(variance: f64, clarity: f64) -> f64 {
    let faded = variance / (clarity * clarity);
    let most = NO_HEADING_SIGMA_RAD * NO_HEADING_SIGMA_RAD;
    if faded > most { most.max(variance) } else { faded }
}

/// Row of the rotation about the object's own z axis.
const HEADING: usize = 2;
/// So unsure of a heading that no difference of headings costs anything (rad).
const NO_HEADING_SIGMA_RAD: f64 = 100.0;
