use super::{Run, boxes, camera_on_base, color_camera, depth, odometry, transform};
use ellipsoid_slam::{
    geometry::Pose,
    pipeline::{Input, Settings},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// Messages of a second or so, some of them missing, doubled or far off, in any order.
fn shuffled(rng: &mut ChaCha8Rng) -> Vec<Input> {
    let mut inputs = vec![color_camera(), camera_on_base()];
    let by_transform = rng.random_bool(0.3);
    for i in 0..30 {
        let ms = match rng.random_range(0..20) {
            0 => rng.random_range(-20_000..20_000),
            _ => 40 * i + rng.random_range(-25..25),
        };
        let pose = Pose::translation(0.001 * ms as f64, 0.0, 0.0);
        match rng.random_range(0..8) {
            0..=2 => inputs.push(depth(ms)),
            3..=4 => inputs.push(boxes(ms)),
            5 => inputs.extend([depth(ms), boxes(ms)]),
            6 if by_transform => inputs.push(transform(false, ms, ["odom", "base_link"], pose)),
            _ => inputs.push(odometry(ms)),
        }
    }
    // Anything from nearly in order to no order at all.
    let reach = [2, 8, inputs.len()][rng.random_range(0..3)];
    for i in 0..inputs.len() {
        let j = (i + rng.random_range(0..reach)).min(inputs.len() - 1);
        inputs.swap(i, j);
    }
    inputs
}

fn count(stamps: impl IntoIterator<Item = i64>) -> BTreeMap<i64, usize> {
    let mut counts = BTreeMap::new();
    for stamp in stamps {
        *counts.entry(stamp).or_default() += 1;
    }
    counts
}

#[test]
fn no_order_of_messages_loses_an_image_or_boxes_in_silence() {
    for seed in 0..1000 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let inputs = shuffled(&mut rng);
        let stamps = |depth: bool| {
            count(inputs.iter().filter_map(|input| match input {
                Input::Depth(d) if depth => Some(d.stamp.as_nanos()),
                Input::Detections(d) if !depth => Some(d.stamp.as_nanos()),
                _ => None,
            }))
        };
        let (images, lists) = (stamps(true), stamps(false));
        let mut run = Run::new(Settings::default());
        run.feed(inputs);
        run.finish();
        let total = &run.total;
        let boxes_lost = |reason: &str| reason == "no_depth_for_boxes";
        let posed = total.poses.iter().map(|p| p.stamp.as_nanos());
        let dropped = total.dropped.iter().filter(|d| !boxes_lost(d.reason));
        let settled = count(posed.chain(dropped.map(|d| d.stamp.as_nanos())));
        assert_eq!(settled, images, "seed {seed}: every image is posed or dropped, and once");

        let unused = total.dropped.iter().filter(|d| boxes_lost(d.reason)).count();
        let given: usize = lists.values().sum();
        let without_pose = total.dropped.len() - unused;
        let used = total.keyframes.len();
        assert!(used + unused <= given, "seed {seed}: boxes are used once");
        assert!(used + unused + without_pose >= given, "seed {seed}: boxes are used or dropped");
    }
}

#[test]
fn the_same_messages_give_the_same_result() {
    for seed in 0..20 {
        let result = || {
            let mut run = Run::new(Settings::default());
            run.feed(shuffled(&mut ChaCha8Rng::seed_from_u64(seed)));
            run.finish();
            format!("{:?}", run.total)
        };
        assert_eq!(result(), result());
    }
}
