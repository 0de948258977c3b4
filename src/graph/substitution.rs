//! From the factorised system to its solution.

use super::{
    SolverSettings,
    bayes_tree::{BayesTree, Clique},
    node::{Node, Tangent},
    quadratic::dot,
};

/// The outcome of a back-substitution.
#[derive(Debug, Default)]
pub(super) struct Solved {
    /// Each variable that was solved for, with what its solution was and what was known of it.
    pub(super) before: Vec<(u32, Tangent, Tangent)>,
    /// Of these the ones whose change was passed on.
    pub(super) announced: Vec<u32>,
    /// By how much the cost is higher, at most, than if all changes had been passed on.
    pub(super) kept_silent: f64,
}

/// Solves for the variables of the `fresh` cliques, and below them as far as changes matter: Kaess et al. 2012,
/// algorithm 6 ("wildfire"), with a threshold on the cost instead of the change itself.
pub(super) fn solve(
    tree: &BayesTree,
    fresh: &[u32],
    nodes: &mut [Node],
    settings: &SolverSettings,
) -> Solved {
    let mut solved = Solved::default();
    let mut is_fresh = vec![false; fresh.iter().max().map_or(0, |c| *c as usize + 1)];
    fresh.iter().for_each(|c| is_fresh[*c as usize] = true);
    let is_fresh = |c: u32| is_fresh.get(c as usize).copied().unwrap_or(false);
    let roots = fresh.iter().filter(|c| tree.clique(**c).parent.is_none_or(|p| !is_fresh(p)));
    let mut open: Vec<u32> = roots.copied().collect();
    let mut announced = vec![false; nodes.len()];
    let mut solution = Vec::new();
    while let Some(index) = open.pop() {
        let clique = tree.clique(index);
        gather(clique, nodes, &mut solution);
        solve_clique(clique, &mut solution);
        let mut rest = solution.as_slice();
        for variable in clique.frontals() {
            let node = &mut nodes[*variable as usize];
            let (own, others) = rest.split_at(node.dimension);
            rest = others;
            solved.before.push((*variable, node.delta, node.announced));
            let mut delta = [0.0; 9];
            delta[..own.len()].copy_from_slice(own);
            node.set_delta(delta);
            let cost = node.cost_of_silence();
            if cost > settings.propagation_tolerance {
                node.announced = node.delta;
                announced[*variable as usize] = true;
                solved.announced.push(*variable);
            } else {
                solved.kept_silent += cost;
            }
        }
        let concerned = |c: &&u32| {
            is_fresh(**c) || tree.clique(**c).separator().iter().any(|v| announced[*v as usize])
        };
        open.extend(clique.children.iter().filter(concerned));
    }
    solved
}

/// The present solution of all variables of a clique.
fn gather(clique: &Clique, nodes: &[Node], solution: &mut Vec<f64>) {
    solution.clear();
    for variable in &clique.variables {
        let node = &nodes[*variable as usize];
        solution.extend_from_slice(&node.delta[..node.dimension]);
    }
}

/// Replaces the solution of the clique's frontals by that for the given separator.
fn solve_clique(clique: &Clique, solution: &mut [f64]) {
    let (rows, columns) = clique.conditional.shape();
    for column in (0..columns).rev() {
        let factor = clique.conditional.column(column);
        let factor = factor.as_slice();
        let known = dot(&factor[column + 1..rows - 1], &solution[column + 1..]);
        solution[column] = (factor[rows - 1] - known) / factor[column];
    }
}
