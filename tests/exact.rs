//! Points against those of independent programs, written by `reference/points.py`, and published tables.

use estimand::points::{
    Faure, Halton, Hammersley, Lattice, PointSet, Sobol, VanDerCorput, radical_inverse,
};

/// Compares with a file of golden points; their last digits may differ by `tolerance`.
fn agrees(points: &dyn PointSet, golden: &str, tolerance: f64) {
    let mut lines = golden.lines().filter(|line| !line.starts_with('#'));
    let dimensions: Vec<u32> = lines
        .next()
        .expect("a line of titles")
        .split(',')
        .skip(1)
        .map(|dimension| dimension.parse().unwrap())
        .collect();
    let mut compared = 0;
    for line in lines {
        let (index, coordinates) = line.split_once(',').unwrap();
        let index = index.parse().unwrap();
        for (&dimension, expected) in dimensions.iter().zip(coordinates.split(',')) {
            let (u, expected): (_, f64) = (
                points.coordinate(index, dimension),
                expected.parse().unwrap(),
            );
            assert!(
                (u - expected).abs() <= tolerance,
                "index {index}, dimension {dimension}: {u} for {expected}"
            );
            compared += 1;
        }
    }
    assert!(compared > 50, "{compared} coordinates are too few");
}

#[test]
fn halton_agrees_with_scipy() {
    let golden = include_str!("../reference/points/halton.csv");
    agrees(&Halton::new(1024).unwrap(), golden, 4e-16);
}

#[test]
fn sobol_agrees_with_scipy() {
    // The other program divides 64 digits by 2^64 and rounds; ours truncates.
    let golden = include_str!("../reference/points/sobol.csv");
    agrees(&Sobol::new(1024).unwrap(), golden, f64::EPSILON / 2.0);
}

#[test]
fn sobol_agrees_with_qmcpy_in_natural_order() {
    let golden = include_str!("../reference/points/sobol-natural.csv");
    agrees(&Sobol::new(1024).unwrap(), golden, 0.0);
}

#[test]
fn lattice_agrees_with_qmcpy() {
    let golden = include_str!("../reference/points/lattice-1024.csv");
    agrees(&Lattice::published(1024, 1024).unwrap(), golden, 0.0);
}

#[test]
fn faure_agrees_with_openturns() {
    for (dimensions, golden) in [
        (2, include_str!("../reference/points/faure-2.csv")),
        (3, include_str!("../reference/points/faure-3.csv")),
        (5, include_str!("../reference/points/faure-5.csv")),
        (7, include_str!("../reference/points/faure-7.csv")),
        (11, include_str!("../reference/points/faure-11.csv")),
    ] {
        agrees(&Faure::new(dimensions).unwrap(), golden, 1e-15);
    }
}

#[test]
fn van_der_corput_is_the_published_table() {
    // Van der Corput (1935), base 2: 0, 1/2, 1/4, 3/4, 1/8, 5/8, 3/8, 7/8 and so on; base 10 by its definition.
    let binary = VanDerCorput::new(2).unwrap();
    let sixteenths = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];
    for (index, sixteenth) in (0..).zip(sixteenths) {
        assert_eq!(binary.coordinate(index, 0), f64::from(sixteenth) / 16.0);
    }
    let decimal = VanDerCorput::new(10).unwrap();
    for (index, expected) in [
        (7, 0.7),
        (10, 0.01),
        (12, 0.21),
        (123_456_789, 0.987_654_321),
    ] {
        assert_eq!(decimal.coordinate(index, 0), expected);
    }
}

#[test]
fn hammersley_is_the_table_of_its_definition() {
    // Wong, Luk, Heng (1997), Sampling with Hammersley and Halton Points: (k / n, phi_2(k)).
    let points = Hammersley::new(6, 2).unwrap();
    for (index, second) in (0..).zip([0.0, 0.5, 0.25, 0.75, 0.125, 0.625]) {
        assert_eq!(points.coordinate(index, 0), index as f64 / 6.0);
        assert_eq!(points.coordinate(index, 1), second);
    }
}

#[test]
fn large_radical_inverses_are_exact_fractions() {
    // In base 3, 3^40 is a one followed by forty zeros; 3^40 - 1 is forty twos.
    let power = 3_u64.pow(40);
    assert_eq!(radical_inverse(3, power), 3_f64.powi(-41));
    assert_eq!(radical_inverse(3, power - 1), 1.0 - f64::EPSILON / 2.0);
    assert_eq!(radical_inverse(10, 10_u64.pow(19)), 1e-20);
}

/// Veach, Eric; Guibas, Leonidas (1995). *Optimally Combining Sampling Techniques for Monte Carlo Rendering*, equations for the
/// balance and the power heuristic with exponent 2. <https://doi.org/10.1145/218380.218498>
#[test]
fn heuristics_have_the_weights_of_their_definition() {
    use estimand::integrands::Heuristic::{Balance, Power};
    for (density, others, balance, power) in [
        (1.0, &[2.0][..], 1.0 / 3.0, 1.0 / 5.0),
        (3.0, &[4.0, 12.0], 3.0 / 19.0, 9.0 / 169.0),
        (5.0, &[], 1.0, 1.0),
        (0.0, &[1.0], 0.0, 0.0),
        (2.0, &[f64::INFINITY], 0.0, 0.0),
    ] {
        for (heuristic, expected) in [(Balance, balance), (Power, power)] {
            let weight = heuristic.weight(density, others);
            assert!(
                (weight - expected).abs() < 1e-15,
                "{density} {others:?}: {weight}"
            );
        }
    }
}
