//! Where an object ends: the six faces of its external cuboid, each with how it is known.
//!
//! A depth camera sees one side of an object. Every face is therefore classified by looking just beyond it: free
//! space means that the object ends there, a surface that goes on means that the box cut it, a nearer surface
//! means that the end is hidden. What was not seen gets little information, not wrong information.

use super::{
    ClassPrior, Frame, Side,
    beyond::{Beyond, what_lies_beyond},
    end::{Blur, end_of},
    footprint::{MIN_SIGMA_RAD, quantile},
    segmentation::{Segment, SurfacePoint},
    silhouette::BoxSide,
    unseen::{hides_itself, is_seen_grazing, unseen_back_m},
};
use crate::geometry::{FaceEvidence, Reach};
use nalgebra::{Isometry3, SMatrix, Translation3, Unit, UnitQuaternion, Vector3};

/// One face, by its coordinate along the outward direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) position_m: f64,
    pub(super) sigma_m: f64,
    pub(super) side: Side,
    /// How much of the position is a guess (m).
    pub(super) guessed_m: f64,
    /// Where the outermost reading is, unless the position is known without one.
    pub(super) seen: Option<Reach>,
}

/// The six faces in the order -x, +x, -y, +y, -z, +z of an upright frame turned by `yaw` in the level frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Faces {
    pub(super) yaw: f64,
    pub(super) faces: [Face; 6],
    /// How far out upright faces that were not seen can be, as there is free space or a wall (m).
    pub(super) at_most_m: [f64; 4],
    /// Whether a prior on the object's size says where unseen faces are: its class has a usual size, and its outline no
    /// diameter that one seen width tells.
    has_size_prior: bool,
}

impl Faces {
    /// Finds the faces of a segment whose axes are turned by `yaw`, as far as they were seen.
    pub(super) fn measure(
        frame: &Frame<'_>,
        segment: &Segment<'_>,
        yaw: f64,
        prior: &ClassPrior,
    ) -> Self {
        let mut faces =
            std::array::from_fn(|i| measure_face(frame, segment, &outward(yaw, i), prior));
        let lowest_m = -faces[4].position_m;
        faces[4] = bottom(segment, faces[4], prior);
        let mut out = Self {
            yaw,
            faces,
            at_most_m: [f64::INFINITY; 4],
            has_size_prior: prior.size_m.is_some() && !prior.outline.is_round(),
        };
        let unseen_m = lowest_m + out.faces[4].position_m;
        out.hide_backs_of_sheets(segment);
        out.hide_backs_of_fronts(segment, prior);
        out.doubt_low_top(frame, segment, prior);
        let is_cut = BoxSide::ALL.into_iter().any(|side| segment.is_cut_by_image(side));
        let hides_lower_part = prior.foot || unseen_m > UNSEEN_SHARE * out.extent_m(2);
        // Of what carries things the top is the widest part.
        if !prior.carries && (hides_lower_part || is_cut) {
            out.allow_for_unseen_part(prior, !hides_lower_part);
        }
        out
    }

    /// Extent along axis 0, 1 or 2 (m); at least a few millimetres.
    pub(super) fn extent_m(&self, axis: usize) -> f64 {
        let [low, high] = [self.faces[2 * axis], self.faces[2 * axis + 1]];
        (high.position_m + low.position_m).max(MIN_EXTENT_M)
    }

    /// Extent without what was guessed, along axis 0, 1 or 2 (m).
    pub(super) fn seen_extent_m(&self, axis: usize) -> f64 {
        self.extent_m(axis) - self.faces[2 * axis].guessed_m - self.faces[2 * axis + 1].guessed_m
    }

    /// Centre's coordinate along axis 0, 1 or 2 (m).
    pub(super) fn center_m(&self, axis: usize) -> f64 {
        0.5 * (self.faces[2 * axis + 1].position_m - self.faces[2 * axis].position_m)
    }

    /// Replaces a face that was not seen by the mirror image of the opposite one, which was, in a plane across
    /// `axis` at coordinate `offset_m`.
    pub(super) fn complete(&mut self, axis: usize, offset_m: f64, sigma_m: f64) {
        let (low, high) = (self.faces[2 * axis], self.faces[2 * axis + 1]);
        for (seen, hidden, sign) in [(low, 2 * axis + 1, 1.0), (high, 2 * axis, -1.0)] {
            if seen.side == Side::Seen && !self.faces[hidden].side.is_known() {
                let position_m = 2.0 * sign * offset_m + seen.position_m;
                if position_m > self.faces[hidden].position_m - 0.05 * self.extent_m(axis) {
                    let mirrored_m = seen.position_m + position_m;
                    self.faces[hidden] = Face {
                        position_m,
                        sigma_m: seen
                            .sigma_m
                            .hypot(2.0 * sigma_m)
                            .hypot(MIRROR_SIGMA_SHARE * mirrored_m),
                        side: Side::Mirrored,
                        guessed_m: 0.0,
                        seen: self.faces[hidden].seen,
                    };
                }
            }
        }
    }

    /// Faces of a body that is turned differently are elsewhere: by as much as its width turns in or out.
    pub(super) fn doubt_heading(&mut self, sigma: f64) {
        let unsure = (sigma * sigma - MIN_SIGMA_RAD * MIN_SIGMA_RAD).max(0.0).sqrt();
        let half_m = [0, 1].map(|axis| 0.5 * self.extent_m(axis));
        for (i, face) in self.faces[..4].iter_mut().enumerate() {
            let turned_m = unsure * half_m[1 - i / 2];
            face.sigma_m = face.sigma_m.hypot(turned_m);
            if let Some(seen) = &mut face.seen {
                seen.sigma_m = seen.sigma_m.hypot(turned_m);
            }
        }
    }

    /// What was seen of each face, from the centre along the box's own axes, without guesses.
    pub(super) fn evidence(&self) -> [FaceEvidence; 6] {
        std::array::from_fn(|i| {
            let face = self.faces[i];
            let sign = if i.is_multiple_of(2) { -1.0 } else { 1.0 };
            let from_center = |reach: Reach| Reach {
                position_m: reach.position_m - sign * self.center_m(i / 2),
                ..reach
            };
            let at = Reach { position_m: face.position_m, sigma_m: face.sigma_m };
            // Of an axis without a known end the middle is not known either, so that it is guessed, view by view.
            let has_known_end = face.side.is_known() || self.faces[i ^ 1].side.is_known();
            let is_bounded = !face.side.is_known() && has_known_end && self.has_size_prior;
            match face.seen.filter(|_| is_bounded) {
                None => FaceEvidence::At(from_center(at)),
                Some(seen) => {
                    let most_m = self.at_most_m.get(i).filter(|most_m| most_m.is_finite());
                    let most = |most_m: &f64| Reach { position_m: *most_m, sigma_m: ROOM_SIGMA_M };
                    FaceEvidence::Between {
                        at_least: from_center(seen),
                        at_most: most_m.map(most).map(from_center),
                    }
                }
            }
        })
    }

    /// Where only one face was seen, the back of the object is not where that face is.
    fn hide_backs_of_sheets(&mut self, segment: &Segment<'_>) {
        let view = segment.direction();
        for i in 0..4 {
            let is_sheet = self.extent_m(i / 2) < segment.sheet_m();
            let face = &mut self.faces[i];
            if is_sheet
                && face.side != Side::Hidden
                && outward(self.yaw, i).dot(&view) > TURNED_AWAY
            {
                face.side = Side::Hidden;
            }
        }
    }

    /// One looks through below a table and between the legs of a chair. So of something on legs that is much thinner than
    /// its class only the front was seen, although there is free space behind it.
    fn hide_backs_of_fronts(&mut self, segment: &Segment<'_>, prior: &ClassPrior) {
        let Some(size) = prior.size_m.filter(|_| prior.legs) else { return };
        let view = segment.direction();
        for i in 0..4 {
            let is_front = is_only_front(self.extent_m(i / 2), size);
            if is_front && outward(self.yaw, i).dot(&view) > BARELY_TURNED_AWAY {
                self.faces[i].side = Side::Hidden;
            }
        }
    }

    /// A back rest without its seat, a screen without its foot: what is lower down may reach farther than what was
    /// seen, to either side, in proportion to the sizes that the class usually has. Of what the image cuts
    /// (`needs_both`) the front is known, unless only a sliver was seen: thin along both axes.
    fn allow_for_unseen_part(&mut self, prior: &ClassPrior, needs_both: bool) {
        let Some(size) = prior.size_m else { return };
        let usual = self.usual_extents_m(size);
        let ratios = [0, 1, 2].map(|axis| self.extent_m(axis) / usual[axis]);
        // A wide screen has a deep foot; other things that are larger than usual may be two.
        let most = if prior.foot { LARGEST_SCREEN } else { 1.0 };
        let scale = ratios.into_iter().fold(0.0, f64::max).min(most);
        let is_thin = |axis: usize| ratios[axis] <= THIN_SHARE * scale;
        if needs_both && !(is_thin(0) && is_thin(1)) {
            return;
        }
        for (axis, usual_m) in usual.iter().enumerate().take(2) {
            let missing_m = 0.5 * (scale * usual_m - self.extent_m(axis));
            if !is_thin(axis) {
                continue;
            }
            for face in &mut self.faces[2 * axis..2 * axis + 2] {
                face.position_m += missing_m;
                face.guessed_m += missing_m;
                face.sigma_m = face.sigma_m.hypot(missing_m);
                face.side = Side::Hidden;
            }
        }
    }

    /// The class's usual extents along the axes (m).
    pub(super) fn usual_extents_m(&self, size_m: [f64; 3]) -> [f64; 3] {
        usual_extents(size_m, &std::array::from_fn(|axis| self.extent_m(axis)))
    }

    /// Semi-axes (m) in the order x, y, z.
    pub(super) fn semi_axes_m(&self) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| 0.5 * self.extent_m(axis))
    }

    /// `level_from_object`.
    pub(super) fn pose(&self) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw);
        let center = rotation * Vector3::from_fn(|axis, _| self.center_m(axis));
        Isometry3::from_parts(Translation3::from(center), rotation)
    }

    /// Covariance of [rotation, translation, log semi-axes] in the object's frame.
    ///
    /// Centre and semi-axis are half the sum and half the difference of two faces: where only one of them
    /// is known they are strongly correlated, and the next view of the other face settles both.
    pub(super) fn covariance(
        &self,
        yaw_sigma: f64,
        tilt_sigma: f64,
        place_sigma_m: f64,
    ) -> SMatrix<f64, 9, 9> {
        let mut covariance = SMatrix::<f64, 9, 9>::zeros();
        covariance[(0, 0)] = tilt_sigma.powi(2);
        covariance[(1, 1)] = tilt_sigma.powi(2);
        covariance[(2, 2)] = yaw_sigma.powi(2);
        for axis in 0..3 {
            let low = self.faces[2 * axis].sigma_m.powi(2);
            let high = self.faces[2 * axis + 1].sigma_m.powi(2);
            let semi = 0.5 * self.extent_m(axis);
            let (t, s) = (3 + axis, 6 + axis);
            covariance[(t, t)] = 0.25 * (low + high);
            covariance[(s, s)] = 0.25 * (low + high) / (semi * semi);
            covariance[(t, s)] = 0.25 * (high - low) / semi;
            covariance[(s, t)] = covariance[(t, s)];
        }
        for t in 3..5 {
            covariance[(t, t)] += place_sigma_m.powi(2);
        }
        covariance
    }
}

/// Direction out of face `i` in the level frame.
pub(super) fn outward(yaw: f64, i: usize) -> Vector3<f64> {
    let (sin, cos) = yaw.sin_cos();
    let axis = match i / 2 {
        0 => Vector3::new(cos, sin, 0.0),
        1 => Vector3::new(-sin, cos, 0.0),
        _ => Vector3::z(),
    };
    if i.is_multiple_of(2) { -axis } else { axis }
}

fn measure_face(
    frame: &Frame<'_>,
    segment: &Segment<'_>,
    outward: &Vector3<f64>,
    prior: &ClassPrior,
) -> Face {
    let mut coordinates: Vec<f64> =
        segment.points.iter().map(|p| p.at.coords.dot(outward)).collect();
    let extent = quantile(&mut coordinates, 0.99) - quantile(&mut coordinates, 0.01);
    let last = outermost(&mut coordinates, extent);
    let mut rim: Vec<&SurfacePoint> =
        segment.points.iter().filter(|p| p.at.coords.dot(outward) > last - RIM_M).collect();
    let n = rim.len() as f64;
    let noise_m = rim.iter().map(|p| p.noise_along_m(outward)).sum::<f64>() / n;
    let step_m = rim.iter().map(|p| sample_step_m(segment, p, outward)).sum::<f64>() / n;
    let end = end_of(
        &coordinates,
        last,
        extent,
        Blur { noise_m, step_m, band_m: EDGE_BAND_PX * step_m / segment.stride },
    );
    rim.retain(|p| p.at.coords.dot(outward) > end.position_m - 0.01 - 2.0 * noise_m);
    let Beyond { side, gap_m, is_ragged } = what_lies_beyond(frame, segment, &rim, outward);
    let side = match side {
        // Where readings get lost, the last one is not the end.
        Side::Seen if is_ragged && !prior.carries && is_seen_grazing(&rim, outward) => Side::Hidden,
        side => side,
    };
    let may_go_on = || may_go_on_outside_image(segment, &rim, outward);
    let (side, unseen_m) = match side {
        Side::Seen if may_go_on() => {
            let is_top = outward.z > 0.0;
            if is_top && prior.carries {
                (Side::Seen, 0.0)
            } else if is_top && is_usual_height(extent, prior) {
                (Side::Seen, CUT_TOP_SHARE * extent)
            } else {
                (Side::Cut, 0.0)
            }
        }
        side => (side, 0.0),
    };
    let back_m = unseen_back_m(segment, &rim, outward, prior);
    let (side, back_m) = match side {
        Side::Seen => (side, back_m),
        // What hides the end is the front of the back rest itself, if the seat before it was seen.
        Side::Hidden
            if back_m > 0.0
                && prior.size_m.is_some_and(|size| !is_only_front(extent, size))
                && !may_go_on()
                && hides_itself(&rim, outward) =>
        {
            (Side::Seen, back_m)
        }
        _ => (side, 0.0),
    };
    let seen = Reach { position_m: end.position_m, sigma_m: end.sigma_m.hypot(MODEL_SIGMA_M) };
    Face {
        position_m: end.position_m + 0.5 * gap_m + back_m,
        sigma_m: end.sigma_m.hypot(MODEL_SIGMA_M).hypot(unseen_m).hypot(0.5 * gap_m).hypot(back_m),
        side,
        guessed_m: 0.0,
        seen: Some(seen),
    }
}

/// Whether what was seen is as high as its class: no more of it will be outside the image, but for a handle.
fn is_usual_height(seen_m: f64, prior: &ClassPrior) -> bool {
    prior.size_m.is_some_and(|[_, _, height]| seen_m > USUAL_SHARE * height)
}

/// Whether what was seen of something on legs is no more than its front, going by the usual size of its class.
fn is_only_front(seen_m: f64, [_, short, _]: [f64; 3]) -> bool {
    seen_m < FRONT_SHARE * short
}

/// Whether more of the outermost points may be outside the image. The face that is turned to the camera goes on there
/// as it is.
fn may_go_on_outside_image(
    segment: &Segment<'_>,
    rim: &[&SurfacePoint],
    outward: &Vector3<f64>,
) -> bool {
    let at_border = rim.iter().filter(|p| segment.is_at_image_border(p)).count();
    let is_front = outward.z == 0.0 && rim.iter().all(|p| p.at.coords.dot(outward) < 0.0);
    !is_front && at_border as f64 > BORDER_SHARE * rim.len() as f64
}

/// The outermost coordinate at which the points are not yet sparse: readings between the object and what is behind it
/// trail off beyond its end.
fn outermost(coordinates: &mut [f64], extent: f64) -> f64 {
    let n = coordinates.len();
    let window = (0.1 * extent).clamp(0.005, 0.03);
    let uniform = n as f64 * window / extent.max(window);
    let enough = ((SPARSE * uniform) as usize).max(3).min(n);
    // The tail is in the outermost tenth.
    let tail_start = n - (n / 10).max(enough);
    coordinates.select_nth_unstable_by(tail_start.min(n - 1), f64::total_cmp);
    let tail = &mut coordinates[tail_start..];
    tail.sort_unstable_by(|a, b| b.total_cmp(a));
    let within = |i: usize| tail[i..].partition_point(|c| *c >= tail[i] - window);
    (0..tail.len()).find(|i| within(*i) >= enough).map_or(tail[tail.len() - 1], |i| tail[i])
}

/// Distance between neighbouring samples when going `outward` along the surface at a point: along the view, on surfaces
/// seen at a grazing angle, they lie far apart.
pub(super) fn sample_step_m(
    segment: &Segment<'_>,
    p: &SurfacePoint,
    outward: &Vector3<f64>,
) -> f64 {
    let ray = p.at.coords / p.at.coords.norm();
    let along = p.normal.map_or(*outward, |n| outward - n.into_inner() * n.dot(outward));
    // A face turned outward has no surface to go along.
    let across_view = Unit::try_new(along, 0.2).map_or(0.7, |along| along.cross(&ray).norm());
    segment.spacing_m / across_view.max(MIN_FACING)
}

/// The class's usual extents along the object's axes; the longer horizontal one goes with the axis that has
/// grown nearer to it.
fn usual_extents(size: [f64; 3], seen: &[f64; 3]) -> [f64; 3] {
    let [long, short, height] = size;
    let misfit = |x: f64, y: f64| (x / seen[0]).ln().abs().min((y / seen[1]).ln().abs());
    if misfit(long, short) <= misfit(short, long) {
        [long, short, height]
    } else {
        [short, long, height]
    }
}

/// The bottom is the support plane where the points reach it, where what is between is hidden, and for classes that
/// stand on legs too thin for a depth camera.
fn bottom(segment: &Segment<'_>, lowest: Face, prior: &ClassPrior) -> Face {
    let Some(support) = segment.support else { return lowest };
    let n = segment.points.len() as f64;
    let center = segment.points.iter().map(|p| p.at.coords).sum::<Vector3<f64>>() / n;
    let level = center.z - support.height_of(&center.into()) / support.plane.normal.z;
    let sigma = segment.points.iter().map(|p| p.sigma_m).sum::<f64>() / n;
    let gap = -lowest.position_m - level;
    let on_plane = |sigma_m: f64, side: Side| Face {
        position_m: -level,
        sigma_m,
        side,
        guessed_m: 0.0,
        seen: None,
    };
    if gap < SUPPORT_REACH_M + 3.0 * sigma + 2.0 * segment.spacing_m {
        return on_plane(0.004 + support.rms_m, Side::Support);
    }
    // What hides: of a table top at eye level little is seen, and the plane found is the floor.
    let height = segment.height_m();
    let missing = prior.size_m.map_or(0.3 * height, |[_, _, usual]| (usual - height).max(0.0));
    match lowest.side {
        _ if prior.legs => on_plane(LEGS_SIGMA_M, Side::Support),
        Side::Hidden if gap < 1.5 * missing + 0.1 => on_plane(0.3 * gap, Side::Hidden),
        Side::Hidden => Face {
            position_m: lowest.position_m + missing,
            sigma_m: (0.5 * missing).max(0.2 * height),
            side: Side::Hidden,
            guessed_m: missing,
            seen: lowest.seen,
        },
        Side::Cut => Face { sigma_m: lowest.sigma_m.hypot(CUT_BOTTOM_SHARE * height), ..lowest },
        // It stands on something that is not a plane of its own, or hangs.
        _ => lowest,
    }
}

/// Structured-light cameras lose readings this near to a jump of the depth (px). Khoshelham and Elberink 2012.
const EDGE_BAND_PX: f64 = 2.0;
/// Of something on legs, what is thinner than this share of the shorter usual extent is its front.
const FRONT_SHARE: f64 = 0.5;
/// Points are sparse where there are fewer than this share of what there would be if they were spread evenly.
const SPARSE: f64 = 0.15;
/// Depth of the layer of outermost points (m).
const RIM_M: f64 = 0.05;
/// How exactly it is known where free space or a wall ends a face (m).
const ROOM_SIGMA_M: f64 = 0.05;
/// Real objects have round edges and handles (m).
const MODEL_SIGMA_M: f64 = 0.01;
/// Cosine of the most grazing view that still gives samples.
const MIN_FACING: f64 = 0.2;
/// Share of the outermost points at the image's border from which on more of them may be outside.
const BORDER_SHARE: f64 = 0.02;
/// Things of a class are at least this share of their usual height.
const USUAL_SHARE: f64 = 0.85;
/// Screens are up to so much larger than the usual one.
const LARGEST_SCREEN: f64 = 1.6;
/// Below what was seen there is room for this share of the object.
const UNSEEN_SHARE: f64 = 0.25;
/// What is thinner than this share of the usual extent is not all of the object.
const THIN_SHARE: f64 = 0.75;
/// Cosine between the view and a face's outward direction from which on the face is turned away.
pub(super) const TURNED_AWAY: f64 = 0.3;
/// The same where nothing but the front was seen.
const BARELY_TURNED_AWAY: f64 = 0.1;
/// Things are symmetric to this share of their extent.
const MIRROR_SIGMA_SHARE: f64 = 0.08;
const MIN_EXTENT_M: f64 = 0.005;
/// Points this near to the support plane are taken to reach it (m).
const SUPPORT_REACH_M: f64 = 0.05;
/// A support plane under legs may be the wrong one of two: a carpet, a step (m).
const LEGS_SIGMA_M: f64 = 0.02;
/// What is below a bottom that the box cuts off, as a share of the height.
const CUT_BOTTOM_SHARE: f64 = 0.25;
/// A handle above a top that the image cuts off, as a share of the height.
const CUT_TOP_SHARE: f64 = 0.2;
