//! Which cliques an elimination will make, before any number is touched.

/// A clique of the Bayes tree to be.
#[derive(Debug)]
pub(super) struct PlannedClique {
    /// Its variables: those that are eliminated in it, in order, then its separator.
    pub(super) variables: Vec<u32>,
    /// How many of them are eliminated in it.
    pub(super) frontals: usize,
    /// The clique, earlier in the list, that holds its separator.
    pub(super) parent: Option<usize>,
    /// Indices of the quadratic forms that enter here.
    pub(super) forms: Vec<u32>,
}

/// The cliques for an elimination in `order` of variables tied by `forms`, parents before children.
///
/// `position` is scratch space for all variables of the graph; it is left with the place of each in `order`.
/// Kaess et al. 2012, algorithms 1 and 2.
pub(super) fn plan_cliques(
    order: &[u32],
    forms: &[&[u32]],
    position: &mut [u32],
) -> Vec<PlannedClique> {
    for (place, variable) in order.iter().enumerate() {
        position[*variable as usize] = place as u32;
    }
    let mut forms_at: Vec<Vec<u32>> = vec![Vec::new(); order.len()];
    for (index, form) in forms.iter().enumerate() {
        if let Some(first) = form.iter().map(|v| position[*v as usize]).min() {
            forms_at[first as usize].push(index as u32);
        }
    }
    let columns = fill(forms, &forms_at, position);
    let mut cliques: Vec<PlannedClique> = Vec::new();
    let mut clique_of = vec![0; order.len()];
    for place in (0..order.len()).rev() {
        let column = &columns[place];
        let parent = column.first().map(|p| clique_of[*p as usize]);
        // The column is part of its parent: as many variables means the same ones.
        let same = parent.filter(|p| column.len() == cliques[*p].variables.len());
        let at = same.unwrap_or_else(|| {
            let variables = column.iter().map(|p| order[*p as usize]).collect();
            cliques.push(PlannedClique { variables, frontals: 0, parent, forms: Vec::new() });
            cliques.len() - 1
        });
        let clique = &mut cliques[at];
        clique.variables.insert(0, order[place]);
        clique.frontals += 1;
        clique.forms.append(&mut forms_at[place]);
        clique_of[place] = at;
    }
    cliques
}

/// For each place in the order the later places that it is tied to when its turn comes, ascending.
fn fill(forms: &[&[u32]], forms_at: &[Vec<u32>], position: &[u32]) -> Vec<Vec<u32>> {
    let count = forms_at.len();
    let mut columns: Vec<Vec<u32>> = Vec::with_capacity(count);
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); count];
    let mut seen_by = vec![u32::MAX; count];
    for place in 0..count {
        let mut column = Vec::new();
        let mut tie = |other: u32| {
            if other > place as u32 && seen_by[other as usize] != place as u32 {
                seen_by[other as usize] = place as u32;
                column.push(other);
            }
        };
        for form in &forms_at[place] {
            forms[*form as usize].iter().for_each(|v| tie(position[*v as usize]));
        }
        for child in &children[place] {
            columns[*child as usize].iter().for_each(|other| tie(*other));
        }
        column.sort_unstable();
        if let Some(parent) = column.first() {
            children[*parent as usize].push(place as u32);
        }
        columns.push(column);
    }
    columns
}
