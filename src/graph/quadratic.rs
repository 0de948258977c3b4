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
        if self.is_empty() {
            return 0.0;
        }
        let (mut sum, mut rest) = (0.0, self.packed.as_slice());
        for (at, moved) in delta.iter().enumerate() {
            let below = &delta[at + 1..];
            let (column, others) = rest.split_at(below.len() + 2);
            rest = others;
            let (information, right) = (&column[1..=below.len()], column[below.len() + 1]);
            sum += moved * (0.5 * column[0] * moved + dot(information, below) - right);
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

/// The scalar product. Four sums side by side let the compiler use vector instructions: it may not reorder additions.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 4;
    let (a_lanes, b_lanes) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let tail = a_lanes.remainder().iter().zip(b_lanes.remainder());
    let tail: f64 = tail.map(|(a, b)| a * b).sum();
    let mut sums = [0.0; LANES];
    for (a, b) in a_lanes.zip(b_lanes) {
        (0..LANES).for_each(|lane| sums[lane] += a[lane] * b[lane]);
    }
    tail + (sums[0] + sums[1]) + (sums[2] + sums[3])
}
