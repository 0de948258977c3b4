//! The surface of a superquadric as triangles, for viewers that have no shape for it.

use crate::msg::geometry_msgs::Point;
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Corners round the footprint and from pole to pole: at a cup's size more of them are not seen.
const ROUND: u32 = 16;
const RINGS: u32 = 8;

/// Three corners a triangle, counterclockwise from outside, of the superquadric (Barr 1981) with exponents of profile and
/// footprint and with semi-axes (m), in its own frame.
pub(super) fn superquadric_triangles(
    profile: f64,
    footprint: f64,
    semi_axes: &Vector3<f64>,
) -> Vec<Point> {
    let at = |ring: u32, turn: u32| {
        let up = -FRAC_PI_2 + 2.0 * FRAC_PI_2 * f64::from(ring) / f64::from(RINGS);
        let around = TAU * f64::from(turn % ROUND) / f64::from(ROUND);
        let wide = power(up.cos(), profile);
        let on_unit = Vector3::new(
            wide * power(around.cos(), footprint),
            wide * power(around.sin(), footprint),
            power(up.sin(), profile),
        );
        let [x, y, z]: [f64; 3] = on_unit.component_mul(semi_axes).into();
        Point { x, y, z }
    };
    let mut corners = Vec::with_capacity(6 * (ROUND * (RINGS - 1)) as usize);
    for ring in 0..RINGS {
        for turn in 0..ROUND {
            let (low, low_next) = (at(ring, turn), at(ring, turn + 1));
            let (high, high_next) = (at(ring + 1, turn), at(ring + 1, turn + 1));
            // At the poles one of the two triangles has no extent.
            if ring > 0 {
                corners.extend([low, low_next, high_next]);
            }
            if ring + 1 < RINGS {
                corners.extend([low, high_next, high]);
            }
        }
    }
    corners
}

/// A power that keeps the sign. What is zero but for rounding stays so: small exponents would make something of it.
fn power(value: f64, exponent: f64) -> f64 {
    if value.abs() < 1e-12 { 0.0 } else { value.signum() * value.abs().powf(exponent) }
}
