//! What one image says, in the frame of the base: what mapping takes. Liao et al. 2020, eq. (12).

use super::{Settings, placement::Placement};
use crate::{
    geometry::{Camera, Pose, Rect},
    graph::BoxSide,
    mapping::{Hints, Measured, Observation, ObservedBox, SlamSettings, WallSighting},
    perception::{Detection, EllipsoidMeasurement, Glimpse, WallSegment},
};

/// What a box says of an object, in the frame of the base.
pub(super) fn observation(
    detection: &Detection,
    (found, glimpse): (Option<&EllipsoidMeasurement>, Option<&Glimpse>),
    camera: &Camera,
    view: (&Pose, &Placement),
    settings: &Settings,
) -> Observation {
    let class = settings.perception.classes.prior(detection.label());
    let measured = match (found, glimpse) {
        (Some(measured), _) => Some(in_base(measured, view, class.size_m)),
        (None, Some(glimpse)) => Some(glimpsed(glimpse, view)),
        (None, None) => None,
    };
    Observation {
        labels: detection.hypotheses().to_vec(),
        track: detection.track,
        outline: class.outline,
        moves: class.moves,
        rect: Some(detection.rect),
        sides: observed_box(detection, (found, glimpse), camera, view, &settings.slam),
        measured,
    }
}

/// A measurement in the frame of the base. Liao et al. 2020, eq. (12).
fn in_base(
    measurement: &EllipsoidMeasurement,
    (base_from_camera, placement): (&Pose, &Placement),
    usual_m: Option<[f64; 3]>,
) -> Measured {
    let ellipsoid = measurement.ellipsoid.transformed(base_from_camera);
    let covariance = placement.widened(&measurement.covariance, &ellipsoid);
    // Where the camera is not known exactly, faces are not either.
    let faces = std::array::from_fn(|face| {
        let at = (3 + face / 2, 3 + face / 2);
        measurement.faces[face]
            .widened((covariance[at] - measurement.covariance[at]).max(0.0).sqrt())
    });
    let measured = Measured {
        covariance,
        ellipsoid,
        faces: Some(faces),
        probability: measurement.probability.combined(),
        support: measurement.support.map(|plane| plane.transformed(base_from_camera)),
        usual_m,
        glimpse: None,
    };
    match usual_m {
        Some([long_m, short_m, _]) => measured.doubting_its_size(long_m.max(short_m)),
        None => measured,
    }
}

pub(super) fn wall_in_base(
    wall: &WallSegment,
    (base_from_camera, placement): (&Pose, &Placement),
) -> WallSighting {
    let (center, normal) = (base_from_camera * wall.center, base_from_camera * wall.normal);
    let displaced_m = normal.dot(&(placement.displacement(&center) * normal)).sqrt();
    let heading_sigma = wall.heading_sigma.hypot(placement.heading_sigma());
    WallSighting {
        center,
        normal,
        half_length_m: wall.half_length_m,
        sigmas: [heading_sigma, wall.distance_sigma_m.hypot(displaced_m)],
    }
}

fn glimpsed(glimpse: &Glimpse, (base_from_camera, placement): (&Pose, &Placement)) -> Measured {
    let ellipsoid = glimpse.ellipsoid.transformed(base_from_camera);
    Measured {
        covariance: placement.widened(&glimpse.covariance, &ellipsoid),
        ellipsoid,
        faces: None,
        probability: 0.0,
        support: glimpse.floor.map(|plane| plane.transformed(base_from_camera)),
        usual_m: None,
        glimpse: Some(Hints {
            depth_covariance: placement.widened(&glimpse.depth_covariance, &ellipsoid),
            usual: glimpse.usual,
        }),
    }
}

/// The sides of a box that say where the object ends, as directions: all inside the image, or of round objects those that
/// are seen to be the silhouette.
fn observed_box(
    detection: &Detection,
    (measured, glimpse): (Option<&EllipsoidMeasurement>, Option<&Glimpse>),
    camera: &Camera,
    (base_from_camera, placement): (&Pose, &Placement),
    settings: &SlamSettings,
) -> ObservedBox {
    let round = measured.filter(|m| settings.silhouettes && m.outline.is_round());
    let used = if settings.boxes { [true; 4] } else { round.map_or([false; 4], |m| m.silhouette) };
    let Rect { x_min, y_min, x_max, y_max } = detection.rect;
    let (u, v) = detection.rect.center();
    let ((fx, fy), border) = (camera.focal(), settings.box_border_px);
    let (right, bottom) = (f64::from(camera.width()) - 1.0, f64::from(camera.height()) - 1.0);
    let inside = |at: f64, end: f64| at > border && at < end - border;
    let extents = [detection.rect.width(), detection.rect.height()];
    let usual =
        |side: usize| settings.box_sigma_px.hypot(settings.box_sigma_ratio * extents[side % 2]);
    let places = [
        (camera.ray(x_min, v).x, inside(x_min, right), fx),
        (camera.ray(u, y_min).y, inside(y_min, bottom), fy),
        (camera.ray(x_max, v).x, inside(x_max, right), fx),
        (camera.ray(u, y_max).y, inside(y_max, bottom), fy),
    ];
    let turned = placement.direction_sigmas();
    let sides = std::array::from_fn(|side| {
        let (at, is_inside, focal) = places[side];
        let sigma_px = match glimpse {
            Some(glimpse) if !settings.boxes => {
                glimpse.hidden_px[side].map(|px| px.hypot(usual(side)))
            }
            _ => used[side].then(|| usual(side)),
        };
        sigma_px
            .filter(|_| is_inside)
            .map(|px| BoxSide { at, sigma: turned[side % 2].hypot(px / focal) })
    });
    ObservedBox { base_from_camera: *base_from_camera, sides }
}
