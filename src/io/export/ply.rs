//! A mesh in ASCII PLY: the outline of each object in its label's colour.

use crate::{
    mapping::{SavedMap, SavedObject},
    msg::convert::color_of,
};
use nalgebra::{Point3, Vector3};
use std::{fmt::Write, iter};

/// Each face of the cube that is bent to an outline has so many squares along a side.
const SQUARES: usize = 8;

pub(super) fn mesh(map: &SavedMap) -> String {
    let sides = cube_sides();
    let corners = (SQUARES + 1) * (SQUARES + 1);
    let (vertices, quads) = (corners * sides.len(), SQUARES * SQUARES * sides.len());
    let objects = map.objects.len();
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment frame {}, metres, z up\nelement vertex {}\nproperty double x\n\
         property double y\nproperty double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
         property uint object_id\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        map.frame_id.replace(char::is_control, " "),
        vertices * objects,
        quads * objects
    );
    for object in &map.objects {
        let [red, green, blue] = color_of(&object.label).map(|part| (255.0 * part).round() as u8);
        for point in sides.iter().flat_map(grid).map(|on_cube| on_outline(object, &on_cube)) {
            let id = u32::try_from(object.id).unwrap_or(u32::MAX);
            let Point3 { coords } = point;
            let (x, y, z) = (coords.x, coords.y, coords.z);
            let written = writeln!(text, "{x} {y} {z} {red} {green} {blue} {id}");
            debug_assert!(written.is_ok(), "writing to a string cannot fail");
        }
    }
    for side in 0..objects * sides.len() {
        for (row, column) in (0..SQUARES).flat_map(|r| iter::repeat(r).zip(0..SQUARES)) {
            let at = side * corners + row * (SQUARES + 1) + column;
            let above = at + SQUARES + 1;
            let written = writeln!(text, "4 {at} {} {} {above}", at + 1, above + 1);
            debug_assert!(written.is_ok(), "writing to a string cannot fail");
        }
    }
    text
}

/// Outward normal of each side of a cube, and two directions along it, so that the three are right-handed.
fn cube_sides() -> [[Vector3<f64>; 3]; 6] {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    [[x, y, z], [-x, z, y], [y, z, x], [-y, x, z], [z, x, y], [-z, y, x]]
}

/// Points on a side of the cube from -1 to 1, row by row.
fn grid([normal, along, up]: &[Vector3<f64>; 3]) -> impl Iterator<Item = Vector3<f64>> {
    let at = |k: usize| 2.0 * k as f64 / SQUARES as f64 - 1.0;
    (0..=SQUARES).flat_map(move |row| {
        (0..=SQUARES).map(move |column| normal + along * at(column) + up * at(row))
    })
}

/// Where a point of the cube lands when the cube is bent to the object's outline.
fn on_outline(object: &SavedObject, on_cube: &Vector3<f64>) -> Point3<f64> {
    let mut scaled = *on_cube;
    // Round footprints first become round, so that the edges of a cylinder stay sharp.
    if object.outline.is_round() {
        let (largest, length) = (scaled.xy().amax(), scaled.xy().norm());
        let bend = if length > 0.0 { largest / length } else { 1.0 };
        scaled = Vector3::new(bend * scaled.x, bend * scaled.y, scaled.z);
    }
    scaled /= object.outline.radius(&scaled);
    let own = scaled.component_mul(&object.ellipsoid.semi_axes);
    object.ellipsoid.pose * Point3::from(own)
}
