//! Whose a reading is. Boxes overlap: what stands in the middle of a table's box may be a chair, which has a box of its own
//! that it fills better.

use super::{
    Frame,
    segmentation::{Segment, SurfacePoint},
};
use crate::geometry::Rect;

/// What the boxes of a frame took for their objects' readings.
pub(super) struct Claims {
    columns: usize,
    /// For each cell of the image who has points there.
    cells: Vec<Vec<Claim>>,
    /// How well each box is filled by its points; nothing for a box that was refused.
    agreements: Vec<Option<f64>>,
    /// Boxes that should do without the points of others.
    contested: Vec<bool>,
}

/// Ranges between which a box has its points (m).
#[derive(Clone, Copy)]
struct Claim {
    owner: usize,
    near_m: f64,
    far_m: f64,
}

impl Claims {
    /// Compares boxes and, of those that were not refused, their segments.
    pub(super) fn new<'a>(
        frame: &Frame<'_>,
        boxes: impl Iterator<Item = (Rect, Option<&'a Segment<'a>>)>,
    ) -> Self {
        let boxes: Vec<_> = boxes.collect();
        let cells = |pixels: u32| pixels as usize / CELL_PX + 1;
        let columns = cells(frame.depth().width());
        let mut claims = Self {
            columns,
            cells: vec![Vec::new(); columns * cells(frame.depth().height())],
            agreements: boxes
                .iter()
                .map(|(_, segment)| Some(segment.as_ref()?.agreement))
                .collect(),
            contested: Vec::new(),
        };
        for (owner, (_, segment)) in boxes.iter().enumerate() {
            segment.iter().flat_map(|s| &s.points).for_each(|p| claims.add(owner, p));
        }
        claims.contested = (0..boxes.len()).map(|at| claims.is_contested(at, &boxes)).collect();
        claims
    }

    /// Whether a box should be looked at again without the points that are others'.
    pub(super) fn contest(&self, at: usize) -> bool {
        self.contested[at]
    }

    /// Whether a point is that of a box which its points fill better than box `at`.
    pub(super) fn are_others(&self, at: usize, p: &SurfacePoint) -> bool {
        let range = p.at.coords.norm();
        let margin = MARGIN_M + 2.0 * p.sigma_m;
        self.cells[self.cell(p)].iter().any(|claim| {
            self.is_better(claim.owner, at)
                && range > claim.near_m - margin
                && range < claim.far_m + margin
        })
    }

    fn is_contested(&self, at: usize, boxes: &[(Rect, Option<&Segment<'_>>)]) -> bool {
        let (rect, segment) = &boxes[at];
        match segment {
            Some(segment) => {
                let shared = segment.points.iter().filter(|p| self.are_others(at, p)).count();
                shared as f64 > MAX_SHARED * segment.points.len() as f64
            }
            None => boxes.iter().enumerate().any(|(other, (others, _))| {
                self.is_better(other, at) && rect.overlap(others) > 0.0
            }),
        }
    }

    fn is_better(&self, other: usize, at: usize) -> bool {
        other != at && self.agreements[other] > self.agreements[at]
    }

    fn add(&mut self, owner: usize, p: &SurfacePoint) {
        let range = p.at.coords.norm();
        let at = self.cell(p);
        match self.cells[at].iter_mut().find(|claim| claim.owner == owner) {
            Some(claim) => {
                (claim.near_m, claim.far_m) = (claim.near_m.min(range), claim.far_m.max(range));
            }
            None => self.cells[at].push(Claim { owner, near_m: range, far_m: range }),
        }
    }

    fn cell(&self, p: &SurfacePoint) -> usize {
        p.v as usize / CELL_PX * self.columns + p.u as usize / CELL_PX
    }
}

/// As large as the distance of samples in the largest box (px).
const CELL_PX: usize = 12;
/// In one cell, points of one object are no farther apart, noise aside (m).
const MARGIN_M: f64 = 0.03;
/// Share of a box's points that may be another one's.
const MAX_SHARED: f64 = 0.3;
