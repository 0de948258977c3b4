//! The dense matrix in which the variables of one clique are eliminated.

use faer::{
    Accum, MatMut, Par, Spec,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{
        cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch},
        matmul::triangular::{BlockStructure, matmul},
        triangular_solve::solve_lower_triangular_in_place,
    },
    reborrow::{Reborrow, ReborrowMut},
};
use nalgebra::DMatrix;

/// Eliminates the first `count` columns of a symmetric matrix of which the lower triangle is given.
///
/// Afterwards these columns hold the Cholesky factor and the rest its Schur complement (Duff and Reid 1983).
///
/// # Errors
/// The column in which the matrix proves to be singular.
pub(super) fn eliminate(front: &mut DMatrix<f64>, count: usize) -> Result<(), usize> {
    let size = front.nrows();
    let diagonal: Vec<f64> = (0..count).map(|i| front[(i, i)]).collect();
    let matrix = MatMut::from_column_major_slice_mut(front.as_mut_slice(), size, size);
    let (mut own, _, mut below, rest) = matrix.split_at_mut(count, count);
    let mut memory =
        MemBuffer::new(cholesky_in_place_scratch::<f64>(count, Par::Seq, Spec::default()));
    let stack = MemStack::new(&mut memory);
    cholesky_in_place(own.rb_mut(), LltRegularization::default(), Par::Seq, stack, Spec::default())
        .map_err(|faer::linalg::cholesky::llt::factor::LltError::NonPositivePivot { index }| {
            index
        })?;
    if let Some(lost) = (0..count).find(|i| is_lost(own[(*i, *i)], diagonal[*i])) {
        return Err(lost);
    }
    solve_lower_triangular_in_place(own.rb(), below.rb_mut().transpose_mut(), Par::Seq);
    matmul(
        rest,
        BlockStructure::TriangularLower,
        Accum::Add,
        below.rb(),
        BlockStructure::Rectangular,
        below.rb().transpose(),
        BlockStructure::Rectangular,
        -1.0,
        Par::Seq,
    );
    Ok(())
}

/// Whether of a diagonal element nothing but rounding is left.
fn is_lost(pivot: f64, diagonal: f64) -> bool {
    const ROUNDING: f64 = 1e-13;
    pivot.is_nan() || pivot * pivot <= ROUNDING * diagonal
}
