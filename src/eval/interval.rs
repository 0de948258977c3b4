//! How far the mean of a few runs can be trusted.

use serde::{Deserialize, Serialize};

/// A mean with the half width of its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Mean of the samples.
    pub mean: f64,
    /// `mean - half_width` to `mean + half_width` covers the expectation with 95 %; nothing for a single sample.
    pub half_width: Option<f64>,
    /// Number of samples.
    pub samples: usize,
}

impl Interval {
    /// Of independent samples, by Student's t distribution (Student 1908); nothing without a sample.
    pub fn of(samples: &[f64]) -> Option<Self> {
        let count = samples.len();
        if count == 0 {
            return None;
        }
        let mean = samples.iter().sum::<f64>() / count as f64;
        let half_width = (count > 1).then(|| {
            let squares: f64 = samples.iter().map(|x| (x - mean).powi(2)).sum();
            let variance = squares / (count - 1) as f64;
            student_quantile(count - 1) * (variance / count as f64).sqrt()
        });
        Some(Self { mean, half_width, samples: count })
    }

    /// Whether a value lies in the interval; a single sample only holds itself.
    ///
    /// Rounding in the last places is no difference.
    pub fn holds(&self, value: f64) -> bool {
        let rounding = 1e-9 * (1.0 + self.mean.abs());
        (value - self.mean).abs() <= self.half_width.unwrap_or(0.0) + rounding
    }
}

/// The 97.5 % quantile of Student's t distribution (Abramowitz and Stegun 1964, table 26.10).
///
/// Between the table's rows it is interpolated in the reciprocal of the degrees of freedom, to three decimals.
fn student_quantile(degrees_of_freedom: usize) -> f64 {
    const TO_30: [f64; 30] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160,
        2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056,
        2.052, 2.048, 2.045, 2.042,
    ];
    /// Reciprocal of 30, 40, 60 and 120 degrees of freedom and of infinitely many.
    const BEYOND: [(f64, f64); 5] = [
        (1.0 / 30.0, 2.042),
        (1.0 / 40.0, 2.021),
        (1.0 / 60.0, 2.000),
        (1.0 / 120.0, 1.980),
        (0.0, 1.960),
    ];
    if let Some(quantile) = TO_30.get(degrees_of_freedom.max(1) - 1) {
        return *quantile;
    }
    let reciprocal = 1.0 / degrees_of_freedom as f64;
    let above = BEYOND.partition_point(|(at, _)| *at > reciprocal).clamp(1, BEYOND.len() - 1);
    let [(from, low), (to, high)] = [BEYOND[above - 1], BEYOND[above]];
    low + (high - low) * (reciprocal - from) / (to - from)
}
