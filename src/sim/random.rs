//! Seeded randomness: streams for sequential draws and a hash for draws per pixel.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A stream of random numbers that depends only on the seed and on what it is used for.
///
/// Each concern draws from its own stream, so that more detections do not move the furniture.
pub(super) struct Random(ChaCha8Rng);

/// What a stream of random numbers is used for.
#[derive(Clone, Copy)]
pub(super) enum Purpose {
    Scene,
    Trajectory,
    Odometry,
    Detector,
    Depth,
}

impl Random {
    /// The stream of a purpose; `index` tells frames apart.
    pub(super) fn new(seed: u64, purpose: Purpose, index: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(mixed(&[seed, purpose as u64, index])))
    }

    /// Uniform between two numbers.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Normal with mean zero.
    pub(super) fn normal(&mut self, sigma: f64) -> f64 {
        let (a, b) = (self.0.random::<f64>(), self.0.random::<f64>());
        sigma * box_muller(a, b)
    }

    /// True with the given probability.
    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }

    /// One of `choices`, which must not be empty.
    pub(super) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.0.random_range(0..choices.len())]
    }

    /// An integer from `low` to `high`, both included.
    pub(super) fn integer(&mut self, low: usize, high: usize) -> usize {
        self.0.random_range(low..=high)
    }
}

/// Draws that depend only on a key, never on the order of evaluation.
pub(super) struct PixelRandom(u64);

impl PixelRandom {
    /// The draws of one pixel of one frame.
    pub(super) fn new(frame_key: u64, pixel: u64) -> Self {
        Self(split_mix(frame_key ^ split_mix(pixel)))
    }

    /// What all pixels of a frame share.
    pub(super) fn frame_key(seed: u64, frame: u64) -> u64 {
        mixed(&[seed, Purpose::Depth as u64, frame])
    }

    /// Uniform in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = split_mix(self.0);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Standard normal.
    pub(super) fn normal(&mut self) -> f64 {
        let (a, b) = (self.unit(), self.unit());
        box_muller(a, b)
    }
}

/// Box and Muller 1958, from two uniform draws in [0, 1).
fn box_muller(a: f64, b: f64) -> f64 {
    (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// The output function of SplitMix64, Steele et al. 2014.
fn split_mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

fn mixed(words: &[u64]) -> u64 {
    words.iter().fold(0, |key, word| split_mix(key ^ split_mix(*word)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_draws_have_mean_zero_and_variance_one() {
        let n = 20_000;
        let mut stream = Random::new(1, Purpose::Scene, 0);
        let streamed: Vec<f64> = (0..n).map(|_| stream.normal(1.0)).collect();
        let hashed: Vec<f64> = (0..n).map(|i| PixelRandom::new(7, i).normal()).collect();
        for draws in [streamed, hashed] {
            let mean = draws.iter().sum::<f64>() / n as f64;
            let variance = draws.iter().map(|x| x * x).sum::<f64>() / n as f64;
            // Four standard errors of 20,000 draws.
            assert!(mean.abs() < 0.03, "mean {mean}");
            assert!((variance - 1.0).abs() < 0.04, "variance {variance}");
        }
    }

    #[test]
    fn purposes_do_not_share_draws() {
        let first = |purpose, index| Random::new(3, purpose, index).between(0.0, 1.0);
        assert_ne!(first(Purpose::Scene, 0), first(Purpose::Odometry, 0));
        assert_ne!(first(Purpose::Detector, 0), first(Purpose::Detector, 1));
    }
}
