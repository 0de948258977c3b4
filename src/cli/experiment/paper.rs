//! The paper's own numbers: Liao et al. 2020, table 2.

use super::metric::Metric;

/// A block of the table.
pub(super) struct Block {
    /// What was recorded.
    pub(super) name: &'static str,
    /// Method; shape as the paper has it, trans (m), rot (deg).
    pub(super) rows: [(&'static str, [f64; 3]); 3],
}

pub(super) const TUM_AVERAGE: Block = Block {
    name: "TUM average, 12 objects",
    rows: [
        ("QuadricSLAM", [0.459, 0.074, 16.6]),
        ("DO", [0.383, 0.142, 11.9]),
        ("DwB", [0.357, 0.074, 10.4]),
    ],
};

pub(super) const REAL_ROBOT: Block = Block {
    name: "real robot, 6 objects",
    rows: [
        ("QuadricSLAM", [0.610, 0.544, 21.3]),
        ("DO", [0.416, 0.189, 19.0]),
        ("DwB", [0.277, 0.185, 19.5]),
    ],
};

/// What the numbers of a block's row are.
pub(super) const METRICS: [Metric; 3] =
    [Metric::PaperShape, Metric::TranslationM, Metric::RotationDeg];
