//! The factors of an object: its measurements by direction, and those besides.

use super::{
    MapObject, Measured, Observation, SlamSettings, Weighting, odometry::Place, views::View,
};
use crate::{
    geometry::{Ellipsoid, Outline, Plane, Pose},
    graph::{
        BoxObservation, EllipsoidId, EllipsoidObservation, EllipsoidPrior, Factor, FactorId, Graph,
        Noise, NoiseError, PoseId, SizePrior, SupportContact,
    },
};
use std::error::Error;

/// A factor that is not counted by its direction.
#[derive(Clone, Debug)]
pub(super) struct Tie {
    factor: TieFactor,
    pub(super) in_graph: FactorId,
    /// The keyframe's, if it is tied to one.
    pub(super) pose: Option<PoseId>,
}

#[derive(Clone, Debug)]
pub(super) enum TieFactor {
    Box(BoxObservation),
    Support(SupportContact),
    /// With the paper's weights.
    Measured(Box<EllipsoidObservation>),
    /// What an earlier run knew.
    Prior(Box<EllipsoidPrior>),
    /// What its class says, with the usual extents (m).
    Size(SizePrior, [f64; 3]),
}

impl Tie {
    pub(super) fn new(graph: &mut Graph, factor: TieFactor, pose: Option<PoseId>) -> Self {
        let in_graph = match &factor {
            TieFactor::Box(factor) => graph.add_factor(factor.clone()),
            TieFactor::Support(factor) => graph.add_factor(factor.clone()),
            TieFactor::Measured(factor) => graph.add_factor(factor.as_ref().clone()),
            TieFactor::Prior(factor) => graph.add_factor(factor.as_ref().clone()),
            TieFactor::Size(factor, _) => graph.add_factor(factor.clone()),
        };
        Self { factor, in_graph, pose }
    }

    /// That an object with this outline stands on a plane of the map.
    pub(super) fn support_factor(
        (object, outline): (EllipsoidId, Outline),
        plane: Plane,
        settings: &SlamSettings,
    ) -> Result<TieFactor, NoiseError> {
        let factor = SupportContact::new(object, outline, plane, settings.support_sigma_m)?;
        Ok(TieFactor::Support(factor.with_kernel(settings.robust_kernel())))
    }

    /// Whether its factor is of the same kind.
    pub(super) fn is_like(&self, factor: &TieFactor) -> bool {
        std::mem::discriminant(&self.factor) == std::mem::discriminant(factor)
    }

    pub(super) fn factor(&self) -> &dyn Factor {
        match &self.factor {
            TieFactor::Box(factor) => factor,
            TieFactor::Support(factor) => factor,
            TieFactor::Measured(factor) => factor.as_ref(),
            TieFactor::Prior(factor) => factor.as_ref(),
            TieFactor::Size(factor, _) => factor,
        }
    }

    /// The plane that it says the object to stand on.
    pub(super) fn support(&self) -> Option<&Plane> {
        match &self.factor {
            TieFactor::Support(factor) => Some(factor.plane()),
            _ => None,
        }
    }

    /// Extents (m) that things of its class usually have, if it says that.
    pub(super) fn usual_m(&self) -> Option<[f64; 3]> {
        match &self.factor {
            TieFactor::Size(_, usual_m) => Some(*usual_m),
            _ => None,
        }
    }

    /// Whether it says without looking how large the object is.
    pub(super) fn tells_size(&self) -> bool {
        matches!(self.factor, TieFactor::Prior(_) | TieFactor::Size(..))
    }

    /// The same for another object.
    pub(super) fn of(self, graph: &mut Graph, variable: EllipsoidId) -> Self {
        graph.remove_factor(self.in_graph);
        let factor = match self.factor {
            TieFactor::Box(factor) => TieFactor::Box(factor.of(variable)),
            TieFactor::Support(factor) => TieFactor::Support(factor.of(variable)),
            TieFactor::Measured(factor) => TieFactor::Measured(Box::new(factor.of(variable))),
            TieFactor::Prior(factor) => TieFactor::Prior(Box::new(factor.of(variable))),
            TieFactor::Size(factor, usual_m) => TieFactor::Size(factor.of(variable), usual_m),
        };
        Self::new(graph, factor, self.pose)
    }

    /// The map has moved, and the factor in the graph with it.
    pub(super) fn move_map(&mut self, new_from_old: &Pose) {
        match &mut self.factor {
            TieFactor::Box(factor) => factor.move_map(new_from_old),
            TieFactor::Support(factor) => factor.move_map(new_from_old),
            TieFactor::Measured(factor) => factor.move_map(new_from_old),
            TieFactor::Prior(factor) => factor.move_map(new_from_old),
            TieFactor::Size(factor, _) => factor.move_map(new_from_old),
        }
    }
}

impl MapObject {
    /// The factors of an observation from a keyframe. Returns the poses from which other measurements were forgotten
    /// for it.
    pub(super) fn tie(
        &mut self,
        graph: &mut Graph,
        observation: &Observation,
        place: &Place,
        settings: &SlamSettings,
    ) -> Result<Vec<PoseId>, Box<dyn Error>> {
        let mut forgotten = Vec::new();
        let measured = observation.measured.as_ref().filter(|_| settings.observations);
        if self.moves {
            return self.tie_moving(graph, measured, place);
        }
        let to = (self.variable, self.outline);
        let mut sides = observation.sides.factor(place, to, settings)?;
        let is_glimpse = measured.is_some_and(|measured| measured.glimpse.is_some());
        if let Some(measured) = measured.filter(|_| !is_glimpse || self.glimpsed) {
            let of_view = sides.take_if(|_| settings.weighting == Weighting::Covariance);
            let measured = (measured, &observation.labels[..]);
            forgotten = self.tie_measured(graph, measured, of_view, place, settings)?;
        }
        if let Some(sides) = sides.filter(|_| !is_glimpse || settings.boxes) {
            self.tie_once(graph, TieFactor::Box(sides), place.keyframe.pose);
        }
        let support = observation.measured.as_ref().and_then(|measured| measured.support);
        let support = support.map(|plane| plane.transformed(&place.map_from_base(graph)));
        if is_glimpse {
            self.stand_on(graph, support.filter(|_| self.glimpsed), settings)?;
        } else if let Some(plane) = support.filter(|_| settings.support) {
            let support = Tie::support_factor(to, plane, settings)?;
            self.tie_once(graph, support, place.keyframe.pose);
        }
        Ok(forgotten)
    }

    /// What moves by itself is where it was seen last, give or take a step. That ties it to the map and not to the robot, so
    /// that it holds no pose.
    fn tie_moving(
        &mut self,
        graph: &mut Graph,
        measured: Option<&Measured>,
        place: &Place,
    ) -> Result<Vec<PoseId>, Box<dyn Error>> {
        let Some(measured) = measured else { return Ok(Vec::new()) };
        let in_map = measured.ellipsoid.transformed(&place.map_from_base(graph));
        let mut covariance = measured.covariance;
        for horizontal in 3..5 {
            covariance[(horizontal, horizontal)] += STEP_M * STEP_M;
        }
        let noise = Noise::from_covariance(&covariance)?;
        let forgotten = self.begin_anew(graph, &in_map);
        self.replace_prior(graph, EllipsoidPrior::new(self.variable, in_map, noise));
        Ok(forgotten)
    }

    /// Remembers where a measurement saw it. Returns the number of the look.
    pub(super) fn look(
        &mut self,
        graph: &Graph,
        (measured, in_map): (&Measured, &Ellipsoid),
        place: &Place,
    ) -> u32 {
        let variance = measured.covariance[(3, 3)].max(measured.covariance[(4, 4)]);
        let eye = place.map_from_base(graph).translation.vector.into();
        self.looks.push((in_map.center(), variance), eye)
    }

    /// Lets this say what was known before, instead of what said it until now.
    pub(super) fn replace_prior(&mut self, graph: &mut Graph, prior: EllipsoidPrior) {
        self.remove_ties(graph, |tie| matches!(tie.factor, TieFactor::Prior(_)));
        self.ties.push(Tie::new(graph, TieFactor::Prior(Box::new(prior)), None));
    }

    /// Share of its information that a measurement with these labels has. Detectors take things for others now and then;
    /// what such a measurement guesses, and what it takes for a known end, is what the other class is usually like.
    fn share_of_information(&self, labels: &[(String, f64)]) -> f64 {
        let Some((label, _)) = labels.first() else { return 1.0 };
        let belief = self.belief().get(label).copied().unwrap_or_default();
        if belief < UNLIKELY_CLASS { OTHER_CLASS_SHARE } else { 1.0 }
    }

    fn tie_measured(
        &mut self,
        graph: &mut Graph,
        (measured, labels): (&Measured, &[(String, f64)]),
        sides: Option<BoxObservation>,
        place: &Place,
        settings: &SlamSettings,
    ) -> Result<Vec<PoseId>, Box<dyn Error>> {
        let ellipsoid = measured.ellipsoid.transformed(&place.keyframe_from_base);
        let covariance = match &measured.glimpse {
            Some(hints) => hints.depth_covariance,
            None if settings.weighting == Weighting::Paper => {
                measured.paper_covariance(settings.eps_z)
            }
            None => measured.covariance,
        };
        let pose = place.keyframe.pose;
        let faces = measured.faces.filter(|_| settings.weighting == Weighting::Faces);
        let to = (self.variable, self.outline);
        let factor = match faces.filter(|_| measured.glimpse.is_none()) {
            Some(faces) => {
                let rotation = std::array::from_fn(|i| measured.covariance[(i, i)].sqrt());
                EllipsoidObservation::of_faces(pose, to.0, ellipsoid, (rotation, faces), to.1)?
            }
            None => EllipsoidObservation::new(pose, to.0, ellipsoid, &covariance, to.1)?,
        };
        let factor = factor.with_kernel(settings.robust_kernel());
        if settings.weighting == Weighting::Paper {
            self.tie_once(graph, TieFactor::Measured(Box::new(factor)), place.keyframe.pose);
            return Ok(Vec::new());
        }
        let factor = factor.scaled(self.share_of_information(labels))?;
        let (mut forgotten, mut order) = (Vec::new(), 0);
        if measured.glimpse.is_none() {
            let in_map = ellipsoid.transformed(&graph.pose(place.keyframe.pose));
            order = self.look(graph, (measured, &in_map), place);
            if self.glimpsed {
                forgotten = self.begin_anew(graph, &in_map);
            }
            self.begin_anew_if_wrong(graph, &in_map);
            self.expect_usual_size(graph, measured.usual_m, labels, settings)?;
        }
        let map_from_object = self.ellipsoid.pose;
        let mut view = View::new(place.keyframe, factor, sides);
        view.order = order;
        forgotten.extend(self.views.add(graph, &map_from_object, view, settings)?);
        if self.is_adrift() {
            let eye = graph.pose(place.keyframe.pose).translation.vector.into();
            self.range_anew(graph, &eye);
        }
        self.forget_ties(graph, &forgotten);
        Ok(forgotten)
    }

    /// Forgets what else was seen from keyframes from which no measurement is kept.
    pub(super) fn forget_ties(&mut self, graph: &mut Graph, poses: &[PoseId]) {
        let is_viewed = |pose: &PoseId| self.views.all().any(|view| view.keyframe.pose == *pose);
        let gone: Vec<PoseId> = poses.iter().copied().filter(|pose| !is_viewed(pose)).collect();
        self.remove_ties(graph, |tie| tie.pose.is_some_and(|pose| gone.contains(&pose)));
    }

    /// Ties it to a keyframe. What a robot that stands still sees again and again is no news: of one kind, a keyframe has
    /// one factor, the latest.
    fn tie_once(&mut self, graph: &mut Graph, factor: TieFactor, pose: PoseId) {
        self.remove_ties(graph, |tie| tie.pose == Some(pose) && tie.is_like(&factor));
        self.ties.push(Tie::new(graph, factor, Some(pose)));
    }

    pub(super) fn remove_ties(&mut self, graph: &mut Graph, is_gone: impl Fn(&Tie) -> bool) {
        self.ties.iter().filter(|t| is_gone(t)).for_each(|t| graph.remove_factor(t.in_graph));
        self.ties.retain(|tie| !is_gone(tie));
    }
}

/// How far people go between two images (m).
const STEP_M: f64 = 0.5;
/// An object whose class is less probable than this is hardly of it,
const UNLIKELY_CLASS: f64 = 0.2;
/// and a measurement made with what is known of that class has this share of its information.
const OTHER_CLASS_SHARE: f64 = 0.05;
