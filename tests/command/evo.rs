//! Our metrics of trajectories against evo itself, on random pairs.

use crate::{environment::python, run::stderr};
use ellipsoid_slam::{
    eval::{Statistics, evaluate_trajectory},
    geometry::{Pose, exp},
    io::read_trajectory,
};
use nalgebra::Vector6;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::{
    fmt::Write,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// A random way and an estimate of it that jitters, turns away, has other stamps and misses poses.
fn write_pair(folder: &Path, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let poses = random.random_range(20..120);
    let (mut truth, mut estimate) = (String::new(), String::new());
    let mut twist = |size: f64| exp(&Vector6::from_fn(|_, _| random.random_range(-size..size)));
    let (mut true_pose, turned) = (twist(2.0), twist(1.0));
    let mut lines = Vec::new();
    for _ in 0..poses {
        true_pose *= twist(0.4);
        lines.push((true_pose, turned * true_pose * twist(0.1)));
    }
    for (i, (true_pose, estimated)) in lines.into_iter().enumerate() {
        let stamp = 1000.0 + 0.1 * i as f64;
        write_line(&mut truth, stamp, &true_pose);
        if i < 2 || random.random_bool(0.8) {
            write_line(&mut estimate, stamp + random.random_range(-0.015..0.015), &estimated);
        }
    }
    fs::create_dir(folder).unwrap();
    fs::write(folder.join("true.tum"), truth).unwrap();
    fs::write(folder.join("estimate.tum"), estimate).unwrap();
}

/// With all digits: rounding is not what is compared.
fn write_line(text: &mut String, stamp: f64, pose: &Pose) {
    let (t, q) = (pose.translation.vector, pose.rotation);
    let numbers = [t.x, t.y, t.z, q.i, q.j, q.k, q.w].map(|x| format!("{x:?}")).join(" ");
    writeln!(text, "{stamp:.6} {numbers}").unwrap();
}

#[test]
fn ate_and_rpe_of_random_pairs_are_those_of_evo() {
    let folder = tempfile::tempdir().unwrap();
    let pairs: Vec<PathBuf> =
        (1..=6).map(|seed: u64| folder.path().join(seed.to_string())).collect();
    (1..).zip(&pairs).for_each(|(seed, pair)| write_pair(pair, seed));
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/evo_numbers.py");
    let output = Command::new(python("tests/requirements.txt").unwrap())
        .arg(script)
        .args(&pairs)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let by_evo: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(by_evo.len(), pairs.len());
    for (pair, theirs) in pairs.iter().zip(&by_evo) {
        let read = |name: &str| read_trajectory(&pair.join(name)).unwrap();
        let ours = evaluate_trajectory(&read("estimate.tum"), &read("true.tum")).unwrap();
        assert_eq!(theirs["poses"], ours.poses);
        assert!(ours.ate_m.rmse > 0.1 && ours.aligned_ate_m.rmse > 0.01, "nothing to compare");
        let parts = [
            ("ate", ours.ate_m),
            ("aligned_ate", ours.aligned_ate_m),
            ("rpe_m", ours.rpe_m),
            ("rpe_deg", ours.rpe_deg),
        ];
        for (name, ours) in parts {
            let Statistics { rmse, mean, median, max } = ours;
            for (at, ours) in [rmse, mean, median, max].into_iter().enumerate() {
                let theirs = theirs[name][at].as_f64().unwrap();
                // Both compute in doubles, in another order; angles go through an arc cosine there.
                assert!((ours - theirs).abs() < 1e-9 * (1.0 + theirs), "{name}: {ours}, {theirs}");
            }
        }
    }
}
