//! What is known of a class of objects before one is seen.

use super::SymmetryType::{self, DualPlane, None as Asymmetric, Plane};
use crate::geometry::Outline::{self, Cuboid, Ellipsoid, Superquadric};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What the objects of a class have in common.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ClassPrior {
    /// How they are symmetric. Liao et al. 2020, Table 1.
    pub symmetry: SymmetryType,
    /// What fills their extents.
    pub outline: Outline,
    /// Whether they stand on legs or feet that a depth camera may miss: their bottom is the support plane.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub legs: bool,
    /// Whether they stand on a flat foot that reaches farther than what is above it, and that a depth camera may take
    /// for a part of the support plane.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub foot: bool,
    /// Whether they stand on the floor: where depth does not reach, the lower side of their boxes tells how far off they are.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub on_floor: bool,
    /// Whether other things stand on their top, which is a horizontal plane: they end there.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub carries: bool,
    /// Whether they move by themselves: they are where they were seen last, and nothing is told by where they are.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub moves: bool,
    /// Usual extents (m): the longer horizontal one, the shorter one, the height. Used for what was not seen, after
    /// Ok et al. 2019.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_m: Option<[f64; 3]>,
}

/// The table of classes, with one entry for the classes it does not list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Classes {
    /// For a class without an entry.
    pub unlisted: ClassPrior,
    /// By the detector's label.
    pub listed: BTreeMap<String, ClassPrior>,
}

impl Classes {
    /// What is known of the objects that the detector calls `label`.
    pub fn prior(&self, label: &str) -> ClassPrior {
        self.listed.get(label).copied().unwrap_or(self.unlisted)
    }
}

impl Default for Classes {
    /// The paper's six labels, the other classes of COCO (Lin et al. 2014), and cabinets, of which many detectors know.
    fn default() -> Self {
        let mut listed = BTreeMap::new();
        for (symmetry, outline, labels) in SHAPES {
            for label in *labels {
                let legs = LEGS.contains(label);
                let foot = FEET.contains(label);
                let on_floor = legs || ON_FLOOR.contains(label);
                let carries = CARRIERS.contains(label);
                let size_m = SIZES.iter().find(|(name, _)| name == label).map(|(_, size)| *size);
                let (symmetry, outline) = (*symmetry, *outline);
                let prior = ClassPrior {
                    symmetry,
                    outline,
                    legs,
                    foot,
                    on_floor,
                    carries,
                    moves: MOVING.contains(label),
                    size_m,
                };
                listed.insert((*label).to_owned(), prior);
            }
        }
        Self { unlisted: ClassPrior::default(), listed }
    }
}

/// Liao et al. 2020, Table 1, continued for the classes of COCO.
const SHAPES: &[(SymmetryType, Outline, &[&str])] = &[
    (
        Plane,
        Cuboid,
        &[
            "airplane",
            "backpack",
            "bed",
            "bicycle",
            "boat",
            "bus",
            "cabinet",
            "car",
            "chair",
            "couch",
            "hair drier",
            "laptop",
            "microwave",
            "motorcycle",
            "oven",
            "parking meter",
            "refrigerator",
            "scissors",
            "sink",
            "teddy bear",
            "toaster",
            "toilet",
            "train",
            "truck",
        ],
    ),
    (
        DualPlane,
        Cuboid,
        &[
            "bench",
            "book",
            "cake",
            "cell phone",
            "dining table",
            "hot dog",
            "keyboard",
            "kite",
            "pizza",
            "remote",
            "sandwich",
            "skateboard",
            "skis",
            "snowboard",
            "stop sign",
            "suitcase",
            "surfboard",
            "traffic light",
            "tv",
        ],
    ),
    (Plane, HANDLED, &["cup"]),
    (DualPlane, ROUNDED, &["bottle", "fire hydrant", "wine glass"]),
    (
        DualPlane,
        Ellipsoid,
        &["apple", "bowl", "clock", "donut", "frisbee", "orange", "sports ball", "vase"],
    ),
    (Plane, Ellipsoid, &["banana", "broccoli", "carrot", "handbag", "mouse", "tie", "umbrella"]),
    (
        Asymmetric,
        Ellipsoid,
        &[
            "bear",
            "bird",
            "cat",
            "cow",
            "dog",
            "elephant",
            "giraffe",
            "horse",
            "person",
            "potted plant",
            "sheep",
            "zebra",
        ],
    ),
    (
        Asymmetric,
        Cuboid,
        &[
            "baseball bat",
            "baseball glove",
            "fork",
            "knife",
            "spoon",
            "tennis racket",
            "toothbrush",
        ],
    ),
];

/// Bottles have shoulders, cups and glasses are narrower at the foot: what is seen round them is less than a cylinder of
/// their extents and more than an ellipsoid.
const ROUNDED: Outline = Superquadric(0.5, 1.0);

/// A handle reaches far along one axis, but not between the axes: seen from there, a cup is narrower than an ellipse of its
/// extents. Of all exponents, this one fits a circle with a handle best.
const HANDLED: Outline = Superquadric(0.5, 1.3);

const MOVING: &[&str] = &[
    "bear", "bird", "cat", "cow", "dog", "elephant", "giraffe", "horse", "person", "sheep", "zebra",
];
const LEGS: &[&str] = &["bed", "bench", "chair", "couch", "dining table"];

const FEET: &[&str] = &["tv"];

/// Besides what has legs.
const ON_FLOOR: &[&str] =
    &["cabinet", "oven", "potted plant", "refrigerator", "suitcase", "toilet"];

const CARRIERS: &[&str] = &["bench", "dining table"];

/// Usual extents of things found in rooms (m): long, short, height.
const SIZES: &[(&str, [f64; 3])] = &[
    ("backpack", [0.35, 0.25, 0.45]),
    ("bed", [2.0, 1.5, 0.6]),
    ("bench", [1.2, 0.4, 0.5]),
    ("book", [0.24, 0.17, 0.03]),
    ("bottle", [0.07, 0.07, 0.25]),
    ("bowl", [0.16, 0.16, 0.08]),
    ("cell phone", [0.15, 0.07, 0.01]),
    ("chair", [0.55, 0.5, 0.9]),
    ("couch", [1.9, 0.9, 0.85]),
    ("cup", [0.11, 0.08, 0.1]),
    ("dining table", [1.5, 0.8, 0.75]),
    ("keyboard", [0.44, 0.15, 0.03]),
    ("laptop", [0.33, 0.25, 0.22]),
    ("microwave", [0.48, 0.36, 0.28]),
    ("mouse", [0.11, 0.065, 0.035]),
    ("oven", [0.6, 0.6, 0.85]),
    ("potted plant", [0.4, 0.4, 0.6]),
    ("refrigerator", [0.7, 0.65, 1.7]),
    ("sink", [0.55, 0.45, 0.2]),
    ("suitcase", [0.6, 0.35, 0.6]),
    ("toilet", [0.65, 0.38, 0.75]),
    ("tv", [0.7, 0.2, 0.45]),
    ("vase", [0.15, 0.15, 0.25]),
    ("wine glass", [0.08, 0.08, 0.2]),
];
