//! The graph of variables and factors, and its incremental solution.

use super::{
    EllipsoidId, Factor, PoseId, SolverSettings, Variable, VariableId, VariableIds,
    bayes_tree::{BayesTree, Clique, Top},
    elimination::{Problem, eliminate, order},
    node::{Node, Price, Tangent, Term},
    quadratic::Quadratic,
    substitution::{Solved, solve},
};
use crate::geometry::{Ellipsoid, Pose};
use thiserror::Error;

/// Poses and ellipsoids tied by factors, solved incrementally.
///
/// Additions and removals are gathered and take effect together in [`Graph::update`]: all of them or, if they would
/// leave a variable undetermined, none.
#[derive(Debug, Default)]
pub struct Graph {
    pub(super) settings: SolverSettings,
    ids: VariableIds,
    /// By variable.
    pub(super) nodes: Vec<Node>,
    /// By factor; nothing for one that was removed.
    pub(super) terms: Vec<Option<Term>>,
    pub(super) tree: BayesTree,
    staged: Staged,
    /// Variables whose conditionals are damped, or that are far from where they were linearised.
    stale: Stale,
    /// Scratch space, an element a variable.
    place: Vec<u32>,
}

/// Identity of a factor, never used twice in a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FactorId(u32);

/// What waits for the next update.
#[derive(Clone, Debug, Default)]
struct Staged {
    variables: Vec<u32>,
    factors: Vec<u32>,
    removed_factors: Vec<u32>,
    removed_variables: Vec<u32>,
}

#[derive(Clone, Debug, Default)]
struct Stale {
    damped: Vec<u32>,
    moved: Vec<u32>,
    reweighted: Vec<u32>,
}

/// What an update did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpdateReport {
    /// Cost of the factors whose variables changed, before and after.
    pub cost_before: f64,
    /// Never more than before, but for rounding.
    pub cost_after: f64,
    /// Variables that were eliminated anew.
    pub eliminated: usize,
    /// Variables that were linearised anew.
    pub relinearized: usize,
    /// Variables whose estimate changed.
    pub changed: usize,
    /// Damping that was needed for the cost not to rise; 0 for none.
    pub damping: f64,
}

/// Why there is no solution.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the factors leave variable {} undetermined", variable.index())]
pub struct Undetermined {
    /// A variable that the factors leave open.
    pub variable: VariableId,
}

/// Which part of the graph an update works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// What is new, and what it makes necessary.
    Changes,
    /// Everything, linearised anew.
    Everything,
}

impl Graph {
    /// An empty graph.
    pub fn new(settings: SolverSettings) -> Self {
        Self { settings, ..Self::default() }
    }

    /// Adds a pose; the next update needs factors that determine it.
    pub fn add_pose(&mut self, initial: Pose) -> PoseId {
        self.stage(Variable::Pose(initial));
        self.ids.next_pose()
    }

    /// Adds an ellipsoid; the next update needs factors that determine it.
    pub fn add_ellipsoid(&mut self, initial: Ellipsoid) -> EllipsoidId {
        self.stage(Variable::Ellipsoid(initial));
        self.ids.next_ellipsoid()
    }

    fn stage(&mut self, initial: Variable) {
        self.staged.variables.push(self.nodes.len() as u32);
        self.nodes.push(Node::new(initial));
        self.place.push(0);
    }

    /// Adds a factor between variables of this graph.
    pub fn add_factor(&mut self, factor: impl Factor + 'static) -> FactorId {
        let index = self.terms.len() as u32;
        self.terms.push(Some(Term::new(Box::new(factor))));
        self.staged.factors.push(index);
        FactorId(index)
    }

    /// Takes a factor out with the next update. One that is not there any more is no harm.
    pub fn remove_factor(&mut self, factor: FactorId) {
        if self.terms[factor.0 as usize].is_some() {
            self.staged.removed_factors.push(factor.0);
        }
    }

    /// Takes a variable and all its factors out with the next update.
    pub fn remove_variable(&mut self, variable: impl Into<VariableId>) {
        let index = variable.into().0;
        if !self.nodes[index as usize].removed {
            self.staged.removed_variables.push(index);
        }
    }

    /// The estimate of a pose.
    pub fn pose(&self, id: PoseId) -> Pose {
        *self.nodes[VariableId::from(id).index()].estimate.pose()
    }

    /// The estimate of an ellipsoid.
    pub fn ellipsoid(&self, id: EllipsoidId) -> Ellipsoid {
        match self.nodes[VariableId::from(id).index()].estimate {
            Variable::Ellipsoid(ellipsoid) => ellipsoid,
            Variable::Pose(_) => unreachable!("ids of ellipsoids are made for ellipsoids"),
        }
    }

    /// Sum of the costs of all factors at the estimate: half the squared whitened residuals, less by robust kernels.
    pub fn cost(&self) -> f64 {
        self.terms.iter().flatten().map(|term| term.price(&self.nodes).cost).sum()
    }

    /// Number of factors.
    pub fn factor_count(&self) -> usize {
        self.terms.iter().flatten().count()
    }

    /// Forgets what was added and removed since the last update.
    pub fn discard(&mut self) {
        let staged = std::mem::take(&mut self.staged);
        self.forget(&staged);
    }

    /// Solves with what was added and removed since the last time: one Gauss-Newton step on what changed, damped until
    /// the true cost does not rise. Kaess et al. 2012, algorithm 8.
    ///
    /// # Errors
    /// When a variable would be undetermined. Then everything is as if nothing had been added or removed.
    pub fn update(&mut self) -> Result<UpdateReport, Undetermined> {
        self.step(Scope::Changes)
    }

    pub(super) fn step(&mut self, scope: Scope) -> Result<UpdateReport, Undetermined> {
        let staged = self.take_staged();
        let stale = std::mem::take(&mut self.stale);
        let work = self.work(scope, &staged, &stale);
        let undo = self.relinearize(&work);
        match self.eliminate(&work, 0.0) {
            Ok(cliques) => {
                self.remove(&staged);
                Ok(self.descend(work, cliques))
            }
            Err(variable) => {
                self.stale = stale;
                self.roll_back(&staged, undo);
                Err(Undetermined { variable: VariableId(variable) })
            }
        }
    }
}

/// What one step works on.
struct Work {
    top: Top,
    variables: Vec<u32>,
    /// All factors that are eliminated.
    factors: Vec<u32>,
    /// Of these the ones to be linearised first.
    outdated: Vec<u32>,
    moved: Vec<u32>,
    /// To be eliminated last: the newest, and what it is tied to.
    recent: Vec<u32>,
}

/// Costs of the factors whose variables moved.
#[derive(Debug, Default)]
struct Repriced {
    before: f64,
    after: f64,
    /// The old prices of those that changed by more than their linear model can be trusted with.
    old: Vec<(u32, Price)>,
}

/// What a failed step has to restore.
struct Undo {
    nodes: Vec<(u32, Node)>,
    terms: Vec<(u32, (Quadratic, f64))>,
}

impl Graph {
    /// Links the new factors to their variables and marks what is removed.
    fn take_staged(&mut self) -> Staged {
        let mut staged = std::mem::take(&mut self.staged);
        for variable in &staged.removed_variables {
            staged.removed_factors.extend(&self.nodes[*variable as usize].factors);
        }
        let is_gone = |f: &u32| staged.removed_factors.contains(f);
        staged.factors.retain(|f| !is_gone(f));
        staged.removed_factors.sort_unstable();
        staged.removed_factors.dedup();
        for factor in &staged.factors {
            let Some(term) = &mut self.terms[*factor as usize] else { continue };
            for variable in term.quadratic.variables.clone() {
                self.nodes[variable as usize].factors.push(*factor);
            }
        }
        for factor in &staged.factors {
            self.price(*factor);
        }
        staged
    }

    fn work(&self, scope: Scope, staged: &Staged, stale: &Stale) -> Work {
        let variables_of = |factors: &[u32]| -> Vec<u32> {
            let terms = factors.iter().filter_map(|f| self.terms[*f as usize].as_ref());
            terms.flat_map(|term| term.variables()).copied().collect()
        };
        let recent = variables_of(&staged.factors);
        let is_staying = |v: &u32| !staged.removed_variables.contains(v);
        let mut moved: Vec<u32> = match scope {
            Scope::Changes => stale.moved.iter().copied().filter(is_staying).collect(),
            Scope::Everything => self.alive().filter(is_staying).collect(),
        };
        let mut touched = recent.clone();
        touched.extend(variables_of(&staged.removed_factors));
        touched.extend(stale.damped.iter().chain(&stale.reweighted));
        // A removed variable must vanish from every separator.
        let everywhere: Vec<u32> = moved.iter().chain(&staged.removed_variables).copied().collect();
        let top = match scope {
            Scope::Changes => self.tree.top(&touched, &everywhere),
            Scope::Everything => self.tree.whole(),
        };
        let cliques = || top.cliques.iter().map(|c| self.tree.clique(*c));
        let frontals = cliques().flat_map(|c| c.frontals().iter().copied()).filter(is_staying);
        let variables: Vec<u32> = frontals.chain(staged.variables.iter().copied()).collect();
        if scope == Scope::Changes {
            moved.extend(self.freely_movable(&top, &moved).filter(is_staying));
        }
        let is_gone = |f: &u32| staged.removed_factors.binary_search(f).is_ok();
        let old = cliques().flat_map(|c| c.factors.iter().copied()).filter(|f| !is_gone(f));
        let factors: Vec<u32> = old.chain(staged.factors.iter().copied()).collect();
        let mut outdated = staged.factors.clone();
        outdated.extend(moved.iter().flat_map(|v| &self.nodes[*v as usize].factors));
        outdated.sort_unstable();
        outdated.dedup();
        outdated.retain(|f| !is_gone(f));
        Work { top, variables, factors, outdated, moved, recent }
    }

    /// Variables of the top that nothing below it depends on: linearising them anew makes no clique more to eliminate.
    fn freely_movable(&self, top: &Top, moved: &[u32]) -> impl Iterator<Item = u32> + '_ {
        let below = top.orphans.iter().flat_map(|c| self.tree.clique(*c).separator());
        let mut tied: Vec<u32> = below.chain(moved).copied().collect();
        tied.sort_unstable();
        let frontals: Vec<u32> =
            top.cliques.iter().flat_map(|c| self.tree.clique(*c).frontals()).copied().collect();
        frontals.into_iter().filter(move |v| {
            let node = &self.nodes[*v as usize];
            tied.binary_search(v).is_err() && node.delta != [0.0; 9]
        })
    }

    fn alive(&self) -> impl Iterator<Item = u32> + '_ {
        let is_in_tree = |v: &u32| self.tree.clique_of(*v).is_some();
        (0..self.nodes.len() as u32).filter(is_in_tree)
    }

    /// Moves the points of linearisation to the estimate and linearises the factors there.
    fn relinearize(&mut self, work: &Work) -> Undo {
        let mut undo = Undo { nodes: Vec::new(), terms: Vec::new() };
        for variable in &work.moved {
            let node = &mut self.nodes[*variable as usize];
            undo.nodes.push((*variable, node.clone()));
            node.relinearize();
        }
        for factor in &work.outdated {
            let Some(term) = &mut self.terms[*factor as usize] else { continue };
            stiffen(&mut self.nodes, &term.quadratic, -1.0);
            undo.terms.push((*factor, term.linearize(&self.nodes)));
            stiffen(&mut self.nodes, &term.quadratic, 1.0);
        }
        undo
    }

    /// The cliques that take the place of the top.
    fn eliminate(&mut self, work: &Work, damping: f64) -> Result<Vec<Clique>, u32> {
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
        let order = order(&problem, |v| work.recent.contains(&v), &mut place);
        let cliques = eliminate(&problem, &order, &mut place);
        self.place = place;
        cliques
    }

    /// Moves the estimate to the solution, damped until the cost does not rise: Levenberg 1944, Marquardt 1963.
    fn descend(&mut self, mut work: Work, mut cliques: Vec<Clique>) -> UpdateReport {
        let mut damping: f64 = 0.0;
        loop {
            work.top.cliques = self.tree.replace(&work.top, cliques);
            for factor in &work.factors {
                self.terms[*factor as usize]
                    .iter_mut()
                    .for_each(|term| term.weight = term.price.weight);
            }
            let Solved { before, announced, kept_silent } =
                solve(&self.tree, &work.top.cliques, &mut self.nodes, &self.settings);
            let Repriced { before: cost_before, after: cost_after, old: touched } =
                self.reprice(&announced);
            // A comparison that a NaN fails.
            let fell = cost_after <= cost_before + kept_silent + COST_TOLERANCE;
            let next = (damping * 10.0).max(FIRST_DAMPING);
            let again = if fell { None } else { self.retry(&before, &touched, &work, next) };
            let Some(damped) = again else {
                let tolerance = self.settings.linearization_tolerance;
                self.stale.moved =
                    self.variables_of(&touched, |price| price.linear_error > tolerance);
                self.stale.reweighted =
                    self.variables_of(&touched, |price| price.weight_error > tolerance);
                if damping > 0.0 {
                    self.stale.damped.clone_from(&work.variables);
                }
                return UpdateReport {
                    cost_before,
                    cost_after: if fell { cost_after } else { cost_before },
                    eliminated: work.variables.len(),
                    relinearized: work.moved.len(),
                    changed: before.len(),
                    damping,
                };
            };
            (cliques, damping) = (damped, next);
        }
    }

    /// Takes back a step that made the cost rise and eliminates with more damping; nothing when that leads nowhere.
    fn retry(
        &mut self,
        before: &[(u32, Tangent)],
        touched: &[(u32, Price)],
        work: &Work,
        damping: f64,
    ) -> Option<Vec<Clique>> {
        for (variable, delta) in before {
            self.nodes[*variable as usize].set_delta(*delta);
        }
        for (factor, price) in touched {
            self.terms[*factor as usize].iter_mut().for_each(|term| term.price = *price);
        }
        if damping > LAST_DAMPING {
            return None;
        }
        self.eliminate(work, damping).ok()
    }

    /// Prices the factors whose variables moved.
    fn reprice(&mut self, moved: &[u32]) -> Repriced {
        let mut touched: Vec<u32> =
            moved.iter().flat_map(|v| &self.nodes[*v as usize].factors).copied().collect();
        touched.sort_unstable();
        touched.dedup();
        let mut repriced = Repriced::default();
        for factor in touched {
            let Some(term) = &self.terms[factor as usize] else { continue };
            let old = term.price;
            let rise = old.weight * (term.model(&self.nodes) - old.model);
            repriced.before += old.cost;
            if rise.abs() < SMALL_CHANGE * (1.0 + old.cost) {
                repriced.after += old.cost + rise;
                continue;
            }
            repriced.old.push((factor, self.price(factor)));
            repriced.after += self.terms[factor as usize].iter().map(|t| t.price.cost).sum::<f64>();
        }
        repriced
    }

    /// The variables of those of the factors whose price has become bad.
    fn variables_of(&self, touched: &[(u32, Price)], is_bad: impl Fn(&Price) -> bool) -> Vec<u32> {
        let terms = touched.iter().filter_map(|(f, _)| self.terms[*f as usize].as_ref());
        let bad = terms.filter(|term| is_bad(&term.price));
        let mut variables: Vec<u32> = bad.flat_map(|term| term.variables()).copied().collect();
        variables.sort_unstable();
        variables.dedup();
        variables
    }

    /// Prices a factor at the estimate; returns what it was.
    fn price(&mut self, factor: u32) -> Price {
        let Some(term) = &self.terms[factor as usize] else { return Price::default() };
        let price = term.price(&self.nodes);
        let Some(term) = &mut self.terms[factor as usize] else { return price };
        std::mem::replace(&mut term.price, price)
    }

    fn remove(&mut self, staged: &Staged) {
        for factor in &staged.removed_factors {
            self.unlink(*factor);
        }
        for variable in &staged.removed_variables {
            self.nodes[*variable as usize].removed = true;
        }
    }

    fn unlink(&mut self, factor: u32) {
        let Some(term) = self.terms[factor as usize].take() else { return };
        stiffen(&mut self.nodes, &term.quadratic, -1.0);
        for variable in term.variables() {
            self.nodes[*variable as usize].factors.retain(|f| *f != factor);
        }
    }

    /// As if nothing had been staged.
    fn roll_back(&mut self, staged: &Staged, undo: Undo) {
        for (variable, node) in undo.nodes {
            self.nodes[variable as usize] = node;
        }
        for (factor, linearized) in undo.terms {
            if let Some(term) = &mut self.terms[factor as usize] {
                term.restore(linearized);
            }
        }
        self.forget(staged);
    }

    fn forget(&mut self, staged: &Staged) {
        staged.factors.iter().for_each(|factor| self.unlink(*factor));
        for variable in &staged.variables {
            self.nodes[*variable as usize].removed = true;
        }
    }
}

/// Adds what a factor says about its variables to their stiffness.
fn stiffen(nodes: &mut [Node], form: &Quadratic, sign: f64) {
    let mut diagonal = form.diagonal();
    for variable in &form.variables {
        let node = &mut nodes[*variable as usize];
        let own = node.stiffness.iter_mut().take(node.dimension).zip(&mut diagonal);
        own.for_each(|(stiffness, information)| *stiffness += sign * information);
    }
}

/// A step may make the cost rise by this much: what changes below the thresholds of relinearisation amount to. One
/// factor that fits well costs several times as much.
const COST_TOLERANCE: f64 = 1e-3;
/// As a share of one plus its cost: a smaller change of a factor's cost is taken from its linear model.
const SMALL_CHANGE: f64 = 0.02;
/// As information: of a standard deviation of 1 m or 1 rad, and of 0.1 mm.
const FIRST_DAMPING: f64 = 1.0;
const LAST_DAMPING: f64 = 1e8;
