//! One step of the estimate: elimination, back-substitution, and whether the cost fell.

use super::{
    Graph, SolverSettings, UpdateReport,
    bayes_tree::Clique,
    changes::{Work, sorted},
    elimination::{Problem, eliminate, order},
    incremental::Scope,
    node::Price,
    substitution::{Solved, solve},
};

/// Costs of the factors whose variables moved.
#[derive(Debug, Default)]
struct Repriced {
    before: f64,
    after: f64,
    /// What they cost before.
    old: Vec<(u32, Price)>,
    /// Those of them that changed by more than their linear model can be trusted with.
    appraised: Vec<u32>,
}

impl Graph {
    /// The cliques that take the place of the top.
    pub(super) fn eliminate(&mut self, work: &Work, damping: f64) -> Result<Vec<Clique>, u32> {
        let mut place = std::mem::take(&mut self.place);
        let problem = Problem {
            nodes: &self.nodes,
            terms: &self.terms,
            tree: &self.tree,
            top: &work.top,
            variables: &work.variables,
            factors: &work.factors,
            damping,
        };
        let order = order(&problem, |v| work.recent.binary_search(&v).is_ok(), &mut place);
        let cliques = eliminate(&problem, &order, &mut place);
        self.place = place;
        cliques
    }

    /// Moves the estimate to the solution, damped until the cost does not rise: Levenberg 1944, Marquardt 1963.
    pub(super) fn descend(&mut self, mut work: Work, mut cliques: Vec<Clique>) -> UpdateReport {
        let mut damping: f64 = 0.0;
        let (solved, repriced, fell) = loop {
            work.top.cliques = self.tree.replace(&work.top, cliques);
            for factor in &work.factors {
                self.terms[*factor as usize]
                    .iter_mut()
                    .for_each(|term| term.weight = term.price.weight);
            }
            let solved = self.solve(&work);
            let repriced = self.reprice(&solved.announced, work.scope);
            let tolerance = match work.scope {
                Scope::Changes => COST_TOLERANCE + solved.kept_silent,
                Scope::Everything => ROUNDING * (1.0 + repriced.before),
            };
            // A comparison that a NaN fails.
            if repriced.after <= repriced.before + tolerance {
                break (solved, repriced, true);
            }
            self.take_back(&solved, &repriced);
            damping = (damping * 10.0).max(FIRST_DAMPING);
            if damping > LAST_DAMPING {
                break (solved, repriced, false);
            }
            // The undamped system was solved, and damping only makes it more definite.
            let Ok(damped) = self.eliminate(&work, damping) else {
                break (solved, repriced, false);
            };
            cliques = damped;
        };
        self.note_stale(&repriced.appraised);
        if damping > 0.0 {
            self.undamp(&mut work);
        }
        UpdateReport {
            cost_before: repriced.before,
            cost_after: if fell { repriced.after } else { repriced.before },
            eliminated: work.variables.len(),
            relinearized: work.moved.len(),
            changed: if fell { solved.before.len() } else { 0 },
            damping,
        }
    }

    fn solve(&mut self, work: &Work) -> Solved {
        let settings = match work.scope {
            Scope::Changes => self.settings,
            Scope::Everything => SolverSettings { propagation_tolerance: 0.0, ..self.settings },
        };
        solve(&self.tree, &work.top.cliques, &mut self.nodes, &settings)
    }

    /// Takes back a step that made the cost rise.
    fn take_back(&mut self, solved: &Solved, repriced: &Repriced) {
        for (variable, delta, announced) in &solved.before {
            let node = &mut self.nodes[*variable as usize];
            node.set_delta(*delta);
            node.announced = *announced;
        }
        for (factor, price) in &repriced.old {
            self.terms[*factor as usize].iter_mut().for_each(|term| term.price = *price);
        }
    }

    /// Leaves a tree without damping, so that covariances claim no more than the factors do, and the way that is left
    /// to its solution to the next update.
    fn undamp(&mut self, work: &mut Work) {
        if let Ok(cliques) = self.eliminate(work, 0.0) {
            work.top.cliques = self.tree.replace(&work.top, cliques);
        }
        self.stale.damped.clone_from(&work.variables);
    }

    /// Prices the factors whose variables moved.
    fn reprice(&mut self, moved: &[u32], scope: Scope) -> Repriced {
        self.pricing += 1;
        let mut repriced = Repriced::default();
        for factor in moved.iter().flat_map(|v| &self.nodes[*v as usize].factors).copied() {
            let Some(term) = &mut self.terms[factor as usize] else { continue };
            if std::mem::replace(&mut term.pricing, self.pricing) == self.pricing {
                continue;
            }
            let old = term.price;
            let rise = old.weight * (term.model(&self.nodes) - old.model);
            if scope == Scope::Changes && rise.abs() < SMALL_CHANGE * (1.0 + old.appraised) {
                term.price.cost = old.appraised + rise;
            } else {
                term.price = term.appraise(&self.nodes);
                repriced.appraised.push(factor);
            }
            repriced.before += old.cost;
            repriced.after += term.price.cost;
            repriced.old.push((factor, old));
        }
        repriced
    }

    /// Notes what the next step has to linearise anew or to weigh anew.
    fn note_stale(&mut self, appraised: &[u32]) {
        let tolerance = self.settings.linearization_tolerance;
        self.stale.moved = self.variables_where(appraised, |price| price.linear_error > tolerance);
        self.stale.reweighted =
            self.variables_where(appraised, |price| price.weight_error > tolerance);
    }

    /// The variables of those of the factors whose price is like that.
    fn variables_where(&self, factors: &[u32], is_so: impl Fn(&Price) -> bool) -> Vec<u32> {
        let terms = factors.iter().filter_map(|f| self.terms[*f as usize].as_ref());
        let found = terms.filter(|term| is_so(&term.price));
        sorted(found.flat_map(|term| term.variables()).copied().collect())
    }
}

/// A step may make the cost rise by this much: what changes below the thresholds of relinearisation amount to. One
/// factor that fits well costs several times as much.
const COST_TOLERANCE: f64 = 1e-3;
/// Of a sum over all factors, as a share of one plus the sum.
const ROUNDING: f64 = 1e-10;
/// As a share of one plus its cost: a smaller change of a factor's cost is taken from its linear model.
const SMALL_CHANGE: f64 = 0.02;
/// As information: of a standard deviation of 1 m or 1 rad, and of 0.1 mm.
const FIRST_DAMPING: f64 = 1.0;
const LAST_DAMPING: f64 = 1e8;
