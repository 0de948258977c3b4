//! What the map doubts: reported, so that a person can look after it.

use std::fmt;

/// Something that a sighting made doubtful. The map is as it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Notice {
    /// Measurements whose covariance is none were left out.
    Unusable {
        /// How many.
        measurements: usize,
    },
    /// One looks through the places of most objects in view: the pose is doubted, not the objects.
    MostlyEmpty {
        /// Objects that seem gone.
        empty: usize,
        /// Objects that should be visible.
        expected: usize,
    },
}

impl Notice {
    /// A name to count it by.
    pub fn reason(&self) -> &'static str {
        match self {
            Self::Unusable { .. } => "unusable_measurement",
            Self::MostlyEmpty { .. } => "pose_in_doubt",
        }
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unusable { measurements } => {
                write!(
                    f,
                    "{measurements} measurements were left out: not finite, or a covariance that is none"
                )
            }
            Self::MostlyEmpty { empty, expected } => write!(
                f,
                "{empty} of {expected} objects that should be visible seem gone at once; that is not believed, as the \
                 pose may be wrong"
            ),
        }
    }
}
