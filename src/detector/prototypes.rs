//! Masks of instances: prototypes that a network gives of the whole image, mixed for each box (Bolya et al. 2019, YOLACT).

use super::{letterbox::Letterbox, output::Tensor};
use crate::{geometry::Rect, perception::Mask};
use std::ops::Range;

/// Prototypes that cover the network's input.
pub(super) struct Prototypes<'a> {
    /// Plane after plane, each row by row.
    planes: &'a [f32],
    count: usize,
    /// `[columns, rows]` of a plane.
    size: [usize; 2],
    /// Pixels of the input, along either side, that a value stands for.
    stride: f64,
}

/// Networks have 32 of them, and they are a fourth as fine as the input. What is more is damage, and would take time and memory.
const MOST: usize = 64;
const FINEST: usize = 4;

impl<'a> Prototypes<'a> {
    /// Those of the outputs, `[1, count, rows, columns]`; nothing where they do not cover an input of `[width, height]` evenly.
    pub(super) fn of(outputs: &'a [Tensor], input: [u32; 2]) -> Option<Self> {
        let Tensor { shape, data } = outputs.iter().find(|tensor| tensor.shape.len() == 4)?;
        let [1, count, rows, columns] = shape[..] else { return None };
        let [width, height] = input.map(|side| side as usize);
        let stride = width.checked_div(columns).filter(|stride| *stride >= FINEST)?;
        let is_even =
            [columns, rows].map(|side| side.checked_mul(stride)) == [width, height].map(Some);
        let fits = is_even && (1..=MOST).contains(&count) && data.len() == count * rows * columns;
        let stride = stride as f64;
        fits.then_some(Self { planes: data, count, size: [columns, rows], stride })
    }

    /// How many they are.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The mask of a box in the image from how much of each prototype it has; nothing where these are not as many, where a
    /// number is not finite, or where it is no mask of the box.
    pub(super) fn mask(&self, parts: &[f32], rect: &Rect, letterbox: &Letterbox) -> Option<Mask> {
        let [left, top] = letterbox.in_input([rect.x_min, rect.y_min]);
        let [right, bottom] = letterbox.in_input([rect.x_max + 1.0, rect.y_max + 1.0]);
        let mixed = self.mixed(parts, [self.span(0, left, right), self.span(1, top, bottom)])?;
        let is_inside = |u: i64, v: i64| {
            let [u, v] = [u as f64, v as f64];
            // The middle of a pixel is half a pixel from its sides, from which networks count.
            let [x, y] = letterbox.in_input([u + 0.5, v + 0.5]).map(|at| self.cell(at));
            // Where the sigmoid is above one half.
            rect.contains(u, v) && mixed.at(x, y) > 0.0
        };
        Mask::from_pixels(rect, is_inside).ok()
    }

    /// Where a place in the input is among the middles of a plane's values.
    fn cell(&self, at: f64) -> f64 {
        at / self.stride - 0.5
    }

    /// The values between which all places from `low` to `high` of the input are.
    fn span(&self, axis: usize, low: f64, high: f64) -> Range<usize> {
        let last = self.size[axis] - 1;
        let (low, high) = (self.cell(low).floor(), self.cell(high).ceil());
        let [first, end] = [low, high].map(|at| at.clamp(0.0, last as f64) as usize);
        first..end + 1
    }

    fn mixed(&self, parts: &[f32], [columns, rows]: [Range<usize>; 2]) -> Option<Mixed> {
        if parts.len() != self.count {
            return None;
        }
        let mut values = vec![0.0; columns.len() * rows.len()];
        let [width, height] = self.size;
        for (plane, part) in self.planes.chunks_exact(width * height).zip(parts) {
            let lines = plane.chunks_exact(width).skip(rows.start);
            for (out, line) in values.chunks_exact_mut(columns.len()).zip(lines) {
                let line = &line[columns.clone()];
                out.iter_mut().zip(line).for_each(|(out, value)| *out += part * value);
            }
        }
        let is_finite = values.iter().all(|value| value.is_finite());
        let first = [columns.start, rows.start].map(|at| at as f64);
        is_finite.then_some(Mixed { first, size: [columns.len(), rows.len()], values })
    }
}

/// The part of a box's own plane that is around it: logarithms of odds.
struct Mixed {
    /// Column and row of the first value in the whole plane.
    first: [f64; 2],
    /// `[columns, rows]`.
    size: [usize; 2],
    values: Vec<f32>,
}

impl Mixed {
    /// The value at a place of the whole plane, interpolated between its neighbours.
    fn at(&self, x: f64, y: f64) -> f32 {
        let [(left, right, across), (upper, lower, down)] =
            [self.between(0, x), self.between(1, y)];
        let value = |column: usize, row: usize| self.values[row * self.size[0] + column];
        let along = |row: usize| value(left, row) + across * (value(right, row) - value(left, row));
        along(upper) + down * (along(lower) - along(upper))
    }

    /// The neighbours along an axis, and how much the second counts.
    fn between(&self, axis: usize, at: f64) -> (usize, usize, f32) {
        let last = self.size[axis] - 1;
        let at = (at - self.first[axis]).clamp(0.0, last as f64);
        let before = at as usize;
        (before, (before + 1).min(last), (at - at.floor()) as f32)
    }
}
