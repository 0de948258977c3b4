//! Lists that stay within a budget, however long the drive.

/// Entries at even steps. Beyond the budget every other one goes, and of later ones every other is not even made.
#[derive(Debug)]
pub(super) struct Thinned<T> {
    entries: Vec<(T, usize)>,
    stride: usize,
    offered: usize,
    cost: usize,
    budget: usize,
}

impl<T> Thinned<T> {
    pub(super) fn new(budget: usize) -> Self {
        Self { entries: Vec::new(), stride: 1, offered: 0, cost: 0, budget }
    }

    /// Whether the next entry is one of those to [`Thinned::add`]; to be asked once for each.
    pub(super) fn takes_next(&mut self) -> bool {
        let takes = self.offered.is_multiple_of(self.stride);
        self.offered += 1;
        takes
    }

    /// Adds an entry that costs a share of the budget.
    pub(super) fn add(&mut self, entry: T, cost: usize) {
        self.entries.push((entry, cost));
        self.cost += cost;
        while self.cost > self.budget && self.entries.len() > 1 {
            let mut at = 0;
            self.entries.retain(|_| {
                at += 1;
                at % 2 == 1
            });
            self.stride *= 2;
            self.cost = self.entries.iter().map(|(_, cost)| cost).sum();
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &T> {
        self.entries.iter().map(|(entry, _)| entry)
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.entries.iter_mut().map(|(entry, _)| entry)
    }

    pub(super) fn into_entries(self) -> Vec<T> {
        self.entries.into_iter().map(|(entry, _)| entry).collect()
    }
}
