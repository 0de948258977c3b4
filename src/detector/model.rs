//! The network: from an image to boxes.

use super::{
    labels::{LabelError, Labels},
    letterbox::{Colors, Fit, Letterbox},
    output::{Rows, Tensor},
    prototypes::Prototypes,
    suppression::suppress,
};
use crate::{
    config::{DetectorSettings, ModelForm},
    msg::convert::RgbImage,
    perception::Detection,
};
use rten::{DataType, Dimension, Model, NodeId, Value, ValueType, ValueView};
use std::panic::{AssertUnwindSafe, catch_unwind};
use thiserror::Error;

/// A detector that is ready to look at images.
pub struct Detector {
    network: Network,
    form: ModelForm,
    labels: Labels,
    segments: bool,
    settings: DetectorSettings,
}

/// Why a model cannot be used. Whoever knows its file names it.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ModelError {
    /// No ONNX model, or a damaged one, or one with operators that are not known here.
    #[error("this is no ONNX model that can be used: {0}")]
    NotUsable(String),
    /// An input that is no image.
    #[error(
        "the model's input must be one image of 32-bit numbers, [1, 3, height, width] with sides from 32 to {MAX_SIDE} \
         that are multiples of 32, but is {0}"
    )]
    Input(String),
    /// Outputs that say nothing of boxes.
    #[error(
        "the model's output, {outputs} for an input of {width}x{height}, is not of the form {form}: known are those of {}",
        ModelForm::known()
    )]
    Output {
        /// Shapes.
        outputs: String,
        /// Width of the input.
        width: u32,
        /// Height of the input.
        height: u32,
        /// What was wanted.
        form: ModelForm,
    },
    /// Classes without names.
    #[error(transparent)]
    Labels(#[from] LabelError),
    /// It does not run.
    #[error("the model does not run: {0}")]
    Run(String),
}

/// No detector looks at larger images; a damaged size must not claim memory.
const MAX_SIDE: u32 = 2048;
/// Side of the input where the model leaves it open.
const OPEN_SIDE: u32 = 640;

impl Detector {
    /// A detector from the bytes of an ONNX model. Without `labels`, classes have the names that the model gives them,
    /// or those of COCO. It looks at an empty image once, to know that it runs and what it gives.
    ///
    /// # Errors
    /// When it is no model, does not run, takes something else than an image, gives something else than boxes, or does
    /// not fit the labels.
    pub fn new(
        onnx: Vec<u8>,
        labels: Option<Labels>,
        settings: &DetectorSettings,
    ) -> Result<Self, ModelError> {
        let network = Network::load(onnx)?;
        let [width, height] = network.input;
        let outputs = network.run(vec![0.0; 3 * width as usize * height as usize])?;
        let Some(rows) = Rows::new(settings.form, &outputs, network.input) else {
            let shapes: Vec<String> = outputs.iter().map(|o| format!("{:?}", o.shape)).collect();
            let (outputs, form) = (shapes.join(" and "), settings.form);
            return Err(ModelError::Output { outputs, width, height, form });
        };
        let given = labels.or_else(|| network.own_labels());
        let labels = match rows.classes() {
            Some(classes) => Labels::for_classes(given, classes)?,
            None => match given {
                Some(labels) => labels,
                None => Labels::for_classes(None, COCO_CLASSES)?,
            },
        };
        let form = rows.form();
        let prototypes = Prototypes::of(&outputs, network.input);
        let segments = prototypes.is_some_and(|given| given.count() == rows.mask_parts());
        Ok(Self { network, form, labels, segments, settings: settings.clone() })
    }

    /// Whether the model segments: its boxes have masks then, but for those whose mask is none.
    pub fn has_masks(&self) -> bool {
        self.segments
    }

    /// The form of the model's output.
    pub fn form(&self) -> ModelForm {
        self.form
    }

    /// Width and height of the model's input in pixels.
    pub fn input_size(&self) -> [u32; 2] {
        self.network.input
    }

    /// What is in an image, most probable first: boxes in its pixels, with masks where the model segments.
    ///
    /// # Errors
    /// When the model does not run, or gives something else than at first.
    pub fn detect(&self, image: &RgbImage) -> Result<Vec<Detection>, ModelError> {
        let (fit, colors) = preparation(self.form);
        let letterbox = Letterbox::new(fit, [image.width, image.height], self.network.input);
        let outputs = self.network.run(letterbox.fill(image, colors))?;
        let rows = Rows::new(self.form, &outputs, self.network.input);
        let rows = rows.ok_or_else(|| ModelError::Run("its output changed its shape".into()))?;
        let candidates = rows.candidates(self.settings.min_score).into_iter();
        let found = candidates.filter_map(|found| {
            let label = self.labels.get(found.class).filter(|l| self.settings.is_wanted(l))?;
            let rect = letterbox.in_image(found.corners)?;
            let detection = Detection::new(rect, vec![(label.to_owned(), found.score)]).ok()?;
            Some((detection, found.at))
        });
        let kept = suppress(found.collect(), self.settings.max_overlap).into_iter();
        let prototypes = Prototypes::of(&outputs, self.network.input);
        let masked = kept.map(|(mut detection, at)| {
            let mask = |prototypes: &Prototypes<'_>| {
                prototypes.mask(&rows.parts_of_mask(at), &detection.rect, &letterbox)
            };
            detection.mask = prototypes.as_ref().and_then(mask);
            detection
        });
        Ok(masked.collect())
    }
}

/// How networks of a form were trained to see images.
fn preparation(form: ModelForm) -> (Fit, Colors) {
    match form {
        ModelForm::Yolox => (Fit::Corner, Colors::Bgr255),
        ModelForm::Rtdetr => (Fit::Stretched, Colors::Rgb1),
        _ => (Fit::Middle, Colors::Rgb1),
    }
}

/// What runs the model.
struct Network {
    model: Model,
    image: NodeId,
    /// `[width, height]` in pixels.
    input: [u32; 2],
}

impl Network {
    fn load(onnx: Vec<u8>) -> Result<Self, ModelError> {
        let model = guarded(|| Model::load(onnx)).map_err(ModelError::NotUsable)?;
        let image = match model.input_ids() {
            [image] => *image,
            others => return Err(ModelError::Input(format!("{} inputs", others.len()))),
        };
        let info = model.node_info(image);
        let kind = info.as_ref().and_then(rten::NodeInfo::dtype);
        let shape = info.and_then(|info| info.shape()).unwrap_or_default();
        let input = input_size(&shape)
            .filter(|_| kind.is_none_or(|kind| kind == ValueType::Tensor(DataType::Float)))
            .ok_or_else(|| ModelError::Input(described(&shape, kind)))?;
        Ok(Self { model, image, input })
    }

    fn run(&self, planes: Vec<f32>) -> Result<Vec<Tensor>, ModelError> {
        let [width, height] = self.input.map(|side| side as usize);
        guarded(|| {
            let input =
                Value::from_shape([1, 3, height, width], planes).map_err(|e| e.to_string())?;
            let inputs = vec![(self.image, input.into())];
            let outputs = self.model.run(inputs, self.model.output_ids(), None);
            let outputs = outputs.map_err(|e| e.to_string())?;
            Ok::<_, String>(outputs.iter().filter_map(|value| tensor(&value.as_view())).collect())
        })
        .map_err(ModelError::Run)
    }

    /// Names of the classes that the model brings.
    fn own_labels(&self) -> Option<Labels> {
        let mut fields = self.model.metadata().fields();
        let names = fields.find(|(name, _)| *name == "names")?;
        Labels::from_metadata(names.1)
    }
}

/// A damaged model can be one on which the library stops instead of saying so.
fn guarded<T, E: ToString>(work: impl FnOnce() -> Result<T, E>) -> Result<T, String> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(outcome) => outcome.map_err(|e| one_line(&e.to_string())),
        Err(_) => Err("it is damaged, or made for another runtime".into()),
    }
}

fn one_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().to_owned()
}

/// The size of an image, if that is what the shape is of.
fn input_size(shape: &[Dimension]) -> Option<[u32; 2]> {
    let [batch, channels, height, width] = shape else { return None };
    let is = |dimension: &Dimension, wanted| match dimension {
        Dimension::Fixed(size) => *size == wanted,
        Dimension::Symbolic(_) => true,
    };
    let side = |dimension: &Dimension| match dimension {
        Dimension::Fixed(size) => u32::try_from(*size).ok(),
        Dimension::Symbolic(_) => Some(OPEN_SIDE),
    };
    let size = [side(width)?, side(height)?];
    let is_usual = size.iter().all(|side| (32..=MAX_SIDE).contains(side) && side % 32 == 0);
    (is(batch, 1) && is(channels, 3) && is_usual).then_some(size)
}

fn described(shape: &[Dimension], kind: Option<ValueType>) -> String {
    let sides: Vec<String> = shape
        .iter()
        .map(|dimension| match dimension {
            Dimension::Fixed(size) => size.to_string(),
            Dimension::Symbolic(name) => name.clone(),
        })
        .collect();
    let kind = kind.map_or_else(String::new, |kind| format!(" of {kind}"));
    format!("[{}]{kind}", sides.join(", "))
}

fn tensor(value: &ValueView<'_>) -> Option<Tensor> {
    let ValueView::FloatTensor(view) = value else { return None };
    use rten_tensor::prelude::*;
    Some(Tensor { shape: view.shape().to_vec(), data: view.to_vec() })
}

/// Where neither the model nor a file says what the classes are.
const COCO_CLASSES: usize = crate::msg::coco::NAMES.len();
