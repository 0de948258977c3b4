//! The factorised system as a tree of cliques: Kaess et al. 2012, "iSAM2: Incremental smoothing and mapping using the
//! Bayes tree".

use super::quadratic::Quadratic;
use nalgebra::DMatrix;

/// `p(frontals | separator)`, and what everything below says about the separator.
#[derive(Clone, Debug)]
pub(super) struct Clique {
    /// Its variables: the frontals in the order of elimination, then the separator.
    pub(super) variables: Vec<u32>,
    /// How many of them are frontals.
    pub(super) frontals: usize,
    /// Columns of the Cholesky factor of the frontals; the last row is the solved right-hand side.
    pub(super) conditional: DMatrix<f64>,
    /// What the clique and all below it say about the separator.
    pub(super) message: Quadratic,
    /// The factors whose first eliminated variable is a frontal of this clique.
    pub(super) factors: Vec<u32>,
    pub(super) parent: Option<u32>,
    pub(super) children: Vec<u32>,
}

impl Clique {
    pub(super) fn frontals(&self) -> &[u32] {
        &self.variables[..self.frontals]
    }

    pub(super) fn separator(&self) -> &[u32] {
        &self.variables[self.frontals..]
    }
}

/// All cliques, and where each variable is a frontal.
#[derive(Clone, Debug, Default)]
pub(super) struct BayesTree {
    cliques: Vec<Option<Clique>>,
    free: Vec<u32>,
    /// By variable; nothing for one that is not in the tree.
    clique_of: Vec<Option<u32>>,
}

/// The part of the tree that an update makes anew: it contains the parent of each of its cliques.
#[derive(Clone, Debug, Default)]
pub(super) struct Top {
    /// Its cliques, in no particular order.
    pub(super) cliques: Vec<u32>,
    /// The cliques below it, which stay as they are.
    pub(super) orphans: Vec<u32>,
}

impl BayesTree {
    pub(super) fn clique(&self, index: u32) -> &Clique {
        match &self.cliques[index as usize] {
            Some(clique) => clique,
            None => unreachable!("links lead to cliques that are there"),
        }
    }

    fn clique_mut(&mut self, index: u32) -> &mut Clique {
        match &mut self.cliques[index as usize] {
            Some(clique) => clique,
            None => unreachable!("links lead to cliques that are there"),
        }
    }

    /// The clique in which a variable is a frontal.
    pub(super) fn clique_of(&self, variable: u32) -> Option<u32> {
        self.clique_of.get(variable as usize).copied().flatten()
    }

    /// The smallest top that holds all cliques of the `touched` variables, and of the `moved` ones also every clique
    /// that has them in its separator.
    pub(super) fn top(&self, touched: &[u32], moved: &[u32]) -> Top {
        let mut marked = Marked { is_marked: vec![false; self.cliques.len()], cliques: Vec::new() };
        for variable in touched.iter().chain(moved) {
            if let Some(clique) = self.clique_of(*variable) {
                self.mark_to_root(clique, &mut marked);
            }
        }
        for variable in moved {
            let mut below: Vec<u32> = self.clique_of(*variable).into_iter().collect();
            while let Some(index) = below.pop() {
                self.mark_to_root(index, &mut marked);
                let children = self.clique(index).children.iter();
                below.extend(children.filter(|c| self.clique(**c).separator().contains(variable)));
            }
        }
        let children = marked.cliques.iter().flat_map(|c| &self.clique(*c).children);
        let orphans = children.copied().filter(|c| !marked.is_marked[*c as usize]).collect();
        Top { cliques: marked.cliques, orphans }
    }

    /// All of the tree.
    pub(super) fn whole(&self) -> Top {
        let cliques =
            (0..self.cliques.len() as u32).filter(|c| self.cliques[*c as usize].is_some());
        Top { cliques: cliques.collect(), orphans: Vec::new() }
    }

    fn mark_to_root(&self, from: u32, marked: &mut Marked) {
        let mut next = Some(from);
        while let Some(index) = next.filter(|c| !marked.is_marked[*c as usize]) {
            marked.is_marked[index as usize] = true;
            marked.cliques.push(index);
            next = self.clique(index).parent;
        }
    }

    /// Takes the top out and puts other cliques in its place, parents before children, whose `parent` is an index
    /// into themselves. Returns where they went.
    pub(super) fn replace(&mut self, top: &Top, with: Vec<Clique>) -> Vec<u32> {
        for index in &top.cliques {
            if let Some(clique) = self.cliques[*index as usize].take() {
                clique.frontals().iter().for_each(|v| self.clique_of[*v as usize] = None);
                self.free.push(*index);
            }
        }
        let mut placed: Vec<u32> = Vec::with_capacity(with.len());
        for mut clique in with {
            let index = self.free.pop().unwrap_or_else(|| {
                self.cliques.push(None);
                self.cliques.len() as u32 - 1
            });
            clique.parent = clique.parent.map(|p| placed[p as usize]);
            if let Some(parent) = clique.parent {
                self.clique_mut(parent).children.push(index);
            }
            for variable in clique.frontals() {
                let variable = *variable as usize;
                self.clique_of.resize(self.clique_of.len().max(variable + 1), None);
                self.clique_of[variable] = Some(index);
            }
            self.cliques[index as usize] = Some(clique);
            placed.push(index);
        }
        for orphan in &top.orphans {
            self.adopt(*orphan);
        }
        placed
    }

    /// Hangs an orphan below the clique that holds its separator: the one that eliminates the first of it.
    fn adopt(&mut self, orphan: u32) {
        let holders = self.clique(orphan).separator().iter().filter_map(|v| self.clique_of(*v));
        let holds = |c: &u32| {
            let held = &self.clique(*c).variables;
            self.clique(orphan).separator().iter().all(|v| held.contains(v))
        };
        let parent = holders.into_iter().find(holds);
        self.clique_mut(orphan).parent = parent;
        if let Some(parent) = parent {
            self.clique_mut(parent).children.push(orphan);
        }
    }

    /// The cliques from that of `variable` up to its root.
    pub(super) fn path_to_root(&self, variable: u32) -> impl Iterator<Item = u32> + '_ {
        std::iter::successors(self.clique_of(variable), |c| self.clique(*c).parent)
    }
}

struct Marked {
    is_marked: Vec<bool>,
    cliques: Vec<u32>,
}
