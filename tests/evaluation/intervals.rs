//! Confidence intervals by Student's t.

use ellipsoid_slam::eval::Interval;

fn assert_near(got: f64, expected: f64) {
    assert!((got - expected).abs() < 1e-9, "{got} instead of {expected}");
}

#[test]
fn the_interval_is_worked_out_by_hand() {
    // Mean 5, squares 9 + 1 + 1 + 9 = 20, s^2 = 20 / 3, standard error sqrt(20 / 12), t of 3 degrees of freedom 3.182.
    let interval = Interval::of(&[2.0, 4.0, 6.0, 8.0]).unwrap();
    assert_near(interval.mean, 5.0);
    assert_near(interval.half_width.unwrap(), 3.182 * (20.0_f64 / 12.0).sqrt());
    assert_eq!(interval.samples, 4);
    // Two samples: t of one degree of freedom, half their distance is the standard error.
    let interval = Interval::of(&[1.0, 2.0]).unwrap();
    assert_near(interval.half_width.unwrap(), 12.706 * 0.5);
}

#[test]
fn few_samples_tell_little() {
    assert_eq!(Interval::of(&[]), None);
    let single = Interval::of(&[0.3]).unwrap();
    assert_eq!((single.mean, single.half_width), (0.3, None));
    assert!(single.holds(0.3) && !single.holds(0.31));
    let equal = Interval::of(&[0.3; 5]).unwrap();
    assert!(equal.half_width.unwrap() < 1e-15 && equal.holds(0.3));
}

#[test]
fn quantiles_fall_with_the_samples_towards_the_normal_one() {
    let quantile = |count: usize| {
        // Half of them at -1, half at 1: the sum of squares is their number.
        let samples: Vec<f64> = (0..count).map(|i| if i % 2 == 0 { -1.0 } else { 1.0 }).collect();
        let standard_error = (1.0 / (count as f64 - 1.0)).sqrt();
        Interval::of(&samples).unwrap().half_width.unwrap() / standard_error
    };
    // 10, 30 and 80 samples: tables of Student's t with 9, 29 and 79 degrees of freedom.
    for (count, expected) in [(10, 2.262), (30, 2.045), (80, 1.990), (100_000, 1.960)] {
        assert!((quantile(count) - expected).abs() < 1e-3, "{count}: {}", quantile(count));
    }
    let falling: Vec<f64> = (1..100).map(|half| quantile(2 * half)).collect();
    assert!(falling.windows(2).all(|pair| pair[1] < pair[0]), "{falling:?}");
}

#[test]
fn intervals_hold_their_edges() {
    let around = |mean: f64| Interval { mean, half_width: Some(1.0), samples: 9 };
    for (value, inside) in [(4.0, true), (6.0, true), (3.9, false), (6.1, false)] {
        assert_eq!(around(5.0).holds(value), inside, "{value}");
    }
}
