//! What is measured in a trial.

use serde::{Deserialize, Serialize};

/// A column of the tables; a value of it is a mean over the objects of one trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Metric {
    Shape,
    PaperShape,
    TranslationM,
    RotationDeg,
    Iou,
    Recall,
    Precision,
    Duplicates,
    IdSwitchesPer200,
    Within90,
    PoseWithin90,
    AteM,
    OdometryAteM,
    AteShare,
}

impl Metric {
    /// The head of its column.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Shape => "shape",
            Self::PaperShape => "paper shape",
            Self::TranslationM => "trans (m)",
            Self::RotationDeg => "rot (deg)",
            Self::Iou => "IoU",
            Self::Recall => "recall",
            Self::Precision => "precision",
            Self::Duplicates => "duplicates",
            Self::IdSwitchesPer200 => "id switches in 200",
            Self::Within90 => "in 90 % region",
            Self::PoseWithin90 => "last pose in 90 % region",
            Self::AteM => "ATE (m)",
            Self::OdometryAteM => "odometry's ATE (m)",
            Self::AteShare => "ATE of odometry's",
        }
    }

    /// How many decimals mean something.
    pub(super) fn decimals(self) -> usize {
        match self {
            Self::RotationDeg | Self::Duplicates | Self::IdSwitchesPer200 => 1,
            Self::Recall
            | Self::Precision
            | Self::Within90
            | Self::PoseWithin90
            | Self::AteShare => 2,
            _ => 3,
        }
    }

    /// Whether less of it is better.
    pub(super) fn is_error(self) -> bool {
        !matches!(
            self,
            Self::Iou | Self::Recall | Self::Precision | Self::Within90 | Self::PoseWithin90
        )
    }
}
