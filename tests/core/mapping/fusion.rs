use super::{
    Covariance, by_faces, given_identities, independent, map_from, map_of, map_with, observation,
    observe, only, slam_settings,
};
use crate::geometry::{pose_distance, upright_pose};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose, yaw_of},
    mapping::{KernelShape, ObjectMap, Observation, SlamSettings},
};
use nalgebra::{SMatrix, SymmetricEigen, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn cabinet() -> Ellipsoid {
    Ellipsoid::new(upright_pose(0.4, Vector3::new(1.0, 2.0, 0.4)), Vector3::new(0.5, 0.2, 0.4))
}

/// The covariance of the same body with its axes renamed: new x is old y, new y is old -x.
fn renamed(covariance: &Covariance, quarters: i64) -> Covariance {
    let mut quarter = SMatrix::<f64, 9, 9>::zeros();
    for first in [0, 3] {
        quarter[(first, first + 1)] = 1.0;
        quarter[(first + 1, first)] = -1.0;
        quarter[(first + 2, first + 2)] = 1.0;
    }
    (quarter[(6, 7)], quarter[(7, 6)], quarter[(8, 8)]) = (1.0, 1.0, 1.0);
    (0..quarters).fold(*covariance, |c, _| quarter * c * quarter.transpose())
}

fn noisy(truth: &Ellipsoid, rng: &mut ChaCha8Rng, sigma: f64) -> Ellipsoid {
    let mut bell = || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>() * sigma;
    let pose = truth.pose * upright_pose(bell(), Vector3::new(bell(), bell(), bell()));
    let axes = truth.semi_axes + Vector3::new(bell(), bell(), bell());
    Ellipsoid::new(pose, axes.map(|a| a.max(0.01)))
}

fn assert_covariance(covariance: &Covariance) {
    assert!((covariance - covariance.transpose()).norm() < 1e-9 * covariance.norm());
    let smallest = SymmetricEigen::new(*covariance).eigenvalues.min();
    assert!(smallest > 0.0, "smallest eigenvalue {smallest}");
}

/// Heading, centre and size; that objects are upright is known better than it was measured. What keeps every object
/// determined (a standard deviation of 1 for the logarithm of a semi-axis) may change some percent.
fn assert_same_covariance(a: &Covariance, b: &Covariance) {
    let of = |c: &Covariance| c.fixed_view::<7, 7>(2, 2).into_owned();
    assert!((of(a) - of(b)).norm() < 0.06 * of(b).norm().max(of(a).norm()), "{a} instead of {b}");
}

#[test]
fn many_noisy_views_come_near_the_truth() {
    let (truth, sigma) = (cabinet(), 0.04);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let views = (0..60).map(|_| {
        let e = noisy(&truth, &mut rng, sigma);
        observation("cabinet", e, independent(&e, sigma, sigma, sigma))
    });
    let slam = SlamSettings { optimize_poses: false, ..SlamSettings::default() };
    let map = map_with(slam, views.collect::<Vec<_>>());
    let object = only(&map);
    let got = object.ellipsoid();
    // 16 views from one direction are all that is kept: 0.01 m a coordinate, of which there are three.
    assert!((got.center() - truth.center()).norm() < 0.03);
    assert!((got.semi_axes - truth.semi_axes).norm() < 0.03);
    assert!((yaw_of(&got.pose) - 0.4).abs() < 0.02);
    assert_covariance(&object.covariance());
    // Similar views are wrong alike: with a correlation of a half, many are worth two.
    let reported = object.covariance()[(3, 3)].sqrt();
    assert!(reported > 0.7 * sigma && reported < 0.8 * sigma, "{reported}");
}

#[test]
fn a_view_of_the_other_face_settles_centre_and_size() {
    let truth = cabinet();
    let (known, guessed) = (0.01, 0.3);
    // From one side: -x seen, +x taken for 20 cm nearer than it is. Centre and semi-axis are wrong by 10 cm.
    let from = |side: f64| {
        let pose = truth.pose * Pose::translation(-0.1 * side, 0.0, 0.0);
        let axes = truth.semi_axes - Vector3::new(0.1, 0.0, 0.0);
        let e = Ellipsoid::new(pose, axes);
        let (low, high) = if side > 0.0 { (known, guessed) } else { (guessed, known) };
        observation("cabinet", e, by_faces(&e, 0.02, [low, high, known, known, known, known]))
    };
    let once = map_of([from(1.0)]);
    assert!((only(&once).ellipsoid().semi_axes.x - 0.4).abs() < 1e-9);
    let map = map_of([from(1.0), from(-1.0)]);
    let got = only(&map).ellipsoid();
    // Guesses weigh (0.01 / 0.3)^2: a thousandth.
    assert!((got.semi_axes - truth.semi_axes).norm() < 0.002, "{}", got.semi_axes);
    assert!((got.center() - truth.center()).norm() < 0.002);
    let sigma = only(&map).covariance()[(3, 3)].sqrt();
    assert!(sigma < 0.02, "the centre is known to {sigma} m now");
}

#[test]
fn a_better_measurement_counts_more() {
    let e = cabinet();
    let moved = Ellipsoid::new(Pose::translation(0.0, 0.0, 0.1) * e.pose, e.semi_axes);
    let map = map_of([
        observation("cabinet", e, independent(&e, 0.05, 0.03, 0.03)),
        observation("cabinet", moved, independent(&e, 0.05, 0.06, 0.03)),
    ]);
    // A quarter of the information: a fifth of the way.
    // The pose is held to a tenth of a millimetre.
    assert!((only(&map).ellipsoid().center().z - 0.42).abs() < 1e-4);
}

#[test]
fn one_wild_view_does_not_ruin_the_estimate() {
    let truth = cabinet();
    let view = |e: Ellipsoid| observation("cabinet", e, independent(&e, 0.02, 0.02, 0.02));
    let wild = Ellipsoid::new(
        truth.pose * upright_pose(0.5, Vector3::new(0.3, 0.1, 0.0)),
        truth.semi_axes * 1.5,
    );
    let mut views = vec![view(truth); 5];
    views.push(view(wild));
    let slam = SlamSettings { kernel: KernelShape::Cauchy, ..slam_settings() };
    let map = map_with(slam, views);
    let got = only(&map).ellipsoid();
    assert!((got.center() - truth.center()).norm() < 0.02);
    assert!((got.semi_axes - truth.semi_axes).norm() < 0.02);
}

#[test]
fn headings_near_half_a_turn_do_not_average_to_nothing() {
    let at = |yaw: f64| {
        let e = Ellipsoid::new(upright_pose(yaw, Vector3::zeros()), Vector3::new(0.5, 0.2, 0.4));
        observation("cabinet", e, independent(&e, 0.05, 0.02, 0.02))
    };
    let map = map_of([at(3.1), at(-3.1), at(3.1), at(-3.1)]);
    let got = only(&map).ellipsoid();
    assert!(yaw_of(&got.pose).cos() < -0.99, "{}", yaw_of(&got.pose));
    assert!((got.semi_axes - Vector3::new(0.5, 0.2, 0.4)).norm() < 0.01);
}

#[test]
fn the_longer_axis_comes_first_with_its_own_covariance() {
    // Known well along its y, which is the longer one.
    let e = Ellipsoid::new(upright_pose(0.3, Vector3::zeros()), Vector3::new(0.2, 0.5, 0.4));
    let covariance = by_faces(&e, 0.05, [0.03, 0.03, 0.01, 0.02, 0.01, 0.01]);
    let map = map_of([observation("cabinet", e, covariance)]);
    let object = only(&map);
    assert!((object.ellipsoid().semi_axes - Vector3::new(0.5, 0.2, 0.4)).norm() < 1e-9);
    assert!((object.ellipsoid().dual_quadric() - e.dual_quadric()).norm() < 1e-9);
    assert_same_covariance(&object.covariance(), &renamed(&covariance, 1));
}

#[test]
fn the_reported_covariance_is_the_measured_one_after_one_view() {
    let e = cabinet();
    let covariance = by_faces(&e, 0.07, [0.01, 0.2, 0.03, 0.04, 0.02, 0.05]);
    let map = map_of([observation("cabinet", e, covariance)]);
    assert_same_covariance(&only(&map).covariance(), &covariance);
}

proptest! {
    #[test]
    fn how_a_measurement_names_its_axes_does_not_matter(
        seed in any::<u64>(), quarters in prop::collection::vec(0_i64..4, 6),
        faces in prop::array::uniform6(0.01..0.2),
    ) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let truth = cabinet();
        let views: Vec<Ellipsoid> = (0..6).map(|_| noisy(&truth, &mut rng, 0.03)).collect();
        let map = |rename: bool| {
            map_of(views.iter().zip(&quarters).map(|(e, q)| {
                let covariance = by_faces(e, 0.05, faces);
                let q = if rename { *q } else { 0 };
                observation("cabinet", e.quarter_turned(q), renamed(&covariance, q))
            }).collect::<Vec<_>>())
        };
        let (plain, renamed) = (map(false), map(true));
        let (plain, renamed) = (only(&plain), only(&renamed));
        let (a, b) = (plain.ellipsoid(), renamed.ellipsoid());
        prop_assert!((a.semi_axes - b.semi_axes).norm() < 1e-9);
        // The main axis has no direction: half a turn is the same.
        let turned = b.relabelled_towards(yaw_of(&a.pose));
        prop_assert!(pose_distance(&a.pose, &turned.pose) < 1e-7);
        let variances = |c: Covariance| c.diagonal();
        prop_assert!((variances(plain.covariance()) - variances(renamed.covariance())).norm() < 1e-9);
        assert_covariance(&plain.covariance());
    }

    /// The same views, of a robot that calls its place by other coordinates.
    #[test]
    fn where_the_map_has_its_origin_does_not_matter(
        seed in any::<u64>(), yaw in -3.0..3.0, x in -5.0..5.0, y in -5.0..5.0,
    ) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let truth = cabinet();
        let views: Vec<Ellipsoid> = (0..5).map(|_| noisy(&truth, &mut rng, 0.03)).collect();
        let motion = upright_pose(yaw, Vector3::new(x, y, 0.5));
        let map = |odom_from_base: &Pose| {
            map_from(odom_from_base, slam_settings(), views.iter().map(|e| {
                let covariance = by_faces(e, 0.05, [0.01, 0.1, 0.05, 0.02, 0.01, 0.02]);
                observation("cabinet", *e, covariance)
            }))
        };
        let (here, there) = (map(&Pose::identity()), map(&motion));
        let (here, there) = (only(&here), only(&there));
        let expected = here.ellipsoid().transformed(&motion);
        prop_assert!(pose_distance(&expected.pose, &there.ellipsoid().pose) < 1e-7);
        assert_same_covariance(&here.covariance(), &there.covariance());
    }
}

/// A round table measured from two sides with whatever heading: what one view saw must count along the direction
/// it was seen in.
#[test]
fn a_hidden_side_is_hidden_where_it_is_not_where_the_heading_says() {
    let truth = Vector3::new(0.4, 0.4, 0.3);
    let at = |yaw: f64, shift: f64, faces| {
        // Wrong along the view's own x only, where it is not sure.
        let pose = upright_pose(yaw, Vector3::zeros()) * Pose::translation(shift, 0.0, 0.0);
        let e = Ellipsoid::new(pose, truth);
        observation("table", e, by_faces(&e, 0.8, faces))
    };
    let known = [0.01; 6];
    let guessed = [0.3, 0.3, 0.01, 0.01, 0.01, 0.01];
    // The first view knows everything, the second is turned by 40 degrees and 10 cm off along its depth.
    let yaw = 40.0_f64.to_radians();
    let map = map_of([at(0.0, 0.0, known), at(yaw, 0.1, guessed)]);
    let center = only(&map).ellipsoid().center();
    // The guess weighs a thousandth; a wrong heading of the covariance would pull it by 2 cm.
    assert!(center.coords.xy().norm() < 0.002, "pulled to {center}");
}

/// Taken for a laptop, a television has no foot: what was seen of it ends where its screen does, for sure.
#[test]
fn what_was_measured_as_another_class_hardly_counts() {
    let half_depth_m = |labels: [&str; 9]| {
        let mut map = ObjectMap::new(given_identities(), slam_settings());
        for (second, label) in labels.into_iter().enumerate() {
            let (half_m, sigma_m) = if label == "tv" { (0.15, 0.05) } else { (0.05, 0.02) };
            let pose = upright_pose(0.3, Vector3::new(2.0, 0.5, 0.7));
            let measured = Ellipsoid::new(pose, Vector3::new(0.5, half_m, 0.3));
            let covariance = independent(&measured, 0.05, 0.05, sigma_m);
            let seen = Observation { track: Some(1), ..observation(label, measured, covariance) };
            observe(&mut map, second as f64, vec![seen]);
        }
        only(&map).ellipsoid().semi_axes.y
    };
    let mut labels = ["tv"; 9];
    assert!((half_depth_m(labels) - 0.15).abs() < 1e-3);
    labels[5] = "laptop";
    assert!(half_depth_m(labels) > 0.14, "{}", half_depth_m(labels));
}
