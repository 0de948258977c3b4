//! What a trial is given: poses, association, boxes.

use crate::{geometry::Camera, mapping::Association, perception::Detection, pipeline::Settings};

/// Where poses come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Poses {
    /// The odometry is the truth.
    True,
    /// The odometry drifts.
    Drifting,
    /// It drifts and takes every way for longer than it is, which its covariance does not say.
    Stretched,
}

/// Which boxes of the detector are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Boxes {
    /// All.
    All,
    /// Those that are whole and that the detector is sure of.
    Sure,
}

/// The conditions of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Protocol {
    /// How files and keys call it.
    pub(super) key: &'static str,
    /// How people call it.
    pub(super) name: &'static str,
    pub(super) poses: Poses,
    pub(super) association: Association,
    pub(super) boxes: Boxes,
}

/// Liao et al. 2020, section VI: poses and association are given, boxes at the image border and unsure ones left out.
pub(super) const PAPER: Protocol = Protocol {
    key: "paper",
    name: "the paper's protocol",
    poses: Poses::True,
    association: Association::Given,
    boxes: Boxes::Sure,
};
pub(super) const TRUE_GIVEN: Protocol = Protocol {
    key: "true-given",
    name: "true poses, given association",
    poses: Poses::True,
    association: Association::Given,
    boxes: Boxes::All,
};
pub(super) const DRIFTING_GIVEN: Protocol = Protocol {
    key: "drifting-given",
    name: "drifting odometry, given association",
    poses: Poses::Drifting,
    association: Association::Given,
    boxes: Boxes::All,
};
pub(super) const STRETCHED_GIVEN: Protocol = Protocol {
    key: "stretched-given",
    name: "odometry 1 % too long besides, given association",
    poses: Poses::Stretched,
    association: Association::Given,
    boxes: Boxes::All,
};
/// By which share ways are too long (1).
pub(super) const STRETCH: f64 = 0.01;
pub(super) const DRIFTING_AUTOMATIC: Protocol = Protocol {
    key: "drifting-automatic",
    name: "drifting odometry, automatic association",
    poses: Poses::Drifting,
    association: Association::Automatic,
    boxes: Boxes::All,
};

/// The protocol of a key.
pub(super) fn protocol(key: &str) -> Result<Protocol, String> {
    const ALL: [Protocol; 5] =
        [PAPER, TRUE_GIVEN, DRIFTING_GIVEN, STRETCHED_GIVEN, DRIFTING_AUTOMATIC];
    let keys = || ALL.map(|protocol| protocol.key).join(", ");
    let found = ALL.into_iter().find(|protocol| protocol.key == key);
    found.ok_or_else(|| format!("there is no such protocol; there are {}", keys()))
}

/// The paper keeps YOLO's boxes above 0.95. Our detector is less sure of itself: 0.90 with a standard deviation of 0.06 for
/// large objects, less for small ones. This keeps 95 % of the boxes of large objects.
pub(super) const SURE: f64 = 0.8;
/// Boxes are as unsure as this: a side that is cut by the border may be reported so far inside (px).
pub(super) const BORDER_PX: f64 = 10.0;

impl Protocol {
    /// Changes settings to what the protocol gives.
    pub(super) fn change(&self, settings: &mut Settings) {
        settings.mapping.association = self.association;
        settings.slam.optimize_poses = self.poses != Poses::True;
        if self.association == Association::Given {
            // What comes with an identity is no chance cluster of false boxes: it counts from its first view on.
            settings.mapping.min_observations = 1;
        }
    }
}

impl Boxes {
    /// Whether there are boxes that are not used.
    pub(super) fn picks(self) -> bool {
        self == Self::Sure
    }

    /// Whether a box is used.
    pub(super) fn keeps(self, detection: &Detection, camera: &Camera) -> bool {
        let rect = &detection.rect;
        let (right, below) = (f64::from(camera.width() - 1), f64::from(camera.height() - 1));
        let distances = [rect.x_min, rect.y_min, right - rect.x_max, below - rect.y_max];
        let is_whole = distances.iter().all(|distance| *distance > BORDER_PX);
        !self.picks() || is_whole && detection.probability() > SURE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Distortion, Rect};

    #[test]
    fn the_paper_keeps_whole_boxes_that_are_sure() {
        let camera =
            Camera::new((640, 480), (525.0, 525.0), (319.5, 239.5), Distortion::None).unwrap();
        let keeps = |boxes: Boxes, sides: [f64; 4], probability: f64| {
            let rect = Rect::new(sides[0], sides[1], sides[2], sides[3]).unwrap();
            let detection = Detection::new(rect, vec![("cup".into(), probability)]).unwrap();
            boxes.keeps(&detection, &camera)
        };
        let whole = [100.0, 100.0, 200.0, 200.0];
        assert!(keeps(Boxes::Sure, whole, 0.81) && !keeps(Boxes::Sure, whole, 0.8));
        let cut = [
            [10.0, 100.0, 200.0, 200.0],
            [100.0, 5.0, 200.0, 200.0],
            [100.0, 100.0, 629.0, 200.0],
            [100.0, 100.0, 200.0, 479.0],
        ];
        for sides in cut {
            assert!(!keeps(Boxes::Sure, sides, 1.0), "{sides:?}");
            assert!(keeps(Boxes::All, sides, 0.1), "{sides:?}");
        }
    }
}
