//! What the estimation is busy with, for whoever measures time: the core itself reads no clock.

/// A step of the work on one keyframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// Moving depth into the colour camera's image.
    Registration,
    /// Finding support planes.
    SupportPlanes,
    /// Finding walls.
    Walls,
    /// Cutting out objects.
    Segmentation,
    /// Finding faces and headings.
    Faces,
    /// Finding mirror planes.
    Symmetry,
    /// Fitting and rating.
    Fit,
    /// Association and fusion.
    Mapping,
}

impl Stage {
    /// All stages in the order of the work.
    pub const ALL: [Self; 8] = [
        Self::Registration,
        Self::SupportPlanes,
        Self::Walls,
        Self::Segmentation,
        Self::Faces,
        Self::Symmetry,
        Self::Fit,
        Self::Mapping,
    ];

    /// A short name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Registration => "registration",
            Self::SupportPlanes => "support_planes",
            Self::Walls => "walls",
            Self::Segmentation => "segmentation",
            Self::Faces => "faces",
            Self::Symmetry => "symmetry",
            Self::Fit => "fit",
            Self::Mapping => "mapping",
        }
    }
}

/// Told of every change of stage.
pub trait StageObserver {
    /// What was going on ends, `stage` begins; `None` when the keyframe is done.
    fn enter(&mut self, stage: Option<Stage>);
}

/// Nobody measures.
impl StageObserver for () {
    fn enter(&mut self, _: Option<Stage>) {}
}
