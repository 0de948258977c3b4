//! Bytes that are not quite what they should be.
//!
//! The same cases come each time. `FUZZ_CASES=1000000 FUZZ_SEED=7` asks for more, and for others.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A source of mutants of some seeds.
pub(crate) struct Mutants<'a> {
    seeds: &'a [Vec<u8>],
    rng: ChaCha8Rng,
}

impl<'a> Mutants<'a> {
    pub(crate) fn of(seeds: &'a [Vec<u8>]) -> Self {
        let seed = number("FUZZ_SEED").unwrap_or(21);
        Self { seeds, rng: ChaCha8Rng::seed_from_u64(seed) }
    }

    /// One of the seeds, changed in up to eight places.
    pub(crate) fn next(&mut self) -> Vec<u8> {
        let mut bytes = self.seed().to_vec();
        let changes = self.rng.random_range(1..9);
        for _ in 0..changes {
            self.change(&mut bytes);
        }
        bytes
    }

    /// Any of this many.
    pub(crate) fn any(&mut self, below: usize) -> usize {
        self.rng.random_range(0..below.max(1))
    }

    fn seed(&mut self) -> &'a [u8] {
        let at = self.any(self.seeds.len());
        &self.seeds[at]
    }

    fn change(&mut self, bytes: &mut Vec<u8>) {
        /// Where arithmetic goes wrong.
        const EDGES: [u64; 9] =
            [0, 1, 0x7f, 0xff, 0xffff, 0x7fff_ffff, 0xffff_ffff, 0x7fff_ffff_ffff_ffff, u64::MAX];
        if bytes.is_empty() {
            bytes.extend(self.seed());
            return;
        }
        let at = self.any(bytes.len());
        let until = (at + 1 + self.any(64)).min(bytes.len());
        match self.any(8) {
            0 => bytes[at] ^= 1 << self.any(8),
            1 => bytes[at] = self.rng.random(),
            2 => bytes[at] = EDGES[self.any(EDGES.len())] as u8,
            3 | 4 => {
                let edge = EDGES[self.any(EDGES.len())].to_le_bytes();
                let wide = [2, 4, 8][self.any(3)].min(bytes.len() - at);
                bytes[at..at + wide].copy_from_slice(&edge[..wide]);
            }
            5 => drop(bytes.drain(at..until)),
            6 => {
                let again = bytes[at..until].to_vec();
                let to = self.any(bytes.len());
                bytes.splice(to..to, again);
            }
            _ => {
                let other = self.seed();
                let from = self.any(other.len());
                bytes.truncate(at);
                bytes.extend(&other[from..]);
            }
        }
    }
}

/// How many cases a target tries: `usual` of them unless more are asked for.
pub(crate) fn cases(usual: u64) -> u64 {
    number("FUZZ_CASES").unwrap_or(usual)
}

fn number(variable: &str) -> Option<u64> {
    std::env::var(variable).ok().map(|value| value.parse().unwrap())
}
