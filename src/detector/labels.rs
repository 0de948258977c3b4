//! Names of the classes that a network numbers.

use crate::msg::coco;
use std::collections::BTreeMap;
use thiserror::Error;

/// Names of classes by their index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Labels(Vec<String>);

/// Why classes have no names.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum LabelError {
    /// As many names as classes are needed.
    #[error(
        "the model knows {classes} classes, but there are {names} labels: give a file with a name a line"
    )]
    Count {
        /// What the model knows.
        classes: usize,
        /// What there are names for.
        names: usize,
    },
    /// Neither a file nor the model names them, and they are not those of COCO.
    #[error(
        "the model knows {classes} classes, which are not the 80 of COCO, and does not name them: \
         give a file with a name a line"
    )]
    Unnamed {
        /// What the model knows.
        classes: usize,
    },
}

impl Labels {
    /// Names from a text with one a line; blank lines at the end do not count.
    pub fn from_lines(text: &str) -> Self {
        Self(text.trim_end().lines().map(|line| line.trim().to_owned()).collect())
    }

    /// Names from what Ultralytics writes into a model: `{0: 'person', 1: 'bicycle'}`.
    pub(super) fn from_metadata(names: &str) -> Option<Self> {
        let names: BTreeMap<usize, String> = serde_saphyr::from_str(names).ok()?;
        let without_gaps = names.keys().enumerate().all(|(at, index)| at == *index);
        without_gaps.then(|| Self(names.into_values().collect()))
    }

    /// The given names if they are as many as the `classes`, those of COCO where none are given.
    ///
    /// # Errors
    /// When there are too few or too many.
    pub(super) fn for_classes(given: Option<Self>, classes: usize) -> Result<Self, LabelError> {
        match given {
            Some(labels) if labels.0.len() == classes => Ok(labels),
            Some(labels) => Err(LabelError::Count { classes, names: labels.0.len() }),
            None if classes == coco::NAMES.len() => {
                Ok(Self(coco::NAMES.map(str::to_owned).to_vec()))
            }
            None => Err(LabelError::Unnamed { classes }),
        }
    }

    /// The name of a class.
    pub(super) fn get(&self, class: usize) -> Option<&str> {
        self.0.get(class).map(String::as_str)
    }
}
