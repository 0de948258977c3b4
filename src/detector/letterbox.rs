//! An image in the input of a network.

use crate::{geometry::Rect, msg::convert::RgbImage};

/// How an image is fitted into the network's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    /// Scaled as a whole and put into the upper left corner, as YOLOX has it.
    Corner,
    /// Scaled as a whole and put into the middle, as Ultralytics has it.
    Middle,
    /// Both sides scaled to those of the input, as RT-DETR has it.
    Stretched,
}

/// What the network's numbers of a pixel are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colors {
    /// Blue, green, red from 0 to 255.
    Bgr255,
    /// Red, green, blue from 0 to 1.
    Rgb1,
}

/// Where an image is in the input of a network, both as `[width, height]` in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Letterbox {
    image: [u32; 2],
    input: [u32; 2],
    scaled: [u32; 2],
    offset: [u32; 2],
}

/// What is around the image: the gray with which these networks were trained.
const GRAY: f32 = 114.0;

impl Letterbox {
    pub(super) fn new(fit: Fit, image: [u32; 2], input: [u32; 2]) -> Self {
        let scales = [0, 1].map(|axis| f64::from(input[axis]) / f64::from(image[axis]));
        let scale = scales[0].min(scales[1]);
        let scaled = [0, 1].map(|axis| {
            let exact = f64::from(image[axis]) * scale;
            let whole = match fit {
                // With room for rounding: what is exactly whole must not lose a pixel.
                Fit::Corner => (exact + 1e-6).floor(),
                Fit::Middle => exact.round(),
                Fit::Stretched => f64::from(input[axis]),
            };
            (whole as u32).clamp(1, input[axis])
        });
        let offset = match fit {
            Fit::Middle => [0, 1].map(|axis| (input[axis] - scaled[axis]) / 2),
            Fit::Corner | Fit::Stretched => [0, 0],
        };
        Self { image, input, scaled, offset }
    }

    /// The input as planes of colours, rows in each of them: interpolated between pixels and rounded to whole shades, as
    /// networks are trained with.
    pub(super) fn fill(&self, image: &RgbImage, colors: Colors) -> Vec<f32> {
        let ([width, height], [left, top]) = (self.input, self.offset);
        let (order, unit) = match colors {
            Colors::Bgr255 => ([2, 1, 0], 1.0),
            Colors::Rgb1 => ([0, 1, 2], 1.0 / 255.0),
        };
        let mut planes = vec![GRAY * unit; 3 * width as usize * height as usize];
        let columns: Vec<Between> = (0..self.scaled[0]).map(|x| self.between(0, x)).collect();
        let stride = 3 * image.width as usize;
        for y in 0..self.scaled[1] {
            let row = self.between(1, y);
            let [upper, lower] = [row.first, row.second].map(|at| &image.data[at * stride..]);
            for (plane, channel) in order.into_iter().enumerate() {
                let line = plane * height as usize + (top + y) as usize;
                let start = line * width as usize + left as usize;
                let out = &mut planes[start..start + columns.len()];
                for (out, column) in out.iter_mut().zip(&columns) {
                    let [first, second] = [column.first, column.second].map(|at| 3 * at + channel);
                    let above = column.mix(upper[first], upper[second]);
                    let below = column.mix(lower[first], lower[second]);
                    *out = (above + row.weight * (below - above)).round() * unit;
                }
            }
        }
        planes
    }

    /// A box of the input, `[left, top, right, bottom]`, in the image; nothing if no pixel of the image is in it.
    pub(super) fn in_image(&self, corners: [f64; 4]) -> Option<Rect> {
        let [left, top, right, bottom] = [0, 1, 2, 3].map(|side| {
            let axis = side % 2;
            let of_image = f64::from(self.image[axis]) / f64::from(self.scaled[axis]);
            (corners[side] - f64::from(self.offset[axis])) * of_image
        });
        Rect::new(left, top, right, bottom)?.clipped(self.image[0], self.image[1])
    }

    /// A place of the image, `[x, y]` from its upper left corner, in the input.
    pub(super) fn in_input(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let of_input = f64::from(self.scaled[axis]) / f64::from(self.image[axis]);
            at[axis] * of_input + f64::from(self.offset[axis])
        })
    }

    /// The pixels of the image between which the centre of a scaled one is.
    fn between(&self, axis: usize, at: u32) -> Between {
        let of_image = f64::from(self.image[axis]) / f64::from(self.scaled[axis]);
        let last = self.image[axis] - 1;
        let exact = ((f64::from(at) + 0.5) * of_image - 0.5).clamp(0.0, f64::from(last));
        let first = exact as u32;
        Between {
            first: first as usize,
            second: (first + 1).min(last) as usize,
            weight: (exact - f64::from(first)) as f32,
        }
    }
}

/// Two neighbours, and how much the second counts.
struct Between {
    first: usize,
    second: usize,
    weight: f32,
}

impl Between {
    fn mix(&self, first: u8, second: u8) -> f32 {
        let (first, second) = (f32::from(first), f32::from(second));
        first + self.weight * (second - first)
    }
}
