//! Switches of identity in sequences made by hand.

use ellipsoid_slam::eval::IdSwitches;

#[test]
fn a_switch_is_another_object_than_the_time_before() {
    // True object, object of the map.
    let cases: &[(&[(u64, u64)], usize)] = &[
        (&[], 0),
        (&[(1, 10)], 0),
        (&[(1, 10), (1, 10), (1, 10)], 0),
        (&[(1, 10), (1, 11), (1, 11)], 1),
        // There and back is two.
        (&[(1, 10), (1, 11), (1, 10)], 2),
        // Two objects between each other: neither switches.
        (&[(1, 10), (2, 20), (1, 10), (2, 20)], 0),
        // They change places: both switch.
        (&[(1, 10), (2, 20), (1, 20), (2, 10)], 2),
        // Two true objects in one object of the map: not a switch, but one of them is missing from the map.
        (&[(1, 10), (2, 10), (1, 10), (2, 10)], 0),
    ];
    for (joined, switches) in cases {
        let counted = IdSwitches::count(joined.iter().copied());
        assert_eq!((counted.switches, counted.observations), (*switches, joined.len()));
    }
}

#[test]
fn the_rate_is_for_200_observations() {
    assert_eq!(IdSwitches::default().per_200(), None);
    let steady = (0..49).map(|_| (1, 10));
    let counted = IdSwitches::count(steady.chain([(1, 11)]));
    assert_eq!((counted.switches, counted.per_200()), (1, Some(4.0)));
}
