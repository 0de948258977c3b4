//! Our errors as the exceptions of `ellipsoid_slam.errors`, each with its sentence.

use ellipsoid_slam::io::MapFileError;
use pyo3::PyErr;
use std::{fmt::Display, path::Path};

/// The exceptions, as Python declares them.
mod python {
    pyo3::import_exception!(ellipsoid_slam.errors, BagError);
    pyo3::import_exception!(ellipsoid_slam.errors, FrameError);
    pyo3::import_exception!(ellipsoid_slam.errors, MapError);
    pyo3::import_exception!(ellipsoid_slam.errors, SettingsError);
}

/// What is not a frame.
pub(crate) fn frame(why: impl Display) -> PyErr {
    python::FrameError::new_err(why.to_string())
}

/// What is not a setting.
pub(crate) fn settings(why: impl Display) -> PyErr {
    python::SettingsError::new_err(why.to_string())
}

/// What a bag lacks.
pub(crate) fn bag(why: impl Display) -> PyErr {
    python::BagError::new_err(why.to_string())
}

/// What is not a map, or cannot be saved as one.
pub(crate) fn map(why: impl Display) -> PyErr {
    python::MapError::new_err(why.to_string())
}

/// The same of a file.
pub(crate) fn map_file(path: &Path, why: &MapFileError) -> PyErr {
    map(format!("{}: {why}", path.display()))
}
