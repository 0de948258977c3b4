//! Which factors the graph gets, and how sure they are.

use crate::graph::{Kernel, MotionModel, SolverSettings};
use serde::{Deserialize, Serialize};

/// How poses and objects are estimated together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SlamSettings {
    /// Whether poses are estimated too; otherwise they are the odometry's, as in the paper's experiments.
    pub optimize_poses: bool,
    /// A new pose for the graph after so much way (m).
    pub min_translation_m: f64,
    /// Or after turning by so much (deg).
    pub min_rotation_deg: f64,
    /// Robust kernel of all observations.
    pub kernel: KernelShape,
    /// Norm of a whitened residual from which it loses weight.
    pub kernel_threshold: f64,
    /// Whether single-frame ellipsoids are used, eq. (13).
    pub observations: bool,
    /// Whether the detector's boxes are used, eq. (15). Single-frame ellipsoids have them in their faces already, where
    /// it is known which sides others hide.
    pub boxes: bool,
    /// Whether, of round objects, those sides are used that are seen to be the object's silhouette. Depth cameras see
    /// neither handles nor leaves; which way a cup is turned is known from how wide its boxes are.
    pub silhouettes: bool,
    /// Whether walls in sight hold the robot's heading and place.
    pub walls: bool,
    /// How exactly walls of a building are parallel or at right angles (deg); 0 where nobody knows.
    pub right_angle_sigma_deg: f64,
    /// Standard deviation of a side of a box (px).
    pub box_sigma_px: f64,
    /// Besides, as a share of the box's width or height.
    pub box_sigma_ratio: f64,
    /// A side nearer to the border of the image is cut, not measured (px).
    pub box_border_px: f64,
    /// What boxes are predicted from.
    pub box_outline: BoxOutline,
    /// Whether objects are held on the planes they stand on. A single-frame ellipsoid has that plane in it already: this
    /// is for boxes alone.
    pub support: bool,
    /// Standard deviation of a support plane's height (m).
    pub support_sigma_m: f64,
    /// Standard deviation of an object's upright axis (deg).
    pub upright_sigma_deg: f64,
    /// What single-frame ellipsoids weigh.
    pub weighting: Weighting,
    /// The paper's weight of eq. (11); only for `weighting: paper`.
    pub eps_z: f64,
    /// Errors of similar views are alike: this is their correlation.
    pub similar_views_correlation: f64,
    /// Views from directions within this angle are similar (deg).
    pub similar_views_deg: f64,
    /// No position is known better than this (m), however many views.
    pub min_position_sigma_m: f64,
    /// The same for semi-axes (m).
    pub min_size_sigma_m: f64,
    /// The same for the heading (deg).
    pub min_heading_sigma_deg: f64,
    /// How odometry's uncertainty grows where it does not say so itself.
    pub motion: MotionModel,
    /// When the incremental solver works again on what it has.
    pub solver: SolverSettings,
}

/// How fast outliers lose weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KernelShape {
    /// Not at all.
    Quadratic,
    /// Slowly: the paper's.
    Huber,
    /// In between.
    Cauchy,
    /// Fast: what is far off counts for nothing.
    #[serde(rename = "geman_mcclure")]
    GemanMcClure,
}

impl SlamSettings {
    /// The robust kernel of all observations.
    pub fn robust_kernel(&self) -> Kernel {
        let threshold = self.kernel_threshold;
        match self.kernel {
            KernelShape::Quadratic => Kernel::Quadratic,
            KernelShape::Huber => Kernel::Huber(threshold),
            KernelShape::Cauchy => Kernel::Cauchy(threshold),
            KernelShape::GemanMcClure => Kernel::GemanMcClure(threshold),
        }
    }
}

/// What a box is predicted from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoxOutline {
    /// The outline of the object's class.
    #[default]
    Class,
    /// The paper's ellipsoid for everything.
    Ellipsoid,
}

/// What single-frame ellipsoids weigh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Weighting {
    /// Each measurement its own covariance, guesses of what was not seen included: needs no knob.
    #[default]
    Covariance,
    /// Each face by itself, as exactly as it was seen; one that was not seen is bounded, and its class says once where it
    /// usually is.
    Faces,
    /// `eps_z P_e` for every component in radians and metres. Liao et al. 2020, eq. (11) and (13).
    Paper,
}

impl Default for SlamSettings {
    fn default() -> Self {
        Self {
            optimize_poses: true,
            min_translation_m: 0.02,
            min_rotation_deg: 1.0,
            kernel: KernelShape::Cauchy,
            kernel_threshold: 3.0,
            observations: true,
            boxes: false,
            silhouettes: true,
            walls: true,
            right_angle_sigma_deg: 0.5,
            box_sigma_px: 3.0,
            box_sigma_ratio: 0.02,
            box_border_px: 2.0,
            box_outline: BoxOutline::Class,
            support: false,
            support_sigma_m: 0.02,
            upright_sigma_deg: 0.1,
            weighting: Weighting::Covariance,
            eps_z: 1000.0,
            similar_views_correlation: 0.5,
            similar_views_deg: 20.0,
            min_position_sigma_m: 0.005,
            min_size_sigma_m: 0.005,
            min_heading_sigma_deg: 1.0,
            motion: MotionModel::default(),
            solver: SolverSettings::default(),
        }
    }
}
