//! Settings of the detector that runs in the program itself.

use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// Which model, and which of its boxes count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DetectorSettings {
    /// Its ONNX file; empty: none.
    pub model: String,
    /// A file with a class name a line; empty: the names in the model, or those of COCO.
    pub labels: String,
    /// The form of the model's output.
    pub form: ModelForm,
    /// Boxes with a lower score are left out.
    pub min_score: f64,
    /// Of boxes of one class that overlap by more than this (intersection over union) the best is kept.
    pub max_overlap: f64,
    /// Names of the classes that count, joined by commas; empty: all.
    pub classes: String,
    /// Most images a second that the live node looks at.
    pub max_hz: f64,
}

/// What a network gives, and how it wants its images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelForm {
    /// Told from the shape of the output.
    #[default]
    Auto,
    /// YOLOX, as its own exporter writes it: a row a cell of three grids, relative to it.
    Yolox,
    /// YOLOv5, v6 and v7: a row an anchor, in pixels.
    Yolov5,
    /// YOLOv8, v9, v11 and v12 of Ultralytics: a column a cell, in pixels.
    Yolov8,
    /// YOLOv10, YOLO26, and others that were exported with their suppression: boxes that are ready.
    EndToEnd,
    /// RT-DETR: a row a query, in parts of the image.
    Rtdetr,
}

impl Default for DetectorSettings {
    fn default() -> Self {
        Self {
            model: String::new(),
            labels: String::new(),
            form: ModelForm::Auto,
            min_score: 0.25,
            max_overlap: 0.45,
            classes: String::new(),
            max_hz: 10.0,
        }
    }
}

impl DetectorSettings {
    /// Whether boxes of this class count.
    pub fn is_wanted(&self, label: &str) -> bool {
        self.classes.is_empty() || self.classes.split(',').any(|name| name.trim() == label)
    }
}

impl ModelForm {
    /// All forms that an output can have, in the order in which they are tried.
    pub const ALL: &'static [Self] =
        &[Self::Yolox, Self::Yolov5, Self::Yolov8, Self::EndToEnd, Self::Rtdetr];

    fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Yolox => "yolox",
            Self::Yolov5 => "yolov5",
            Self::Yolov8 => "yolov8",
            Self::EndToEnd => "end_to_end",
            Self::Rtdetr => "rtdetr",
        }
    }

    /// Names of all forms.
    pub fn known() -> String {
        Self::ALL.iter().map(|form| form.name()).collect::<Vec<_>>().join(", ")
    }
}

impl fmt::Display for ModelForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ModelForm {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let all = || std::iter::once(&Self::Auto).chain(Self::ALL);
        let known = all().find(|form| form.name() == name);
        known.copied().ok_or_else(|| format!("no form `{name}`; known are auto, {}", Self::known()))
    }
}
