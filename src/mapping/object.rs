//! An object of the map.

use super::{
    MappingSettings, ObjectState, Observation, SavedObject, SlamSettings,
    company::Company,
    existence::Existence,
    looks::Looks,
    ties::{Tie, TieFactor},
    views::{View, Views},
};
use crate::{
    geometry::{Ellipsoid, Outline, Pose, yaw_of},
    graph::{EllipsoidId, EllipsoidPrior, Graph, Noise, NoiseError, PoseId, Upright},
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
    /// Whether it moves by itself, going by its class: it is where it was seen last. It holds no pose, and no place is
    /// recognised by it.
    pub moves: bool,
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
    pub(super) variable: EllipsoidId,
    pub(super) views: Views,
    /// Its other factors.
    pub(super) ties: Vec<Tie>,
    /// Where the latest measurements saw it.
    pub(super) looks: Looks,
    pub(super) ellipsoid: Ellipsoid,
    covariance: SMatrix<f64, 9, 9>,
    /// Sum of the detector's probabilities by label.
    votes: BTreeMap<String, f64>,
    /// What follows from them.
    belief: BTreeMap<String, f64>,
    pub(super) existence: Existence,
    /// Whether there are only glimpses of it.
    pub(super) glimpsed: bool,
    /// Whether it is known where it is.
    pub(super) placed: bool,
    /// What people call it.
    pub(super) given_name: Option<String>,
    /// Whether it stays in the map and in its place whatever images say.
    pub(super) locked: bool,
    pub(super) company: Company,
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
            moves: first.moves,
            observations: 0,
            first_seen: stamp,
            last_seen: stamp,
            support_height_m: None,
            support_heights: 0,
            variable,
            views: Views::default(),
            ties: Vec::new(),
            looks: Looks::default(),
            ellipsoid: upright(initial),
            covariance: SMatrix::identity(),
            votes: BTreeMap::new(),
            belief: BTreeMap::new(),
            existence: Existence::default(),
            glimpsed: first.is_glimpse(),
            placed: false,
            given_name: None,
            locked: false,
            company: Company::default(),
        }
    }

    /// An object of an earlier run, of which the graph gets a prior.
    ///
    /// # Errors
    /// When its covariance is none.
    pub(super) fn remembered(
        saved: &SavedObject,
        graph: &mut Graph,
        settings: &SlamSettings,
    ) -> Result<Self, NoiseError> {
        let covariance = saved.reliable_covariance();
        let noise = Noise::from_covariance(&covariance)?;
        let variable = graph.add_ellipsoid(saved.ellipsoid);
        let prior = EllipsoidPrior::new(variable, saved.ellipsoid, noise);
        let prior = prior.with_kernel(settings.robust_kernel());
        let prior = Tie::new(graph, TieFactor::Prior(Box::new(prior)), None);
        // What was never seen is believed as much as what was seen once.
        let votes = f64::from(saved.observations.max(1));
        let height = saved.support_height_m;
        Ok(Self {
            id: saved.into(),
            track: None,
            outline: saved.outline,
            moves: false,
            observations: saved.observations,
            first_seen: saved.first_seen,
            last_seen: saved.last_seen,
            support_height_m: height,
            support_heights: if height.is_some() { saved.observations.max(1) } else { 0 },
            variable,
            views: Views::default(),
            ties: vec![prior],
            looks: Looks::default(),
            ellipsoid: saved.ellipsoid,
            covariance: saved.covariance,
            votes: saved.labels.iter().map(|(label, p)| (label.clone(), p * votes)).collect(),
            belief: saved.labels.clone(),
            existence: Existence::remembered(saved.existence),
            glimpsed: false,
            placed: true,
            given_name: saved.name.clone(),
            locked: saved.locked,
            company: Company::remembered(saved.observations),
        })
    }

    /// Gives what is not in the graph in another frame.
    pub(super) fn move_map(&mut self, new_from_old: &Pose) {
        self.ellipsoid = self.ellipsoid.transformed(new_from_old);
        self.looks.move_map(new_from_old);
        self.ties.iter_mut().for_each(|tie| tie.move_map(new_from_old));
        if let Some(height) = &mut self.support_height_m {
            *height += new_from_old.translation.z;
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

    /// The covariance in the frame that the graph has.
    pub(super) fn own_covariance(&self) -> &SMatrix<f64, 9, 9> {
        &self.covariance
    }

    /// The most probable label.
    pub fn label(&self) -> &str {
        let mut best: (&str, f64) = ("", f64::MIN);
        for (label, probability) in &self.belief {
            if *probability > best.1 {
                best = (label, *probability);
            }
        }
        best.0
    }

    /// What people call it; its most probable label where nobody has named it.
    pub fn name(&self) -> &str {
        self.given_name.as_deref().unwrap_or_else(|| self.label())
    }

    /// Whether detectors or people call it so.
    pub fn is_called(&self, name: &str) -> bool {
        name == self.label() || Some(name) == self.given_name()
    }

    /// The name that people gave it.
    pub fn given_name(&self) -> Option<&str> {
        self.given_name.as_deref()
    }

    /// Whether it stays in the map and in its place whatever images say.
    pub fn is_locked(&self) -> bool {
        self.locked
    }

    /// Probability of each label; they sum to one.
    pub fn labels(&self) -> BTreeMap<String, f64> {
        self.belief.clone()
    }

    /// Probability that the object exists.
    pub fn existence(&self) -> f64 {
        self.existence.probability()
    }

    /// Where it is in its life.
    pub fn state(&self) -> ObjectState {
        self.existence.state
    }

    /// Whether it was seen often enough to be an object of the map.
    pub(super) fn counts(&self) -> bool {
        self.existence.state != ObjectState::Tentative
    }

    /// Whether more boxes in its place speak against it than for it.
    pub(super) fn is_discredited(&self) -> bool {
        !self.locked && self.company.is_discredited()
    }

    pub(super) fn belief(&self) -> &BTreeMap<String, f64> {
        &self.belief
    }

    pub(super) fn variable(&self) -> EllipsoidId {
        self.variable
    }

    /// Its ellipsoid as the graph names its axes.
    pub(super) fn estimate(&self) -> &Ellipsoid {
        &self.ellipsoid
    }

    /// Quarter turns that put the longer horizontal axis first.
    fn quarters(&self) -> i64 {
        i64::from(self.ellipsoid.semi_axes.y > self.ellipsoid.semi_axes.x)
    }

    /// Counts an observation.
    pub(super) fn join(
        &mut self,
        stamp: Stamp,
        observation: &Observation,
        map_from_base: &Pose,
        settings: &MappingSettings,
    ) {
        self.observations += 1;
        self.last_seen = self.last_seen.max(stamp);
        for (label, probability) in &observation.labels {
            *self.votes.entry(label.clone()).or_default() += probability;
        }
        self.belief = settings.labels.posterior(&self.votes);
        if observation.labels.first().is_some_and(|(label, _)| label == self.label()) {
            self.moves = observation.moves;
        }
        let Some(measured) = &observation.measured else { return };
        let eye = map_from_base.translation.vector.into();
        let score = observation.labels.first().map_or(0.0, |(_, score)| *score);
        self.existence.measured((score, measured.probability), &eye, &settings.life);
        if let Some(height) = measured.support_height_m(map_from_base) {
            self.support_heights += 1;
            let weight = 1.0 / f64::from(self.support_heights);
            let known = self.support_height_m.unwrap_or(height);
            self.support_height_m = Some(known + weight * (height - known));
        }
    }

    /// The factors that a new object needs: it stands upright and has about the size and, where only boxes see it, the
    /// place of the first guess. So it is never undetermined.
    pub(super) fn found(
        &mut self,
        graph: &mut Graph,
        (first, initial): (&Observation, &Ellipsoid),
        only_boxes: bool,
        settings: &SlamSettings,
    ) -> Result<(), Box<dyn Error>> {
        graph.add_factor(Upright::new(self.variable, settings.upright_sigma_deg.to_radians())?);
        let sigmas = if only_boxes { BARELY_KNOWN } else { NOT_ABSURD };
        let noise = Noise::from_sigmas(sigmas)?;
        graph.add_factor(EllipsoidPrior::new(self.variable, *initial, noise));
        let hints = first.measured.as_ref().and_then(|measured| measured.glimpse.as_ref());
        if let Some(hints) = hints.filter(|_| first.sides.has_any()) {
            let prior = hints.prior(self.variable, initial)?;
            self.ties.push(Tie::new(graph, TieFactor::Prior(Box::new(prior)), None));
        }
        Ok(())
    }

    /// Takes over all that is known of another object that is the same thing: its factors, votes and times. The other's
    /// variable leaves the graph. Returns the poses whose measurements were forgotten for it.
    pub(super) fn absorb(
        &mut self,
        graph: &mut Graph,
        mut other: Self,
        (mapping, settings): (&MappingSettings, &SlamSettings),
    ) -> Result<Vec<PoseId>, NoiseError> {
        let mut forgotten = Vec::new();
        match (self.glimpsed, other.glimpsed) {
            (true, false) => {
                forgotten = self.forget_views(graph);
                graph.set_ellipsoid(self.variable, other.ellipsoid);
                self.ellipsoid = other.ellipsoid;
            }
            (false, true) => forgotten = other.forget_views(graph),
            (true, true) => other.forget_usual_size(graph),
            (false, false) => {}
        }
        let place = self.ellipsoid.pose;
        let views: Vec<View> = other.views.all().cloned().collect();
        other.views.take(graph, &views);
        forgotten.extend(self.views.join(graph, (self.variable, &place), views, settings)?);
        let is_sized = self.ties.iter().any(Tie::tells_size);
        other.remove_ties(graph, |tie| is_sized && tie.usual_m().is_some());
        self.ties.extend(other.ties.into_iter().map(|tie| tie.of(graph, self.variable)));
        self.forget_ties(graph, &forgotten);
        graph.remove_variable(other.variable);
        self.observations += other.observations;
        self.first_seen = self.first_seen.min(other.first_seen);
        self.last_seen = self.last_seen.max(other.last_seen);
        for (label, votes) in other.votes {
            *self.votes.entry(label).or_default() += votes;
        }
        self.belief = mapping.labels.posterior(&self.votes);
        self.existence.absorb(&other.existence);
        self.placed |= other.placed;
        self.given_name = self.given_name.take().or(other.given_name);
        self.locked |= other.locked;
        self.looks.clear();
        let (own, others) = (f64::from(self.support_heights), f64::from(other.support_heights));
        self.support_height_m = match (self.support_height_m, other.support_height_m) {
            (Some(own_m), Some(other_m)) => Some((own * own_m + others * other_m) / (own + others)),
            (own_m, other_m) => own_m.or(other_m),
        };
        self.support_heights += other.support_heights;
        Ok(forgotten)
    }

    /// Gives up the measurements that are another object's: those that are much nearer to it. Returns how many,
    /// and the poses whose measurements were forgotten for them.
    pub(super) fn yield_to(
        &mut self,
        graph: &mut Graph,
        other: &mut Self,
        settings: &SlamSettings,
    ) -> Result<(usize, Vec<PoseId>), NoiseError> {
        let (own, others) = (self.ellipsoid.center(), other.ellipsoid.center());
        let poses = |view: &View| graph.pose(view.keyframe.pose);
        let center = |view: &View| view.factor.measured().transformed(&poses(view)).center();
        let is_others = |center: Point3<f64>| {
            nalgebra::distance(&center, &others) < NEARER * nalgebra::distance(&center, &own)
        };
        let wrong: Vec<View> = self.views.all().filter(|v| is_others(center(v))).cloned().collect();
        let count = wrong.len();
        self.views.take(graph, &wrong);
        let place = (other.variable, &other.ellipsoid.pose.clone());
        let is_others = |tie: &Tie| wrong.iter().any(|v| tie.pose == Some(v.keyframe.pose));
        let (theirs, own): (Vec<Tie>, Vec<Tie>) = self.ties.drain(..).partition(is_others);
        self.ties = own;
        other.ties.extend(theirs.into_iter().map(|tie| tie.of(graph, other.variable)));
        let forgotten = other.views.join(graph, place, wrong, settings)?;
        other.forget_ties(graph, &forgotten);
        Ok((count, forgotten))
    }

    /// Takes its variable and factors out of the graph. Returns the poses that it was measured from.
    pub(super) fn leave(&self, graph: &mut Graph) -> Vec<PoseId> {
        graph.remove_variable(self.variable);
        self.views.all().map(|view| view.keyframe.pose).collect()
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

/// The same ellipsoid without roll and pitch.
fn upright(ellipsoid: &Ellipsoid) -> Ellipsoid {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_of(&ellipsoid.pose));
    Ellipsoid {
        pose: Pose::from_parts(ellipsoid.pose.translation, rotation),
        semi_axes: ellipsoid.semi_axes,
    }
}

/// A measurement is another object's if it is so much nearer to it.
const NEARER: f64 = 0.4;
/// A semi-axis that measurements disagree about must not shrink to nothing (rad, m, 1).
const NOT_ABSURD: [f64; 9] = [10.0, 10.0, 10.0, 100.0, 100.0, 100.0, 1.0, 1.0, 1.0];
/// What boxes alone leave open must not become infinite (rad, m, 1).
const BARELY_KNOWN: [f64; 9] = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0];
