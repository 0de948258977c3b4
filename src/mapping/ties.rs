//! Factors of an object besides its measurements by direction.

use super::SlamSettings;
use crate::{
    geometry::{Outline, Plane, Pose},
    graph::{
        BoxObservation, EllipsoidId, EllipsoidObservation, EllipsoidPrior, Factor, FactorId, Graph,
        NoiseError, PoseId, SizePrior, SupportContact,
    },
};

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
    pub(super) fn to_support(
        graph: &mut Graph,
        (object, outline): (EllipsoidId, Outline),
        plane: Plane,
        settings: &SlamSettings,
    ) -> Result<Self, NoiseError> {
        let factor = SupportContact::new(object, outline, plane, settings.support_sigma_m)?;
        let factor = factor.with_kernel(settings.robust_kernel());
        Ok(Self::new(graph, TieFactor::Support(factor), None))
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
