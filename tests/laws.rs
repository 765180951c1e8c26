//! The laws that every point set keeps, by one macro: a new set is one line more at the end.
//!
//! See `PointSet` for the laws.

use std::collections::HashSet;

use estimand::points::{
    BlueNoise, DigitPermutation, DigitalShift, Faure, Folded, Halton, Hammersley, HashedOwen,
    Independent, Kronecker, Lattice, LatticeSequence, LinearMatrix, MultiJittered, NRooks,
    OrthogonalArray, Owen, Padded, PointSet, Rescrambled, Shifted, Skipped, Sobol, Stratified,
    VanDerCorput,
};

/// Indices where integers of some width end, and their neighbours.
const INDICES: [u64; 13] = [
    0,
    1,
    1000,
    1 << 16,
    (1 << 24) - 1,
    (1 << 31) - 1,
    u32::MAX as u64,
    1 << 32,
    (1 << 53) - 1,
    1 << 53,
    (1 << 63) - 1,
    1 << 63,
    u64::MAX,
];

/// The first dimensions, odd ones, and some past the last dimension of every set.
const DIMENSIONS: [u32; 8] = [0, 1, 2, 3, 7, 100, 2000, u32::MAX];

fn in_the_unit_interval(points: &dyn PointSet) {
    for index in INDICES {
        for dimension in DIMENSIONS {
            let u = points.coordinate(index, dimension);
            assert!(
                (0.0..1.0).contains(&u),
                "index {index}, dimension {dimension}: {u}"
            );
        }
    }
}

fn pure(points: &dyn PointSet) {
    for index in INDICES {
        for dimension in DIMENSIONS {
            let u = points.coordinate(index, dimension);
            // Something else is asked for in between.
            points.coordinate(index ^ 1, dimension ^ 1);
            assert_eq!(u, points.coordinate(index, dimension));
        }
    }
}

fn fill_is_coordinate(points: &dyn PointSet) {
    let widths = [
        0..1,
        0..2,
        0..3,
        1..6,
        0..8,
        3..20,
        0..32,
        0..33,
        5..75,
        0..130,
    ];
    let rows = [1_usize, 2, 7, 16, 33, 129];
    for dimensions in widths {
        for rows in rows {
            let last = u64::MAX - (rows as u64 - 1);
            for first in [0, 1, 3, 8, 1021, (1 << 32) - 5, (1 << 53) - 3, last] {
                check_fill(points, first, dimensions.clone(), rows);
            }
        }
    }
    // Long enough for whatever is prepared for long blocks; and far out.
    check_fill(points, 12_345, 0..5, 3000);
    check_fill(points, 77, 1020..1030, 65);
    check_fill(points, 7, u32::MAX - 3..u32::MAX, 9);
    points.fill(u64::MAX, 0..3, &mut []);
    points.fill(5, 2..2, &mut []);
}

fn check_fill(points: &dyn PointSet, first: u64, dimensions: std::ops::Range<u32>, rows: usize) {
    let width = dimensions.len();
    // Every coordinate is written: none is left NaN.
    let mut out = vec![f64::NAN; rows * width];
    points.fill(first, dimensions.clone(), &mut out);
    for (index, row) in (first..=u64::MAX).zip(out.chunks_exact(width)) {
        for (dimension, u) in dimensions.clone().zip(row) {
            let expected = points.coordinate(index, dimension);
            assert_eq!(
                u.to_bits(),
                expected.to_bits(),
                "{rows} rows of {dimensions:?} from {first}: {u} at {index}, {dimension} for {expected}"
            );
        }
    }
}

fn fill_refuses_what_it_cannot_write(points: &dyn PointSet) {
    for (first, dimensions, length) in [(0, 0..2, 3), (u64::MAX, 0..1, 2), (0, 1..1, 1)] {
        let fill = || points.fill(first, dimensions, &mut vec![0.0; length]);
        let quiet = std::panic::catch_unwind(std::panic::AssertUnwindSafe(fill));
        assert!(quiet.is_err(), "{first} {length}");
    }
}

/// Different seeds give different points, every pair of them.
fn replicates_differ(build: &dyn Fn(u64) -> Box<dyn PointSet>) {
    const SEEDS: u64 = 64;
    let seeds = (0..SEEDS).chain([u64::MAX, 1 << 32, 0x9e37_79b9_7f4a_7c15]);
    let replicates: HashSet<Vec<u64>> = seeds
        .map(|seed| {
            let points = build(seed);
            (0..8)
                .flat_map(|index| (0..2).map(move |dimension| (index, dimension)))
                .map(|(index, dimension)| points.coordinate(index, dimension).to_bits())
                .collect()
        })
        .collect();
    assert_eq!(replicates.len() as u64, SEEDS + 3);
}

/// Over many seeds a coordinate of a randomised set is uniform.
///
/// 1024 seeds, 16 cells: chi-square with 15 degrees of freedom exceeds 60 with a probability of 2e-7, in each of about 300
/// cases.
fn replicates_are_uniform(build: &dyn Fn(u64) -> Box<dyn PointSet>) {
    for (index, dimension) in [(0, 0), (0, 1), (1, 0), (1, 1), (5, 4), (1000, 2), (5, 3000)] {
        let mut cells = [0_i32; 16];
        for seed in 0..1024 {
            let u = build(seed).coordinate(index, dimension);
            let cell = (0..16).rfind(|&cell| u * 16.0 >= f64::from(cell)).unwrap();
            cells[usize::try_from(cell).unwrap()] += 1;
        }
        let chi2: i32 = cells.iter().map(|&count| (count - 64).pow(2)).sum();
        assert!(
            chi2 < 60 * 64,
            "index {index}, dimension {dimension}: {cells:?}"
        );
    }
}

macro_rules! laws {
    ($($name:ident: $points:expr;)*) => {$(
        mod $name {
            use super::*;

            #[test]
            fn in_the_unit_interval() { super::in_the_unit_interval(&$points); }
            #[test]
            fn pure() { super::pure(&$points); }
            #[test]
            fn fill_is_coordinate() { super::fill_is_coordinate(&$points); }
            #[test]
            fn fill_refuses_what_it_cannot_write() {
                super::fill_refuses_what_it_cannot_write(&$points);
            }
            #[test]
            fn a_box_is_the_set() {
                let (points, boxed) = ($points, Box::new($points) as Box<dyn PointSet>);
                assert_eq!((points.size(), points.dimensions()), (boxed.size(), boxed.dimensions()));
                assert_eq!(points.radix(), boxed.radix());
                assert_eq!(points.coordinate(5, 1), boxed.coordinate(5, 1));
            }
        }
    )*};
}

macro_rules! replicates {
    ($($name:ident: |$seed:ident| $points:expr;)*) => {$(
        #[test]
        fn $name() { replicates_differ(&|$seed| Box::new($points)); }
    )*};
}

macro_rules! uniform {
    ($($name:ident: |$seed:ident| $points:expr;)*) => {$(
        #[test]
        fn $name() { replicates_are_uniform(&|$seed| Box::new($points)); }
    )*};
}

/// Random sets, of which every point is uniform on its own.
macro_rules! laws_of_random_sets {
    ($($name:ident: |$seed:ident| $points:expr;)*) => {
        laws! { $($name: { let $seed = 42; $points };)* }
        mod different { use super::*; replicates! { $($name: |$seed| $points;)* } }
        mod uniform { use super::*; uniform! { $($name: |$seed| $points;)* } }
    };
}

/// Random sets of which all points together are spread uniformly: each one stays in its stratum.
macro_rules! laws_of_random_grids {
    ($($name:ident: |$seed:ident| $points:expr;)*) => {
        laws! { $($name: { let $seed = 42; $points };)* }
        mod different_grids { use super::*; replicates! { $($name: |$seed| $points;)* } }
    };
}

laws! {
    van_der_corput: VanDerCorput::new(2).unwrap();
    van_der_corput_10: VanDerCorput::new(10).unwrap();
    van_der_corput_max: VanDerCorput::new(u32::MAX).unwrap();
    halton: Halton::new(40).unwrap();
    halton_starting_late: Halton::new(40).unwrap().starting_at(u64::MAX - 50);
    hammersley: Hammersley::new(1000, 40).unwrap();
    hammersley_inner_axis: Hammersley::new(u64::MAX, 4).unwrap().axis(2).unwrap().offset(0.5).unwrap();
    sobol: Sobol::new(100).unwrap();
    sobol_of_all_dimensions: Sobol::new(1024).unwrap();
    faure: Faure::new(7).unwrap();
    faure_with_a_large_base: Faure::new(40).unwrap();
    lattice: Lattice::published(1000, 40).unwrap();
    lattice_of_a_prime_count: Lattice::component_by_component(251, 40).unwrap();
    lattice_of_2_53: Lattice::published(1 << 53, 40).unwrap();
    lattice_past_2_53: Lattice::published(u64::MAX, 40).unwrap();
    lattice_sequence: LatticeSequence::new(40).unwrap();
    kronecker: Kronecker::r(40).unwrap();
    folded: Folded::new(Sobol::new(9).unwrap());
}

laws_of_random_sets! {
    independent: |seed| Independent::new(seed);
    n_rooks: |seed| NRooks::new(100, seed).unwrap();
    n_rooks_10_5: |seed| NRooks::new(100_000, seed).unwrap();
    n_rooks_2_32: |seed| NRooks::new(1 << 32, seed).unwrap();
    n_rooks_2_64: |seed| NRooks::new(u64::MAX, seed).unwrap();
    orthogonal_array: |seed| OrthogonalArray::new(100, 8, seed).unwrap();
    orthogonal_array_of_all_dimensions: |seed| OrthogonalArray::new(10_000, 102, seed).unwrap();
    halton_digital_shift: |seed| Halton::new(40).unwrap().scrambled(DigitalShift { seed });
    halton_permuted: |seed| Halton::new(40).unwrap().scrambled(DigitPermutation { seed });
    halton_owen: |seed| Halton::new(40).unwrap().scrambled(Owen { seed });
    hammersley_digital_shift: |seed| Shifted::new(
        Hammersley::new(100, 3).unwrap().scrambled(DigitalShift { seed }), seed);
    hammersley_permuted: |seed| Shifted::new(
        Hammersley::new(100, 40).unwrap().axis(9).unwrap().scrambled(DigitPermutation { seed }), seed);
    hammersley_owen: |seed| Shifted::new(
        Hammersley::new(100, 3).unwrap().scrambled(Owen { seed }), seed);
    sobol_digital_shift: |seed| Sobol::new(40).unwrap().scrambled(DigitalShift { seed });
    sobol_linear_matrix: |seed| Sobol::new(10).unwrap().scrambled(LinearMatrix { seed });
    sobol_owen: |seed| Sobol::new(40).unwrap().scrambled(Owen { seed });
    sobol_hashed_owen: |seed| Sobol::new(40).unwrap().scrambled(HashedOwen { seed });
    faure_digital_shift: |seed| Faure::new(7).unwrap().scrambled(DigitalShift { seed });
    faure_permuted: |seed| Faure::new(7).unwrap().scrambled(DigitPermutation { seed });
    faure_owen: |seed| Faure::new(7).unwrap().scrambled(Owen { seed });
    lattice_shifted: |seed| Shifted::new(Lattice::published(64, 8).unwrap(), seed);
    lattice_folded: |seed| Folded::new(Shifted::new(LatticeSequence::new(8).unwrap(), seed));
    kronecker_shifted: |seed| Shifted::new(Kronecker::r(3).unwrap(), seed);
    rescrambled_2: |seed| Rescrambled::new(2, seed).unwrap();
    rescrambled_4: |seed| Rescrambled::new(4, seed).unwrap();
    skipped: |seed| Skipped::new(Rescrambled::new(4, seed).unwrap(), 24);
    skipped_past_the_last_index: |seed| Skipped::new(Halton::new(5).unwrap().scrambled(Owen { seed }), u64::MAX - 20);
    padded: |seed| Padded::new(
        Sobol::new(4).unwrap().scrambled(HashedOwen { seed }), 4, NRooks::new(64, !seed).unwrap()).unwrap();
    blue_noise_of_a_sample: |seed| BlueNoise::new(1, seed).unwrap().pixel([3, 4]);
    blue_noise_of_two_samples: |seed| BlueNoise::new(2, seed).unwrap().pixel([3, 4]);
    blue_noise_of_1024_samples: |seed| BlueNoise::new(1 << 10, seed).unwrap().pixel([3, 4]);
    blue_noise_of_the_most_samples: |seed| BlueNoise::new(1 << 32, seed).unwrap().pixel([3, 4]);
    blue_noise: |seed| BlueNoise::new(16, seed).unwrap().pixel([3, 4]);
    blue_noise_of_64_samples: |seed| BlueNoise::new(64, seed).unwrap().pixel([3, 70_004]);
    blue_noise_of_32_samples: |seed| BlueNoise::new(32, seed).unwrap().pixel([9, 9]);
    blue_noise_of_many_samples: |seed| BlueNoise::new(1 << 9, seed).unwrap().pixel([3, 4]);
    blue_noise_at_odd_powers: |seed| BlueNoise::new(8, seed).unwrap().pixel([70_000, 4]);
}

laws_of_random_grids! {
    stratified: |seed| Stratified::new(30, 2, seed).unwrap();
    stratified_in_many_dimensions: |seed| Stratified::new(100_000, 5, seed).unwrap();
    stratified_past_2_32: |seed| Stratified::new(u64::MAX, 3, seed).unwrap();
    multi_jittered: |seed| MultiJittered::new(90, seed).unwrap();
    multi_jittered_of_many_points: |seed| MultiJittered::grid(1 << 12, 1 << 20, seed).unwrap();
    multi_jittered_in_one_row: |seed| MultiJittered::grid(1000, 1, seed).unwrap();
}
