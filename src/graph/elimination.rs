//! From quadratic forms to cliques of the Bayes tree.

use super::{
    bayes_tree::{BayesTree, Clique, Top},
    front,
    node::{Node, Term},
    ordering::elimination_order,
    quadratic::Quadratic,
    symbolic::{PlannedClique, plan_cliques},
};
use nalgebra::DMatrix;

/// What is eliminated together: variables, the factors among them, and what the tree below says about them.
pub(super) struct Problem<'a> {
    pub(super) nodes: &'a [Node],
    pub(super) terms: &'a [Option<Term>],
    pub(super) tree: &'a BayesTree,
    pub(super) top: &'a Top,
    pub(super) variables: &'a [u32],
    pub(super) factors: &'a [u32],
    /// Added to the diagonal of the information matrix: Levenberg 1944.
    pub(super) damping: f64,
}

/// The order of elimination, with the variables for which `last` holds at its end.
pub(super) fn order(
    problem: &Problem<'_>,
    last: impl Fn(u32) -> bool,
    place: &mut [u32],
) -> Vec<u32> {
    for (at, variable) in problem.variables.iter().enumerate() {
        place[*variable as usize] = at as u32;
    }
    let local = |variables: &[u32]| variables.iter().map(|v| place[*v as usize]).collect();
    let ties: Vec<Vec<u32>> = problem.forms().map(|(form, _)| local(&form.variables)).collect();
    let last: Vec<bool> = problem.variables.iter().map(|v| last(*v)).collect();
    let order = elimination_order(problem.variables.len(), &ties, &last);
    order.into_iter().map(|at| problem.variables[at as usize]).collect()
}

/// Eliminates the variables in this order into cliques, parents before children.
///
/// # Errors
/// The variable that the factors leave undetermined.
pub(super) fn eliminate(
    problem: &Problem<'_>,
    order: &[u32],
    position: &mut [u32],
) -> Result<Vec<Clique>, u32> {
    let forms: Vec<(&Quadratic, f64)> = problem.forms().collect();
    let ties: Vec<&[u32]> = forms.iter().map(|(form, _)| form.variables.as_slice()).collect();
    let plan = plan_cliques(order, &ties, position);
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); plan.len()];
    for (at, clique) in plan.iter().enumerate() {
        clique.parent.into_iter().for_each(|parent| children[parent].push(at));
    }
    let mut done: Vec<Option<Clique>> = plan.iter().map(|_| None).collect();
    // The first row of each variable in the matrix that is being worked on; every entry that is read was just set.
    let row_of = position;
    for (at, planned) in plan.into_iter().enumerate().rev() {
        let mut assembled = Front::new(problem.nodes, &planned, row_of);
        planned.forms.iter().for_each(|form| assembled.add(forms[*form as usize], row_of));
        for child in &children[at] {
            done[*child].iter().for_each(|child| assembled.add((&child.message, 1.0), row_of));
        }
        assembled.damp(&planned, problem.damping);
        let factors =
            planned.forms.iter().filter_map(|f| problem.factors.get(*f as usize).copied());
        let factors = factors.collect();
        done[at] = Some(assembled.eliminate(planned, factors)?);
    }
    Ok(done.into_iter().flatten().collect())
}

impl Problem<'_> {
    /// The factors, then the messages of the orphans, each with its weight.
    fn forms(&self) -> impl Iterator<Item = (&Quadratic, f64)> {
        let factors = self.factors.iter().filter_map(|f| self.terms[*f as usize].as_ref());
        let orphans = self.top.orphans.iter().map(|c| (&self.tree.clique(*c).message, 1.0));
        factors.map(|term| (&term.quadratic, term.price.weight)).chain(orphans)
    }
}

/// The augmented information matrix of one clique.
struct Front<'a> {
    nodes: &'a [Node],
    matrix: DMatrix<f64>,
    frontal_rows: usize,
}

impl<'a> Front<'a> {
    fn new(nodes: &'a [Node], planned: &PlannedClique, row_of: &mut [u32]) -> Self {
        let (mut rows, mut frontal_rows) = (0, 0);
        for (at, variable) in planned.variables.iter().enumerate() {
            row_of[*variable as usize] = rows as u32;
            rows += nodes[*variable as usize].dimension;
            if at + 1 == planned.frontals {
                frontal_rows = rows;
            }
        }
        Self { nodes, matrix: DMatrix::zeros(rows + 1, rows + 1), frontal_rows }
    }

    fn add(&mut self, (form, weight): (&Quadratic, f64), row_of: &[u32]) {
        let mut rows = Vec::with_capacity(64);
        for variable in &form.variables {
            let first = row_of[*variable as usize] as usize;
            rows.extend(first..first + self.nodes[*variable as usize].dimension);
        }
        rows.push(self.matrix.nrows() - 1);
        form.add_to(weight, &mut self.matrix, &rows);
    }

    /// A pull towards the present estimate.
    fn damp(&mut self, planned: &PlannedClique, damping: f64) {
        if damping == 0.0 {
            return;
        }
        let last = self.matrix.nrows() - 1;
        let frontals = planned.variables[..planned.frontals].iter();
        let present = frontals.flat_map(|v| {
            let node = &self.nodes[*v as usize];
            &node.delta[..node.dimension]
        });
        for (row, delta) in present.enumerate() {
            self.matrix[(row, row)] += damping;
            self.matrix[(last, row)] += damping * delta;
        }
    }

    fn eliminate(mut self, planned: PlannedClique, factors: Vec<u32>) -> Result<Clique, u32> {
        let PlannedClique { variables, frontals, parent, .. } = planned;
        if let Err(column) = front::eliminate(&mut self.matrix, self.frontal_rows) {
            return Err(self.owner(&variables, column));
        }
        let separator = variables[frontals..].to_vec();
        let message = Quadratic::from_augmented(separator, &self.matrix, self.frontal_rows);
        Ok(Clique {
            conditional: self.matrix.columns(0, self.frontal_rows).into_owned(),
            message,
            variables,
            frontals,
            factors,
            parent: parent.map(|p| p as u32),
            children: Vec::new(),
        })
    }

    /// The variable that a column belongs to.
    fn owner(&self, variables: &[u32], column: usize) -> u32 {
        let mut end = 0;
        let owner = variables.iter().find(|v| {
            end += self.nodes[**v as usize].dimension;
            column < end
        });
        owner.copied().unwrap_or(variables[0])
    }
}
