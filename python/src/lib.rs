//! What the Python package `ellipsoid_slam` is made of: its Python sources check arrays and shape what comes out; here it
//! is computed, without the interpreter's lock.

mod arguments;
mod errors;
mod map;
mod replay;
mod run;
mod settings;
mod slam;
mod update;

/// The compiled half of the package.
#[pyo3::pymodule(gil_used = false)]
mod _native {
    #[pymodule_export]
    use crate::{
        map::{map_json, parse_map, pose_from_matrix, read_map, write_map},
        replay::replay,
        settings::settings_json,
        slam::Slam,
    };
}
