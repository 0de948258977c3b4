//! What values have to be to each other, and the numbers of arrays.

use super::ConfigError;
use crate::{
    geometry::Outline,
    mapping::{LabelSettings, LifeSettings},
    perception::{ClassPrior, Classes},
    pipeline::Settings,
};

/// Extents of things that a robot can meet (m).
const SIZES_M: [f64; 2] = [0.001, 100.0];
/// Exponents of superquadrics below are cuboids, to the last digits of what is seen of them.
const LEAST_EXPONENT: f64 = 0.01;
/// Above, a footprint is a rhombus, whose corners have no tangent.
const LARGEST_FOOTPRINT: f64 = 1.99;
/// Groups of classes that are alike, and names in one.
const MOST_ALIKE: usize = 1000;

/// Checks what the range of a single key cannot say.
pub(super) fn check_together(settings: &Settings) -> Result<(), ConfigError> {
    let Classes { unlisted, listed } = &settings.perception.classes;
    check_class("unlisted", unlisted)?;
    for (label, class) in listed {
        check_class(&format!("listed.{label}"), class)?;
    }
    check_labels(&settings.mapping.labels)?;
    check_life(&settings.mapping.life)
}

fn check_class(name: &str, class: &ClassPrior) -> Result<(), ConfigError> {
    let unfit = |part: &str, wanted| {
        let path = format!("perception.classes.{name}.{part}");
        Err(ConfigError::Unfit { path, wanted })
    };
    if let Some(size_m) = class.size_m {
        let [low, high] = SIZES_M;
        if !size_m.iter().all(|metres| (low..=high).contains(metres)) {
            return unfit("size_m", "has to be three numbers from 0.001 to 100 [m]");
        }
        if size_m[0] < size_m[1] {
            return unfit("size_m", "has to be [long, short, height]: the longer side comes first");
        }
    }
    match class.outline {
        Outline::Superquadric(profile, footprint)
            if !(LEAST_EXPONENT..=1.0).contains(&profile)
                || !(LEAST_EXPONENT..=LARGEST_FOOTPRINT).contains(&footprint) =>
        {
            unfit(
                "outline",
                "has to have exponents from 0.01 to 1 (profile) and to 1.99 (footprint)",
            )
        }
        _ => Ok(()),
    }
}

fn check_labels(labels: &LabelSettings) -> Result<(), ConfigError> {
    let unfit = |name: &str, wanted| {
        Err(ConfigError::Unfit { path: format!("mapping.labels.{name}"), wanted })
    };
    let sizes = labels.alike.iter().map(Vec::len);
    if sizes.chain([labels.alike.len()]).any(|count| count > MOST_ALIKE) {
        return unfit("alike", "may have 1000 groups of 1000 names at most");
    }
    if labels.wrong > labels.confused {
        return unfit("wrong", "must not be above `mapping.labels.confused`");
    }
    Ok(())
}

fn check_life(life: &LifeSettings) -> Result<(), ConfigError> {
    if life.false_detection_probability >= life.detection_probability {
        return Err(ConfigError::Unfit {
            path: "mapping.life.false_detection_probability".into(),
            wanted: "has to be below `mapping.life.detection_probability`",
        });
    }
    Ok(())
}
