//! What of images shows an object.

use super::{
    picture::{as_base64, thumbnail},
    thinned::Thinned,
};
use crate::{
    geometry::Rect,
    mapping::ObjectId,
    msg::convert::{ConvertError, RgbImage},
};
use serde::Serialize;
use std::collections::BTreeMap;

/// Crops of an object, at most.
const MAX_CROPS: usize = 8;
/// Longer side of a crop (px).
const SIDE_PX: u32 = 120;
/// Share of the box that is shown around it.
const MARGIN: f64 = 0.08;
/// All crops together (bytes).
const BUDGET: usize = 3_000_000;

/// A part of an image that a detector's box of the object was in.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Crop {
    /// When, since the start (s).
    t: f64,
    #[serde(serialize_with = "as_base64")]
    jpeg: Vec<u8>,
}

#[derive(Debug, Default)]
pub(super) struct Crops {
    by_object: BTreeMap<ObjectId, Thinned<Crop>>,
}

impl Crops {
    /// Whether the next box of an object is to be added; to be asked once for each. An image is decoded for a crop alone only
    /// where the object has none.
    pub(super) fn takes_next(&mut self, object: ObjectId, is_decoded: bool) -> bool {
        let crops = self.by_object.entry(object).or_insert_with(|| Thinned::new(MAX_CROPS));
        (is_decoded || crops.iter().next().is_none()) && crops.takes_next()
    }

    pub(super) fn add(
        &mut self,
        object: ObjectId,
        t: f64,
        image: &RgbImage,
        rect: &Rect,
    ) -> Result<(), ConvertError> {
        let (x, y) = (MARGIN * rect.width(), MARGIN * rect.height());
        let part = Rect {
            x_min: (rect.x_min - x).max(0.0),
            y_min: (rect.y_min - y).max(0.0),
            x_max: (rect.x_max + x).min(image.width.into()),
            y_max: (rect.y_max + y).min(image.height.into()),
        };
        if part.width() < 2.0 || part.height() < 2.0 {
            return Ok(());
        }
        let jpeg = thumbnail(image, &part, SIDE_PX)?;
        if let Some(crops) = self.by_object.get_mut(&object) {
            crops.add(Crop { t, jpeg }, 1);
        }
        Ok(())
    }

    /// Two objects were one.
    pub(super) fn merge(&mut self, kept: ObjectId, gone: ObjectId) {
        let Some(gone) = self.by_object.remove(&gone) else { return };
        let own = self.by_object.entry(kept).or_insert_with(|| Thinned::new(MAX_CROPS));
        gone.into_entries().into_iter().for_each(|crop| own.add(crop, 1));
    }

    /// Those of the objects of the map in order of time, and how many an object has at most.
    pub(super) fn finish(self, in_map: &[u64]) -> (BTreeMap<u64, Vec<Crop>>, usize) {
        let kept = self.by_object.into_iter().filter(|(id, _)| in_map.contains(&id.0));
        let mut all: BTreeMap<u64, Vec<Crop>> =
            kept.map(|(id, crops)| (id.0, crops.into_entries())).collect();
        all.values_mut().for_each(|crops| crops.sort_by(|a, b| a.t.total_cmp(&b.t)));
        let mut most = MAX_CROPS;
        while most > 1 && all.values().flatten().map(|c| c.jpeg.len()).sum::<usize>() > BUDGET {
            most /= 2;
            for crops in all.values_mut().filter(|crops| crops.len() > most) {
                let count = crops.len();
                let mut at = 0;
                crops.retain(|_| {
                    at += 1;
                    (at * most) / count > ((at - 1) * most) / count
                });
            }
        }
        (all, most)
    }
}
