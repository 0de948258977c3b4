//! A quadratic form over some variables: what a linearised factor and what an eliminated part of the graph have in common.

use nalgebra::DMatrix;

/// `½ δᵀ H δ - bᵀ δ` over the stacked tangents `δ` of some variables: Gaussian information in canonical form.
#[derive(Clone, Debug)]
pub(super) struct Quadratic {
    /// Indices of the variables, in the order of their blocks.
    pub(super) variables: Vec<u32>,
    /// The lower triangle of `[[H], [bᵀ]]`, column after column.
    packed: Vec<f64>,
}

impl Quadratic {
    /// That says nothing yet.
    pub(super) fn empty(variables: Vec<u32>) -> Self {
        Self { variables, packed: Vec::new() }
    }

    /// Whether it says nothing yet.
    pub(super) fn is_empty(&self) -> bool {
        self.packed.is_empty()
    }

    /// Over `variables` from the lower triangle of the symmetric `augmented = [[H, b], [bᵀ, ·]]` that starts at row
    /// and column `first`.
    pub(super) fn from_augmented(
        variables: Vec<u32>,
        augmented: &DMatrix<f64>,
        first: usize,
    ) -> Self {
        let rows = augmented.nrows();
        let size = rows - first;
        let mut packed = Vec::with_capacity(size * (size + 1) / 2);
        for column in first..rows - 1 {
            packed.extend_from_slice(&augmented.column(column).as_slice()[column..]);
        }
        Self { variables, packed }
    }

    /// Adds the form times `weight` to the lower triangle of an augmented matrix; `rows[i]` is where its i-th scalar goes and the
    /// last one of `rows` is the row of the right-hand side.
    pub(super) fn add_to(&self, weight: f64, augmented: &mut DMatrix<f64>, rows: &[usize]) {
        let height = augmented.nrows();
        let target = augmented.as_mut_slice();
        let mut values = self.packed.iter();
        for (at, column) in rows.iter().enumerate().take(rows.len() - 1) {
            for (row, value) in rows[at..].iter().zip(&mut values) {
                let (low, high) = if row < column { (row, column) } else { (column, row) };
                target[low * height + high] += weight * value;
            }
        }
    }

    /// Its value at the stacked tangents `delta`.
    pub(super) fn value(&self, delta: &[f64]) -> f64 {
        let mut values = self.packed.iter();
        let mut sum = 0.0;
        for (at, column) in delta.iter().enumerate() {
            let diagonal = values.next().copied().unwrap_or(0.0) * 0.5 * column;
            let below: f64 = delta[at + 1..].iter().zip(&mut values).map(|(row, h)| row * h).sum();
            sum += column * (diagonal + below - values.next().copied().unwrap_or(0.0));
        }
        sum
    }

    /// The diagonal of `H`; empty for a form that says nothing yet.
    pub(super) fn diagonal(&self) -> impl Iterator<Item = f64> + '_ {
        // Columns shrink by one, and each has the right-hand side below it: the first of 2, 3, ... n + 1 elements last.
        let size = ((8.0 * self.packed.len() as f64 + 9.0).sqrt() as usize).saturating_sub(3) / 2;
        (0..size).scan(0, move |at, column| {
            let value = self.packed[*at];
            *at += size + 1 - column;
            Some(value)
        })
    }
}
