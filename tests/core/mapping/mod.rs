//! The object map, fed with hand-made measurements.

mod approach;
mod association;
mod coverage;
mod drift;
mod editing;
mod forward_camera;
mod fusion;
mod generations;
mod glimpses;
mod life;
mod loop_closing;
mod merging;
mod moving;
mod pushes;
mod queries;
mod relocalisation;
mod soak;
mod standing;
mod walls;

use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose},
    mapping::{
        Association, KernelShape, MapObject, MappingSettings, Measured, ObjectId, ObjectMap,
        Observation, ObservedBox, Sighting, SlamSettings,
    },
    time::Stamp,
};
use nalgebra::{SMatrix, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

pub(crate) type Covariance = SMatrix<f64, 9, 9>;

/// Seen from the origin of the map, without a box.
pub(crate) fn observation(
    label: &str,
    ellipsoid: Ellipsoid,
    covariance: Covariance,
) -> Observation {
    Observation {
        track: None,
        labels: vec![(label.into(), 0.9)],
        outline: Outline::Cuboid,
        moves: false,
        rect: None,
        sides: ObservedBox { base_from_camera: Pose::identity(), sides: [None; 4] },
        measured: Some(Measured {
            ellipsoid,
            covariance,
            probability: 0.7,
            support: None,
            faces: None,
            usual_m: None,
            glimpse: None,
        }),
    }
}

/// Six cabinets in a ring.
pub(crate) fn ring_of_cabinets() -> Vec<Ellipsoid> {
    let cabinet = |i: u32| {
        let angle = f64::from(i) * 1.05;
        let place = Vector3::new(1.5 * angle.cos(), 1.5 * angle.sin(), 0.4);
        Ellipsoid::new(upright_pose(0.5 * f64::from(i), place), Vector3::new(0.4, 0.25, 0.4))
    };
    (0..6).map(cabinet).collect()
}

/// The pose of a robot that drives round such a ring and looks to its middle, 79 steps a round.
pub(crate) fn round_the_ring(step: usize) -> Pose {
    let angle = step as f64 * 0.08;
    let place = Vector3::new(3.5 * angle.cos(), 3.5 * angle.sin(), 0.0);
    upright_pose(angle + std::f64::consts::PI, place)
}

/// It is known which object each observation is of, and one is enough.
pub(crate) fn given_identities() -> MappingSettings {
    MappingSettings {
        association: Association::Given,
        min_observations: 1,
        ..MappingSettings::default()
    }
}

/// Nearly normal, with a standard deviation of 1.
pub(crate) fn normal(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()
}

/// Standard deviations of heading [rad], centre [m] and semi-axes [m], without correlations.
pub(crate) fn independent(e: &Ellipsoid, heading: f64, center: f64, size: f64) -> Covariance {
    let mut covariance = Covariance::zeros();
    for i in 0..3 {
        covariance[(i, i)] = if i == 2 { heading * heading } else { 4e-4 };
        covariance[(3 + i, 3 + i)] = center * center;
        covariance[(6 + i, 6 + i)] = (size / e.semi_axes[i]).powi(2);
    }
    covariance
}

/// As a camera measures: each face -x, +x, -y, +y, -z, +z with a standard deviation of its own [m].
pub(crate) fn by_faces(e: &Ellipsoid, heading: f64, faces: [f64; 6]) -> Covariance {
    let mut covariance = independent(e, heading, 1.0, 1.0);
    for axis in 0..3 {
        let (low, high) = (faces[2 * axis].powi(2), faces[2 * axis + 1].powi(2));
        let (t, s, semi) = (3 + axis, 6 + axis, e.semi_axes[axis]);
        covariance[(t, t)] = 0.25 * (low + high);
        covariance[(s, s)] = 0.25 * (low + high) / (semi * semi);
        covariance[(t, s)] = 0.25 * (high - low) / semi;
        covariance[(s, t)] = covariance[(t, s)];
    }
    covariance
}

/// Poses are given and every view counts in full: no kernel, no floors.
pub(crate) fn slam_settings() -> SlamSettings {
    SlamSettings {
        optimize_poses: false,
        kernel: KernelShape::Quadratic,
        similar_views_correlation: 0.0,
        min_position_sigma_m: 0.0,
        min_size_sigma_m: 0.0,
        min_heading_sigma_deg: 0.0,
        ..SlamSettings::default()
    }
}

/// A map after these observations from one place, one a second.
pub(crate) fn map_of(observations: impl IntoIterator<Item = Observation>) -> ObjectMap {
    map_with(slam_settings(), observations)
}

pub(crate) fn map_with(
    slam: SlamSettings,
    observations: impl IntoIterator<Item = Observation>,
) -> ObjectMap {
    map_from(&Pose::identity(), slam, observations)
}

/// A map after these observations from one place, where odometry says that it is.
pub(crate) fn map_from(
    odom_from_base: &Pose,
    slam: SlamSettings,
    observations: impl IntoIterator<Item = Observation>,
) -> ObjectMap {
    let mut map = ObjectMap::new(MappingSettings::default(), slam);
    for (second, observation) in observations.into_iter().enumerate() {
        observe_from(odom_from_base, &mut map, second as f64, vec![observation]);
    }
    map.finish();
    map
}

/// Joins what is seen from the origin; which objects it is.
pub(crate) fn observe(
    map: &mut ObjectMap,
    second: f64,
    observations: Vec<Observation>,
) -> Vec<Option<ObjectId>> {
    observe_from(&Pose::identity(), map, second, observations)
}

fn observe_from(
    odom_from_base: &Pose,
    map: &mut ObjectMap,
    second: f64,
    observations: Vec<Observation>,
) -> Vec<Option<ObjectId>> {
    let sighted = map.observe(&Sighting {
        stamp: Stamp::from_secs(second),
        odom_from_base: *odom_from_base,
        odometry_covariance: None,
        observations,
        walls: Vec::new(),
        view: None,
    });
    assert_eq!(sighted.refused, None);
    sighted.objects
}

pub(crate) fn only(map: &ObjectMap) -> &MapObject {
    assert_eq!(map.all().len(), 1, "{:?}", map.all());
    &map.all()[0]
}
