//! Which object a measurement belongs to.

use super::MapObject;
use crate::geometry::Ellipsoid;
use serde::{Deserialize, Serialize};

/// Who decides which measurement belongs to which object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Association {
    /// The map, by label and distance.
    #[default]
    Automatic,
    /// The detections' own identities ([`crate::perception::Detection::track`]); what has none is left out. The paper
    /// joins by hand, so its figures can only be compared like this.
    Given,
}

/// The gate: how far apart two views of one object may be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GateSettings {
    /// Distance of the centres on the ground, as a share of the footprint's half diagonal.
    pub max_distance_in_radii: f64,
    /// Distance allowed to the smallest objects (m).
    pub min_distance_m: f64,
}

impl Default for GateSettings {
    fn default() -> Self {
        Self { max_distance_in_radii: 0.8, min_distance_m: 0.08 }
    }
}

/// For each measurement the index of its object, nearest pairs first, each object once.
pub(super) fn associate(
    objects: &[MapObject],
    measured: &[(&str, Ellipsoid)],
    gate: &GateSettings,
) -> Vec<Option<usize>> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (m, (label, ellipsoid)) in measured.iter().enumerate() {
        for (o, object) in objects.iter().enumerate() {
            if object.label() != *label {
                continue;
            }
            let known = object.ellipsoid();
            let reach = gate
                .min_distance_m
                .max(gate.max_distance_in_radii * radius(&known).max(radius(ellipsoid)));
            let apart = ellipsoid.center() - known.center();
            let ratio = apart.xy().norm() / reach;
            if ratio <= 1.0 && apart.z.abs() <= reach + known.semi_axes.z + ellipsoid.semi_axes.z {
                pairs.push((ratio, m, o));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut of_measurement = vec![None; measured.len()];
    let mut taken = vec![false; objects.len()];
    for (_, m, o) in pairs {
        if of_measurement[m].is_none() && !taken[o] {
            of_measurement[m] = Some(o);
            taken[o] = true;
        }
    }
    of_measurement
}

fn radius(ellipsoid: &Ellipsoid) -> f64 {
    ellipsoid.semi_axes.xy().norm()
}
