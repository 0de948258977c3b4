use ellipsoid_slam::graph::Kernel;
use proptest::prelude::*;

fn kernels() -> impl Strategy<Value = Kernel> {
    prop_oneof![
        Just(Kernel::Quadratic),
        (0.1..10.0).prop_map(Kernel::Huber),
        (0.1..10.0).prop_map(Kernel::Cauchy),
        (0.1..10.0).prop_map(Kernel::GemanMcClure),
    ]
}

/// Cost and weight at norms of 1, 2.5 and 7 with a threshold of 1.5, as GTSAM 4.3 has them (`loss`, `weight`).
#[test]
fn conventions_are_those_of_gtsam() {
    let table = [
        (Kernel::Huber(1.5), [0.5, 2.625, 9.375], [1.0, 0.6, 0.21428571428571427]),
        (
            Kernel::Cauchy(1.5),
            [0.413690377640982, 1.4952779406899348, 3.5165085770274627],
            [0.6923076923076923, 0.2647058823529412, 0.04390243902439024],
        ),
        (
            Kernel::GemanMcClure(1.5),
            [0.34615384615384615, 0.8272058823529411, 1.075609756097561],
            [0.47928994082840237, 0.07006920415224914, 0.0019274241522903035],
        ),
    ];
    for (kernel, costs, weights) in table {
        for (i, norm) in [1.0_f64, 2.5, 7.0].into_iter().enumerate() {
            assert!((kernel.cost(norm * norm) - costs[i]).abs() < 1e-12, "{kernel:?} {norm}");
            assert!((kernel.weight(norm * norm) - weights[i]).abs() < 1e-12, "{kernel:?} {norm}");
        }
    }
}

#[test]
fn huber_has_no_step_where_it_changes() {
    let (kernel, k) = (Kernel::Huber(2.0), 2.0_f64);
    let (inside, outside) = (k * k * (1.0 - 1e-9), k * k * (1.0 + 1e-9));
    // The cost grows by half of what the squared norm does, the weight by less.
    assert!((kernel.cost(outside) - kernel.cost(inside)).abs() < 1e-8);
    assert!((kernel.weight(outside) - kernel.weight(inside)).abs() < 1e-8);
}

proptest! {
    #[test]
    fn no_residual_costs_nothing(kernel in kernels()) {
        prop_assert_eq!(kernel.cost(0.0), 0.0);
        prop_assert_eq!(kernel.weight(0.0), 1.0);
    }

    #[test]
    fn the_weight_is_twice_the_slope(kernel in kernels(), s in 0.01..400.0) {
        let h = 1e-5 * s;
        let slope = (kernel.cost(s + h) - kernel.cost(s - h)) / (2.0 * h);
        // Truncation: huber's second derivative jumps at its threshold.
        prop_assert!((kernel.weight(s) - 2.0 * slope).abs() < 1e-4, "{slope}");
    }

    #[test]
    fn larger_residuals_cost_more_and_weigh_less(kernel in kernels(), s in 0.0..400.0, more in 0.0..9.0) {
        prop_assert!(kernel.cost(s + more) >= kernel.cost(s));
        prop_assert!(kernel.weight(s + more) <= kernel.weight(s));
        prop_assert!(kernel.cost(s) <= Kernel::Quadratic.cost(s) * (1.0 + 1e-12));
        prop_assert!(kernel.weight(s) > 0.0);
    }
}
