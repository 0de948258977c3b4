//! One box of several that show the same.

use crate::perception::Detection;

/// No image has more things in it.
const MOST_BOXES: usize = 300;

/// Of boxes of one class that overlap (intersection over union) by more than `max_overlap`, only the most probable is
/// kept. Most probable first; equals stay in their order.
pub(super) fn suppress(mut found: Vec<Detection>, max_overlap: f64) -> Vec<Detection> {
    found.sort_by(|a, b| b.probability().total_cmp(&a.probability()));
    let mut kept: Vec<Detection> = Vec::new();
    for next in found {
        let is_same = |known: &Detection| {
            known.label() == next.label() && known.rect.overlap(&next.rect) > max_overlap
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
