//! The direction numbers of Joe and Kuo, and the generator matrices that they make.
//!
//! The numbers and their licence are in the files beside this one.

use core::ops::Deref;
use std::sync::{Arc, OnceLock};

use super::Columns;
use crate::points::DigitOrder;

/// How many dimensions [`Sobol`](super::Sobol) has at most: 1024, or 21201 with the feature `sobol-full`.
pub const DIMENSIONS: u32 = if cfg!(feature = "sobol-full") {
    21_201
} else {
    1024
};

/// Lines `d s a m_1 .. m_s` for the dimensions 2 to 1024, counted from 1, after one line of titles.
const FIRST: &str = include_str!("new-joe-kuo-6.2-1024.txt");

/// The same for the dimensions 1025 to 21201.
#[cfg(feature = "sobol-full")]
const REST: &str = include_str!("new-joe-kuo-6.1025-21201.txt");
#[cfg(not(feature = "sobol-full"))]
const REST: &str = "";

/// One generator matrix for each dimension.
#[derive(Clone, Debug)]
pub(super) enum Matrices {
    /// Those of the table: nothing is counted, so that a set can be made and dropped for every pixel.
    Table(&'static [Columns]),
    /// Those that a scramble has changed.
    Changed(Arc<[Columns]>),
}

impl Deref for Matrices {
    type Target = [Columns];

    #[inline]
    fn deref(&self) -> &[Columns] {
        match self {
            Self::Table(matrices) => matrices,
            Self::Changed(matrices) => matrices,
        }
    }
}

/// The generator matrices of the first `dimensions` dimensions, at most [`DIMENSIONS`]. They are made once for the whole
/// program, for a power of two of dimensions at a time.
pub(in crate::points) fn table(dimensions: u32, order: DigitOrder) -> &'static [Columns] {
    /// The least and the most that are made at once, as powers of two.
    const FEWEST: u32 = 5;
    const MOST: u32 = DIMENSIONS.next_power_of_two().trailing_zeros();
    const LEVELS: usize = (MOST - FEWEST + 1) as usize;
    static TABLES: [[OnceLock<Box<[Columns]>>; LEVELS]; 2] =
        [const { [const { OnceLock::new() }; LEVELS] }; 2];

    let level = dimensions.next_power_of_two().ilog2().max(FEWEST);
    let tables = &TABLES[match order {
        DigitOrder::FirstHighest => 0,
        DigitOrder::FirstLowest => 1,
    }];
    let table = tables[(level - FEWEST) as usize].get_or_init(|| {
        let matrices = matrices().take(1 << level);
        match order {
            DigitOrder::FirstHighest => matrices.collect(),
            DigitOrder::FirstLowest => matrices
                .map(|columns| columns.map(u64::reverse_bits))
                .collect(),
        }
    });
    &table[..dimensions as usize]
}

/// The generator matrices of all dimensions, in order.
fn matrices() -> impl Iterator<Item = Columns> {
    let lines = FIRST.lines().skip(1).chain(REST.lines().skip(1));
    core::iter::once(van_der_corput()).chain(lines.map(matrix))
}

/// The first dimension: the digits of the index, reversed.
pub(in crate::points) fn van_der_corput() -> Columns {
    core::array::from_fn(|bit| 1 << (63 - bit))
}

/// The matrix of a line of the table.
fn matrix(line: &str) -> Columns {
    let numbers: Vec<u64> = line
        .split_whitespace()
        .map(|number| number.parse().expect("the table holds numbers"))
        .collect();
    let [_, _, inner, directions @ ..] = &numbers[..] else {
        panic!("the lines of the table are whole");
    };
    generator(*inner, directions)
}

/// The matrix of a primitive polynomial whose degree `s` is the number of the `directions`, with the inner coefficients `inner`. The
/// directions are odd numbers `m_k < 2^k`: column `k`, from 1, is `m_k / 2^k`; each later one is a sum of the `s` before it.
pub(in crate::points) fn generator(inner: u64, directions: &[u64]) -> Columns {
    let degree = directions.len();
    let mut columns = [0; 64];
    for (k, (column, direction)) in columns.iter_mut().zip(directions).enumerate() {
        *column = direction << (63 - k);
    }
    for k in degree..64 {
        let oldest = columns[k - degree];
        columns[k] = (1..degree)
            .filter(|step| inner >> (degree - 1 - step) & 1 == 1)
            .fold(oldest ^ (oldest >> degree), |sum, step| {
                sum ^ columns[k - step]
            });
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_hold_the_dimensions_asked_for_in_either_order() {
        let all: Vec<Columns> = matrices().collect();
        for dimensions in [1, 2, 31, 32, 33, 64, 65, DIMENSIONS] {
            let highest = table(dimensions, DigitOrder::FirstHighest);
            let lowest = table(dimensions, DigitOrder::FirstLowest);
            assert_eq!(highest, &all[..dimensions as usize]);
            assert!(
                lowest
                    .iter()
                    .flatten()
                    .map(|column| column.reverse_bits())
                    .eq(highest.iter().flatten().copied())
            );
        }
    }

    #[test]
    fn the_table_has_every_dimension_and_every_matrix_an_inverse() {
        let mut count = 0;
        for columns in matrices() {
            count += 1;
            // Upper triangular with ones on the diagonal.
            for (bit, column) in columns.into_iter().enumerate() {
                assert_eq!(column.trailing_zeros() as usize, 63 - bit);
            }
        }
        assert_eq!(count, DIMENSIONS);
    }
}
