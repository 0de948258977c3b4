//! Covariances of estimates, on demand.

use super::{Graph, VariableId, bayes_tree::Clique};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// A square root of covariances: what several of them share need not be computed again.
#[derive(Clone, Debug)]
pub struct CovarianceRoot {
    /// Its rows, by clique.
    rows: BTreeMap<u32, DMatrix<f64>>,
    columns: usize,
}

impl CovarianceRoot {
    /// The covariance of its variables with those of another root of the same graph: a row for each of its own tangents, a
    /// column for each of the other's.
    pub fn with(&self, other: &Self) -> DMatrix<f64> {
        let mut covariance = DMatrix::zeros(self.columns, other.columns);
        for (clique, rows) in &self.rows {
            if let Some(others) = other.rows.get(clique) {
                covariance.gemm_tr(1.0, rows, others, 1.0);
            }
        }
        covariance
    }
}

impl Graph {
    /// The joint covariance of some variables in the order given, of their tangents at the estimate: 6 rows for a pose,
    /// 9 for an ellipsoid, 2 for a wall.
    ///
    /// # Panics
    /// When one of them was removed.
    pub fn covariance(&self, variables: &[VariableId]) -> DMatrix<f64> {
        let root = self.covariance_root(variables);
        root.with(&root)
    }

    /// What the covariances of some variables, in the order given, follow from.
    ///
    /// With `Λ = L Lᵀ` they are `Yᵀ Y` for `L Y = E`, where the columns of `E` pick the variables: `Y` has rows only on
    /// the way from their cliques to the root, so that the cost does not depend on the rest of the map. (Kaess and
    /// Dellaert 2009 recover the same from the covariance's own recursion.)
    ///
    /// # Panics
    /// When one of them was removed.
    pub fn covariance_root(&self, variables: &[VariableId]) -> CovarianceRoot {
        let columns = variables.iter().map(|v| self.node(*v).dimension).sum();
        let mut open: BTreeMap<u32, DMatrix<f64>> = BTreeMap::new();
        let mut column = 0;
        for variable in variables {
            let dimension = self.nodes[variable.index()].dimension;
            let rows =
                open.entry(variable.0.index).or_insert_with(|| DMatrix::zeros(dimension, columns));
            (0..dimension).for_each(|i| rows[(i, column + i)] = 1.0);
            column += dimension;
        }
        let solved = |clique| {
            let rows = self.substitute(self.tree.clique(clique), &mut open, columns);
            (clique, rows)
        };
        let rows = self.cliques_upwards(variables).into_iter().map(solved).collect();
        CovarianceRoot { rows, columns }
    }

    /// The cliques between some variables and their roots, children before parents.
    fn cliques_upwards(&self, variables: &[VariableId]) -> Vec<u32> {
        let mut depth: BTreeMap<u32, usize> = BTreeMap::new();
        for variable in variables {
            let path: Vec<u32> = self.tree.path_to_root(variable.0.index).collect();
            for (at, clique) in path.iter().enumerate() {
                depth.insert(*clique, path.len() - at);
            }
        }
        let mut cliques: Vec<(usize, u32)> = depth.into_iter().map(|(c, d)| (d, c)).collect();
        cliques.sort_unstable_by(|a, b| b.cmp(a));
        cliques.into_iter().map(|(_, clique)| clique).collect()
    }

    /// One clique of the forward substitution: solves for its frontals and takes their share from its separator.
    fn substitute(
        &self,
        clique: &Clique,
        open: &mut BTreeMap<u32, DMatrix<f64>>,
        columns: usize,
    ) -> DMatrix<f64> {
        let frontal_rows = clique.conditional.ncols();
        let mut solved = DMatrix::zeros(frontal_rows, columns);
        let mut row = 0;
        for variable in clique.frontals() {
            let dimension = self.nodes[*variable as usize].dimension;
            if let Some(rows) = open.remove(variable) {
                solved.rows_mut(row, dimension).copy_from(&rows);
            }
            row += dimension;
        }
        let own = clique.conditional.rows(0, frontal_rows);
        own.solve_lower_triangular_unchecked_mut(&mut solved);
        for variable in clique.separator() {
            let dimension = self.nodes[*variable as usize].dimension;
            let share = clique.conditional.rows(row, dimension) * &solved;
            let rows = open.entry(*variable).or_insert_with(|| DMatrix::zeros(dimension, columns));
            *rows -= share;
            row += dimension;
        }
        solved
    }
}
