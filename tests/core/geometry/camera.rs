use super::ROUNDING;
use ellipsoid_slam::geometry::{Camera, CameraError, Distortion};
use nalgebra::{Point3, Vector2};
use proptest::prelude::*;

fn camera(distortion: Distortion) -> Camera {
    Camera::new((640, 480), (525.0, 520.0), (319.5, 239.5), distortion).unwrap()
}

/// Lenses as calibrations of depth cameras give them.
const LENSES: [Distortion; 4] = [
    Distortion::None,
    Distortion::PlumbBob([0.262383, -0.953104, -0.005358, 0.002628, 1.163314]),
    Distortion::PlumbBob([-0.28, 0.07, 0.0002, 0.00002, 0.0]),
    Distortion::Rational([0.55, -2.67, 0.00035, -0.0003, 1.53, 0.43, -2.49, 1.46]),
];

#[test]
fn x_goes_right_y_goes_down_z_goes_ahead() {
    let camera = camera(Distortion::None);
    let pixel = |x, y, z| camera.project(&Point3::new(x, y, z)).unwrap();
    assert_eq!(pixel(0.0, 0.0, 2.0), Point3::new(319.5, 239.5, 0.0).xy());
    assert_eq!(pixel(0.2, 0.0, 2.0), Point3::new(319.5 + 52.5, 239.5, 0.0).xy());
    assert_eq!(pixel(0.0, 0.2, 2.0), Point3::new(319.5, 239.5 + 52.0, 0.0).xy());
    assert_eq!(camera.project(&Point3::new(0.0, 0.0, -2.0)), None, "behind the camera");
    assert_eq!(camera.project(&Point3::new(0.0, 0.0, 0.0)), None, "at the camera");
}

#[test]
fn distortion_by_hand() {
    // At (0.4, 0.2): r2 = 0.2.
    let project = |d| {
        let pixel = camera(d).project(&Point3::new(0.4, 0.2, 1.0)).unwrap();
        Vector2::new((pixel.x - 319.5) / 525.0, (pixel.y - 239.5) / 520.0)
    };
    for (distortion, x, y) in [
        // A barrel: 1 - 0.5 * 0.2.
        (Distortion::PlumbBob([-0.5, 0.0, 0.0, 0.0, 0.0]), 0.36, 0.18),
        (Distortion::PlumbBob([0.0, 1.0, 0.0, 0.0, 0.0]), 0.416, 0.208),
        (Distortion::PlumbBob([0.0, 0.0, 0.0, 0.0, 10.0]), 0.432, 0.216),
        // p1 (r2 + 2 y^2) goes to y and 2 p1 x y to x.
        (Distortion::PlumbBob([0.0, 0.0, 0.1, 0.0, 0.0]), 0.416, 0.228),
        (Distortion::PlumbBob([0.0, 0.0, 0.0, 0.1, 0.0]), 0.452, 0.216),
        // 1 / (1 + 0.25)
        (Distortion::Rational([0.0, 0.0, 0.0, 0.0, 0.0, 1.25, 0.0, 0.0]), 0.32, 0.16),
    ] {
        let off = (project(distortion) - Vector2::new(x, y)).norm();
        assert!(off < ROUNDING, "{distortion:?} is off by {off}");
    }
}

#[test]
fn numbers_that_are_no_camera_are_refused() {
    let new = |size, focal, principal| Camera::new(size, focal, principal, Distortion::None);
    let good = ((640, 480), (500.0, 500.0), (320.0, 240.0));
    assert!(new(good.0, good.1, good.2).is_ok());
    assert!(matches!(new((0, 480), good.1, good.2), Err(CameraError::EmptyImage { .. })));
    for focal in [(0.0, 500.0), (500.0, -1.0), (f64::NAN, 500.0), (500.0, f64::INFINITY)] {
        assert!(matches!(new(good.0, focal, good.2), Err(CameraError::FocalLength { .. })));
    }
    assert_eq!(new(good.0, good.1, (f64::NAN, 0.0)), Err(CameraError::NotFinite));
    let lens = Distortion::PlumbBob([f64::NAN, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(Camera::new(good.0, good.1, good.2, lens), Err(CameraError::NotFinite));
}

#[test]
fn no_distortion_is_one_thing() {
    for zeros in [Distortion::PlumbBob([0.0; 5]), Distortion::Rational([0.0; 8])] {
        assert_eq!(camera(zeros), camera(Distortion::None));
    }
    for lens in LENSES {
        assert_eq!(camera(lens).rectified(), camera(Distortion::None));
    }
}

#[test]
fn every_pixel_of_a_real_lens_has_a_ray() {
    for lens in LENSES {
        let camera = camera(lens);
        for (u, v) in [(0.0, 0.0), (639.0, 0.0), (0.0, 479.0), (639.0, 479.0), (319.5, 0.0)] {
            let ray = camera.ray(u, v);
            let back = camera.project(&Point3::from(ray)).unwrap();
            let off = (back.x - u).hypot(back.y - v);
            assert!(off < 0.01, "{lens:?} at ({u}, {v}): {off} px");
        }
    }
}

proptest! {
    /// A hundredth of a pixel, as promised.
    #[test]
    fn a_ray_is_seen_where_it_came_from(
        lens in 0..LENSES.len(), u in 0.0..639.0, v in 0.0..479.0, range in 0.1..8.0,
    ) {
        let camera = camera(LENSES[lens]);
        let pixel = camera.project(&Point3::from(camera.ray(u, v) * range)).unwrap();
        prop_assert!((pixel.x - u).hypot(pixel.y - v) < 0.01);
    }

    #[test]
    fn a_point_lies_on_the_ray_of_its_pixel(
        lens in 0..LENSES.len(), x in -0.5..0.5, y in -0.4..0.4, z in 0.1..8.0,
    ) {
        let camera = camera(LENSES[lens]);
        let point = Point3::new(x * z, y * z, z);
        let pixel = camera.project(&point).unwrap();
        prop_assert!((camera.ray(pixel.x, pixel.y) * z - point.coords).norm() < 1e-4 * z);
    }
}
