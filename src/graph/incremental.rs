//! The graph of variables and factors, and its incremental solution.
//!
//! The factorised system is a Bayes tree (`bayes_tree.rs`), and an update makes only its top anew, as in iSAM2 (Kaess et
//! al. 2012). What decides how much is done anew is different, because iSAM2's thresholds are lengths and angles, and
//! what a millimetre is worth depends on who measured it:
//! - **A change is passed on by what it costs to keep it** (`substitution.rs`): a variable tells those below it in the
//!   tree when silence would raise the cost by more than a tolerance. Its stiffness, the diagonal of all information
//!   about it, turns a change into that cost.
//! - **Factors are linearised anew where their linear model is wrong** (`changes.rs`), as cost, and not where a variable
//!   has moved: a rigid shift of a whole loop moves everything and makes no relative pose less linear. What a robust
//!   kernel does to a factor's information is looked after in the same way, without linearising.
//! - **What is free is done**: variables of the top that nothing below depends on are linearised at the estimate
//!   whenever the top is made anew.
//! - **A step counts when the true cost does not rise** (`descent.rs`); otherwise it is taken back and damped. iSAM2 takes
//!   every step of Gauss-Newton, which outliers and poor initial values do not forgive.

use super::{
    EllipsoidId, Factor, PoseId, SolverSettings, Variable, VariableId, VariableIds, WallId,
    bayes_tree::BayesTree,
    node::{Node, Term},
    slots::{Slot, Slots},
};
use crate::geometry::{Ellipsoid, Pose, Wall};
use thiserror::Error;

/// Poses, ellipsoids and walls tied by factors, solved incrementally.
///
/// Additions and removals are gathered and take effect together in [`Graph::update`]: all of them or, if they would
/// leave a variable undetermined, none.
#[derive(Debug, Default)]
pub struct Graph {
    pub(super) settings: SolverSettings,
    pub(super) ids: VariableIds,
    pub(super) factor_slots: Slots,
    /// By variable.
    pub(super) nodes: Vec<Node>,
    /// By factor; nothing for one that was removed.
    pub(super) terms: Vec<Option<Term>>,
    pub(super) tree: BayesTree,
    pub(super) staged: Staged,
    pub(super) stale: Stale,
    /// Number of the round in which prices are compared.
    pub(super) pricing: u64,
    /// Scratch space, an element a variable.
    pub(super) place: Vec<u32>,
}

/// Identity of a factor, never used twice in a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FactorId(Slot);

/// What waits for the next update.
#[derive(Clone, Debug, Default)]
pub(super) struct Staged {
    pub(super) variables: Vec<u32>,
    pub(super) factors: Vec<u32>,
    pub(super) removed_factors: Vec<u32>,
    pub(super) removed_variables: Vec<u32>,
}

/// What the last step left to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Stale {
    /// Variables that stopped short of the solution.
    pub(super) damped: Vec<u32>,
    /// Variables of factors whose linear model has become bad.
    pub(super) moved: Vec<u32>,
    /// Variables of factors whose weight is no longer what they were eliminated with.
    pub(super) reweighted: Vec<u32>,
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

    /// From now on these tolerances count.
    pub fn change_settings(&mut self, settings: SolverSettings) {
        self.settings = settings;
    }

    /// Adds a pose; the next update needs factors that determine it.
    pub fn add_pose(&mut self, initial: Pose) -> PoseId {
        let id = self.ids.next_pose();
        self.stage(id.into(), Variable::Pose(initial));
        id
    }

    /// Adds an ellipsoid; the next update needs factors that determine it.
    pub fn add_ellipsoid(&mut self, initial: Ellipsoid) -> EllipsoidId {
        let id = self.ids.next_ellipsoid();
        self.stage(id.into(), Variable::Ellipsoid(initial));
        id
    }

    /// Adds a wall; the next update needs factors that determine it.
    pub fn add_wall(&mut self, initial: Wall) -> WallId {
        let id = self.ids.next_wall();
        self.stage(id.into(), Variable::Wall(initial));
        id
    }

    fn stage(&mut self, id: VariableId, initial: Variable) {
        self.staged.variables.push(id.0.index);
        if id.index() == self.nodes.len() {
            self.nodes.push(Node::new(initial));
            self.place.push(0);
        } else {
            self.nodes[id.index()] = Node::new(initial);
        }
    }

    /// Adds a factor between variables of this graph. One that is tied to a removed variable goes with it.
    pub fn add_factor(&mut self, factor: impl Factor + 'static) -> FactorId {
        let slot = self.factor_slots.take();
        if self.terms.len() == slot.index as usize {
            self.terms.push(None);
        }
        if factor.variables().iter().all(|v| self.ids.is_there(*v)) {
            self.terms[slot.index as usize] = Some(Term::new(Box::new(factor)));
            self.staged.factors.push(slot.index);
        } else {
            self.factor_slots.leave(slot.index);
        }
        FactorId(slot)
    }

    /// Takes a factor out with the next update. One that is not there any more is no harm.
    pub fn remove_factor(&mut self, factor: FactorId) {
        if self.factor_slots.is_taken(factor.0) {
            self.staged.removed_factors.push(factor.0.index);
        }
    }

    /// Takes a variable and all its factors out with the next update.
    pub fn remove_variable(&mut self, variable: impl Into<VariableId>) {
        let id = variable.into();
        if self.ids.is_there(id) {
            self.staged.removed_variables.push(id.0.index);
        }
    }

    /// How many factors the last update left at a variable.
    ///
    /// # Panics
    /// When the variable was removed.
    pub fn degree(&self, variable: impl Into<VariableId>) -> usize {
        self.node(variable.into()).factors.len()
    }

    pub(super) fn node(&self, id: VariableId) -> &Node {
        assert!(self.ids.is_there(id), "{id:?} was removed from the graph");
        &self.nodes[id.index()]
    }

    /// The estimate of a pose.
    ///
    /// # Panics
    /// When it was removed.
    pub fn pose(&self, id: PoseId) -> Pose {
        *self.node(id.into()).estimate.pose()
    }

    /// The estimate of an ellipsoid.
    ///
    /// # Panics
    /// When it was removed.
    pub fn ellipsoid(&self, id: EllipsoidId) -> Ellipsoid {
        *self.node(id.into()).estimate.known_ellipsoid()
    }

    /// The estimate of a wall.
    ///
    /// # Panics
    /// When it was removed.
    pub fn wall(&self, id: WallId) -> Wall {
        *self.node(id.into()).estimate.known_wall()
    }

    /// Sum of the costs of all factors at the estimate: half the squared whitened residuals, less by robust kernels.
    pub fn cost(&self) -> f64 {
        self.terms.iter().flatten().map(|term| term.appraise(&self.nodes).cost).sum()
    }

    /// Number of factors.
    pub fn factor_count(&self) -> usize {
        self.terms.iter().flatten().count()
    }

    /// Moves the estimate of an ellipsoid to where something outside the graph knows that it is, for instance because
    /// it began with an outlier: descent alone does not cross to another minimum of a robust cost. Takes effect with
    /// the next update.
    pub fn set_ellipsoid(&mut self, id: EllipsoidId, ellipsoid: Ellipsoid) {
        let variable = VariableId::from(id);
        self.nodes[variable.index()].estimate = Variable::Ellipsoid(ellipsoid);
        self.stale.moved.push(variable.0.index);
    }

    /// Moves the whole map: every variable and every place that a factor knows. No residual changes, so that the solution
    /// and its uncertainty are what they were. `new_from_old` turns about the vertical: what is upright stays so.
    pub fn move_map(&mut self, new_from_old: &Pose) {
        for node in &mut self.nodes {
            node.linearized_at = node.linearized_at.moved(new_from_old);
            node.estimate = node.estimate.moved(new_from_old);
        }
        for term in self.terms.iter_mut().flatten() {
            term.factor.move_map(new_from_old);
        }
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
        let changes = self.take_staged();
        let stale = std::mem::take(&mut self.stale);
        let work = self.work(scope, &changes, &stale);
        let undo = self.relinearize(&work);
        match self.eliminate(&work, 0.0) {
            Ok(cliques) => {
                self.remove(&changes);
                Ok(self.descend(work, cliques))
            }
            Err(variable) => {
                let undetermined = Undetermined { variable: self.ids.at(variable) };
                self.stale = stale;
                self.roll_back(&changes, undo);
                Err(undetermined)
            }
        }
    }
}
