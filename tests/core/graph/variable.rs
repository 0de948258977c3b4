use crate::geometry::{ellipsoids, pose_distance, poses, walls};
use ellipsoid_slam::graph::{Variable, VariableId, VariableIds};
use proptest::{array::uniform9, prelude::*};

fn pairs() -> impl Strategy<Value = (Variable, Variable)> {
    prop_oneof![
        (poses(), poses()).prop_map(|(a, b)| (Variable::Pose(a), Variable::Pose(b))),
        (ellipsoids(), ellipsoids())
            .prop_map(|(a, b)| (Variable::Ellipsoid(a), Variable::Ellipsoid(b))),
        // Opposite ways are half a turn apart, whichever way one turns.
        (walls(), walls())
            .prop_filter("opposite", |(a, b)| a.local(b).x.abs() < 3.0)
            .prop_map(|(a, b)| (Variable::Wall(a), Variable::Wall(b))),
    ]
}

fn distance(a: &Variable, b: &Variable) -> f64 {
    if let (Variable::Wall(a), Variable::Wall(b)) = (a, b) {
        // As planes: a point may slide along its wall.
        return (a.normal() - b.normal()).norm() + a.signed_distance(&b.point).abs();
    }
    let size = |v: &Variable| v.ellipsoid().map_or(nalgebra::Vector3::zeros(), |e| e.semi_axes);
    pose_distance(a.pose(), b.pose()) + (size(a) - size(b)).norm()
}

proptest! {
    #[test]
    fn no_step_leaves_a_variable_where_it_is((a, _) in pairs()) {
        prop_assert!(distance(&a.retract(&vec![0.0; a.dimension()]), &a) < 1e-7);
        prop_assert!(a.local(&a).norm() < 1e-7);
    }

    #[test]
    fn steps_have_the_variables_dimension((a, b) in pairs()) {
        prop_assert_eq!(a.local(&b).len(), a.dimension());
        let expected = match a {
            Variable::Pose(_) => 6,
            Variable::Ellipsoid(_) => 9,
            Variable::Wall(_) => 2,
        };
        prop_assert_eq!(a.dimension(), expected);
    }

    #[test]
    fn retract_takes_back_local((a, b) in pairs()) {
        prop_assert!(distance(&a.retract(a.local(&b).as_slice()), &b) < 1e-6);
    }

    #[test]
    fn local_takes_back_retract((a, _) in pairs(), step in uniform9(-0.9..0.9)) {
        let step = &step[..a.dimension()];
        let back = a.local(&a.retract(step));
        for (back, step) in back.iter().zip(step) {
            prop_assert!((back - step).abs() < 1e-8);
        }
    }

    /// Along one direction steps add up, so that the inverse of a step is the step with the other sign.
    #[test]
    fn a_step_back_is_the_inverse((a, _) in pairs(), step in uniform9(-0.9..0.9)) {
        let step = &step[..a.dimension()];
        let back: Vec<f64> = step.iter().map(|s: &f64| -*s).collect();
        prop_assert!(distance(&a.retract(step).retract(&back), &a) < 1e-7);
    }
}

#[test]
fn handles_are_never_given_out_twice() {
    let mut ids = VariableIds::default();
    let all: Vec<VariableId> =
        vec![ids.next_pose().into(), ids.next_ellipsoid().into(), ids.next_wall().into()];
    let places: Vec<usize> = all.iter().map(|id| id.index()).collect();
    assert_eq!(places, [0, 1, 2]);
}
