//! The map in forms that other programs read.

mod csv;
mod geojson;
mod ply;
mod sdf;

use crate::{geometry::Outline, mapping::SavedMap};

/// A form of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapFormat {
    /// A table, a line an object: for spreadsheets, numpy, pandas.
    Csv,
    /// A coloured mesh of the outlines: for Open3D, trimesh, MeshLab, Blender.
    Ply,
    /// Footprints on the ground: for GIS programs and planners.
    GeoJson,
    /// A world of static models: for Gazebo.
    Sdf,
}

/// The text of a file of this form. Everything is in metres and radians in the map's frame, with z up.
pub fn export_map(map: &SavedMap, format: MapFormat) -> String {
    match format {
        MapFormat::Csv => csv::table(map),
        MapFormat::Ply => ply::mesh(map),
        MapFormat::GeoJson => geojson::footprints(map),
        MapFormat::Sdf => sdf::world(map),
    }
}

/// The outline's name as in the map file.
fn outline_name(outline: Outline) -> &'static str {
    match outline {
        Outline::Ellipsoid => "ellipsoid",
        Outline::Cuboid => "cuboid",
        Outline::Cylinder => "cylinder",
        Outline::Superquadric(..) => "superquadric",
    }
}
