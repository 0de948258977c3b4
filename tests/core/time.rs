//! Stamps.

use ellipsoid_slam::time::Stamp;
use proptest::prelude::*;

#[test]
fn stamps_are_written_as_seconds_with_nine_decimals() {
    for (nanos, expected) in [
        (0, "0.000000000"),
        (1, "0.000000001"),
        (1_700_000_000_200_000_000, "1700000000.200000000"),
        (-1, "-0.000000001"),
        (-1_500_000_000, "-1.500000000"),
        (i64::MIN, "-9223372036.854775808"),
    ] {
        assert_eq!(Stamp::from_nanos(nanos).to_string(), expected);
    }
}

#[test]
fn what_does_not_fit_saturates() {
    assert_eq!(Stamp::from_secs(1e300).as_nanos(), i64::MAX);
    assert_eq!(Stamp::from_secs(-1e300).as_nanos(), i64::MIN);
    let last = Stamp::from_nanos(i64::MAX);
    assert_eq!(last.shifted(1.0), last);
    assert!(last.seconds_since(Stamp::from_nanos(i64::MIN)) > 9e9);
}

proptest! {
    #[test]
    fn a_stamp_is_read_back_from_what_is_written(nanos in any::<i64>()) {
        let text = Stamp::from_nanos(nanos).to_string();
        let (whole, decimals) = text.split_once('.').unwrap();
        prop_assert_eq!(decimals.len(), 9);
        let digits: i128 = format!("{whole}{decimals}").parse().unwrap();
        prop_assert_eq!(digits, i128::from(nanos));
    }

    #[test]
    fn seconds_are_the_same_however_often_they_are_read_and_written(nanos in 0..i64::MAX) {
        let once = Stamp::from_nanos(nanos).as_secs();
        prop_assert_eq!(Stamp::from_secs(once).as_secs(), once);
    }

    /// A microsecond: a present-day stamp in seconds has 0.24 microseconds between neighbouring numbers.
    #[test]
    fn seconds_hold_a_stamp_to_a_microsecond(nanos in 0_i64..4_000_000_000_000_000_000) {
        let stamp = Stamp::from_nanos(nanos);
        prop_assert!((Stamp::from_secs(stamp.as_secs()).as_nanos() - nanos).abs() < 1_000);
    }

    #[test]
    fn moving_a_stamp_is_measured_back(nanos in 0_i64..2_000_000_000_000_000_000, step in -3600.0..3600.0) {
        let stamp = Stamp::from_nanos(nanos);
        let moved = stamp.shifted(step);
        // Half a nanosecond of rounding.
        prop_assert!((moved.seconds_since(stamp) - step).abs() <= 0.6e-9);
        prop_assert_eq!(moved.seconds_since(stamp), -stamp.seconds_since(moved));
        prop_assert_eq!(moved > stamp, moved.as_nanos() > nanos);
    }
}
