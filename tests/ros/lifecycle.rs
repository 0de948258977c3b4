//! The states of a managed node, without ROS 2.

use ellipsoid_slam::ros::lifecycle::{ARRIVALS, REQUESTS, State, ways};

/// Where a request leads from a state in which a node stays.
fn leads_to(from: State, label: &str, id: u8) -> Option<State> {
    ways(from, label, id).map(|[first, second]| {
        assert_eq!((first.from, first.to), (from, second.from));
        second.to
    })
}

#[test]
fn only_these_transitions_can_be_made() {
    use State::{Active, Finalized, Inactive, Unconfigured};
    let possible = [
        (Unconfigured, "configure", 1, Inactive),
        (Inactive, "cleanup", 2, Unconfigured),
        (Inactive, "activate", 3, Active),
        (Active, "deactivate", 4, Inactive),
        (Unconfigured, "shutdown", 5, Finalized),
        (Inactive, "shutdown", 6, Finalized),
        (Active, "shutdown", 7, Finalized),
    ];
    for from in State::ALL {
        for id in 0..=u8::MAX {
            let expected = possible.iter().find(|it| (it.0, it.2) == (from, id));
            assert_eq!(leads_to(from, "", id), expected.map(|it| it.3), "{from:?} {id}");
        }
        for label in ["configure", "cleanup", "activate", "deactivate", "shutdown", "fly"] {
            let expected = possible.iter().find(|it| (it.0, it.1) == (from, label));
            assert_eq!(leads_to(from, label, 0), expected.map(|it| it.3), "{from:?} {label}");
        }
    }
    // A label counts rather than an id, as in rclcpp_lifecycle.
    assert_eq!(leads_to(Inactive, "cleanup", 3), Some(Unconfigured));
    assert_eq!(leads_to(Inactive, "fly", 3), None);
}

#[test]
fn states_and_transitions_have_the_numbers_of_lifecycle_msgs() {
    let states = State::ALL.map(|state| (state.id(), state.label()));
    let expected = [
        (1, "unconfigured"),
        (2, "inactive"),
        (3, "active"),
        (4, "finalized"),
        (10, "configuring"),
        (11, "cleaningup"),
        (12, "shuttingdown"),
        (13, "activating"),
        (14, "deactivating"),
    ];
    assert_eq!(states, expected);
    // TRANSITION_ON_CONFIGURE_SUCCESS and so on.
    assert_eq!(ARRIVALS.map(|way| way.id), [10, 20, 30, 40, 50]);
    let ways: Vec<_> = REQUESTS.iter().chain(&ARRIVALS).map(|way| way.id).collect();
    assert_eq!(ways.len(), ways.iter().collect::<std::collections::BTreeSet<_>>().len());
}
