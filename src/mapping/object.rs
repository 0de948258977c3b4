//! An object of the map.

use super::{BoxOutline, Measured, Observation, SlamSettings, Weighting, views::Views};
use crate::{
    geometry::{Ellipsoid, Outline, Pose, yaw_of},
    graph::{
        BoxObservation, EllipsoidId, EllipsoidObservation, EllipsoidPrior, Graph, Noise, PoseId,
        SupportContact, Upright,
    },
    time::Stamp,
};
use nalgebra::{Point3, SMatrix, SVector, UnitQuaternion, Vector3};
use std::{collections::BTreeMap, error::Error, fmt};

/// Identity of an object, never used twice in a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u64);

impl fmt::Display for ObjectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// An object of the map.
#[derive(Clone, Debug)]
pub struct MapObject {
    /// Its identity.
    pub id: ObjectId,
    /// Identity that its first measurement came with, if any.
    pub track: Option<u64>,
    /// What fills its extents.
    pub outline: Outline,
    /// Measurements that were joined to it.
    pub observations: u32,
    /// Stamp of the first measurement.
    pub first_seen: Stamp,
    /// Stamp of the latest measurement.
    pub last_seen: Stamp,
    /// Height of the plane it stands on in the map frame (m), if one was seen.
    pub support_height_m: Option<f64>,
    /// Measurements that saw that plane.
    support_heights: u32,
    variable: EllipsoidId,
    views: Views,
    /// Where single measurements saw its centre, in the map.
    centers: Vec<Point3<f64>>,
    ellipsoid: Ellipsoid,
    covariance: SMatrix<f64, 9, 9>,
    /// Sum of the detector's probabilities by label.
    votes: BTreeMap<String, f64>,
    /// Probability that all measurements were false.
    doubt: f64,
}

impl MapObject {
    pub(super) fn new(
        id: ObjectId,
        stamp: Stamp,
        first: &Observation,
        (variable, initial): (EllipsoidId, &Ellipsoid),
    ) -> Self {
        Self {
            id,
            track: first.track,
            outline: first.outline,
            observations: 0,
            first_seen: stamp,
            last_seen: stamp,
            support_height_m: None,
            support_heights: 0,
            variable,
            views: Views::default(),
            centers: Vec::new(),
            ellipsoid: upright(initial),
            covariance: SMatrix::identity(),
            votes: BTreeMap::new(),
            doubt: 1.0,
        }
    }

    /// Its ellipsoid in the map frame, upright, with the longer horizontal axis first.
    pub fn ellipsoid(&self) -> Ellipsoid {
        self.ellipsoid.quarter_turned(self.quarters())
    }

    /// Covariance of `[rotation, translation, log semi-axes]` of [`MapObject::ellipsoid`], a right perturbation in
    /// the object's frame. As of the last time the object was seen, or of the end of the run.
    pub fn covariance(&self) -> SMatrix<f64, 9, 9> {
        if self.quarters() == 0 {
            return self.covariance;
        }
        // New x is old y, new y is old -x.
        let mut turn = SMatrix::<f64, 9, 9>::zeros();
        for first in [0, 3] {
            turn[(first, first + 1)] = 1.0;
            turn[(first + 1, first)] = -1.0;
            turn[(first + 2, first + 2)] = 1.0;
        }
        (turn[(6, 7)], turn[(7, 6)], turn[(8, 8)]) = (1.0, 1.0, 1.0);
        turn * self.covariance * turn.transpose()
    }

    /// The most probable label.
    pub fn label(&self) -> &str {
        let mut best: (&str, f64) = ("", f64::MIN);
        for (label, votes) in &self.votes {
            if *votes > best.1 {
                best = (label, *votes);
            }
        }
        best.0
    }

    /// Probability of each label; they sum to one.
    pub fn labels(&self) -> BTreeMap<String, f64> {
        let total: f64 = self.votes.values().sum();
        self.votes.iter().map(|(label, votes)| (label.clone(), votes / total)).collect()
    }

    /// Probability that the object exists.
    pub fn existence(&self) -> f64 {
        1.0 - self.doubt
    }

    /// Quarter turns that put the longer horizontal axis first.
    fn quarters(&self) -> i64 {
        i64::from(self.ellipsoid.semi_axes.y > self.ellipsoid.semi_axes.x)
    }

    /// Counts an observation.
    pub(super) fn join(&mut self, stamp: Stamp, observation: &Observation, map_from_base: &Pose) {
        self.observations += 1;
        self.last_seen = self.last_seen.max(stamp);
        for (label, probability) in &observation.labels {
            *self.votes.entry(label.clone()).or_default() += probability;
        }
        let Some(measured) = &observation.measured else { return };
        self.doubt = (self.doubt * (1.0 - 0.5 * measured.probability)).max(MIN_DOUBT);
        if let Some(height) = support_height(measured, map_from_base) {
            self.support_heights += 1;
            let weight = 1.0 / f64::from(self.support_heights);
            let known = self.support_height_m.unwrap_or(height);
            self.support_height_m = Some(known + weight * (height - known));
        }
    }

    /// The factors that a new object needs: it stands upright and has about the size and, where only boxes see it, the
    /// place of the first guess. So it is never undetermined.
    pub(super) fn found(
        &self,
        graph: &mut Graph,
        initial: &Ellipsoid,
        only_boxes: bool,
        settings: &SlamSettings,
    ) -> Result<(), Box<dyn Error>> {
        graph.add_factor(Upright::new(self.variable, settings.upright_sigma_deg.to_radians())?);
        let sigmas = if only_boxes { BARELY_KNOWN } else { NOT_ABSURD };
        let noise = Noise::from_sigmas(sigmas)?;
        graph.add_factor(EllipsoidPrior::new(self.variable, *initial, noise));
        Ok(())
    }

    /// The factors of an observation from a keyframe.
    pub(super) fn tie(
        &mut self,
        graph: &mut Graph,
        observation: &Observation,
        (pose, keyframe_from_base): (PoseId, &Pose),
        settings: &SlamSettings,
    ) -> Result<(), Box<dyn Error>> {
        if let Some(measured) = observation.measured.as_ref().filter(|_| settings.observations) {
            self.tie_measured(graph, measured, (pose, keyframe_from_base), settings)?;
        }
        let sides = &observation.sides;
        if (settings.boxes || settings.silhouettes) && sides.sides.iter().any(Option::is_some) {
            let outline = match settings.box_outline {
                BoxOutline::Class => self.outline,
                BoxOutline::Ellipsoid => Outline::Ellipsoid,
            };
            let keyframe_from_camera = keyframe_from_base * sides.base_from_camera;
            let factor = BoxObservation::new(
                pose,
                self.variable,
                keyframe_from_camera,
                outline,
                sides.sides,
            )?;
            graph.add_factor(factor.with_kernel(settings.robust_kernel()));
        }
        let support = observation.measured.as_ref().and_then(|measured| measured.support);
        if let Some(plane) = support.filter(|_| settings.support) {
            let plane = plane.transformed(&(graph.pose(pose) * keyframe_from_base));
            let factor =
                SupportContact::new(self.variable, self.outline, plane, settings.support_sigma_m)?;
            graph.add_factor(factor.with_kernel(settings.robust_kernel()));
        }
        Ok(())
    }

    fn tie_measured(
        &mut self,
        graph: &mut Graph,
        measured: &Measured,
        (pose, keyframe_from_base): (PoseId, &Pose),
        settings: &SlamSettings,
    ) -> Result<(), Box<dyn Error>> {
        let ellipsoid = measured.ellipsoid.transformed(keyframe_from_base);
        let covariance = match settings.weighting {
            Weighting::Covariance => measured.covariance,
            Weighting::Paper => paper_covariance(&ellipsoid, measured.probability * settings.eps_z),
        };
        let factor =
            EllipsoidObservation::new(pose, self.variable, ellipsoid, &covariance, self.outline)?;
        let factor = factor.with_kernel(settings.robust_kernel());
        if settings.weighting == Weighting::Paper {
            graph.add_factor(factor);
            return Ok(());
        }
        self.begin_anew_if_wrong(graph, &ellipsoid.transformed(&graph.pose(pose)));
        let eye = graph.pose(pose).translation.vector.into();
        let eye = self.ellipsoid.pose.inverse_transform_point(&eye);
        Ok(self.views.add(graph, &eye, factor, settings)?)
    }

    /// An object that began with an outlier stays at it: the robust kernel then takes what is right for outliers. So where
    /// more measurements are near the latest one than near the estimate, the estimate begins anew there.
    fn begin_anew_if_wrong(&mut self, graph: &mut Graph, measured: &Ellipsoid) {
        let center = measured.center();
        if self.centers.len() < MAX_CENTERS {
            self.centers.push(center);
        }
        let estimate = graph.ellipsoid(self.variable).center();
        let reach = measured.semi_axes.norm();
        let near = |place: &Point3<f64>| {
            self.centers.iter().filter(|c| nalgebra::distance(c, place) < reach).count()
        };
        if nalgebra::distance(&center, &estimate) > reach && near(&center) > near(&estimate) {
            graph.set_ellipsoid(self.variable, *measured);
        }
    }

    pub(super) fn take_estimate(&mut self, graph: &Graph) {
        self.ellipsoid = upright(&graph.ellipsoid(self.variable));
    }

    pub(super) fn take_covariance(&mut self, graph: &Graph, settings: &SlamSettings) {
        let joint = graph.covariance(&[self.variable.into()]);
        self.covariance = joint.fixed_view::<9, 9>(0, 0).into_owned();
        let (place, size) = (settings.min_position_sigma_m, settings.min_size_sigma_m);
        let mut floors = SVector::<f64, 9>::zeros();
        floors[2] = settings.min_heading_sigma_deg.to_radians();
        floors.fixed_rows_mut::<3>(3).fill(place);
        floors.fixed_rows_mut::<3>(6).copy_from(&self.ellipsoid.semi_axes.map(|s| size / s));
        for i in 0..9 {
            self.covariance[(i, i)] += floors[i] * floors[i];
        }
    }
}

/// Height in the map of the plane that a measured object stands on, below its centre (m).
fn support_height(measured: &Measured, map_from_base: &Pose) -> Option<f64> {
    let plane = measured.support?.transformed(map_from_base);
    let center = measured.ellipsoid.transformed(map_from_base).center();
    Some(center.z - plane.signed_distance(&center) / plane.normal.z)
}

/// The same ellipsoid without roll and pitch.
fn upright(ellipsoid: &Ellipsoid) -> Ellipsoid {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_of(&ellipsoid.pose));
    Ellipsoid {
        pose: Pose::from_parts(ellipsoid.pose.translation, rotation),
        semi_axes: ellipsoid.semi_axes,
    }
}

/// The same information for every component of eq. (14) (1/rad^2, 1/m^2).
fn paper_covariance(ellipsoid: &Ellipsoid, information: f64) -> SMatrix<f64, 9, 9> {
    let mut variances = SVector::<f64, 9>::repeat(1.0 / information);
    let log_axes = ellipsoid.semi_axes.map(|s| 1.0 / (information * s * s));
    variances.fixed_rows_mut::<3>(6).copy_from(&log_axes);
    SMatrix::from_diagonal(&variances)
}

/// Measurements that are remembered to judge an object's place by.
const MAX_CENTERS: usize = 100;
/// Detectors and depth can always be wrong together.
const MIN_DOUBT: f64 = 1e-3;
/// A semi-axis that measurements disagree about must not shrink to nothing (rad, m, 1).
const NOT_ABSURD: [f64; 9] = [10.0, 10.0, 10.0, 100.0, 100.0, 100.0, 1.0, 1.0, 1.0];
/// What boxes alone leave open must not become infinite (rad, m, 1).
const BARELY_KNOWN: [f64; 9] = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0];
