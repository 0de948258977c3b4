//! An object of the map.

use super::fusion::Estimate;
use crate::{
    geometry::{Ellipsoid, Outline},
    time::Stamp,
};
use nalgebra::SMatrix;
use std::{collections::BTreeMap, fmt};

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
    pub(super) support_heights: u32,
    pub(super) estimate: Estimate,
    /// Sum of the detector's probabilities by label.
    pub(super) votes: BTreeMap<String, f64>,
    /// Probability that all measurements were false.
    pub(super) doubt: f64,
}

impl MapObject {
    /// Its ellipsoid in the map frame, upright, with the longer horizontal axis first.
    pub fn ellipsoid(&self) -> Ellipsoid {
        self.estimate.ellipsoid().quarter_turned(self.quarters())
    }

    /// Covariance of `[rotation, translation, log semi-axes]` of [`MapObject::ellipsoid`], a right perturbation in
    /// the object's frame.
    pub fn covariance(&self) -> SMatrix<f64, 9, 9> {
        self.estimate.covariance(self.quarters())
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
        let s = self.estimate.ellipsoid().semi_axes;
        i64::from(s.y > s.x)
    }
}
