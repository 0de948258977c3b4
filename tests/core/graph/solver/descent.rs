//! The cost never rises, however wrong the initial values are.

use super::world::{Course, Drive};
use ellipsoid_slam::graph::{Kernel, SolverSettings};

/// The tolerance of a step, and what is taken from linear models that are nearly right.
const TOLERANCE: f64 = 0.05;

fn assert_descends(course: Course) -> Drive {
    let mut drive = Drive::new(course);
    while drive.step() {
        let before = drive.twin.graph.cost();
        let report = drive.twin.graph.update().unwrap();
        let after = drive.twin.graph.cost();
        assert!(after <= before + TOLERANCE, "from {before} to {after}: {report:?}");
    }
    drive
}

fn far_off(seed: u64, kernel: Kernel) -> Course {
    Course {
        kernel,
        outlier_every: 12,
        initial_error: 10.0,
        // Changes are not kept from anything, so that the cost that counts is all of it.
        settings: SolverSettings { propagation_tolerance: 0.0, ..SolverSettings::default() },
        ..Course::new(seed)
    }
}

#[test]
fn updates_descend_with_huber() {
    (0..4).for_each(|seed| {
        assert_descends(far_off(seed, Kernel::Huber(3.0)));
    });
}

#[test]
fn updates_descend_with_kernels_that_forget_outliers() {
    for seed in 0..4 {
        assert_descends(far_off(seed, Kernel::GemanMcClure(3.0)));
        assert_descends(far_off(seed, Kernel::Cauchy(3.0)));
    }
}

#[test]
fn with_the_usual_settings_little_is_lost_by_silence() {
    for seed in 0..4 {
        let course = far_off(seed, Kernel::Huber(3.0));
        let mut drive = assert_descends(Course { settings: SolverSettings::default(), ..course });
        let cost = drive.twin.graph.cost();
        drive.twin.converge();
        assert!(cost < 1.01 * drive.twin.graph.cost(), "{cost}");
    }
}

#[test]
fn wrong_initial_values_are_overcome() {
    for seed in 0..4 {
        let mut drive = Drive::new(far_off(seed, Kernel::Huber(3.0)));
        while drive.step() {
            drive.twin.graph.update().unwrap();
        }
        drive.twin.converge();
        let mut good = Course { outlier_every: 12, ..Course::new(seed) }.driven();
        good.twin.converge();
        let (found, wanted) = (drive.twin.graph.cost(), good.twin.graph.cost());
        assert!((found / wanted - 1.0).abs() < 1e-6, "seed {seed}: {found}, not {wanted}");
    }
}

#[test]
fn an_update_with_nothing_to_do_changes_nothing() {
    let mut empty = Drive::new(Course::new(0));
    let report = empty.twin.graph.update().unwrap();
    assert_eq!((report.eliminated, report.changed, report.cost_after), (0, 0, 0.0));
    let mut drive = Course::new(1).driven();
    drive.twin.converge();
    let before = drive.twin.estimate();
    let report = drive.twin.graph.update().unwrap();
    assert_eq!((report.eliminated, report.relinearized, report.changed), (0, 0, 0));
    assert_eq!(drive.twin.estimate(), before);
}
