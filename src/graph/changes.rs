//! Which part of the graph a step works on, and how it is undone.

use super::{
    Graph, Variable,
    bayes_tree::Top,
    incremental::{Scope, Staged, Stale},
    node::{Price, Tangent},
    quadratic::Quadratic,
};

/// What was staged, sorted out: lists are ascending, and what goes does not also come.
pub(super) struct Changes {
    /// Everything that was staged.
    staged: Staged,
    variables: Vec<u32>,
    factors: Vec<u32>,
    removed_factors: Vec<u32>,
    removed_variables: Vec<u32>,
}

/// What one step works on.
pub(super) struct Work {
    pub(super) scope: Scope,
    pub(super) top: Top,
    pub(super) variables: Vec<u32>,
    /// All factors that are eliminated.
    pub(super) factors: Vec<u32>,
    /// Of these the ones to be linearised first.
    outdated: Vec<u32>,
    /// Variables whose point of linearisation moves to the estimate.
    pub(super) moved: Vec<u32>,
    /// To be eliminated last: the newest, and what it is tied to.
    pub(super) recent: Vec<u32>,
}

/// What a failed step has to restore.
pub(super) struct Undo {
    moved: Vec<(u32, Variable, Tangent, Tangent)>,
    stiffness: Vec<(u32, Tangent)>,
    terms: Vec<(u32, (Quadratic, f64), Price)>,
}

impl Graph {
    /// Links the new factors to their variables and marks what is removed.
    pub(super) fn take_staged(&mut self) -> Changes {
        let staged = std::mem::take(&mut self.staged);
        let removed_variables = sorted(staged.removed_variables.clone());
        let mut removed_factors = staged.removed_factors.clone();
        for factor in &staged.factors {
            let Some(term) = &self.terms[*factor as usize] else { continue };
            for variable in term.variables() {
                self.nodes[*variable as usize].factors.push(*factor);
            }
        }
        for variable in &removed_variables {
            removed_factors.extend(&self.nodes[*variable as usize].factors);
        }
        let removed_factors = sorted(removed_factors);
        let left = |all: &[u32], removed: &[u32]| -> Vec<u32> {
            all.iter().copied().filter(|index| removed.binary_search(index).is_err()).collect()
        };
        Changes {
            variables: left(&staged.variables, &removed_variables),
            factors: left(&staged.factors, &removed_factors),
            removed_factors,
            removed_variables,
            staged,
        }
    }

    pub(super) fn work(&self, scope: Scope, changes: &Changes, stale: &Stale) -> Work {
        let Changes { removed_factors, removed_variables, .. } = changes;
        let recent = sorted(self.variables_of(&changes.factors));
        let is_staying = |v: &u32| removed_variables.binary_search(v).is_err();
        let mut moved: Vec<u32> = match scope {
            Scope::Changes => stale.moved.iter().copied().filter(is_staying).collect(),
            Scope::Everything => self.in_tree().filter(is_staying).collect(),
        };
        let mut touched = recent.clone();
        touched.extend(self.variables_of(removed_factors));
        touched.extend(stale.damped.iter().chain(&stale.reweighted));
        // A removed variable must vanish from every separator.
        let everywhere: Vec<u32> = moved.iter().chain(removed_variables).copied().collect();
        let top = match scope {
            Scope::Changes => self.tree.top(&touched, &everywhere),
            Scope::Everything => self.tree.whole(),
        };
        let cliques = || top.cliques.iter().map(|c| self.tree.clique(*c));
        let frontals = cliques().flat_map(|c| c.frontals().iter().copied()).filter(is_staying);
        let variables: Vec<u32> = frontals.chain(changes.variables.iter().copied()).collect();
        if scope == Scope::Changes {
            moved.extend(self.freely_movable(&top, &moved).filter(is_staying));
        }
        let is_left = |f: &u32| removed_factors.binary_search(f).is_err();
        let old = cliques().flat_map(|c| c.factors.iter().copied()).filter(is_left);
        let factors: Vec<u32> = old.chain(changes.factors.iter().copied()).collect();
        let mut outdated = changes.factors.clone();
        outdated.extend(moved.iter().flat_map(|v| &self.nodes[*v as usize].factors));
        outdated.retain(is_left);
        let outdated = sorted(outdated);
        Work { scope, top, variables, factors, outdated, moved, recent }
    }

    fn variables_of(&self, factors: &[u32]) -> Vec<u32> {
        let terms = factors.iter().filter_map(|f| self.terms[*f as usize].as_ref());
        terms.flat_map(|term| term.variables()).copied().collect()
    }

    /// Variables of the top that nothing below it depends on: linearising them anew makes no clique more to eliminate.
    fn freely_movable(&self, top: &Top, moved: &[u32]) -> impl Iterator<Item = u32> + '_ {
        let below = top.orphans.iter().flat_map(|c| self.tree.clique(*c).separator());
        let tied = sorted(below.chain(moved).copied().collect());
        let frontals: Vec<u32> =
            top.cliques.iter().flat_map(|c| self.tree.clique(*c).frontals()).copied().collect();
        frontals.into_iter().filter(move |v| {
            tied.binary_search(v).is_err() && !self.nodes[*v as usize].is_at_linearization()
        })
    }

    fn in_tree(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.nodes.len() as u32).filter(|v| self.tree.clique_of(*v).is_some())
    }

    /// Moves the points of linearisation to the estimate, linearises the factors there and prices them by it.
    pub(super) fn relinearize(&mut self, work: &Work) -> Undo {
        let mut undo = Undo { moved: Vec::new(), stiffness: Vec::new(), terms: Vec::new() };
        for variable in &work.moved {
            let node = &mut self.nodes[*variable as usize];
            undo.moved.push((*variable, node.linearized_at, node.delta, node.announced));
            node.relinearize();
        }
        for variable in sorted(self.variables_of(&work.outdated)) {
            undo.stiffness.push((variable, self.nodes[variable as usize].stiffness));
        }
        for factor in &work.outdated {
            let Some(term) = &mut self.terms[*factor as usize] else { continue };
            term.stiffen(&mut self.nodes, -1.0);
            let old = term.linearize(&self.nodes);
            term.stiffen(&mut self.nodes, 1.0);
            let price = term.appraise(&self.nodes);
            undo.terms.push((*factor, old, std::mem::replace(&mut term.price, price)));
        }
        undo
    }

    /// Takes out what was removed.
    pub(super) fn remove(&mut self, changes: &Changes) {
        changes.removed_factors.iter().for_each(|factor| self.unlink(*factor));
        for variable in &changes.removed_variables {
            self.ids.leave(*variable);
        }
    }

    fn unlink(&mut self, factor: u32) {
        let Some(term) = self.terms[factor as usize].take() else { return };
        self.factor_slots.leave(factor);
        term.stiffen(&mut self.nodes, -1.0);
        for variable in term.variables() {
            self.nodes[*variable as usize].factors.retain(|f| *f != factor);
        }
    }

    /// Takes back what was added and not yet solved for, backwards: the places that it leaves are taken again in the
    /// same order.
    pub(super) fn forget(&mut self, staged: &Staged) {
        staged.factors.iter().rev().for_each(|factor| self.unlink(*factor));
        staged.variables.iter().rev().for_each(|variable| self.ids.leave(*variable));
    }

    /// As if nothing had been staged.
    pub(super) fn roll_back(&mut self, changes: &Changes, undo: Undo) {
        for (factor, linearized, price) in undo.terms {
            if let Some(term) = &mut self.terms[factor as usize] {
                term.restore(linearized);
                term.price = price;
            }
        }
        self.forget(&changes.staged);
        for (variable, linearized_at, delta, announced) in undo.moved {
            let node = &mut self.nodes[variable as usize];
            (node.linearized_at, node.delta, node.announced) = (linearized_at, delta, announced);
        }
        for (variable, stiffness) in undo.stiffness {
            self.nodes[variable as usize].stiffness = stiffness;
        }
    }
}

/// Ascending, each once.
pub(super) fn sorted(mut indices: Vec<u32>) -> Vec<u32> {
    indices.sort_unstable();
    indices.dedup();
    indices
}
