//! Settings of the solver.

use serde::{Deserialize, Serialize};

/// When the incremental solver works again on what it has. Both tolerances are costs, half a squared whitened residual:
/// they have no units and mean the same for a precise sensor and a coarse one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SolverSettings {
    /// A factor is linearised anew when its linear model misses its cost by more than this share of one plus the cost.
    pub linearization_tolerance: f64,
    /// A variable's change is kept from the rest of the map as long as that raises the cost by less than this.
    pub propagation_tolerance: f64,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self { linearization_tolerance: 0.1, propagation_tolerance: 0.2 }
    }
}
