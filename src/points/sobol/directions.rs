//! The direction numbers of Joe and Kuo, and the generator matrices that they make.
//!
//! The numbers and their licence are in the files beside this one.

use super::Columns;

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

/// The generator matrices of all dimensions, in order.
pub(super) fn matrices() -> impl Iterator<Item = Columns> {
    let lines = FIRST.lines().skip(1).chain(REST.lines().skip(1));
    core::iter::once(van_der_corput()).chain(lines.map(matrix))
}

/// The first dimension: the digits of the index, reversed.
fn van_der_corput() -> Columns {
    core::array::from_fn(|bit| 1 << (63 - bit))
}

/// The matrix of a line of the table.
///
/// The line holds a primitive polynomial of degree `s` with the inner coefficients `a`, and the first `s` odd
/// numbers `m_k < 2^k`. Column `k`, from 1, is `m_k / 2^k`; each later one is a sum of the `s` before it.
fn matrix(line: &str) -> Columns {
    let mut numbers = line
        .split_whitespace()
        .map(|number| number.parse::<u64>().expect("the table holds numbers"));
    let mut next = || numbers.next().expect("the lines of the table are whole");
    let (_, degree, inner) = (next(), next(), next());
    let degree = usize::try_from(degree).expect("degrees are small");
    let mut columns = [0; 64];
    for (k, column) in columns[..degree].iter_mut().enumerate() {
        *column = next() << (63 - k);
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
