//! Places in a vector that are used again, so that what comes and goes takes no more room than what is there at once.

/// A place, and how often it had been left before: two that are handed out are never equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Slot {
    pub(super) index: u32,
    generation: u32,
}

/// Which places are taken.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots {
    /// By place, how often it was left.
    generations: Vec<u32>,
    free: Vec<u32>,
}

impl Slots {
    /// The place that was left last, or a new one at the end.
    pub(super) fn take(&mut self) -> Slot {
        let index = self.free.pop().unwrap_or_else(|| {
            self.generations.push(0);
            self.generations.len() as u32 - 1
        });
        self.at(index)
    }

    /// Leaves a taken place.
    pub(super) fn leave(&mut self, index: u32) {
        self.generations[index as usize] += 1;
        self.free.push(index);
    }

    /// Whether it was handed out and not left since.
    pub(super) fn is_taken(&self, slot: Slot) -> bool {
        self.generations.get(slot.index as usize) == Some(&slot.generation)
    }

    /// The slot of a taken place.
    pub(super) fn at(&self, index: u32) -> Slot {
        Slot { index, generation: self.generations[index as usize] }
    }
}
