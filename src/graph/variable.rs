//! What is estimated: poses, ellipsoids and walls, and the handles by which factors name them.

use super::slots::{Slot, Slots};
use crate::geometry::{self, Ellipsoid, Pose, Wall};
use nalgebra::{DVector, SVector, Vector2, Vector6};

/// Handle of a variable in a graph, never given out twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VariableId(pub(super) Slot);

impl VariableId {
    /// Its place among the variables that are there. A later variable may get that of a removed one.
    pub fn index(self) -> usize {
        self.0.index as usize
    }
}

/// Handle of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PoseId(VariableId);

/// Handle of an ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EllipsoidId(VariableId);

/// Handle of a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WallId(VariableId);

/// What has a pose: poses themselves, and ellipsoids.
pub trait Body: Into<VariableId> {}

impl Body for PoseId {}
impl Body for EllipsoidId {}

impl From<WallId> for VariableId {
    fn from(id: WallId) -> Self {
        id.0
    }
}

impl From<PoseId> for VariableId {
    fn from(id: PoseId) -> Self {
        id.0
    }
}

impl From<EllipsoidId> for VariableId {
    fn from(id: EllipsoidId) -> Self {
        id.0
    }
}

/// Gives out handles, each once. Handles of a kind come from nowhere else, so that no factor is tied to a variable of
/// the wrong kind.
#[derive(Clone, Debug, Default)]
pub struct VariableIds {
    slots: Slots,
}

impl VariableIds {
    /// A handle for a new pose.
    pub fn next_pose(&mut self) -> PoseId {
        PoseId(VariableId(self.slots.take()))
    }

    /// A handle for a new ellipsoid.
    pub fn next_ellipsoid(&mut self) -> EllipsoidId {
        EllipsoidId(VariableId(self.slots.take()))
    }

    /// A handle for a new wall.
    pub fn next_wall(&mut self) -> WallId {
        WallId(VariableId(self.slots.take()))
    }

    /// Whether a handle was given out and its variable has not left since.
    pub(super) fn is_there(&self, id: VariableId) -> bool {
        self.slots.is_taken(id.0)
    }

    /// The handle of the variable at a place.
    pub(super) fn at(&self, index: u32) -> VariableId {
        VariableId(self.slots.at(index))
    }

    /// The variable at a place has left.
    pub(super) fn leave(&mut self, index: u32) {
        self.slots.leave(index);
    }
}

/// The value of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variable {
    /// `map_from_base` of a keyframe. Tangent: `[rotation, translation]`.
    Pose(Pose),
    /// An object in the map. Tangent: `[rotation, translation, log semi-axes]`.
    Ellipsoid(Ellipsoid),
    /// A wall of the map. Tangent: `[heading, distance]`.
    Wall(Wall),
}

impl Variable {
    /// Size of its tangent space: 6, 9 or 2.
    pub fn dimension(&self) -> usize {
        match self {
            Self::Pose(_) => 6,
            Self::Ellipsoid(_) => 9,
            Self::Wall(_) => 2,
        }
    }

    /// `self ⊞ delta`.
    ///
    /// # Panics
    /// When `delta` has another length than [`Variable::dimension`].
    pub fn retract(&self, delta: &[f64]) -> Self {
        assert_eq!(delta.len(), self.dimension(), "a step in another tangent space");
        match self {
            Self::Pose(pose) => {
                Self::Pose(geometry::retract(pose, &Vector6::from_column_slice(delta)))
            }
            Self::Ellipsoid(e) => {
                Self::Ellipsoid(e.retract(&SVector::<f64, 9>::from_column_slice(delta)))
            }
            Self::Wall(wall) => Self::Wall(wall.retract(&Vector2::from_column_slice(delta))),
        }
    }

    /// `other ⊟ self`: the `delta` for which `self.retract(delta)` is `other`.
    ///
    /// # Panics
    /// When the other is of another kind.
    pub fn local(&self, other: &Self) -> DVector<f64> {
        match (self, other) {
            (Self::Pose(from), Self::Pose(to)) => {
                DVector::from_column_slice(geometry::local(from, to).as_slice())
            }
            (Self::Ellipsoid(from), Self::Ellipsoid(to)) => {
                DVector::from_column_slice(from.local(to).as_slice())
            }
            (Self::Wall(from), Self::Wall(to)) => {
                DVector::from_column_slice(from.local(to).as_slice())
            }
            _ => unreachable!("{self:?} and {other:?} are of different kinds"),
        }
    }

    /// The same in a frame `new`, given in a frame `old`.
    pub(super) fn moved(&self, new_from_old: &Pose) -> Self {
        match self {
            Self::Pose(pose) => Self::Pose(new_from_old * pose),
            Self::Ellipsoid(e) => Self::Ellipsoid(e.transformed(new_from_old)),
            Self::Wall(wall) => Self::Wall(wall.transformed(new_from_old)),
        }
    }

    /// The pose of a [`Body`].
    ///
    /// # Panics
    /// When it is a wall.
    pub fn pose(&self) -> &Pose {
        match self {
            Self::Pose(pose) => pose,
            Self::Ellipsoid(ellipsoid) => &ellipsoid.pose,
            // Only handles of bodies are taken for what needs a pose.
            Self::Wall(wall) => unreachable!("a body's handle led to the wall {wall:?}"),
        }
    }

    /// The ellipsoid, if it is one.
    pub fn ellipsoid(&self) -> Option<&Ellipsoid> {
        match self {
            Self::Pose(_) | Self::Wall(_) => None,
            Self::Ellipsoid(ellipsoid) => Some(ellipsoid),
        }
    }

    /// The ellipsoid behind an [`EllipsoidId`].
    pub(super) fn known_ellipsoid(&self) -> &Ellipsoid {
        match self {
            // An `EllipsoidId` names an ellipsoid: only `VariableIds` makes them.
            Self::Pose(_) | Self::Wall(_) => unreachable!("an ellipsoid's handle led to {self:?}"),
            Self::Ellipsoid(ellipsoid) => ellipsoid,
        }
    }

    /// The wall behind a [`WallId`].
    pub(super) fn known_wall(&self) -> &Wall {
        match self {
            Self::Wall(wall) => wall,
            // As above.
            Self::Pose(_) | Self::Ellipsoid(_) => unreachable!("a wall's handle led to {self:?}"),
        }
    }
}
