//! L2 discrepancies and the other measures, against rational arithmetic, scipy, published designs and closed forms.

use core::f64::consts::{PI, TAU};

use estimand::discrepancy::{
    L2, Periodogram, Points, UpdatableL2, minimum_distance, t_value, toroidal_minimum_distance,
};
use estimand::points::{Faure, Hammersley, Independent, PointSet, Sobol};
use proptest::prelude::*;
use serde_json::Value;

const KINDS: [(&str, L2); 6] = [
    ("l2-star", L2::Star),
    ("centred", L2::Centred),
    ("wrap-around", L2::WrapAround),
    ("mixture", L2::Mixture),
    ("symmetric", L2::Symmetric),
    ("extreme", L2::Extreme),
];

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list").iter();
    list.map(|number| number.as_f64().expect("a number"))
        .collect()
}

/// Asserts that two numbers agree to `digits` decimals, as a table prints them.
#[track_caller]
fn assert_prints(value: f64, printed: &str) {
    let decimals = printed
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    assert_eq!(format!("{value:.decimals$}"), printed, "{value}");
}

/// Values of reference/discrepancy.py: in rational arithmetic from the definitions, and by scipy 1.17.1.
#[test]
fn values_agree_with_rational_arithmetic_and_scipy() {
    let text = include_str!("../reference/discrepancy.json");
    let reference: Value = serde_json::from_str(text).unwrap();
    let sets = reference["sets"].as_array().unwrap();
    assert_eq!(sets.len(), 18);
    for set in sets {
        let rows: Vec<Vec<f64>> = set["points"]
            .as_array()
            .unwrap()
            .iter()
            .map(numbers)
            .collect();
        let points = Points::from_slices(&rows).unwrap();
        let weights = numbers(&set["weights"]);
        for (name, kind) in KINDS {
            // The rounding of sums of terms of that size.
            let rounding = 4e-16 * 2.5_f64.powi(i32::try_from(points.dimensions()).unwrap());
            let close = |value: f64, expected: &Value, rounding: f64| {
                let expected = expected.as_f64().unwrap();
                assert!(
                    (value - expected).abs() < rounding,
                    "{name}: {value} {expected}"
                );
            };
            close(kind.squared(&points), &set["squared"][name], rounding);
            let weighted = kind.squared_weighted(&points, &weights).unwrap();
            close(weighted, &set["weighted"][name], rounding);
            if !set["scipy"][name].is_null() {
                close(kind.squared(&points), &set["scipy"][name], 10.0 * rounding);
            }
            let root = kind.root(&points);
            assert_eq!(root, kind.squared(&points).sqrt());
        }
    }
}

#[test]
fn values_agree_with_published_designs() {
    let centred = |levels: &[f64], count: f64, dimensions: usize| {
        let rows: Vec<f64> = levels
            .iter()
            .map(|l| (2.0 * l - 1.0) / (2.0 * count))
            .collect();
        KINDS.map(|(_, kind)| kind.squared(&Points::from_rows(&rows, dimensions).unwrap()))
    };
    // Fang, Li, Sudjianto (2006), Design and Modeling for Computer Experiments: two Latin squares of six runs.
    let [_, first, ..] = centred(&[1., 3., 2., 6., 3., 2., 4., 5., 5., 1., 6., 4.], 6.0, 2);
    let [_, second, ..] = centred(&[1., 5., 2., 4., 3., 3., 4., 2., 5., 1., 6., 6.], 6.0, 2);
    assert_prints(first, "0.0081");
    assert_prints(second, "0.0105");
    // The same in rational arithmetic, by `squared` of reference/discrepancy.py.
    assert!((first - 0.008142039609053497).abs() < 2e-16);
    assert!((second - 0.010456854423868314).abs() < 2e-16);
    // Zhou, Fang, Ning (2013), https://doi.org/10.1016/j.jco.2012.11.006, example 4.
    let levels = [
        2., 1., 1., 2., 2., 2., 1., 2., 2., 2., 2., 2., 2., 1., 1., 1., 1., 1., 1., 1., 1., 1., 2.,
        2., 1., 2., 2., 2., 1., 1., 2., 2., 2., 2., 1., 1., 2., 2., 2., 1., 2., 2.,
    ];
    let [star, centred, wrap_around, mixture, ..] = centred(&levels, 2.0, 6);
    assert!((mixture - 2.499950475328891).abs() < 1e-14);
    assert!((wrap_around - 1.368011239668195).abs() < 1e-14);
    assert!((centred - 0.317168018199526).abs() < 1e-14);
    assert!((star.sqrt() - 0.037450517408051).abs() < 1e-14);
    // The point (1, ..., 1) is in no box [0, y): what is left is the integral of the squared volume, 3^-d.
    for dimensions in [2, 4, 8, 16, 32, 64] {
        let rows = vec![1.0; dimensions];
        let root = L2::Star.root(&Points::from_rows(&rows, dimensions).unwrap());
        let expected = 3.0_f64.powf(-0.5 * dimensions as f64);
        assert!(
            (root / expected - 1.0).abs() < 1e-13,
            "{dimensions}: {root}"
        );
    }
}

#[test]
fn l2_star_discrepancy_of_halton() {
    // Exact rational arithmetic over the definition, by a program independent of this crate.
    for (dimensions, count, printed) in [
        (1, 8, "0.005208333"),
        (1, 16, "0.001302083"),
        (1, 32, "0.000325521"),
        (2, 8, "0.016227816"),
        (2, 16, "0.004657761"),
        (2, 32, "0.001409269"),
    ] {
        let halton = estimand::points::Halton::new(dimensions).unwrap();
        let points = Points::from_set(&halton, 0..count, dimensions).unwrap();
        assert_prints(L2::Star.squared(&points), printed);
    }
}

#[test]
fn l2_star_discrepancy_of_hammersley() {
    // Halton and Zaremba (1969), "The extreme and L2 discrepancies of some plane sets",
    // Monatshefte für Mathematik: with N = 2^m points,
    // (N D)^2 = m^2 / 64 + 29 m / 192 + 3 / 8 - m / (16 2^m) + 1 / (4 2^m) - 1 / (72 4^m).
    for m in 0..=18 {
        let n = 2.0_f64.powi(m);
        let f = f64::from(m);
        let expected = f * f / 64.0 + 29.0 * f / 192.0 + 0.375 - f / (16.0 * n) + 0.25 / n
            - 1.0 / (72.0 * n * n);
        let rows: Vec<f64> = (0..1_u64 << m)
            .flat_map(|i| {
                let reversed = i.reverse_bits() >> 11;
                [i as f64 / n, reversed as f64 / (1_u64 << 53) as f64]
            })
            .collect();
        let value = L2::Star.squared(&Points::from_rows(&rows, 2).unwrap());
        // Terms of 1/9 cancel to 1e-5 and less: what is left is right to a fraction of their rounding.
        let error = (value - expected / (n * n)).abs();
        assert!(
            error < 1e-17 || error < 1e-14 * value,
            "{m}: {value} {error}"
        );
    }
}

#[test]
fn the_smallest_squares_are_accurate_and_not_negative() {
    // The n centres of n equal intervals: 1 / (12 n^2), for the star as for the extreme discrepancy.
    for m in [0, 4, 8, 12, 14] {
        let n = 1_u64 << m;
        let rows: Vec<f64> = (0..n)
            .map(|i| (2 * i + 1) as f64 / (2 * n) as f64)
            .collect();
        let points = Points::from_rows(&rows, 1).unwrap();
        let expected = 1.0 / (12 * n * n) as f64;
        for kind in [L2::Star, L2::Extreme] {
            let squared = kind.squared(&points);
            assert!(
                (squared / expected - 1.0).abs() < 1e-9,
                "{kind:?} {n}: {squared}"
            );
        }
    }
    let one = Points::from_rows(&[0.3, 0.7, 0.2], 3).unwrap();
    for (_, kind) in KINDS {
        assert!(kind.squared(&one) >= 0.0);
        // Without any weight there is nothing to be uneven.
        assert!(kind.squared_weighted(&one, &[0.0; 3]).unwrap() < 1e-15);
        for weights in [&[1.0; 2][..], &[1.0, -1.0, 1.0], &[1.0, f64::NAN, 1.0]] {
            assert!(kind.squared_weighted(&one, weights).is_err());
        }
    }
}

#[test]
fn diaphony_is_known_in_closed_form() {
    // From the definition as a sum over frequencies: one point leaves all of them, n equidistant points the multiples of n.
    for dimensions in 1..6_i32 {
        let rows = vec![0.4; usize::try_from(dimensions).unwrap()];
        let squared = L2::Diaphony.squared(&Points::from_rows(&rows, rows.len()).unwrap());
        let expected = (1.0 + PI * PI / 3.0).powi(dimensions) - 1.0;
        assert!((squared / expected - 1.0).abs() < 1e-14);
    }
    for n in [2_u32, 3, 10, 100] {
        let rows: Vec<f64> = (0..n).map(|i| f64::from(i) / f64::from(n)).collect();
        let squared = L2::Diaphony.squared(&Points::from_rows(&rows, 1).unwrap());
        let expected = PI * PI / (3.0 * f64::from(n * n));
        assert!(
            (squared - expected).abs() < 1e-14,
            "{n}: {squared} {expected}"
        );
    }
}

#[test]
fn nets_have_their_t() {
    for m in 0..10 {
        let hammersley = Hammersley::new(1 << m, 2).unwrap();
        let points = Points::from_set(&hammersley, 0..1 << m, 2).unwrap();
        assert_eq!(t_value(&points, 2).unwrap(), 0);
        let sobol = Points::from_set(&Sobol::new(2).unwrap(), 0..1 << m, 2).unwrap();
        assert_eq!(t_value(&sobol, 2).unwrap(), 0);
    }
    // The points (i / b^m, radical inverse of i in base b): t = 0 in every base. These are not to be represented in f64.
    for (base, m) in [(3, 5), (5, 4), (7, 3), (10, 3), (49, 2)] {
        let count = u64::from(base).pow(m);
        let rows: Vec<f64> = (0..count)
            .flat_map(|i| {
                let mut rest = i;
                let reversed = (0..m).fold(0, |reversed, _| {
                    let digit = rest % u64::from(base);
                    rest /= u64::from(base);
                    reversed * u64::from(base) + digit
                });
                [i as f64 / count as f64, reversed as f64 / count as f64]
            })
            .collect();
        let points = Points::from_rows(&rows, 2).unwrap();
        assert_eq!(t_value(&points, base).unwrap(), 0, "base {base}");
        assert_eq!(t_value(&points, base * base).is_ok(), m % 2 == 0);
    }
    let three = Points::from_rows(&[0.0, 0.5, 0.75], 1).unwrap();
    assert!(t_value(&three, 2).is_err() && t_value(&three, 1).is_err());
}

/// The least t by the definition: every elementary interval is gone through.
fn exhaustive_t(rows: &[f64], dimensions: usize, base: u32, m: u32) -> u32 {
    let even = |digits: &[u32]| {
        let cells: Vec<u32> = digits.iter().map(|&k| base.pow(k)).collect();
        let intervals: u32 = cells.iter().product();
        (0..intervals).all(|mut number| {
            let place: Vec<u32> = cells
                .iter()
                .map(|cells| {
                    let here = number % cells;
                    number /= cells;
                    here
                })
                .collect();
            let inside = rows.chunks_exact(dimensions).filter(|row| {
                (row.iter().zip(&place).zip(&cells)).all(|((&x, &a), &cells)| {
                    let end = |a: u32| f64::from(a) / f64::from(cells);
                    end(a) <= x && x < end(a + 1)
                })
            });
            inside.count() == base.pow(m) as usize / intervals as usize
        })
    };
    let all_even = |digits: u32| {
        // All ways to share the digits: the numbers below (digits + 1)^d with so large a sum of digits.
        let radix = digits + 1;
        (0..radix.pow(u32::try_from(dimensions).unwrap())).all(|mut code| {
            let share: Vec<u32> = (0..dimensions)
                .map(|_| {
                    let here = code % radix;
                    code /= radix;
                    here
                })
                .collect();
            share.iter().sum::<u32>() != digits || even(&share)
        })
    };
    (0..=m)
        .find(|t| all_even(m - t))
        .expect("t = m holds always")
}

#[test]
fn nets_in_more_dimensions_have_their_t() {
    // Faure (1982), "Discrépance de suites associées à un système de numération (en dimension s)": t = 0 in a prime base
    // of at least the dimension.
    for (dimensions, base, m) in [(3, 3, 5), (4, 5, 3), (5, 5, 4), (7, 7, 3)] {
        let count = u64::from(base).pow(m);
        let faure = Faure::new(dimensions).unwrap();
        let points = Points::from_set(&faure, 0..count, dimensions).unwrap();
        assert_eq!(t_value(&points, base).unwrap(), 0, "{dimensions} {base}");
    }
    // And what is no net of quality 0, by the definition. In base 2 all is exact.
    for (dimensions, m) in [(3, 5), (3, 7), (4, 6), (5, 5)] {
        let sobol = Sobol::new(dimensions).unwrap();
        let points = Points::from_set(&sobol, 0..1 << m, dimensions).unwrap();
        let rows: Vec<f64> = points.rows().flatten().copied().collect();
        let expected = exhaustive_t(&rows, dimensions as usize, 2, m);
        assert!(expected > 0);
        assert_eq!(t_value(&points, 2).unwrap(), expected, "{dimensions} {m}");
    }
}

fn pairs(count: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(
        prop_oneof![(0..16_u32).prop_map(|x| f64::from(x) / 16.0), 0.0..1.0_f64],
        2 * count,
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn t_agrees_with_its_definition(seed in 0..1000_u64, m in 0..5_u32, mixed in 0..4_usize) {
        // A scrambled net, of which some points are moved.
        let net = Sobol::new(2).unwrap().scrambled(estimand::points::Owen { seed });
        let mut rows = vec![0.0; 2 << m];
        net.fill(0, 0..2, &mut rows);
        for k in 0..mixed {
            let at = k % rows.len();
            rows[at] = Independent::new(seed).coordinate(k as u64, 0);
        }
        let points = Points::from_rows(&rows, 2).unwrap();
        prop_assert_eq!(t_value(&points, 2).unwrap(), exhaustive_t(&rows, 2, 2, m));
    }

    #[test]
    fn distances_agree_with_all_pairs(rows in (2..40_usize).prop_flat_map(pairs)) {
        let points = Points::from_rows(&rows, 2).unwrap();
        let (mut plain, mut torus) = (f64::INFINITY, f64::INFINITY);
        for i in 0..points.count() {
            for j in 0..i {
                let along = [0, 1].map(|k| (points.row(i)[k] - points.row(j)[k]).abs());
                plain = plain.min(along[0].hypot(along[1]));
                let around = along.map(|t| t.min(1.0 - t));
                torus = torus.min(around[0].hypot(around[1]));
            }
        }
        prop_assert!((minimum_distance(&points) - plain).abs() < 1e-15);
        prop_assert!((toroidal_minimum_distance(&points) - torus).abs() < 1e-15);
    }

    #[test]
    fn updates_agree_with_a_fresh_start(
        rows in pairs(5),
        changes in prop::collection::vec((0..8_usize, 0.0..=1.0_f64, 0.0..=1.0_f64), 0..30),
    ) {
        for (_, kind) in KINDS {
            let mut design = UpdatableL2::new(kind, &Points::from_rows(&rows, 2).unwrap());
            let mut expected = rows.clone();
            for &(place, x, y) in &changes {
                if 2 * place < expected.len() {
                    design.replace(place, &[x, y]).unwrap();
                    expected[2 * place..][..2].copy_from_slice(&[x, y]);
                } else {
                    design.add(&[x, y]).unwrap();
                    expected.extend([x, y]);
                }
            }
            let mut kept: Vec<_> = design.points().rows().map(<[f64]>::to_vec).collect();
            let mut wanted: Vec<_> = expected.chunks_exact(2).map(<[f64]>::to_vec).collect();
            prop_assert_eq!(&kept, &wanted);
            kept.sort_by(|a, b| a.partial_cmp(b).unwrap());
            wanted.sort_by(|a, b| a.partial_cmp(b).unwrap());
            let afresh = kind.squared(&Points::from_rows(&expected, 2).unwrap());
            prop_assert!((design.squared() - afresh).abs() < 1e-14);
        }
    }
}

#[test]
fn changes_that_make_no_sense_are_refused() {
    let points = Points::from_rows(&[0.5, 0.5], 2).unwrap();
    let mut design = UpdatableL2::new(L2::Centred, &points);
    let before = design.squared();
    assert!(design.add(&[0.5]).is_err());
    assert!(design.add(&[0.5, f64::NAN]).is_err());
    assert!(design.replace(1, &[0.5, 0.5]).is_err());
    assert_eq!(design.squared(), before);
}

#[test]
fn a_periodogram_is_its_definition() {
    let points = Points::from_set(&Independent::new(5), 0..50, 2).unwrap();
    let spectrum = Periodogram::new(&points, 6).unwrap();
    for first in -6..=6 {
        for second in -6..=6 {
            let (re, im) = points.rows().fold((0.0, 0.0), |(re, im), row| {
                let phase = TAU * (f64::from(first) * row[0] + f64::from(second) * row[1]);
                (re + phase.cos(), im + phase.sin())
            });
            let expected = (re * re + im * im) / 50.0;
            assert!((spectrum.power(first, second) - expected).abs() < 1e-12);
        }
    }
    assert!((spectrum.radial_mean()[0] - 50.0).abs() < 1e-12);
    let line = Points::from_rows(&[0.5], 1).unwrap();
    assert!(Periodogram::new(&line, 6).is_err());
}

#[cfg(feature = "parallel")]
#[test]
fn threads_change_nothing() {
    let points = Points::from_set(&Independent::new(1), 0..3000, 3).unwrap();
    let all = || {
        let mut values = KINDS
            .map(|(_, kind)| kind.squared(&points).to_bits())
            .to_vec();
        values.push(
            L2::Star
                .squared_weighted(&points, &[1.0, 0.5, 0.25])
                .unwrap()
                .to_bits(),
        );
        values.push(minimum_distance(&points).to_bits());
        values
    };
    let pool = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
    };
    assert_eq!(pool(1).install(all), pool(3).install(all));
}
