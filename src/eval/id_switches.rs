//! How steadily a map knows the same thing again.

use serde::Serialize;
use std::collections::BTreeMap;

/// Switches of identity, after the CLEAR MOT metrics (Bernardin and Stiefelhagen 2008).
///
/// They need to know which object each single box was joined to. A map or a `result.mcap` does not hold that, so
/// `eval` cannot count them; `experiment` does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct IdSwitches {
    /// How often a true object was joined to another object of the map than the time before.
    pub switches: usize,
    /// Boxes of true objects that were joined to some object of the map.
    pub observations: usize,
}

impl IdSwitches {
    /// Counts over boxes in the order of time, each with the true object it shows and the object of the map it was
    /// joined to. Boxes that were joined to nothing are to be left out: a gap is no switch.
    pub fn count(joined: impl IntoIterator<Item = (u64, u64)>) -> Self {
        let mut last = BTreeMap::new();
        let mut counted = Self::default();
        for (true_id, id) in joined {
            counted.observations += 1;
            let before = last.insert(true_id, id);
            counted.switches += usize::from(before.is_some_and(|before| before != id));
        }
        counted
    }

    /// Switches in 200 observations; nothing without an observation.
    pub fn per_200(&self) -> Option<f64> {
        (self.observations > 0).then(|| 200.0 * self.switches as f64 / self.observations as f64)
    }
}
