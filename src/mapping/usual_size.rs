//! What the class of an object says of what was not seen of it.

use super::{
    MapObject, SlamSettings,
    ties::{Tie, TieFactor},
};
use crate::graph::{Graph, NoiseError, SizePrior};
use nalgebra::Vector3;

impl MapObject {
    /// Expects it to be about as large as things of its class are, if the labels of this measurement say what it is.
    pub(super) fn expect_usual_size(
        &mut self,
        graph: &mut Graph,
        usual_m: Option<[f64; 3]>,
        labels: &[(String, f64)],
        settings: &SlamSettings,
    ) -> Result<(), NoiseError> {
        let is_its_class = labels.first().is_some_and(|(label, _)| label == self.label());
        let Some(usual_m) = usual_m.filter(|_| is_its_class) else { return Ok(()) };
        // What it was taken for before was another class.
        self.remove_ties(graph, |tie| tie.usual_m().is_some_and(|other_m| other_m != usual_m));
        if self.ties.iter().any(Tie::tells_size) {
            return Ok(());
        }
        let usual = 0.5 * Vector3::from(usual_m);
        let prior = SizePrior::new(self.variable, usual, USUAL_SIZE_SIGMAS)?;
        let prior = prior.with_kernel(settings.robust_kernel());
        self.ties.push(Tie::new(graph, TieFactor::Size(prior, usual_m), None));
        Ok(())
    }
}

/// Standard deviations of the logarithms of how large things of a class are, and of each extent besides.
const USUAL_SIZE_SIGMAS: [f64; 2] = [0.2, 0.2];
