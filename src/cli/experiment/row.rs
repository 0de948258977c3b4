//! What is compared: a row of a table is a way to set the pipeline.

use super::protocol::Protocol;
use crate::{
    mapping::{BoxOutline, KernelShape, Weighting},
    perception::{FitModel, SymmetryType},
    pipeline::Settings,
};

/// A method under test.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// How `--rows`, files and keys call it.
    pub(super) key: &'static str,
    /// How people call it.
    pub(super) name: &'static str,
    /// Changes the default settings, to which the protocol was applied before.
    pub(super) change: fn(&mut Settings, &Protocol),
    /// What is measured.
    pub(super) output: Output,
}

/// What of a run is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Output {
    /// The map at the end.
    Map,
    /// Each measurement by itself: the median over an object's measurements.
    SingleFrames,
}

/// All rows. A new one is an entry here, and its key in the tables and figures of `plan.rs` where it shall appear.
pub(super) const ROWS: &[Row] = &[
    Row {
        key: "one-frame",
        name: "one frame (median)",
        change: |_, _| (),
        output: Output::SingleFrames,
    },
    Row {
        key: "one-frame-asymmetric",
        name: "one frame (median), without symmetry",
        change: |settings, _| forget_symmetry(settings),
        output: Output::SingleFrames,
    },
    Row {
        key: "quadric-slam",
        name: "QuadricSLAM (boxes and support planes)",
        change: |settings, _| {
            settings.slam.observations = false;
            by_the_paper(settings);
        },
        output: Output::Map,
    },
    Row {
        key: "do",
        name: "DO (depth only)",
        change: |settings, _| {
            by_the_paper(settings);
            settings.slam.boxes = false;
        },
        output: Output::Map,
    },
    Row {
        key: "dwb",
        name: "DwB (depth with boxes)",
        change: |settings, _| by_the_paper(settings),
        output: Output::Map,
    },
    Row {
        key: "quadric-fit",
        name: "ours, fit of eq. (7)",
        change: |settings, _| settings.perception.fit = FitModel::Quadric,
        output: Output::Map,
    },
    Row {
        key: "asymmetric",
        name: "ours, without symmetry",
        change: |settings, _| forget_symmetry(settings),
        output: Output::Map,
    },
    Row {
        key: "ours-boxes",
        name: "ours, with box factors",
        change: |settings, _| settings.slam.boxes = true,
        output: Output::Map,
    },
    Row {
        key: "ours-huber",
        name: "ours, with Huber's kernel",
        change: |settings, _| settings.slam.kernel = KernelShape::Huber,
        output: Output::Map,
    },
    Row {
        key: "ours-faces",
        name: "ours, face by face",
        change: |settings, _| settings.slam.weighting = Weighting::Faces,
        output: Output::Map,
    },
    Row {
        key: "without-walls",
        name: "ours, without walls",
        change: |settings, _| settings.slam.walls = false,
        output: Output::Map,
    },
    Row { key: OURS, name: "ours", change: |_, _| (), output: Output::Map },
];

/// The row with everything on, which the others are compared with.
pub(super) const OURS: &str = "ours";

/// The row of a key.
pub(super) fn row(key: &str) -> Result<&'static Row, String> {
    ROWS.iter().find(|row| row.key == key).ok_or_else(|| {
        let keys: Vec<&str> = ROWS.iter().map(|row| row.key).collect();
        format!("there is no such row; there are {}", keys.join(", "))
    })
}

/// The paper's form of every part that a setting chooses: the fit of eq. (7), boxes round ellipses, `eps_z P_e` for all
/// components alike.
fn by_the_paper(settings: &mut Settings) {
    settings.perception.fit = FitModel::Quadric;
    settings.perception.glimpses = false;
    settings.slam.boxes = true;
    settings.slam.silhouettes = false;
    settings.slam.support = true;
    settings.slam.box_outline = BoxOutline::Ellipsoid;
    settings.slam.box_sigma_px = 1.0;
    settings.slam.box_sigma_ratio = 0.0;
    settings.slam.weighting = Weighting::Paper;
    settings.slam.eps_z = PAPER_EPS_Z;
    settings.slam.kernel = KernelShape::Huber;
}

/// Where DwB is best over both sequences, by the sweep of this setting; the paper's own best on its real robot.
const PAPER_EPS_Z: f64 = 1e5;

fn forget_symmetry(settings: &mut Settings) {
    let classes = &mut settings.perception.classes;
    classes.unlisted.symmetry = SymmetryType::None;
    classes.listed.values_mut().for_each(|class| class.symmetry = SymmetryType::None);
}
