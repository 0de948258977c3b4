//! One box of several that show the same.

use crate::perception::Detection;

/// No image has more things in it.
const MOST_BOXES: usize = 300;

/// Of boxes of one class that overlap (intersection over union) by more than `max_overlap`, only the most probable is
/// kept, each with what it brings along. Most probable first; equals stay in their order.
pub(super) fn suppress<T>(mut found: Vec<(Detection, T)>, max_overlap: f64) -> Vec<(Detection, T)> {
    found.sort_by(|(a, _), (b, _)| b.probability().total_cmp(&a.probability()));
    let mut kept: Vec<(Detection, T)> = Vec::new();
    for next in found {
        let is_same = |(known, _): &(Detection, T)| {
            known.label() == next.0.label() && known.rect.overlap(&next.0.rect) > max_overlap
        };
        if !kept.iter().any(is_same) {
            kept.push(next);
        }
        if kept.len() == MOST_BOXES {
            break;
        }
    }
    kept
}
