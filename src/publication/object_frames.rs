//! A frame in TF for each object.

use crate::{
    mapping::{MapObject, checked_name},
    pipeline::StampedTransform,
    time::Stamp,
};
use std::collections::BTreeSet;

/// The frames `object_ID` at the objects' centres, and `object_NAME` of those that people have named: what is no letter, digit
/// or underscore becomes an underscore. Of several with one name it is the first one's.
pub(super) fn object_frames<'a>(
    objects: impl Iterator<Item = &'a MapObject>,
    stamp: Stamp,
    map_frame: &str,
) -> Vec<StampedTransform> {
    let mut taken = BTreeSet::new();
    let mut frames = Vec::new();
    for object in objects {
        let numbered = format!("object_{}", object.id);
        let named = object.given_name().and_then(frame_name);
        for child_frame_id in [Some(numbered), named].into_iter().flatten() {
            if taken.insert(child_frame_id.clone()) {
                frames.push(StampedTransform {
                    stamp,
                    frame_id: map_frame.to_owned(),
                    child_frame_id,
                    parent_from_child: object.ellipsoid().pose,
                });
            }
        }
    }
    frames
}

/// Not where it could be taken for a number.
fn frame_name(name: &str) -> Option<String> {
    let name = checked_name(name).ok()?;
    let is_number = name.chars().all(|c| c.is_ascii_digit());
    let allowed = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    (!is_number).then(|| format!("object_{}", name.chars().map(allowed).collect::<String>()))
}
