//! What was asked for and what was used are both in the result.

use estimand::points::{
    Faure, Folded, HashedOwen, Independent, NRooks, PointSet, Shifted, Sobol, Stratified,
};
use estimand::{Average, Estimator, MonteCarlo, Replicated, Warning, cube};

#[test]
fn a_grid_uses_the_nearest_number_of_cells_and_says_so() {
    let f = cube(|[x, y]| x * y);
    // The nearest product of two numbers that differ by at most one; of two that are equally near, the smaller.
    for (asked, used) in [
        (1, 1),
        (2, 2),
        (3, 2),
        (4, 4),
        (5, 4),
        (9, 9),
        (11, 12),
        (100, 100),
        (1000, 992),
    ] {
        let grid = Stratified::new(asked, 2, 1).unwrap();
        let estimate = Average::new(grid, asked).estimate(&f).unwrap();
        assert_eq!((estimate.requested, estimate.used), (asked, used));
    }
    let grid = |seed| Stratified::new(1000, 3, seed).unwrap();
    let estimate = Replicated::new(4, 1000, grid).estimate(&f).unwrap();
    assert_eq!((estimate.requested, estimate.used), (4000, 4000));
}

#[test]
fn a_finite_set_is_used_as_a_whole() {
    let rooks = NRooks::new(81, 1).unwrap();
    let estimate = Average::new(rooks, 50).estimate(&cube(|[x]| x)).unwrap();
    assert_eq!((estimate.requested, estimate.used), (50, 81));
}

#[test]
fn streams_and_sequences_use_what_is_asked_for() {
    let f = cube(|[x]| x);
    for count in [1, 2, 1023, 1024, 1025, 99_999] {
        assert_eq!(MonteCarlo::new(count, 1).estimate(&f).unwrap().used, count);
        assert_eq!(
            Average::new(Independent::new(1), count)
                .estimate(&f)
                .unwrap()
                .used,
            count
        );
    }
}

#[test]
fn counts_that_are_no_power_of_the_radix_are_reported() {
    fn reported(points: impl PointSet, count: u64) -> Option<Warning> {
        let estimate = Average::new(points, count).estimate(&cube(|[x]| x));
        estimate.unwrap().warnings.first().copied()
    }
    let sobol = || Sobol::new(3).unwrap();
    for count in [1, 2, 64, 1 << 16] {
        assert_eq!(reported(sobol(), count), None);
    }
    for count in [3, 63, 65, 1000] {
        let warning = Some(Warning::NoPower { count, radix: 2 });
        assert_eq!(reported(sobol(), count), warning);
        assert_eq!(reported(Shifted::new(sobol(), 1), count), warning);
        assert_eq!(reported(Folded::new(sobol()), count), warning);
    }
    let faure = || Faure::new(3).unwrap();
    assert_eq!(reported(faure(), 81), None);
    let warning = Warning::NoPower {
        count: 64,
        radix: 3,
    };
    assert_eq!(reported(faure(), 64), Some(warning));
    assert_eq!(reported(Independent::new(1), 1000), None);
    assert_eq!(reported(NRooks::new(1000, 1).unwrap(), 1000), None);
    // Of every replicate, not of all together.
    let replicated = |count| {
        let owen = |seed| sobol().scrambled(HashedOwen { seed });
        let estimate = Replicated::new(12, count, owen).estimate(&cube(|[x]| x));
        estimate.unwrap().warnings
    };
    assert_eq!(replicated(64), []);
    assert_eq!(
        replicated(100),
        [Warning::NoPower {
            count: 100,
            radix: 2
        }]
    );
}
