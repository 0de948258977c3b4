//! Which pixels of a detector's box are the object.

use crate::geometry::Rect;
use std::collections::BTreeMap;
use thiserror::Error;

/// The pixels of an image that are one object, as a network that segments instances says.
///
/// It is kept in cells over the box and a margin round it: of a pixel each in boxes of up to about 200 pixels, larger ones in
/// larger boxes, so that no mask takes more than 8 kB.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// Left and upper side of the first cell (px); pixels have their centres at integers.
    origin: [f64; 2],
    /// Width of a cell (px).
    cell_px: f64,
    columns: usize,
    rows: usize,
    /// Of each cell, row by row, whether it is inside.
    cells: Vec<u64>,
}

/// Why there is no mask. The box still counts.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MaskError {
    /// No outline has so few points, or so many.
    #[error("an outline has from 3 to {MAX_POINTS} points, this one has {0}")]
    Points(usize),
    /// A point that is none.
    #[error("a point of the outline is not finite")]
    NotFinite,
    /// Nothing is inside, or all of it is elsewhere.
    #[error("no pixel of the box is inside the mask")]
    Empty,
    /// It cannot be of this box: perhaps of an image of another size.
    #[error("the mask reaches over {:.0} % of the box only", 100.0 * share)]
    NotOfBox {
        /// What the box has in common with the rectangle round the mask, as a share of the box.
        share: f64,
    },
}

impl Mask {
    /// The mask of a box from what is said of each pixel: whether the pixel `(u, v)` of the image, of the column `u` and the row `v`,
    /// is the object. Pixels outside of the image may be asked for, too.
    ///
    /// # Errors
    /// When it has hardly anything to do with the box.
    pub fn from_pixels(
        rect: &Rect,
        is_inside: impl Fn(i64, i64) -> bool,
    ) -> Result<Self, MaskError> {
        let mut mask = Self::empty(rect);
        for row in 0..mask.rows {
            for column in 0..mask.columns {
                let [u, v] = mask.center([column, row]);
                if is_inside(u.round() as i64, v.round() as i64) {
                    mask.insert(column, row);
                }
            }
        }
        mask.of_box(rect)
    }

    /// The mask of a box from its outline in pixels of the image: corners of a polygon, which is closed from the last to the first one.
    /// Where it crosses itself, what is inside alternates from side to side of a line (even-odd).
    ///
    /// # Errors
    /// When it is no outline, or has hardly anything to do with the box.
    pub fn from_outline(rect: &Rect, corners: &[[f64; 2]]) -> Result<Self, MaskError> {
        if !(3..=MAX_POINTS).contains(&corners.len()) {
            return Err(MaskError::Points(corners.len()));
        }
        if !corners.iter().flatten().all(|x| x.is_finite()) {
            return Err(MaskError::NotFinite);
        }
        let mut mask = Self::empty(rect);
        // In cells: the centre of the first is at (0, 0).
        let in_cells = |corner: &[f64; 2]| {
            [0, 1].map(|i| (corner[i].clamp(-FAR_PX, FAR_PX) - mask.origin[i]) / mask.cell_px - 0.5)
        };
        let corners: Vec<[f64; 2]> = corners.iter().map(in_cells).collect();
        let next = corners.iter().cycle().skip(1);
        let mut turns = vec![false; mask.columns * mask.rows];
        for ([x, y], [to_x, to_y]) in corners.iter().zip(next) {
            let row = |at: f64| at.ceil().clamp(0.0, mask.rows as f64) as usize;
            for at in row(y.min(*to_y))..row(y.max(*to_y)) {
                let crossing = x + (at as f64 - y) / (to_y - y) * (to_x - x);
                let column = crossing.ceil().max(0.0) as usize;
                if column < mask.columns {
                    turns[at * mask.columns + column] ^= true;
                }
            }
        }
        for row in 0..mask.rows {
            let mut inside = false;
            for column in 0..mask.columns {
                inside ^= turns[row * mask.columns + column];
                if inside {
                    mask.insert(column, row);
                }
            }
        }
        mask.of_box(rect)
    }

    /// Whether a place in the image (px) is inside.
    pub fn contains(&self, u: f64, v: f64) -> bool {
        let [x, y] = [u - self.origin[0], v - self.origin[1]].map(|d| (d / self.cell_px).floor());
        let is_there = x >= 0.0 && y >= 0.0 && x < self.columns as f64 && y < self.rows as f64;
        is_there && self.has(x as usize, y as usize)
    }

    /// Its outline, as [`Mask::from_outline`] reads it (px). Parts and holes follow each other, joined by lines that are gone there and
    /// back.
    pub fn outline(&self) -> Vec<[f64; 2]> {
        let mut borders = self.borders();
        let (mut corners, mut starts) = (Vec::new(), Vec::new());
        while let Some((start, _)) = borders.first_key_value() {
            let mut at = *start;
            starts.push(at);
            corners.push(at);
            while let Some(mut ways) = borders.remove(&at) {
                let next = ways.pop().unwrap_or(at);
                if !ways.is_empty() {
                    borders.insert(at, ways);
                }
                corners.push(next);
                at = next;
            }
        }
        starts.pop();
        corners.extend(starts.into_iter().rev());
        corners.dedup();
        let is_on_the_way = |[a, b, c]: [[usize; 2]; 3]| {
            (0..2).any(|i| {
                a[i] == b[i] && b[i] == c[i] && (a[1 - i] < b[1 - i]) == (b[1 - i] < c[1 - i])
            })
        };
        let mut kept: Vec<[usize; 2]> = Vec::new();
        for corner in corners {
            if let [.., a, b] = kept[..]
                && is_on_the_way([a, b, corner])
            {
                kept.pop();
            }
            kept.push(corner);
        }
        let in_image =
            |corner: [usize; 2]| [0, 1].map(|i| self.origin[i] + corner[i] as f64 * self.cell_px);
        kept.into_iter().map(in_image).collect()
    }

    /// From each corner of a cell the ways along the border, with the inside to the right.
    fn borders(&self) -> BTreeMap<[usize; 2], Vec<[usize; 2]>> {
        let mut borders: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for [x, y] in self.inside() {
            let [upper_left, upper_right] = [[x, y], [x + 1, y]];
            let [lower_left, lower_right] = [[x, y + 1], [x + 1, y + 1]];
            let sides = [
                (y > 0 && self.has(x, y - 1), upper_left, upper_right),
                (x + 1 < self.columns && self.has(x + 1, y), upper_right, lower_right),
                (y + 1 < self.rows && self.has(x, y + 1), lower_right, lower_left),
                (x > 0 && self.has(x - 1, y), lower_left, upper_left),
            ];
            for (_, from, to) in sides.into_iter().filter(|(goes_on, ..)| !goes_on) {
                borders.entry(from).or_default().push(to);
            }
        }
        borders
    }

    /// How much memory it takes besides itself (bytes).
    pub fn bytes(&self) -> usize {
        size_of_val(self.cells.as_slice())
    }

    /// The mask and all round it within a distance (px), to the left and right, up and down.
    pub(super) fn grown(&self, by_px: f64) -> Self {
        let reach = (by_px / self.cell_px).ceil() as usize;
        let along_rows = self.spread(|[column, row], at| [column + at, row], reach);
        along_rows.spread(|[column, row], at| [column, row + at], reach)
    }

    /// The mask without all that is within a distance (px) of what is not inside.
    pub(super) fn shrunk(&self, by_px: f64) -> Self {
        self.inverted().grown(by_px).inverted()
    }

    fn inverted(&self) -> Self {
        Self { cells: self.cells.iter().map(|cells| !cells).collect(), ..*self }
    }

    /// Each cell with those that follow up to `reach`, moved back by `reach`.
    fn spread(&self, moved: impl Fn([usize; 2], usize) -> [usize; 2], reach: usize) -> Self {
        let mut wide = Self { cells: vec![0; self.cells.len()], ..*self };
        for cell in self.inside() {
            for at in 0..=2 * reach {
                let [column, row] = moved(cell, at);
                let back = moved([0, 0], reach);
                if let (Some(column), Some(row)) =
                    (column.checked_sub(back[0]), row.checked_sub(back[1]))
                    && column < self.columns
                    && row < self.rows
                {
                    wide.insert(column, row);
                }
            }
        }
        wide
    }

    /// No cell of a box is inside.
    fn empty(rect: &Rect) -> Self {
        let margin = |extent: f64| MARGIN * extent + MARGIN_PX;
        let (across, down) = (margin(rect.width()), margin(rect.height()));
        let extents = [rect.width() + 2.0 * across, rect.height() + 2.0 * down];
        let cell_px = (extents[0].max(extents[1]) / MAX_CELLS as f64).max(1.0);
        let count = |extent: f64| ((extent / cell_px).ceil() as usize + 1).min(MAX_CELLS + 1);
        let [columns, rows] = extents.map(count);
        let origin = [rect.x_min - across, rect.y_min - down].map(|at| at.floor() - 0.5);
        Self { origin, cell_px, columns, rows, cells: vec![0; (columns * rows).div_ceil(64)] }
    }

    /// This, if it can be of a box.
    fn of_box(self, rect: &Rect) -> Result<Self, MaskError> {
        let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
        for at in self.inside().map(|cell| self.center(cell)) {
            low = [low[0].min(at[0]), low[1].min(at[1])];
            high = [high[0].max(at[0]), high[1].max(at[1])];
        }
        let wide = 0.5 * self.cell_px + BORDER_PX;
        let round = Rect::new(low[0] - wide, low[1] - wide, high[0] + wide, high[1] + wide);
        let common = round.ok_or(MaskError::Empty)?.intersection(rect).map_or(0.0, |r| r.area());
        let share = common / rect.area();
        if share >= MIN_SHARE { Ok(self) } else { Err(MaskError::NotOfBox { share }) }
    }

    /// The cells that are inside, as column and row.
    fn inside(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let all = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| [column, row]));
        all.filter(|[column, row]| self.has(*column, *row))
    }

    /// The middle of a cell (px).
    fn center(&self, cell: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.origin[i] + (cell[i] as f64 + 0.5) * self.cell_px)
    }

    fn has(&self, column: usize, row: usize) -> bool {
        let at = row * self.columns + column;
        self.cells[at / 64] >> (at % 64) & 1 == 1
    }

    fn insert(&mut self, column: usize, row: usize) {
        let at = row * self.columns + column;
        self.cells[at / 64] |= 1 << (at % 64);
    }
}

/// Networks draw the border of a mask so far off (px), and by this share of the longer side of the box besides: their masks are
/// a fourth as fine as their input.
pub(super) const BORDER_PX: f64 = 3.0;
pub(super) const BORDER_SHARE: f64 = 0.02;
/// A mask may reach out of its box by this share of its sides, and so much besides (px).
const MARGIN: f64 = 0.15;
const MARGIN_PX: f64 = 4.0;
/// So many cells along the longer side.
const MAX_CELLS: usize = 250;
/// Outlines of networks have some hundred points.
const MAX_POINTS: usize = 20_000;
/// No image reaches as far (px).
const FAR_PX: f64 = 1e9;
/// A mask and its box are of the same thing where they have this share of the box in common, borders aside.
const MIN_SHARE: f64 = 0.3;
