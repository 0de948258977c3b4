//! What an object is called, when detectors confuse classes.

use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// How detectors confuse classes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LabelSettings {
    /// Groups of classes that are taken for each other.
    pub alike: Vec<Vec<String>>,
    /// Probability that an object is given the name of another class of its group.
    pub confused: f64,
    /// Probability that it is given any other name.
    pub wrong: f64,
}

impl Default for LabelSettings {
    fn default() -> Self {
        let group = |labels: &[&str]| labels.iter().map(|label| (*label).to_owned()).collect();
        Self {
            alike: ALIKE.iter().map(|labels| group(labels)).collect(),
            confused: 0.1,
            wrong: 0.002,
        }
    }
}

/// Classes of COCO that look alike in rooms.
const ALIKE: &[&[&str]] = &[
    &["tv", "laptop"],
    &["keyboard", "laptop", "remote"],
    &["mouse", "remote", "cell phone"],
    &["chair", "couch", "bench"],
    &["couch", "bed"],
    &["cup", "bowl", "vase", "bottle", "wine glass"],
    &["potted plant", "vase"],
    &["suitcase", "backpack", "handbag"],
    &["suitcase", "refrigerator", "oven", "microwave"],
    &["dining table", "bench", "bed"],
    &["book", "laptop", "cell phone"],
];

impl LabelSettings {
    /// The other classes of a class' groups, each once.
    fn alike_to(&self, class: &str) -> BTreeSet<&str> {
        let groups = self.alike.iter().filter(|group| group.iter().any(|other| other == class));
        groups.flatten().map(String::as_str).filter(|other| *other != class).collect()
    }

    /// Posterior of the classes that an object was called, by Bayes' rule, when it was called each so often and all are
    /// as probable beforehand. Counts may be fractions: a detector's probabilities.
    ///
    /// Views of one object repeat each other's mistakes, so that any number of them says no more than [`INDEPENDENT_NAMES`].
    pub(super) fn posterior(&self, votes: &BTreeMap<String, f64>) -> BTreeMap<String, f64> {
        let total: f64 = votes.values().sum();
        let share = (INDEPENDENT_NAMES / total).min(1.0);
        // All names are wrong ones but those of the class and of its group: no sum over pairs.
        let (right, confused, wrong) =
            ((1.0 - self.confused).ln(), self.confused.ln(), self.wrong.ln());
        let log_likelihood = |class: &String| -> f64 {
            let of = |name: &str| votes.get(name).copied().unwrap_or(0.0);
            let alike: f64 = self.alike_to(class).into_iter().map(of).sum();
            let own = of(class);
            share * (own * right + alike * confused + (total - own - alike) * wrong)
        };
        let logs: Vec<f64> = votes.keys().map(log_likelihood).collect();
        let best = logs.iter().copied().fold(f64::MIN, f64::max);
        let likelihoods = logs.iter().map(|log| (log - best).exp());
        proper_belief(votes.keys().cloned().zip(likelihoods).collect())
    }

    /// Negative logarithm of the probability that a thing with this belief about its class is called so.
    pub(super) fn cost(&self, called: &[(String, f64)], belief: &BTreeMap<String, f64>) -> f64 {
        let total: f64 = called.iter().map(|(_, p)| p).sum();
        let believed: f64 = belief.values().sum();
        let of = |class: &str| belief.get(class).copied().unwrap_or(0.0);
        let of_name = |name: &str| {
            let alike: f64 = self.alike_to(name).into_iter().map(of).sum();
            let own = of(name);
            own * (1.0 - self.confused)
                + alike * self.confused
                + (believed - own - alike).max(0.0) * self.wrong
        };
        let likelihood: f64 = called.iter().map(|(name, p)| p / total * of_name(name)).sum();
        -likelihood.max(f64::MIN_POSITIVE).ln()
    }

    /// The same for two things of which each has a belief.
    pub(super) fn cost_of_same(&self, a: &BTreeMap<String, f64>, b: &BTreeMap<String, f64>) -> f64 {
        let called: Vec<(String, f64)> = a.iter().map(|(name, p)| (name.clone(), *p)).collect();
        self.cost(&called, b)
    }

    /// Whether things with this cost may be the same by what they are called: alike, or better.
    pub(super) fn is_alike(&self, cost: f64) -> bool {
        cost <= -(0.5 * self.confused).max(self.wrong).ln()
    }
}

/// A belief that sums to one and rules out no name that it has, from weights that need not: what underflowed, or was cut
/// by an earlier version's file, is improbable and no more. A belief that is one already stays as it is, to the last bit;
/// weights that say nothing are taken for equal ones.
pub fn proper_belief(mut weights: BTreeMap<String, f64>) -> BTreeMap<String, f64> {
    weights.values_mut().filter(|w| !(w.is_finite() && **w >= 0.0)).for_each(|w| *w = 0.0);
    let largest = weights.values().copied().fold(0.0, f64::max);
    let sum: f64 = weights.values().sum();
    let least = LEAST_BELIEF * largest;
    // Rounding of a division and back.
    let is_proper = (sum - 1.0).abs() < 1e-9 && weights.values().all(|w| *w >= 0.999 * least);
    if is_proper {
        return weights;
    }
    let scale = if largest > 0.0 { largest } else { 1.0 };
    weights.values_mut().for_each(|w| *w = (*w / scale).max(LEAST_BELIEF));
    let total: f64 = weights.values().sum();
    weights.values_mut().for_each(|w| *w /= total);
    weights
}

/// Names after which more of them say nothing new: ten views of each of five sides.
const INDEPENDENT_NAMES: f64 = 50.0;
/// No name that an object was ever given is less probable, beside its most probable one.
const LEAST_BELIEF: f64 = 1e-6;
