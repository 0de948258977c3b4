use super::{Run, boxes, depth, odometry};

#[test]
fn boxes_come_long_after_their_image() {
    let mut run = Run::ready();
    for ms in (0..2000).step_by(100) {
        run.feed([depth(ms), odometry(ms)]);
        if ms >= 600 {
            run.feed([boxes(ms - 600)]);
        }
    }
    assert_eq!(run.keyframes(), (0..1400).step_by(100).collect::<Vec<_>>());
    run.finish();
    assert_eq!(run.posed(), (0..2000).step_by(100).collect::<Vec<_>>());
    assert!(run.total.dropped.is_empty(), "{:?}", run.total.dropped);
}

#[test]
fn boxes_may_come_before_their_image() {
    let mut run = Run::ready();
    for ms in (0..1000).step_by(100) {
        run.feed([odometry(ms), boxes(ms), depth(ms)]);
    }
    run.finish();
    assert_eq!(run.keyframes(), (0..1000).step_by(100).collect::<Vec<_>>());
    assert!(run.total.dropped.is_empty(), "{:?}", run.total.dropped);
}

#[test]
fn an_exact_stamp_comes_before_a_near_one() {
    // Boxes of 110 are 10 ms from the first image, but belong to the second, whichever comes first.
    for early_boxes in [true, false] {
        let mut run = Run::ready();
        let mut inputs = vec![odometry(0), odometry(500), depth(100), depth(110), boxes(110)];
        if early_boxes {
            inputs.swap(3, 4);
        }
        run.feed(inputs);
        run.finish();
        assert_eq!(run.keyframes(), [110], "early: {early_boxes}");
        assert_eq!(run.posed(), [100, 110]);
        assert!(run.total.dropped.is_empty());
    }
}

#[test]
fn the_nearer_of_two_images_gets_the_boxes() {
    for (stamp, expected) in [(108, 100), (112, 120)] {
        let mut run = Run::ready();
        run.feed([odometry(0), odometry(500), depth(100), boxes(stamp), depth(120), depth(300)]);
        run.finish();
        assert_eq!(run.keyframes(), [expected]);
    }
}

#[test]
fn the_slop_is_kept() {
    for (stamp, paired) in [(80, true), (120, true), (79, false), (121, false)] {
        let mut run = Run::ready();
        run.feed([odometry(0), odometry(5000), depth(100), boxes(stamp)]);
        run.feed((1..10).map(|i| depth(100 + 400 * i)));
        run.finish();
        let expected: &[i64] = if paired { &[100] } else { &[] };
        assert_eq!(run.keyframes(), expected, "boxes of {stamp}");
        let lost: &[_] = if paired { &[] } else { &[(stamp, "no_depth_for_boxes")] };
        assert_eq!(run.dropped(), lost);
    }
}

#[test]
fn nothing_is_paired_twice() {
    // One set of boxes half way between two images.
    let mut run = Run::ready();
    run.feed([odometry(0), odometry(500), boxes(110), depth(100), depth(120), depth(300)]);
    run.finish();
    assert_eq!(run.keyframes().len(), 1);
    // Two sets for one image: the exact one is used, the other reported.
    let mut run = Run::ready();
    run.feed([odometry(0), odometry(500), boxes(105), boxes(100), depth(100), depth(300)]);
    run.finish();
    assert_eq!(run.keyframes(), [100]);
    assert_eq!(run.dropped(), [(105, "no_depth_for_boxes")]);
}

#[test]
fn images_without_boxes_still_get_a_pose() {
    let mut run = Run::ready();
    for ms in (0..3000).step_by(100) {
        run.feed([depth(ms), odometry(ms)]);
    }
    // Later than a second after its image nobody waits for boxes.
    assert!(run.posed().len() >= 19, "{:?}", run.posed());
    run.finish();
    assert_eq!(run.posed(), (0..3000).step_by(100).collect::<Vec<_>>());
    assert!(run.keyframes().is_empty() && run.total.dropped.is_empty());
}

#[test]
fn a_detector_slower_than_the_camera_leaves_poses_only() {
    let mut run = Run::ready();
    for ms in (0..900).step_by(100) {
        run.feed([odometry(ms), depth(ms)]);
    }
    run.feed([boxes(300), boxes(600)]);
    run.finish();
    assert_eq!(run.keyframes(), [300, 600]);
    assert_eq!(run.posed(), (0..900).step_by(100).collect::<Vec<_>>());
}

#[test]
fn an_empty_list_of_boxes_makes_a_keyframe_without_objects() {
    let mut run = Run::ready();
    run.feed([odometry(0), odometry(200), depth(100), boxes(100)]);
    let keyframe = &run.total.keyframes[0];
    assert!(keyframe.boxes.is_empty());
    assert_eq!(run.slam.objects().count(), 0);
}
