//! What sets promise about strata: elementary intervals in base 2 and in other bases, also after scrambling; one point in
//! every stratum of an axis, in every cell of a grid, of every pair of dimensions.

use estimand::points::{
    DigitPermutation, DigitalShift, Faure, Halton, Hammersley, HashedOwen, Lattice,
    LatticeSequence, LinearMatrix, MultiJittered, NRooks, OrthogonalArray, Owen, PointSet,
    Rescrambled, Shifted, Sobol, Stratified, VanDerCorput,
};

/// The stratum, of `count` equal ones, that `u` lies in. Fractions that are rounded down across a boundary count for the
/// stratum that they are meant to be in: 1/3 is just below the number nearest to it.
fn stratum(u: f64, count: u64) -> u64 {
    let place = u * count as f64;
    (0..count)
        .rfind(|&stratum| place >= stratum as f64 - 1e-9)
        .expect("coordinates are not negative")
}

/// Each of the boxes that are made of `strata[k]` equal strata of the dimension `dimensions[k]` has the same number of the
/// points `indices`.
fn evenly(points: &dyn PointSet, indices: &[u64], dimensions: &[u32], strata: &[u64]) {
    let boxes: u64 = strata.iter().product();
    let mut counts = vec![0; usize::try_from(boxes).unwrap()];
    for &index in indices {
        let place = dimensions
            .iter()
            .zip(strata)
            .fold(0, |place, (&dimension, &strata)| {
                place * strata + stratum(points.coordinate(index, dimension), strata)
            });
        counts[usize::try_from(place).unwrap()] += 1;
    }
    let expected = indices.len() as u64 / boxes;
    assert!(
        counts.iter().all(|&count| count == expected),
        "{strata:?} strata of {dimensions:?}, points from {}: {counts:?}",
        indices[0]
    );
}

/// All ways to write `sum` as a sum of `parts` numbers, in order.
fn compositions(sum: u32, parts: usize) -> Vec<Vec<u32>> {
    if parts == 1 {
        return vec![vec![sum]];
    }
    (0..=sum)
        .flat_map(|first| {
            compositions(sum - first, parts - 1)
                .into_iter()
                .map(move |rest| [vec![first], rest].concat())
        })
        .collect()
}

/// Blocks of `base^m` points in `dimensions` are (t, m, s)-nets: every elementary interval of volume `base^(t - m)` has
/// `base^t` of them.
fn nets(points: &dyn PointSet, base: u64, t: u32, m: u32, dimensions: &[u32]) {
    let count = base.pow(m);
    for block in [0, 1, 5] {
        let indices: Vec<u64> = (block * count..(block + 1) * count).collect();
        for exponents in compositions(m - t, dimensions.len()) {
            let strata: Vec<u64> = exponents.iter().map(|&k| base.pow(k)).collect();
            evenly(points, &indices, dimensions, &strata);
        }
    }
}

#[test]
fn sobol_is_a_net_under_every_scramble() {
    // The quality parameter of the first dimensions is the sum of the degrees of their polynomials, each less 1.
    for (dimensions, t) in [(1, 0), (2, 0), (3, 1), (4, 3)] {
        let list: Vec<u32> = (0..dimensions).collect();
        for m in [t, 6, 8] {
            let plain = Sobol::new(dimensions).unwrap();
            nets(&plain, 2, t, m, &list);
            for seed in 0..5 {
                let scrambled = || plain.clone();
                nets(
                    &scrambled().scrambled(DigitalShift { seed }),
                    2,
                    t,
                    m,
                    &list,
                );
                nets(
                    &scrambled().scrambled(LinearMatrix { seed }),
                    2,
                    t,
                    m,
                    &list,
                );
                nets(&scrambled().scrambled(Owen { seed }), 2, t, m, &list);
                nets(&scrambled().scrambled(HashedOwen { seed }), 2, t, m, &list);
            }
        }
    }
}

#[test]
fn every_dimension_of_sobol_is_stratified() {
    let plain = Sobol::new(1024).unwrap();
    let owen = plain.clone().scrambled(Owen { seed: 1 });
    let hashed = plain.clone().scrambled(HashedOwen { seed: 1 });
    for dimension in (0..1024).step_by(31) {
        for points in [&plain as &dyn PointSet, &owen, &hashed] {
            nets(points, 2, 0, 8, &[dimension]);
        }
    }
}

#[test]
fn faure_is_a_net_under_every_scramble() {
    for (dimensions, m) in [(2, 6), (3, 4), (5, 3)] {
        let base = u64::from(dimensions);
        let list: Vec<u32> = (0..dimensions).collect();
        let plain = Faure::new(dimensions).unwrap();
        nets(&plain, base, 0, m, &list);
        for seed in 0..5 {
            let scrambled = || plain.clone();
            nets(
                &scrambled().scrambled(DigitalShift { seed }),
                base,
                0,
                m,
                &list,
            );
            nets(
                &scrambled().scrambled(DigitPermutation { seed }),
                base,
                0,
                m,
                &list,
            );
            nets(&scrambled().scrambled(Owen { seed }), base, 0, m, &list);
        }
    }
}

/// Every block of `product of bases[k]^exponents[k]` points has one in each box of as many strata.
fn halton_boxes(points: &dyn PointSet) {
    for (exponents, dimensions) in [
        (vec![3_u32, 2], vec![0_u32, 1]),
        (vec![2, 1, 1], vec![0, 1, 2]),
        (vec![5], vec![1]),
        (vec![1, 1], vec![3, 5]),
        (vec![2], vec![9]),
    ] {
        let bases = [2_u64, 3, 5, 7, 11, 13, 17, 19, 23, 29];
        let strata: Vec<u64> = dimensions
            .iter()
            .zip(&exponents)
            .map(|(&dimension, &exponent)| bases[dimension as usize].pow(exponent))
            .collect();
        let count: u64 = strata.iter().product();
        for block in [0, 1, 7] {
            let indices: Vec<u64> = (block * count..(block + 1) * count).collect();
            evenly(points, &indices, &dimensions, &strata);
        }
    }
}

#[test]
fn halton_keeps_its_boxes_under_every_scramble() {
    let plain = Halton::new(10).unwrap();
    halton_boxes(&plain);
    for seed in 0..5 {
        halton_boxes(&plain.clone().scrambled(DigitalShift { seed }));
        halton_boxes(&plain.clone().scrambled(DigitPermutation { seed }));
        halton_boxes(&plain.clone().scrambled(Owen { seed }));
    }
}

#[test]
fn van_der_corput_fills_every_power_of_its_base() {
    for (base, m) in [(2, 8), (3, 5), (10, 2), (64, 1), (6, 3)] {
        let points = VanDerCorput::new(base).unwrap();
        nets(&points, base.into(), 0, m, &[0]);
    }
}

#[test]
fn hammersley_has_one_point_in_every_stratum_of_its_axis() {
    for count in [1, 9, 36, 100] {
        for offset in [0.0, 0.5] {
            let points = Hammersley::new(count, 3).unwrap().axis(1).unwrap();
            let points = points.offset(offset).unwrap();
            let indices: Vec<u64> = (0..count).collect();
            evenly(&points, &indices, &[1], &[count]);
        }
    }
}

#[test]
fn hammersley_is_a_net_in_two_dimensions_under_every_scramble() {
    fn check(points: &dyn PointSet) {
        let indices: Vec<u64> = (0..64).collect();
        for k in 0..=6 {
            evenly(points, &indices, &[0, 1], &[1 << k, 1 << (6 - k)]);
        }
    }
    let plain = Hammersley::new(64, 2).unwrap();
    check(&plain);
    for seed in 0..5 {
        check(&plain.clone().scrambled(DigitalShift { seed }));
        check(&plain.clone().scrambled(DigitPermutation { seed }));
        check(&plain.clone().scrambled(Owen { seed }));
    }
}

#[test]
fn n_rooks_have_one_point_in_every_stratum_of_every_axis() {
    for count in [1, 2, 9, 16, 17, 36, 100, 128, 1000] {
        let points = NRooks::new(count, 3).unwrap();
        for set in [0, 1, 9] {
            let indices: Vec<u64> = (set * count..(set + 1) * count).collect();
            for dimension in [0, 1, 2, 77] {
                evenly(&points, &indices, &[dimension], &[count]);
            }
        }
    }
}

#[test]
fn grids_have_one_point_in_every_cell() {
    for (count, dimensions) in [(9, 2), (36, 2), (30, 2), (27, 3), (100, 3), (16, 4), (7, 1)] {
        let points = Stratified::new(count, dimensions, 5).unwrap();
        let size = points.size().unwrap();
        for set in [0, 3] {
            let indices: Vec<u64> = (set * size..(set + 1) * size).collect();
            for grid in [0, 1, 8] {
                let list: Vec<u32> = (grid * dimensions..(grid + 1) * dimensions).collect();
                let cells: Vec<u64> = list.iter().map(|&d| points.cells(d)).collect();
                evenly(&points, &indices, &list, &cells);
            }
        }
    }
}

#[test]
fn multi_jittered_points_are_a_grid_and_rooks() {
    for (columns, rows) in [(3, 3), (4, 5), (1, 7), (8, 2), (16, 17)] {
        let points = MultiJittered::grid(columns, rows, 2).unwrap();
        let count = columns * rows;
        for set in [0, 2] {
            let indices: Vec<u64> = (set * count..(set + 1) * count).collect();
            for pair in [0, 1, 40] {
                let list = [2 * pair, 2 * pair + 1];
                evenly(&points, &indices, &list, &[columns, rows]);
                evenly(&points, &indices, &list[..1], &[count]);
                evenly(&points, &indices, &list[1..], &[count]);
            }
        }
    }
}

#[test]
fn orthogonal_arrays_fill_the_grid_of_every_pair() {
    for (count, dimensions) in [(4, 3), (9, 4), (25, 6), (49, 8), (121, 5)] {
        let points = OrthogonalArray::new(count, dimensions, 4).unwrap();
        assert_eq!(points.size(), Some(count));
        let levels = count.isqrt();
        for set in [0, 3] {
            let indices: Vec<u64> = (set * count..(set + 1) * count).collect();
            for first in 0..dimensions {
                evenly(&points, &indices, &[first], &[count]);
                for second in first + 1..dimensions {
                    evenly(&points, &indices, &[first, second], &[levels, levels]);
                }
            }
        }
    }
}

#[test]
fn lattices_have_one_point_in_every_stratum_of_every_axis() {
    let dimensions = [0, 1, 7, 39];
    let (lattice, sequence) = (
        Lattice::published(64, 40).unwrap(),
        LatticeSequence::new(40).unwrap(),
    );
    let built = Lattice::component_by_component(55, 40).unwrap();
    for dimension in dimensions {
        evenly(&lattice, &(0..64).collect::<Vec<_>>(), &[dimension], &[64]);
        evenly(&built, &(0..55).collect::<Vec<_>>(), &[dimension], &[55]);
        nets(&sequence, 2, 0, 7, &[dimension]);
    }
    // Shifted by less than a stratum, cyclically: still one in each.
    let shifted = Shifted::new(lattice, 9);
    evenly(&shifted, &(0..64).collect::<Vec<_>>(), &[3], &[64]);
}

#[test]
fn rescrambled_groups_are_nets_wherever_they_start() {
    for seed in 0..5 {
        let pairs = Rescrambled::new(2, seed).unwrap();
        let fours = Rescrambled::new(4, seed).unwrap();
        for group in [0, 1, 50, 1_000_000] {
            nets(&pairs, 2, 0, 6, &[2 * group, 2 * group + 1]);
            nets(&fours, 2, 3, 7, &[0, 1, 2, 3].map(|d| 4 * group + d));
        }
    }
}
