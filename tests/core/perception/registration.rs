use ellipsoid_slam::{
    geometry::{Camera, Distortion, Pose},
    perception::{DepthImage, DepthNoise, Rays},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const FOCAL: f64 = 100.0;

fn camera() -> Camera {
    camera_of((64, 48), FOCAL)
}

fn camera_of((width, height): (u32, u32), focal: f64) -> Camera {
    let principal = (f64::from(width) / 2.0 - 0.5, f64::from(height) / 2.0 - 0.5);
    Camera::new((width, height), (focal, focal), principal, Distortion::None).unwrap()
}

/// As a camera whose readings are good to 2 cm sees it.
fn register_depth(depth: &DepthImage, rays: &Rays, to: &Camera, there: &Pose) -> DepthImage {
    let noise = DepthNoise { base_m: 0.02, quadratic_per_m: 0.0, best_range_m: 0.0 };
    ellipsoid_slam::perception::register_depth(depth, rays, to, there, &noise)
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
fn the_nearest_surface_wins() {
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

/// A fine depth image of a colour image with a third of its columns and rows: nine readings a pixel.
fn fine_image(depth: impl FnMut(usize, usize) -> f32) -> (DepthImage, Rays) {
    let (width, height) = (3 * 64, 3 * 48);
    let mut depth = depth;
    let pixels = (0..height).flat_map(|v| (0..width).map(move |u| (u, v)));
    let metres = pixels.map(|(u, v)| depth(u, v)).collect();
    let rays = Rays::new(camera_of((width as u32, height as u32), 3.0 * FOCAL));
    (DepthImage::new(width as u32, height as u32, metres).unwrap(), rays)
}

#[test]
fn many_noisy_readings_a_pixel_are_not_taken_too_near() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    // The sum of twelve uniform numbers has a variance of one.
    let mut normal = || (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f32>();
    let (noisy, rays) = fine_image(|_, _| 3.0 + 0.02 * normal());
    let got = register_depth(&noisy, &rays, &camera(), &Pose::identity());
    let off: Vec<f32> = got.metres().iter().map(|z| z - 3.0).collect();
    let mean = off.iter().sum::<f32>() / off.len() as f32;
    let sigma = (off.iter().map(|x| x * x).sum::<f32>() / off.len() as f32).sqrt();
    // The nearest of nine readings is 1.49 standard deviations too near: 30 mm. A median of nine scatters by 0.4 of them.
    assert!(mean.abs() < 0.001, "{mean} m too far");
    assert!((0.006..0.01).contains(&sigma), "{sigma} m");
}

#[test]
fn a_slope_that_falls_off_within_a_pixel_stays_where_it_is() {
    let (slope, rays) = fine_image(|_, v| 2.0 + 0.03 * v as f32);
    let got = register_depth(&slope, &rays, &camera(), &Pose::identity());
    // Three rows of the fine image lie on one of the other's, and the middle one is at its middle.
    for v in 0..48 {
        let expected = 2.0 + 0.03 * (3 * v + 1) as f32;
        assert!((got.at(30, v).unwrap() - expected).abs() < 1e-3, "row {v}");
    }
}

#[test]
fn near_things_do_not_grow_in_a_coarser_image() {
    // It covers columns 20 to 29 of the other image, of column 19 and of column 30 less than a third each.
    let rows = 3 * 10..3 * 20;
    let is_near = |u: usize, v: usize| (3 * 20..3 * 30).contains(&u) && rows.contains(&v);
    let shifted = Pose::translation(-0.001, 0.0, 0.0);
    let (two, rays) = fine_image(|u, v| if is_near(u, v) { 1.0 } else { 4.0 });
    let got = register_depth(&two, &rays, &camera(), &shifted);
    let near = (0..64).filter(|u| got.at(*u, 15).is_some_and(|z| z < 2.0));
    assert_eq!(near.collect::<Vec<_>>(), (20..30).collect::<Vec<_>>());
}

#[test]
fn what_is_behind_the_other_camera_is_left_out() {
    let wall = image(|_, _| 2.0);
    let behind = Pose::translation(0.0, 0.0, -3.0);
    let got = register_depth(&wall, &Rays::new(camera()), &camera(), &behind);
    assert!(got.metres().iter().all(|z| z.is_nan()));
}
