//! The object map, fed with hand-made measurements.

mod association;
mod fusion;

use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline},
    mapping::{MapObject, MappingSettings, ObjectMap, Observation},
    time::Stamp,
};
use nalgebra::SMatrix;

pub(crate) type Covariance = SMatrix<f64, 9, 9>;

pub(crate) fn observation(
    label: &str,
    ellipsoid: Ellipsoid,
    covariance: Covariance,
) -> Observation {
    Observation {
        track: None,
        labels: vec![(label.into(), 0.9)],
        ellipsoid,
        covariance,
        outline: Outline::Cuboid,
        probability: 0.7,
        support_height_m: None,
    }
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

/// A map after these measurements, one a second.
pub(crate) fn map_of(observations: impl IntoIterator<Item = Observation>) -> ObjectMap {
    let mut map = ObjectMap::default();
    for (second, observation) in observations.into_iter().enumerate() {
        map.observe(Stamp::from_secs(second as f64), &[observation], &MappingSettings::default());
    }
    map
}

pub(crate) fn only(map: &ObjectMap) -> &MapObject {
    assert_eq!(map.all().len(), 1, "{:?}", map.all());
    &map.all()[0]
}
