//! Coloured points from depth images, at most one a voxel.

use super::{color_images::ColorImages, picture::as_base64};
use crate::{
    geometry::Pose,
    msg::convert::RgbImage,
    pipeline::{FramePose, Keyframe, ObjectSlam},
};
use nalgebra::Point3;
use serde::Serialize;
use std::collections::BTreeMap;

/// Edge of a voxel as long as there are few points (m).
const FINEST_M: f64 = 0.02;
/// By how much voxels grow when there are too many.
const COARSER: f64 = 1.5;
/// Points kept: a browser without a graphics card still turns them smoothly.
const MAX_POINTS: usize = 90_000;
/// Readings looked at in an image.
const SAMPLES: f64 = 16_000.0;
/// Readings from farther off are too noisy to be looked at (m).
const MAX_DEPTH_M: f32 = 6.0;
/// Neighbouring readings that differ by more, as a share of the depth, are of different surfaces, and what lies between
/// is of neither.
const MAX_JUMP: f32 = 0.04;
/// What the camera has to move (m) or turn (rad) to see something else, and how many times that to see what is new.
const OTHER_VIEW: (f64, f64) = (0.1, 0.09);
const NEW_VIEW: f64 = 4.0;

/// Where an image was taken.
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// The base at that time.
    pub pose: FramePose,
    /// The camera on it.
    pub base_from_camera: Pose,
}

impl Anchor {
    fn odom_from_camera(&self) -> Pose {
        self.pose.odom_from_base * self.base_from_camera
    }

    /// Where the camera was after all that is known now.
    pub(super) fn map_from_camera(&self, slam: &ObjectSlam) -> Pose {
        slam.map_from_base(&self.pose) * self.base_from_camera
    }
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    anchor: u32,
    in_camera: [f32; 3],
    color: [u8; 3],
}

/// Coloured points of what was seen. Samples by their voxel in odometry's frame. They are kept in the frame of their camera, so that they end where the
/// camera was after all optimisation.
#[derive(Debug)]
pub struct Cloud {
    anchors: Vec<Anchor>,
    samples: BTreeMap<[i32; 3], Sample>,
    voxel_m: f64,
    has_color: bool,
}

/// Points in the map.
#[derive(Debug)]
pub struct Placed {
    /// With red, green and blue.
    pub(super) points: Vec<(Point3<f64>, [u8; 3])>,
    pub(super) voxel_m: f64,
    pub(super) has_color: bool,
}

/// Points as the page has them: 16-bit steps of `step_m` from `origin`, three an axis a point, little-endian.
#[derive(Debug, Serialize)]
pub(super) struct Points {
    count: usize,
    voxel_m: f64,
    origin: [f64; 3],
    step_m: f64,
    #[serde(serialize_with = "as_base64")]
    positions: Vec<u8>,
    /// Red, green, blue; empty without colour images.
    #[serde(serialize_with = "as_base64")]
    colors: Vec<u8>,
}

impl Default for Cloud {
    fn default() -> Self {
        let (anchors, samples) = (Vec::new(), BTreeMap::new());
        Self { anchors, samples, voxel_m: FINEST_M, has_color: false }
    }
}

impl Cloud {
    /// Samples the depth image of a keyframe if it shows something else than the latest one did; so much else that its
    /// image is worth being decoded for that alone, unless that `is_decoded` for other reasons.
    pub fn look(
        &mut self,
        keyframe: &Keyframe,
        anchor: &Anchor,
        images: &mut ColorImages,
        is_decoded: bool,
    ) {
        let times = if is_decoded { 1.0 } else { NEW_VIEW };
        let is_new = self.anchors.last().is_none_or(|last| {
            let moved = last.odom_from_camera().inv_mul(&anchor.odom_from_camera());
            moved.translation.vector.norm() > times * OTHER_VIEW.0
                || moved.rotation.angle() > times * OTHER_VIEW.1
        });
        if is_new {
            self.add(*anchor, keyframe, images.decoded(keyframe.stamp).as_deref());
        }
    }

    /// Samples an image, with the colours of one of the same size.
    fn add(&mut self, anchor: Anchor, keyframe: &Keyframe, color: Option<&RgbImage>) {
        let number = self.anchors.len() as u32;
        self.anchors.push(anchor);
        let (depth, camera) = (&keyframe.depth, &keyframe.camera);
        let (width, height) = (depth.width(), depth.height());
        let color = color.filter(|image| (image.width, image.height) == (width, height));
        self.has_color |= color.is_some();
        let odom_from_camera = anchor.odom_from_camera();
        let stride = (f64::from(width) * f64::from(height) / SAMPLES).sqrt().ceil() as usize;
        for v in (stride / 2..height as usize).step_by(stride) {
            for u in (stride / 2..width as usize).step_by(stride) {
                let at = v * width as usize + u;
                let Some(z) = inner(depth.metres(), at, width as usize) else { continue };
                let ray = camera.ray(u as f64, v as f64);
                let in_camera = Point3::from(ray * f64::from(z));
                let pixel = color.and_then(|image| image.data.get(3 * at..3 * at + 3));
                let color = pixel.map_or([0; 3], |p| [p[0], p[1], p[2]]);
                let key = voxel(&(odom_from_camera * in_camera), self.voxel_m);
                let in_camera = in_camera.coords.map(|c| c as f32).into();
                self.samples.entry(key).or_insert(Sample { anchor: number, in_camera, color });
            }
        }
        while self.samples.len() > MAX_POINTS {
            self.coarsen();
        }
    }

    fn coarsen(&mut self) {
        self.voxel_m *= COARSER;
        for sample in std::mem::take(&mut self.samples).into_values() {
            let odom_from_camera = self.anchors[sample.anchor as usize].odom_from_camera();
            let key = voxel(&(odom_from_camera * point(&sample)), self.voxel_m);
            self.samples.entry(key).or_insert(sample);
        }
    }

    /// Where the points are after all optimisation, again at most one a voxel.
    pub fn finish(self, slam: &ObjectSlam) -> Placed {
        let poses: Vec<Pose> = self.anchors.iter().map(|a| a.map_from_camera(slam)).collect();
        let place = |sample: &Sample| (poses[sample.anchor as usize] * point(sample), sample.color);
        let mut points: Vec<(Point3<f64>, [u8; 3])> = self.samples.values().map(place).collect();
        // Stable: of the points of a voxel the same one stays each time.
        points.sort_by_key(|(at, _)| voxel(at, self.voxel_m));
        points.dedup_by_key(|(at, _)| voxel(at, self.voxel_m));
        Placed { points, voxel_m: self.voxel_m, has_color: self.has_color }
    }
}

impl Placed {
    /// The points with red, green and blue; none where there are no colours.
    pub fn colored(&self) -> &[(Point3<f64>, [u8; 3])] {
        if self.has_color { &self.points } else { &[] }
    }
}

impl Points {
    pub(super) fn of(placed: &Placed) -> Self {
        let bounds = |pick: fn(f64, f64) -> f64, from: f64| {
            placed.points.iter().fold([from; 3], |so_far, (at, _)| {
                [pick(so_far[0], at.x), pick(so_far[1], at.y), pick(so_far[2], at.z)]
            })
        };
        let (low, high) = (bounds(f64::min, f64::MAX), bounds(f64::max, f64::MIN));
        let extent = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
        let step_m = (extent / f64::from(u16::MAX)).max(1e-4);
        let (mut positions, mut colors) = (Vec::new(), Vec::new());
        for (at, color) in &placed.points {
            for axis in 0..3 {
                let steps = ((at[axis] - low[axis]) / step_m).round() as u16;
                positions.extend(steps.to_le_bytes());
            }
            colors.extend(if placed.has_color { &color[..] } else { &[] });
        }
        let origin = if placed.points.is_empty() { [0.0; 3] } else { low };
        Self {
            count: placed.points.len(),
            voxel_m: placed.voxel_m,
            origin,
            step_m,
            positions,
            colors,
        }
    }
}

/// A reading that its neighbours to the right and below confirm.
fn inner(metres: &[f32], at: usize, width: usize) -> Option<f32> {
    let z = *metres.get(at)?;
    let near = |other: Option<&f32>| other.is_some_and(|o| (o - z).abs() < MAX_JUMP * z);
    let is_inner = near(metres.get(at + 1)) && near(metres.get(at + width));
    (z < MAX_DEPTH_M && is_inner).then_some(z)
}

fn point(sample: &Sample) -> Point3<f64> {
    Point3::from(sample.in_camera.map(f64::from))
}

fn voxel(at: &Point3<f64>, edge_m: f64) -> [i32; 3] {
    [at.x, at.y, at.z].map(|c| (c / edge_m).floor() as i32)
}
