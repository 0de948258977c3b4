//! How sides of an object are known.

use serde::{Deserialize, Serialize};

/// How the position of a face is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Its edge stands out against what is behind.
    Seen,
    /// It rests on the support plane.
    Support,
    /// The mirror image of a face that was seen.
    Mirrored,
    /// Nothing was seen of it but that the detector's box reaches so far.
    Outline,
    /// The object goes on: cut by the box, or by another object's border.
    Cut,
    /// Behind the object itself, behind another one or outside the image.
    Hidden,
}

impl Side {
    /// Whether the face's position was measured.
    pub fn is_known(self) -> bool {
        matches!(self, Side::Seen | Side::Support | Side::Mirrored | Side::Outline)
    }
}
