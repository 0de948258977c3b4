//! How long it takes to say which of a thousand objects twenty boxes show: `cargo bench --bench association`.
#![expect(clippy::unwrap_used, reason = "a benchmark ends where something is not as it should be")]
#![expect(clippy::disallowed_methods, reason = "a benchmark reads the clock")]

use ellipsoid_slam::{
    geometry::{Camera, Distortion, Ellipsoid, Outline, Pose, Rect},
    mapping::{
        MappingSettings, Measured, ObjectMap, Observation, ObservedBox, Sighting, SlamSettings,
        View,
    },
    perception::{DepthImage, DepthNoise},
    time::Stamp,
};
use nalgebra::{SMatrix, Translation3, UnitQuaternion, Vector3};
use std::{f64::consts::FRAC_PI_2, time::Instant};

const ROWS: usize = 50;
const IN_A_ROW: usize = 20;
const REPEATS: usize = 200;

fn main() {
    let mut map = ObjectMap::new(MappingSettings::default(), SlamSettings::default());
    let camera = Camera::new((640, 480), (300.0, 300.0), (319.5, 239.5), Distortion::None).unwrap();
    let depth = DepthImage::new(640, 480, vec![4.0; 640 * 480]).unwrap();
    for pass in 0..3 {
        for row in 0..ROWS {
            let sighting = sighting(row, 0.02 * f64::from(pass), &camera, &depth);
            assert_eq!(map.observe(&sighting).refused, None);
        }
    }
    let sighting = sighting(ROWS - 1, 0.01, &camera, &depth);
    let found = map.recognise(&sighting).iter().flatten().count();
    let mut times: Vec<f64> = (0..REPEATS)
        .map(|_| {
            let start = Instant::now();
            std::hint::black_box(map.recognise(&sighting));
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!(
        "{} objects, {IN_A_ROW} boxes, {found} known again: median {:.2} ms, 95 % {:.2} ms",
        map.all().len(),
        times[REPEATS / 2],
        times[REPEATS * 95 / 100]
    );
}

/// A robot that drives along x past rows of cups, looking to the left: one row a keyframe.
fn sighting<'a>(row: usize, along: f64, camera: &'a Camera, depth: &'a DepthImage) -> Sighting<'a> {
    let odom_from_base = Pose::translation(4.0 * row as f64 + along, 0.0, 0.0);
    let rotation = UnitQuaternion::from_euler_angles(-FRAC_PI_2, 0.0, 0.0);
    let base_from_camera = Pose::from_parts(Translation3::new(0.0, 0.0, 0.5), rotation);
    let observations = (0..IN_A_ROW).map(|i| {
        let (column, line) = ((i % 10) as f64, (i / 10) as f64);
        let center = Pose::translation(0.3 * (column - 4.5) - along, 2.0 + line, 0.3 + 0.4 * line);
        let body = Ellipsoid::new(center, Vector3::new(0.06, 0.05, 0.08));
        observation(body, base_from_camera, camera)
    });
    Sighting {
        stamp: Stamp::from_secs(row as f64),
        odom_from_base,
        odometry_covariance: None,
        observations: observations.collect(),
        walls: Vec::new(),
        view: Some(View {
            base_from_camera,
            camera,
            depth,
            noise: DepthNoise::default(),
            max_range_m: 6.0,
        }),
    }
}

fn observation(body: Ellipsoid, base_from_camera: Pose, camera: &Camera) -> Observation {
    let mut covariance = SMatrix::<f64, 9, 9>::identity() * 4e-4;
    (6..9).for_each(|i| covariance[(i, i)] = 0.04);
    let center = base_from_camera.inverse() * body.center();
    let at = |x: f64, y: f64| camera.project(&(center + Vector3::new(x, y, 0.0))).unwrap();
    let (low, high) = (at(-0.06, -0.08), at(0.06, 0.08));
    Observation {
        labels: vec![("cup".into(), 0.9)],
        track: None,
        moves: false,
        outline: Outline::Cuboid,
        rect: Rect::new(low.x, low.y, high.x, high.y),
        sides: ObservedBox { base_from_camera, sides: [None; 4] },
        measured: Some(Measured {
            ellipsoid: body,
            covariance,
            probability: 0.8,
            support: None,
            faces: None,
            usual_m: None,
            glimpse: None,
        }),
    }
}
