//! A robot whose odometry drifts drives round some cabinets, without images: what the graph makes of it.

use super::{given_identities, independent, normal, observation, ring_of_cabinets, round_the_ring};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose, retract},
    mapping::{ObjectMap, Observation, Sighting, SlamSettings},
    time::Stamp,
};
use nalgebra::{Point3, SVector, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

struct Drive {
    map: ObjectMap,
    /// True pose, that of odometry, and keyframes at the time.
    steps: Vec<(Pose, Pose, usize)>,
    /// Distance of the pose that was known at the time to the true one (m), and poses in the graph.
    live: Vec<(f64, usize)>,
    cabinets: Vec<Ellipsoid>,
}

/// Twice round.
fn drive(seed: u64, wrong: f64, slam: SlamSettings) -> Drive {
    long_drive(seed, wrong, slam, 158)
}

/// Round and round, looking to the middle; of the boxes this share is given the identity of another cabinet.
fn long_drive(seed: u64, wrong: f64, slam: SlamSettings, count: usize) -> Drive {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let cabinets = ring_of_cabinets();
    let mut map = ObjectMap::new(given_identities(), slam);
    let at = round_the_ring;
    let (mut odom, mut steps, mut live) = (at(0), Vec::new(), Vec::new());
    for step in 0..count {
        let truth = at(step);
        if step > 0 {
            let sigmas = Vector6::new(0.0, 0.0, 0.02, 0.02, 0.01, 0.0);
            let noise = Vector6::from_fn(|i, _| sigmas[i] * normal(&mut rng));
            odom *= retract(&(at(step - 1).inverse() * truth), &noise);
        }
        let mut observations = Vec::new();
        for (i, cabinet) in cabinets.iter().enumerate() {
            let seen = cabinet.transformed(&truth.inverse());
            if seen.center().coords.norm() > 3.5 {
                continue;
            }
            let sigmas = [0.001, 0.001, 0.03, 0.02, 0.02, 0.02, 0.05, 0.05, 0.05];
            let noise = SVector::<f64, 9>::from_fn(|i, _| sigmas[i] * normal(&mut rng));
            let seen = seen.retract(&noise);
            let covariance = independent(&seen, 0.03, 0.02, 0.02);
            let other = rng.random_range(1..cabinets.len());
            let by = if rng.random_bool(wrong) { other } else { 0 };
            let track = ((i + by) % cabinets.len()) as u64;
            let seen = observation("cabinet", seen, covariance);
            observations.push(Observation { track: Some(track), ..seen });
        }
        let sighted = map.observe(&Sighting {
            stamp: Stamp::from_secs(step as f64),
            odom_from_base: odom,
            odometry_covariance: None,
            observations,
            walls: Vec::new(),
            view: None,
        });
        assert_eq!(sighted.refused, None);
        let known = map.map_from_odom() * odom;
        let error = (known.translation.vector - truth.translation.vector).norm();
        live.push((error, map.poses()));
        steps.push((truth, odom, map.keyframes()));
    }
    map.finish();
    Drive { map, steps, live, cabinets }
}

impl Drive {
    /// Root mean square error of the positions, optimised and by odometry (m).
    fn errors(&self) -> (f64, f64) {
        let (mut optimised, mut raw) = (0.0, 0.0);
        for (i, (truth, odom, keyframes)) in self.steps.iter().enumerate() {
            let stamp = Stamp::from_secs(i as f64);
            let pose = self.map.map_from_odom_at(stamp, *keyframes) * odom;
            let apart =
                |pose: &Pose| (pose.translation.vector - truth.translation.vector).norm_squared();
            optimised += apart(&pose) / self.steps.len() as f64;
            raw += apart(odom) / self.steps.len() as f64;
        }
        (optimised.sqrt(), raw.sqrt())
    }

    /// Mean distance of the objects' centres from the true ones (m).
    fn object_error(&self) -> f64 {
        let apart = |track: usize, center: Point3<f64>| {
            (center - self.cabinets[track].center()).norm() / self.map.all().len() as f64
        };
        self.map
            .all()
            .iter()
            .map(|o| apart(o.track.unwrap() as usize, o.ellipsoid().center()))
            .sum()
    }
}

#[test]
fn what_is_seen_again_takes_the_drift_away() {
    for seed in 0..5 {
        let drive = drive(seed, 0.0, SlamSettings::default());
        let (optimised, raw) = drive.errors();
        assert!(optimised < 0.3 * raw, "seed {seed}: {optimised} m instead of {raw} m");
        assert!(drive.object_error() < 0.1, "seed {seed}: {} m", drive.object_error());
    }
}

#[test]
fn poses_that_are_given_stay_as_they_are() {
    let slam = SlamSettings { optimize_poses: false, ..SlamSettings::default() };
    let drive = drive(1, 0.0, slam);
    let (optimised, raw) = drive.errors();
    // Held to a tenth of a millimetre each.
    assert!((optimised - raw).abs() < 1e-3, "{optimised} m instead of {raw} m");
}

#[test]
fn a_fifth_of_wrong_associations_does_little_harm() {
    let over = |wrong: f64| {
        let drives: Vec<Drive> =
            (0..6).map(|seed| drive(seed, wrong, SlamSettings::default())).collect();
        let mean = |of: &dyn Fn(&Drive) -> f64| drives.iter().map(of).sum::<f64>() / 6.0;
        (mean(&Drive::object_error), mean(&|drive| drive.errors().0))
    };
    let (clean, spoiled) = (over(0.0), over(0.2));
    println!("error of objects and poses: {clean:?} m, with wrong associations {spoiled:?} m");
    assert!(spoiled.0 < 1.5 * clean.0 && spoiled.1 < 1.5 * clean.1, "{spoiled:?} m, {clean:?} m");
}

#[test]
fn the_same_drive_gives_the_same_map() {
    let bits = |drive: Drive| -> Vec<u64> {
        let centers = drive.map.all().iter().map(|o| o.ellipsoid().center());
        centers.flat_map(|c| [c.x.to_bits(), c.y.to_bits(), c.z.to_bits()]).collect()
    };
    let again = || bits(drive(3, 0.1, SlamSettings::default()));
    assert_eq!(again(), again());
}

/// Fifty times round: what was seen often enough is forgotten, and the robot still knows where it is.
#[test]
fn a_long_drive_neither_grows_nor_drifts() {
    let lap = 79;
    let drive = long_drive(7, 0.0, SlamSettings::default(), 50 * lap);
    let worst = |laps: std::ops::Range<usize>| {
        let live = &drive.live[laps.start * lap..laps.end * lap];
        live.iter()
            .fold((0.0_f64, 0), |most, (error, poses)| (most.0.max(*error), most.1.max(*poses)))
    };
    let ((early, _), (middle, some)) = (worst(2..10), worst(20..30));
    let (late, all) = worst(40..50);
    let (_, raw) = drive.errors();
    println!(
        "live error at most {early} m, {middle} m, {late} m, of odometry {raw} m; {some} and {all} poses"
    );
    assert!(late < 1.5 * early && late < 0.1 * raw);
    assert!(all <= some + some / 20);
}
