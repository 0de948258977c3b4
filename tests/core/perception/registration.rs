use ellipsoid_slam::{
    geometry::{Camera, Distortion, Pose},
    perception::{DepthImage, Rays, register_depth},
};

const FOCAL: f64 = 100.0;

fn camera() -> Camera {
    camera_of((64, 48), FOCAL)
}

fn camera_of((width, height): (u32, u32), focal: f64) -> Camera {
    let principal = (f64::from(width) / 2.0 - 0.5, f64::from(height) / 2.0 - 0.5);
    Camera::new((width, height), (focal, focal), principal, Distortion::None).unwrap()
}

fn image(depth: impl Fn(usize, usize) -> f32) -> DepthImage {
    let pixels = (0..48).flat_map(|v| (0..64).map(move |u| (u, v)));
    DepthImage::new(64, 48, pixels.map(|(u, v)| depth(u, v)).collect()).unwrap()
}

#[test]
fn the_same_camera_changes_nothing() {
    let slope = image(|u, v| if (u * v) % 7 == 0 { 0.0 } else { 1.0 + 0.01 * (u + v) as f32 });
    let got = register_depth(&slope, &Rays::new(camera()), &camera(), &Pose::identity());
    for (a, b) in got.metres().iter().zip(slope.metres()) {
        assert!(a.is_nan() && b.is_nan() || (a - b).abs() < 1e-5, "{a} {b}");
    }
}

#[test]
fn a_baseline_shifts_by_focal_length_times_baseline_over_depth() {
    // The depth camera sits 10 cm to the right of the other: things move right by 100 * 0.1 / 2 = 5 px.
    let one = image(|u, v| if (20..30).contains(&u) && (10..20).contains(&v) { 2.0 } else { 0.0 });
    let got =
        register_depth(&one, &Rays::new(camera()), &camera(), &Pose::translation(0.1, 0.0, 0.0));
    for v in 0..48 {
        for u in 0..64 {
            let expected = (25..35).contains(&u) && (10..20).contains(&v);
            assert_eq!(got.at(u, v), expected.then_some(2.0), "({u}, {v})");
        }
    }
    // Ahead by half a metre: depth grows by as much.
    let ahead = Pose::translation(0.0, 0.0, 0.5);
    let got = register_depth(&one, &Rays::new(camera()), &camera(), &ahead);
    assert!(got.metres().iter().all(|z| z.is_nan() || (z - 2.5).abs() < 1e-6));
}

#[test]
fn the_nearest_reading_wins() {
    // A near stripe shifts by 10 px, the wall behind it by 2.
    let stripe = |u: usize| (20..25).contains(&u);
    let two = image(|u, _| if stripe(u) { 1.0 } else { 5.0 });
    let got =
        register_depth(&two, &Rays::new(camera()), &camera(), &Pose::translation(0.1, 0.0, 0.0));
    for u in 4..64 {
        let expected = match u {
            30..35 => Some(1.0),
            22..27 => None,
            _ => Some(5.0),
        };
        assert_eq!(got.at(u, 24), expected, "column {u}");
    }
}

#[test]
fn a_finer_image_has_no_holes() {
    let fine = camera_of((128, 96), 2.0 * FOCAL);
    let wall = image(|_, _| 2.0);
    let got = register_depth(&wall, &Rays::new(camera()), &fine, &Pose::identity());
    let filled = (2..126).flat_map(|u| (2..94).map(move |v| (u, v)));
    assert!(filled.into_iter().all(|(u, v)| got.at(u, v) == Some(2.0)));
}

#[test]
fn what_is_behind_the_other_camera_is_left_out() {
    let wall = image(|_, _| 2.0);
    let behind = Pose::translation(0.0, 0.0, -3.0);
    let got = register_depth(&wall, &Rays::new(camera()), &camera(), &behind);
    assert!(got.metres().iter().all(|z| z.is_nan()));
}
