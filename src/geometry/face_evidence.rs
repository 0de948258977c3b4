//! What one view tells of where a face of a box is.

/// A distance from the centre of a measured box along a face's outward normal, and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// (m), negative on the other side of the centre.
    pub position_m: f64,
    /// Standard deviation (m), positive.
    pub sigma_m: f64,
}

/// Where a face is, as far as one view tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceEvidence {
    /// The face was seen there.
    At(Reach),
    /// The face was not seen: the box reaches at least as far as what was seen of it, and at most as far as space is
    /// free or a wall allows.
    Between {
        /// The outermost reading.
        at_least: Reach,
        /// Nothing where no view looks past the box.
        at_most: Option<Reach>,
    },
}

impl FaceEvidence {
    /// By how many standard deviations a face at `position_m` contradicts the view, signed outwards, and the derivative
    /// of that number by the position (1/m). Both are zero within the bounds.
    pub fn whitened(&self, position_m: f64) -> (f64, f64) {
        let off =
            |reach: &Reach| ((position_m - reach.position_m) / reach.sigma_m, 1.0 / reach.sigma_m);
        match self {
            Self::At(at) => off(at),
            Self::Between { at_least, .. } if position_m < at_least.position_m => off(at_least),
            Self::Between { at_most: Some(most), .. } if position_m > most.position_m => off(most),
            Self::Between { .. } => (0.0, 0.0),
        }
    }

    /// The same with so much more uncertainty (standard deviation, m).
    #[must_use]
    pub fn widened(self, by_m: f64) -> Self {
        let wider = |reach: Reach| Reach { sigma_m: reach.sigma_m.hypot(by_m), ..reach };
        match self {
            Self::At(at) => Self::At(wider(at)),
            Self::Between { at_least, at_most } => {
                Self::Between { at_least: wider(at_least), at_most: at_most.map(wider) }
            }
        }
    }

    /// Whether all its numbers are finite and its standard deviations positive.
    pub fn is_valid(&self) -> bool {
        let is_valid = |reach: &Reach| {
            reach.position_m.is_finite() && reach.sigma_m.is_finite() && reach.sigma_m > 0.0
        };
        match self {
            Self::At(at) => is_valid(at),
            Self::Between { at_least, at_most } => {
                is_valid(at_least) && at_most.as_ref().is_none_or(is_valid)
            }
        }
    }
}
