//! What a network gives, as boxes in its input.

use crate::config::ModelForm;

/// A tensor of the network's.
#[derive(Clone, Debug)]
pub(super) struct Tensor {
    pub(super) shape: Vec<usize>,
    /// Row-major.
    pub(super) data: Vec<f32>,
}

/// A box before overlapping ones are suppressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    /// `[left, top, right, bottom]` in pixels of the network's input.
    pub(super) corners: [f64; 4],
    pub(super) class: usize,
    /// From 0 to 1.
    pub(super) score: f64,
    /// Its place among all of the network's.
    pub(super) at: usize,
}

/// Outputs whose form is known, in rows that are alike: one a candidate.
pub(super) struct Rows<'a> {
    form: ModelForm,
    /// `[width, height]` of the network's input.
    input: [u32; 2],
    boxes: &'a Tensor,
    /// Where classes have a tensor of their own.
    scores: Option<&'a Tensor>,
    /// The last numbers of a candidate say how much its mask has of each of the network's.
    mask_parts: usize,
}

/// Networks that need no suppression give at most this many boxes.
const MOST_QUERIES: usize = 1000;
/// Cells of the grids of YOLOX are so many pixels wide.
const STRIDES: [u32; 3] = [8, 16, 32];

impl<'a> Rows<'a> {
    /// Outputs of the form that is wanted; with [`ModelForm::Auto`], of the only one that their shapes fit. Nothing
    /// where they fit none.
    pub(super) fn new(wanted: ModelForm, outputs: &'a [Tensor], input: [u32; 2]) -> Option<Self> {
        let batch = |tensor: &Tensor| tensor.shape.len() == 3 && tensor.shape[0] == 1;
        let sized = |tensor: &&Tensor| {
            let product = tensor.shape.iter().try_fold(1_usize, |n, side| n.checked_mul(*side));
            batch(tensor) && product == Some(tensor.data.len())
        };
        let usable: Vec<&Tensor> = outputs.iter().filter(sized).collect();
        // Networks that segment have one more output: their masks, `[1, masks, height, width]`.
        let masks = outputs.iter().find(|tensor| tensor.shape.len() == 4);
        let mask_parts = masks.map_or(0, |masks| masks.shape[1]);
        let forms = match wanted {
            ModelForm::Auto => ModelForm::ALL,
            _ => std::slice::from_ref(&wanted),
        };
        forms.iter().find_map(|form| Self::of_form(*form, &usable, mask_parts, input))
    }

    fn of_form(
        form: ModelForm,
        outputs: &[&'a Tensor],
        mask_parts: usize,
        input: [u32; 2],
    ) -> Option<Self> {
        let (boxes, scores) = match (form, outputs) {
            (ModelForm::Rtdetr, [boxes, scores]) if boxes.columns() == 4 => (*boxes, Some(*scores)),
            (ModelForm::Rtdetr, [scores, boxes]) if boxes.columns() == 4 => (*boxes, Some(*scores)),
            (_, [boxes]) => (*boxes, None),
            _ => return None,
        };
        let mask_parts = match form {
            ModelForm::Yolox | ModelForm::Rtdetr | ModelForm::Auto => 0,
            ModelForm::Yolov5 | ModelForm::Yolov8 | ModelForm::EndToEnd => mask_parts,
        };
        let [rows, columns] = [boxes.rows(), boxes.columns()];
        let cells = cells(input);
        let fits = match form {
            ModelForm::Auto => false,
            ModelForm::Yolox => rows == cells && columns > 5,
            ModelForm::Yolov5 => rows == 3 * cells && columns > 5 + mask_parts,
            ModelForm::Yolov8 => columns == cells && rows > 4 + mask_parts,
            ModelForm::EndToEnd => rows <= MOST_QUERIES && columns == 6 + mask_parts,
            ModelForm::Rtdetr => match scores {
                Some(scores) => scores.rows() == rows,
                None => rows <= MOST_QUERIES && columns > 4,
            },
        };
        fits.then_some(Self { form, input, boxes, scores, mask_parts })
    }

    /// The form.
    pub(super) fn form(&self) -> ModelForm {
        self.form
    }

    /// How many classes the network knows; nothing where its output does not say.
    pub(super) fn classes(&self) -> Option<usize> {
        match self.form {
            ModelForm::Yolox | ModelForm::Yolov5 => {
                Some(self.boxes.columns() - 5 - self.mask_parts)
            }
            ModelForm::Yolov8 => Some(self.boxes.rows() - 4 - self.mask_parts),
            ModelForm::Rtdetr => {
                Some(self.scores.map_or(self.boxes.columns() - 4, Tensor::columns))
            }
            ModelForm::EndToEnd | ModelForm::Auto => None,
        }
    }

    /// How many masks of the network's each candidate refers to; 0 where it gives boxes alone.
    pub(super) fn mask_parts(&self) -> usize {
        self.mask_parts
    }

    /// How much a candidate's mask has of each of them.
    pub(super) fn parts_of_mask(&self, candidate: usize) -> Vec<f32> {
        let (data, rows, columns) = (&self.boxes.data, self.boxes.rows(), self.boxes.columns());
        match self.form {
            ModelForm::Yolov8 => {
                let last = rows - self.mask_parts..rows;
                last.map(|row| data[row * columns + candidate]).collect()
            }
            _ => {
                let end = (candidate + 1) * columns;
                data[end - self.mask_parts..end].to_vec()
            }
        }
    }

    /// Boxes with a score of at least `min_score`, each with its most probable class.
    pub(super) fn candidates(&self, min_score: f64) -> Vec<Candidate> {
        match self.form {
            ModelForm::Yolox => self.of_grids(min_score),
            ModelForm::Yolov5 => self.of_rows(min_score),
            ModelForm::Yolov8 => self.of_columns(min_score),
            ModelForm::Rtdetr => self.of_queries(min_score),
            ModelForm::EndToEnd => self.ready(min_score),
            ModelForm::Auto => Vec::new(),
        }
    }

    /// Centres relative to cells, logarithms of sizes (Ge et al. 2021, YOLOX).
    fn of_grids(&self, min_score: f64) -> Vec<Candidate> {
        let rows = self.boxes.data.chunks_exact(self.boxes.columns());
        let cells = STRIDES.into_iter().flat_map(|stride| {
            let [columns, lines] = self.input.map(|side| side / stride);
            (0..lines).flat_map(move |y| (0..columns).map(move |x| (stride, x, y)))
        });
        let decoded = rows.zip(cells).enumerate().filter_map(|(at, (row, (stride, x, y)))| {
            let (class, score) = best(&row[5..])?;
            let score = f64::from(score) * f64::from(row[4]);
            let stride = f64::from(stride);
            let center = [f64::from(row[0]) + f64::from(x), f64::from(row[1]) + f64::from(y)];
            let size = [row[2], row[3]].map(|log| f64::from(log).exp());
            let [[x, y], [width, height]] = [center, size].map(|v| v.map(|v| v * stride));
            (score >= min_score).then(|| candidate(at, [x, y, width, height], (class, score)))
        });
        decoded.collect()
    }

    /// Rows `x, y, width, height, how probable it is that there is something`, and the classes.
    fn of_rows(&self, min_score: f64) -> Vec<Candidate> {
        let rows = self.boxes.data.chunks_exact(self.boxes.columns()).enumerate();
        let decoded = rows.filter_map(|(at, row)| {
            let (class, score) = best(&row[5..row.len() - self.mask_parts])?;
            let score = f64::from(score) * f64::from(row[4]);
            let body = [row[0], row[1], row[2], row[3]].map(f64::from);
            (score >= min_score).then(|| candidate(at, body, (class, score)))
        });
        decoded.collect()
    }

    /// The same turned: a column a candidate, without a probability that there is something.
    fn of_columns(&self, min_score: f64) -> Vec<Candidate> {
        let (rows, columns) = (self.boxes.rows(), self.boxes.columns());
        let at = |row: usize, column: usize| self.boxes.data[row * columns + column];
        let decoded = (0..columns).filter_map(|column| {
            let classes: Vec<f32> =
                (4..rows - self.mask_parts).map(|row| at(row, column)).collect();
            let (class, score) = best(&classes)?;
            let body = [0, 1, 2, 3].map(|row| f64::from(at(row, column)));
            let score = f64::from(score);
            (score >= min_score).then(|| candidate(column, body, (class, score)))
        });
        decoded.collect()
    }

    /// Boxes as parts of the input; classes beside them, or as logits in a tensor of their own.
    fn of_queries(&self, min_score: f64) -> Vec<Candidate> {
        let queries = self.boxes.data.chunks_exact(self.boxes.columns()).enumerate();
        let decoded = queries.filter_map(|(at, row)| {
            let (class, score) = match self.scores {
                None => best(&row[4..])?,
                Some(scores) => {
                    let columns = scores.columns();
                    let (class, logit) = best(&scores.data[at * columns..(at + 1) * columns])?;
                    (class, 1.0 / (1.0 + (-logit).exp()))
                }
            };
            let [width, height] = self.input.map(f64::from);
            let parts = [row[0], row[1], row[2], row[3]].map(f64::from);
            let body = [parts[0] * width, parts[1] * height, parts[2] * width, parts[3] * height];
            let score = f64::from(score);
            (score >= min_score).then(|| candidate(at, body, (class, score)))
        });
        decoded.collect()
    }

    /// Rows `left, top, right, bottom, score, class`.
    fn ready(&self, min_score: f64) -> Vec<Candidate> {
        let rows = self.boxes.data.chunks_exact(self.boxes.columns()).enumerate();
        let decoded = rows.filter_map(|(at, row)| {
            let score = f64::from(row[4]);
            let corners = [row[0], row[1], row[2], row[3]].map(f64::from);
            let is_class = row[5] >= 0.0 && row[5].fract() == 0.0;
            (score >= min_score && is_class).then(|| Candidate {
                corners,
                class: row[5] as usize,
                score,
                at,
            })
        });
        decoded.collect()
    }
}

impl Tensor {
    fn rows(&self) -> usize {
        self.shape[1]
    }

    fn columns(&self) -> usize {
        self.shape[2]
    }
}

/// Cells of the grids that the networks of the YOLO family lay over their input.
fn cells(input: [u32; 2]) -> usize {
    let of = |stride: u32| input.map(|side| (side / stride) as usize).iter().product::<usize>();
    STRIDES.into_iter().map(of).sum()
}

/// The largest value and its place; the first of equals, nothing where there is none or one is not a number.
fn best(values: &[f32]) -> Option<(usize, f32)> {
    let (at, value) =
        values.iter().copied().enumerate().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    (!value.is_nan()).then_some((at, value))
}

fn candidate(
    at: usize,
    [x, y, width, height]: [f64; 4],
    (class, score): (usize, f64),
) -> Candidate {
    let corners = [x - 0.5 * width, y - 0.5 * height, x + 0.5 * width, y + 0.5 * height];
    Candidate { corners, class, score, at }
}
