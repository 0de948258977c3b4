//! Which object is which, and what that says about a map.

use ellipsoid_slam::{
    eval::{EstimatedObject, GroundTruth, TrueObject, assignment, evaluate, evaluate_identified},
    geometry::{Ellipsoid, Pose},
};
use nalgebra::{Point3, SMatrix, Vector3};

fn on_a_line(xs: &[f64]) -> Vec<Point3<f64>> {
    xs.iter().map(|x| Point3::new(*x, 0.0, 0.0)).collect()
}

/// Two lists of points and the pairs of their indices.
type Case = (&'static [f64], &'static [f64], &'static [(usize, usize)]);

#[test]
fn the_assignment_is_the_best_one() {
    let cases: &[Case] = &[
        (&[], &[1.0], &[]),
        (&[1.0], &[], &[]),
        (&[0.0], &[0.74], &[(0, 0)]),
        (&[0.0], &[0.76], &[]),
        (&[0.0, 5.0], &[5.1, 0.1], &[(0, 1), (1, 0)]),
        // The nearest pair first would leave two points alone.
        (&[0.0, 0.4], &[0.3, 0.9], &[(0, 0), (1, 1)]),
        // Two far pairs are not better than a close one.
        (&[0.0, 0.6], &[0.6, 1.3], &[(1, 0)]),
        // More on either side.
        (&[0.0, 1.0, 2.0], &[1.9], &[(2, 0)]),
        (&[1.9], &[0.0, 1.0, 2.0], &[(0, 2)]),
    ];
    for (a, b, expected) in cases {
        assert_eq!(assignment(&on_a_line(a), &on_a_line(b), 0.75), *expected, "{a:?} {b:?}");
        let turned: Vec<_> = assignment(&on_a_line(b), &on_a_line(a), 0.75);
        let mut turned: Vec<_> = turned.into_iter().map(|(b, a)| (a, b)).collect();
        turned.sort_unstable();
        assert_eq!(turned, *expected, "{b:?} {a:?}");
    }
}

fn true_object(id: u64, x: f64, observations: u64) -> TrueObject {
    TrueObject {
        id,
        label: "cup".into(),
        pose: Pose::translation(x, 0.0, 0.0),
        size: Vector3::new(0.4, 0.2, 0.2),
        observations,
    }
}

fn estimated(id: u64, label: &str, x: f64) -> EstimatedObject {
    EstimatedObject {
        id,
        label: label.into(),
        ellipsoid: Ellipsoid::new(Pose::translation(x, 0.0, 0.0), Vector3::new(0.2, 0.1, 0.1)),
        covariance: SMatrix::identity(),
    }
}

#[test]
fn a_map_is_scored() {
    let objects = vec![
        true_object(1, 0.0, 10),
        true_object(2, 3.0, 4),
        true_object(3, 6.0, 5),
        true_object(4, 9.0, 50),
    ];
    let truth = GroundTruth { frame_id: "map".into(), objects };
    let map = [
        estimated(10, "cup", 0.1),
        // Shows object 1 once more: its centre is in the box grown by 10 cm.
        estimated(11, "cup", -0.25),
        // Object 2 was seen too rarely to count, so this is neither right nor wrong.
        estimated(12, "cup", 3.1),
        estimated(13, "vase", 8.8),
        estimated(14, "cup", 20.0),
    ];
    let scores = evaluate(&map, &truth);
    assert_eq!((scores.true_objects, scores.map_objects, scores.duplicates), (3, 4, 1));
    assert_eq!(scores.precision, Some(2.0 / 4.0));
    assert_eq!(scores.recall, Some(2.0 / 3.0));
    assert_eq!(scores.label_agreement, Some(0.5));
    assert!((scores.translation_m.unwrap() - 0.15).abs() < 1e-12);
    assert_eq!((scores.rotation_deg, scores.rotation_left_out), (Some(0.0), 0));
    let pairs: Vec<_> = scores.matches.iter().map(|m| (m.true_id, m.id)).collect();
    assert_eq!(pairs, [(1, 10), (4, 13)]);
    assert_eq!(scores.missed.iter().map(|m| m.true_id).collect::<Vec<_>>(), [3]);
    let wrong: Vec<_> = scores.false_objects.iter().map(|f| (f.id, f.duplicate_of)).collect();
    assert_eq!(wrong, [(11, Some(1)), (14, None)]);
}

#[test]
fn what_stands_beside_a_thing_of_another_class_is_not_that_thing() {
    // Somebody looked too seldom at the book for it to count, and the cup's estimate is nearer to it than to the cup.
    let book = TrueObject { label: "book".into(), ..true_object(2, 0.3, 2) };
    let objects = vec![true_object(1, 0.0, 10), book.clone()];
    let truth = GroundTruth { frame_id: "map".into(), objects };
    let cup = estimated(10, "cup", 0.2);
    let scores = evaluate(std::slice::from_ref(&cup), &truth);
    assert_eq!((scores.recall, scores.precision), (Some(1.0), Some(1.0)));
    // What has no partner of its class takes what is left.
    let scores = evaluate(&[cup, estimated(11, "laptop", 0.1)], &truth);
    assert_eq!((scores.true_objects, scores.map_objects), (1, 1));
    let truth = GroundTruth { frame_id: "map".into(), objects: vec![book] };
    let scores = evaluate(&[estimated(10, "cup", 0.2)], &truth);
    assert_eq!((scores.true_objects, scores.map_objects), (0, 0), "neither right nor wrong");
}

#[test]
fn an_empty_map_has_no_precision_and_no_means() {
    let truth = GroundTruth { frame_id: "map".into(), objects: vec![true_object(1, 0.0, 9)] };
    let scores = evaluate(&[], &truth);
    assert_eq!((scores.precision, scores.recall, scores.translation_m), (None, Some(0.0), None));
    assert_eq!(scores.calibration.mean_nees_per_dimension, None);
    let scores = evaluate(&[], &GroundTruth { frame_id: "map".into(), objects: Vec::new() });
    assert_eq!((scores.precision, scores.recall), (None, None));
}

#[test]
fn known_objects_count_as_found_however_far_off() {
    let objects = vec![true_object(1, 0.0, 10), true_object(2, 0.3, 10), true_object(3, 9.0, 4)];
    let truth = GroundTruth { frame_id: "map".into(), objects };
    // They lie nearest to each other's place, and one is beyond every distance at which places are matched.
    let map = [
        (2, estimated(10, "cup", 0.0)),
        (1, estimated(11, "cup", 2.0)),
        (3, estimated(12, "cup", 9.0)),
        (1, estimated(13, "cup", 0.1)),
    ];
    let scores = evaluate_identified(&map, &truth);
    let pairs: Vec<_> = scores.matches.iter().map(|m| (m.true_id, m.id)).collect();
    assert_eq!(pairs, [(1, 11), (2, 10)], "3 was seen too rarely to count");
    assert!((scores.translation_m.unwrap() - 0.5 * (2.0 + 0.3)).abs() < 1e-12);
    assert_eq!(scores.false_objects.iter().map(|f| f.id).collect::<Vec<_>>(), [13]);
}
