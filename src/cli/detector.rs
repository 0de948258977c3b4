//! The detector that commands use: what arguments say of it, and how it is loaded.

use crate::{config::DetectorSettings, msg::convert::FindBoxes};
use std::path::PathBuf;

/// A model of one's own.
#[derive(Clone, Debug, Default, clap::Args)]
pub(super) struct DetectorArgs {
    /// Find the boxes in the colour images with this detector, an ONNX model; docs/detectors.md says which.
    #[arg(long, value_name = "FILE.onnx")]
    model: Option<PathBuf>,
    /// Names of its classes, one a line; without it the model's own, or those of COCO.
    #[arg(long, value_name = "FILE")]
    labels: Option<PathBuf>,
}

impl DetectorArgs {
    /// The settings with what the arguments say.
    pub(super) fn over(&self, settings: &DetectorSettings) -> DetectorSettings {
        let text = |path: &Option<PathBuf>, otherwise: &str| {
            path.as_ref().map_or(otherwise.to_owned(), |path| path.to_string_lossy().into_owned())
        };
        DetectorSettings {
            model: text(&self.model, &settings.model),
            labels: text(&self.labels, &settings.labels),
            ..settings.clone()
        }
    }
}

/// A detector, and what it is in words.
pub(super) struct Loaded {
    pub(super) find: FindBoxes,
    pub(super) described: String,
    /// Whether its boxes have masks.
    pub(super) has_masks: bool,
}

/// The detector of the settings; nothing if they name none.
#[cfg(feature = "detector")]
pub(super) fn load(settings: &DetectorSettings) -> anyhow::Result<Option<Loaded>> {
    use crate::detector::{Detector, Labels};
    use anyhow::Context;
    use std::fs;

    if settings.model.is_empty() {
        return Ok(None);
    }
    let onnx = fs::read(&settings.model)
        .with_context(|| format!("cannot read the model {}", settings.model))?;
    let labels = match settings.labels.as_str() {
        "" => None,
        path => {
            let text = fs::read_to_string(path)
                .with_context(|| format!("cannot read the labels {path}"))?;
            Some(Labels::from_lines(&text))
        }
    };
    let detector = Detector::new(onnx, labels, settings).with_context(|| settings.model.clone())?;
    let [width, height] = detector.input_size();
    let has_masks = detector.has_masks();
    let with_masks = if has_masks { " with masks" } else { "" };
    let described =
        format!("a model of the form {}{with_masks} for {width}x{height}", detector.form());
    let find = Box::new(move |image: &_| detector.detect(image).map_err(|e| e.to_string()));
    Ok(Some(Loaded { find, described, has_masks }))
}

/// Without the feature there is none.
#[cfg(not(feature = "detector"))]
pub(super) fn load(settings: &DetectorSettings) -> anyhow::Result<Option<Loaded>> {
    match settings.model.as_str() {
        "" => Ok(None),
        model => anyhow::bail!("{model}: this program was built without the feature `detector`"),
    }
}
