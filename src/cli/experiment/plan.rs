//! Which tables and figures there are, and which trials they need.

use super::{
    metric::Metric,
    paper,
    protocol::{DRIFTING_AUTOMATIC, DRIFTING_GIVEN, PAPER, Protocol, STRETCHED_GIVEN, TRUE_GIVEN},
    row::{OURS, Row},
    sequence::{
        CROWDED_FORWARD, CROWDED_ORBIT, DESK_FORWARD, DESK_ORBIT, HOME_BUMPED, HOME_D435,
        HOME_FORWARD, HOME_LOOP, HOME_LOW, HOME_NANO, HOME_OAKD, HOME_ORBIT, OFFICE_FORWARD,
        OFFICE_LOOP, Sequence,
    },
};
use crate::pipeline::Settings;

/// A table: a block a sequence, in it a line for each protocol and row.
pub(super) struct Table {
    pub(super) title: &'static str,
    /// What it shows, and how.
    pub(super) text: &'static str,
    pub(super) sequences: &'static [Sequence],
    pub(super) protocols: &'static [Protocol],
    /// Keys of rows.
    pub(super) rows: &'static [&'static str],
    pub(super) metrics: &'static [Metric],
    /// The paper's own numbers for a sequence.
    pub(super) published: &'static [(Sequence, &'static paper::Block)],
}

const IN_TABLE_2: &[Metric] =
    &[Metric::Shape, Metric::TranslationM, Metric::RotationDeg, Metric::PaperShape, Metric::Iou];
const IN_OWN_TABLE: &[Metric] = &[
    Metric::Shape,
    Metric::TranslationM,
    Metric::RotationDeg,
    Metric::Iou,
    Metric::Precision,
    Metric::Duplicates,
    Metric::IdSwitchesPer200,
    Metric::Within90,
    Metric::AteM,
    Metric::OdometryAteM,
];
const OF_ASSOCIATION: &[Metric] = &[
    Metric::Precision,
    Metric::Recall,
    Metric::Duplicates,
    Metric::IdSwitchesPer200,
    Metric::TranslationM,
    Metric::Iou,
];
const OF_ROBOTS: &[Metric] = &[
    Metric::Precision,
    Metric::Recall,
    Metric::TranslationM,
    Metric::Shape,
    Metric::Iou,
    Metric::Within90,
    Metric::AteM,
];
const OF_LOOPS: &[Metric] = &[
    Metric::AteM,
    Metric::OdometryAteM,
    Metric::AteShare,
    Metric::Precision,
    Metric::Recall,
    Metric::Duplicates,
    Metric::IdSwitchesPer200,
];
const BY_THE_PAPER: &[Sequence] = &[DESK_ORBIT, HOME_FORWARD];

pub(super) const TABLES: &[Table] = &[
    Table {
        title: "Table 2",
        text: "The paper's protocol: true poses, given association, boxes near the image border left out, only boxes \
               that the detector is sure of, objects with at least 5 such boxes. DwB and DO have eps_z = 1e5, where DwB \
               is best over both sequences.",
        sequences: BY_THE_PAPER,
        protocols: &[PAPER],
        rows: &["one-frame", "quadric-slam", "do", "dwb", "quadric-fit", OURS],
        metrics: IN_TABLE_2,
        published: &[(DESK_ORBIT, &paper::TUM_AVERAGE), (HOME_FORWARD, &paper::REAL_ROBOT)],
    },
    Table {
        title: "Symmetry on and off",
        text: "The paper's protocol, with the mirror planes of all classes and without any.",
        sequences: BY_THE_PAPER,
        protocols: &[PAPER],
        rows: &["one-frame", "one-frame-asymmetric", OURS, "asymmetric"],
        metrics: IN_TABLE_2,
        published: &[],
    },
    Table {
        title: "Our own protocol",
        text: "As on a robot: all boxes of a detector that misses, invents, cuts and confuses, odometry that drifts \
               (white noise), objects that were in sight in at least 5 frames. An object that was found has its centre \
               within 0.75 m of the true one, those of one class first; where association is given, it is known which it is, however far off. So \
               errors under the two associations are means over different objects: the automatic one leaves out what \
               it lost, and of two objects for one true one the nearer counts.",
        sequences: &[DESK_ORBIT, DESK_FORWARD, HOME_ORBIT, HOME_FORWARD],
        protocols: &[TRUE_GIVEN, DRIFTING_GIVEN, DRIFTING_AUTOMATIC],
        rows: &["ours-boxes", "ours-huber", "ours-faces", OURS],
        metrics: IN_OWN_TABLE,
        published: &[],
    },
    Table {
        title: "Whether covariances hold",
        text: "One value an object and run, and one for the last pose of a run. White noise is what odometry's covariance \
               says; that it takes ways for longer than they are, it does not say.",
        sequences: &[DESK_ORBIT, DESK_FORWARD, HOME_ORBIT, HOME_FORWARD],
        protocols: &[DRIFTING_GIVEN, STRETCHED_GIVEN],
        rows: &[OURS],
        metrics: &[Metric::Within90, Metric::PoseWithin90, Metric::AteM, Metric::OdometryAteM],
        published: &[],
    },
    Table {
        title: "Which object is which",
        text: "The same protocol with automatic association: what the map decides. An office, and a scene of things that \
               look alike: six chairs round a table, a row of books, two monitors side by side.",
        sequences: &[HOME_ORBIT, HOME_FORWARD, OFFICE_FORWARD, CROWDED_ORBIT, CROWDED_FORWARD],
        protocols: &[DRIFTING_AUTOMATIC],
        rows: &[OURS],
        metrics: OF_ASSOCIATION,
        published: &[],
    },
    Table {
        title: "Walls on and off",
        text: "The same again, with walls as landmarks and without them.",
        sequences: &[DESK_ORBIT, DESK_FORWARD, HOME_ORBIT, HOME_FORWARD, OFFICE_FORWARD],
        protocols: &[DRIFTING_AUTOMATIC],
        rows: &["without-walls", OURS],
        metrics: OF_LOOPS,
        published: &[],
    },
    Table {
        title: "Robots and sensors",
        text: "The drive through the home with other robots, as `simulate --sensor` and `--detector` have them: their numbers \
               are of data sheets and papers where there are any, and none is the estimator's.",
        sequences: &[HOME_FORWARD, HOME_LOW, HOME_D435, HOME_OAKD, HOME_NANO, HOME_BUMPED],
        protocols: &[DRIFTING_AUTOMATIC],
        rows: &[OURS],
        metrics: OF_ROBOTS,
        published: &[],
    },
    Table {
        title: "Loops",
        text: "A robot drives round and comes back to where it started, with odometry that drifts mostly in heading: 0.03 \
               rad after one metre and after one radian, 5 mm along and 3 mm across after one metre.",
        sequences: &[HOME_LOOP, OFFICE_LOOP],
        protocols: &[DRIFTING_AUTOMATIC],
        rows: &["without-walls", OURS],
        metrics: OF_LOOPS,
        published: &[],
    },
];

/// Figure 6: error against the number of views of an object.
pub(super) struct Convergence {
    pub(super) sequences: &'static [Sequence],
    pub(super) protocol: Protocol,
    /// Keys of rows.
    pub(super) rows: &'static [&'static str],
}

pub(super) const CONVERGENCE: Convergence =
    Convergence { sequences: BY_THE_PAPER, protocol: PAPER, rows: &["quadric-slam", "dwb", OURS] };

/// A figure like the paper's 7: error against the value of a setting.
pub(super) struct Sweep {
    /// How files and keys call it.
    pub(super) key: &'static str,
    /// The setting as it stands at the axis.
    pub(super) axis: &'static str,
    pub(super) text: &'static str,
    /// In rising order; on a logarithmic axis.
    pub(super) values: &'static [f64],
    /// Gives the setting a value, after the row has made its changes.
    pub(super) set: fn(&mut Settings, f64),
    /// The row whose setting is changed.
    pub(super) row: &'static str,
    /// The rows that are drawn as dashed lines.
    pub(super) references: &'static [&'static str],
    pub(super) sequences: &'static [Sequence],
    pub(super) protocol: Protocol,
}

/// All figures of this kind. A new one is an entry here.
pub(super) const SWEEPS: &[Sweep] = &[Sweep {
    key: "eps_z",
    axis: "eps_z",
    text: "The weight of what depth says against what boxes say, eq. (11), for DwB by the paper's weighting. The paper \
           finds its best near 1e3 on orbits and 1e5 forward. Ours weighs each measurement by its own covariance.",
    values: &[1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
    set: |settings, value| settings.slam.eps_z = value,
    row: "dwb",
    references: &["quadric-slam", OURS],
    sequences: BY_THE_PAPER,
    protocol: PAPER,
}];

/// One trial of every seed.
#[derive(Clone, Copy)]
pub(super) struct Case {
    pub(super) sequence: Sequence,
    pub(super) protocol: Protocol,
    pub(super) row: &'static Row,
    /// A setting and its value.
    pub(super) sweep: Option<(&'static Sweep, f64)>,
}

impl Case {
    /// Tells it from all other cases.
    pub(super) fn key(&self) -> String {
        let key = cell_key(&self.sequence, &self.protocol, self.row.key);
        match self.sweep {
            Some((sweep, value)) => swept_key(&key, sweep, value),
            None => key,
        }
    }

    /// Whether its curve over the number of views is part of a figure.
    pub(super) fn has_curve(&self) -> bool {
        self.sweep.is_none()
            && self.protocol == CONVERGENCE.protocol
            && CONVERGENCE.rows.contains(&self.row.key)
            && CONVERGENCE.sequences.contains(&self.sequence)
    }

    /// The settings that it runs with.
    pub(super) fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        self.protocol.change(&mut settings);
        (self.row.change)(&mut settings, &self.protocol);
        if let Some((sweep, value)) = self.sweep {
            (sweep.set)(&mut settings, value);
        }
        settings
    }
}

/// The key of a case without a sweep.
pub(super) fn cell_key(sequence: &Sequence, protocol: &Protocol, row: &str) -> String {
    format!("{}/{}/{row}", sequence.key, protocol.key)
}

/// The key of a case in a sweep.
pub(super) fn swept_key(key: &str, sweep: &Sweep, value: f64) -> String {
    format!("{key}/{}={value}", sweep.key)
}

/// The trials of one sequence that all tables and figures need with these rows, each once.
pub(super) fn cases(sequence: Sequence, rows: &[&'static Row]) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    let mut add = |protocol: &Protocol, keys: &[&str], sweep| {
        for row in rows.iter().copied().filter(|row| keys.contains(&row.key)) {
            let case = Case { sequence, protocol: *protocol, row, sweep };
            if !cases.iter().any(|other| other.key() == case.key()) {
                cases.push(case);
            }
        }
    };
    for table in TABLES.iter().filter(|table| table.sequences.contains(&sequence)) {
        table.protocols.iter().for_each(|protocol| add(protocol, table.rows, None));
    }
    if CONVERGENCE.sequences.contains(&sequence) {
        add(&CONVERGENCE.protocol, CONVERGENCE.rows, None);
    }
    for sweep in SWEEPS.iter().filter(|sweep| sweep.sequences.contains(&sequence)) {
        for value in sweep.values {
            add(&sweep.protocol, &[sweep.row], Some((sweep, *value)));
        }
        add(&sweep.protocol, sweep.references, None);
    }
    cases
}

/// All sequences of the plan.
pub(super) const SEQUENCES: [Sequence; 14] = [
    DESK_ORBIT,
    DESK_FORWARD,
    HOME_ORBIT,
    HOME_FORWARD,
    OFFICE_FORWARD,
    CROWDED_ORBIT,
    CROWDED_FORWARD,
    HOME_LOOP,
    OFFICE_LOOP,
    HOME_LOW,
    HOME_D435,
    HOME_OAKD,
    HOME_NANO,
    HOME_BUMPED,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::experiment::row::{ROWS, row};
    use std::collections::BTreeSet;

    /// A key with a slip of the pen would leave a row out without a word.
    #[test]
    fn every_row_that_is_named_exists() {
        let of_tables = TABLES.iter().flat_map(|table| table.rows);
        let of_sweeps = SWEEPS.iter().flat_map(|s| s.references.iter().chain([&s.row]));
        let named: Vec<&str> =
            of_tables.chain(CONVERGENCE.rows).chain(of_sweeps).copied().collect();
        for key in &named {
            assert!(row(key).is_ok(), "{key}");
        }
        let keys: BTreeSet<&str> = ROWS.iter().map(|row| row.key).collect();
        assert_eq!(keys.len(), ROWS.len(), "two rows have the same key");
        assert!(keys.iter().all(|key| named.contains(key)), "a row is in no table");
        assert!(TABLES.iter().flat_map(|table| table.sequences).all(|s| SEQUENCES.contains(s)));
    }

    #[test]
    fn every_trial_is_run_once_and_set_as_it_says() {
        let rows: Vec<&'static Row> = ROWS.iter().collect();
        for sequence in SEQUENCES {
            let cases = cases(sequence, &rows);
            let keys: BTreeSet<String> = cases.iter().map(Case::key).collect();
            assert_eq!(keys.len(), cases.len());
            assert!(keys.contains(&format!("{}/drifting-automatic/ours", sequence.key)));
        }
        let of_orbit = cases(DESK_ORBIT, &rows);
        let settings =
            |key: &str| of_orbit.iter().find(|case| case.key() == key).map(Case::settings).unwrap();
        assert_eq!(settings("desk-orbit/drifting-automatic/ours"), Settings::default());
        let swept = settings("desk-orbit/paper/dwb/eps_z=1000");
        assert_eq!(swept.slam.eps_z, 1000.0);
        assert_eq!(swept.mapping.association, crate::mapping::Association::Given);
        assert_eq!(swept.perception.classes, Settings::default().perception.classes);
        let without = settings("desk-orbit/paper/asymmetric").perception.classes;
        assert_eq!(without.prior("tv").symmetry, crate::perception::SymmetryType::None);
    }
}
