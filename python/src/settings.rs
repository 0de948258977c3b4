//! Settings: a parameter file, and a dictionary above it.

use crate::errors;
use ellipsoid_slam::config::{Parameters, parameters_from_yaml};
use pyo3::{FromPyObject, PyResult, pyfunction};
use serde_json::Value;
use std::{fmt::Display, fs, path::PathBuf};

/// A parameter file, if there is one, and a JSON object whose keys count more.
#[derive(FromPyObject)]
pub(crate) struct SettingsArgument(Option<PathBuf>, String);

impl SettingsArgument {
    /// What both say, on top of the defaults.
    pub(crate) fn parameters(&self) -> PyResult<Parameters> {
        let mut parameters = match &self.0 {
            None => Parameters::default(),
            Some(path) => {
                let in_file =
                    |why: &dyn Display| errors::settings(format!("{}: {why}", path.display()));
                let text = fs::read_to_string(path).map_err(|why| in_file(&why))?;
                parameters_from_yaml(&text).map_err(|why| in_file(&why))?
            }
        };
        let given: Value = serde_json::from_str(&self.1).map_err(errors::settings)?;
        parameters.overlay(&given).map_err(errors::settings)?;
        Ok(parameters)
    }
}

/// All settings as JSON.
#[pyfunction]
pub(crate) fn settings_json(settings: SettingsArgument) -> PyResult<String> {
    Ok(settings.parameters()?.tree().map_err(errors::settings)?.to_string())
}
