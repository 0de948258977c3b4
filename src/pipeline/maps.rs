//! The maps that a run leaves to the next one.

use crate::mapping::{Continuation, SavedMap};

/// What there is to save.
#[derive(Clone, Debug)]
pub struct MapsToSave {
    /// The map that the next run continues.
    pub map: SavedMap,
    /// Another one in a frame of its own, and the name of its file beside the first.
    pub beside: Option<(&'static str, SavedMap)>,
    /// Why the place in the saved map was not recognised, where `map` is that one as it was.
    pub why: Option<String>,
}

/// What was seen while the place in the saved map was not recognised.
pub const LOCAL_MAP: &str = "local_map.json";
/// A saved map of few objects, whose place was never recognised.
pub const SET_ASIDE_MAP: &str = "set_aside_map.json";
/// The frame of what was seen while the place in the saved map was not recognised.
pub(super) const LOCAL_FRAME: &str = "local_map";

/// What is said when a saved map is given up.
pub(super) fn set_aside(waiting: &Continuation) -> String {
    format!(
        "the saved map has {} objects, too few to recognise a place by: what is seen is a map of its own, and the saved one \
         is kept beside it; where the robot starts in it (map.start_pose, --start) would have joined them",
        waiting.saved().objects.len()
    )
}
