//! In which order variables are eliminated.

use faer::{
    dyn_stack::{MemBuffer, MemStack},
    sparse::{SymbolicSparseColMatRef, linalg::amd},
};

/// An order of the variables `0..count` that keeps the factorisation sparse, those of `last` at its end.
///
/// Approximate minimum degree (Amestoy, Davis and Duff 1996). What the next keyframe will touch is eliminated last,
/// so that it stays near the root of the Bayes tree (Kaess et al. 2012, section 4.3).
pub(super) fn elimination_order(count: usize, cliques: &[Vec<u32>], last: &[bool]) -> Vec<u32> {
    let by_degree = minimum_degree(count, cliques);
    let (early, late): (Vec<u32>, Vec<u32>) =
        by_degree.into_iter().partition(|variable| !last[*variable as usize]);
    early.into_iter().chain(late).collect()
}

fn minimum_degree(count: usize, cliques: &[Vec<u32>]) -> Vec<u32> {
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); count];
    for clique in cliques {
        for (i, a) in clique.iter().enumerate() {
            for b in &clique[i + 1..] {
                neighbours[*a.max(b) as usize].push(*a.min(b));
            }
        }
    }
    let mut starts = Vec::with_capacity(count + 1);
    let mut rows = Vec::new();
    starts.push(0);
    for column in &mut neighbours {
        column.sort_unstable();
        column.dedup();
        rows.extend_from_slice(column);
        starts.push(rows.len() as u32);
    }
    let pattern = SymbolicSparseColMatRef::new_checked(count, count, &starts, None, &rows);
    let (mut order, mut inverse) = (vec![0_u32; count], vec![0_u32; count]);
    let mut memory = MemBuffer::new(amd::order_scratch::<u32>(count, rows.len()));
    let ordered = amd::order(
        &mut order,
        &mut inverse,
        pattern,
        amd::Control::default(),
        MemStack::new(&mut memory),
    );
    // OK because the order is only about speed: indices that overflow 32 bits leave it as it was.
    if ordered.is_err() {
        return (0..count as u32).collect();
    }
    order
}
