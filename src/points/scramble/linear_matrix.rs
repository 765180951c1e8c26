//! A random triangular matrix, then a digital shift.

use super::{BinaryScramble, Columns};
use crate::hash::hash;

/// A random lower triangular matrix over the two-element field, with ones on its diagonal, applied to the digits;
/// then a digital shift.[^matousek]
///
/// The matrix is multiplied into the columns of the generator matrix once, so that a point costs what it costs with
/// a [`DigitalShift`](super::DigitalShift). The variance of an average over a net is that of
/// [`Owen`](super::Owen)'s scrambling. The one to take when a median of replicates is used, which gains
/// from linear scrambling only.[^pan]
///
/// ```
/// use estimand::points::{LinearMatrix, PointSet, Sobol};
///
/// let points = Sobol::new(2)?.scrambled(LinearMatrix { seed: 1 });
/// assert_ne!(points.coordinate(0, 0) < 0.5, points.coordinate(1, 0) < 0.5);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^matousek]: Matoušek, Jiří (1998). *On the L2-Discrepancy for Anchored Boxes*. <https://doi.org/10.1006/jcom.1998.0489>
///
/// [^pan]: Pan, Zexin; Owen, Art (2023). *Super-polynomial accuracy of one dimensional randomized nets using the median
///     of means*. <https://doi.org/10.1090/mcom/3791>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinearMatrix {
    /// What selects the matrices and the shifts.
    pub seed: u64,
}

impl BinaryScramble for LinearMatrix {
    fn seed(&self) -> u64 {
        self.seed
    }

    fn prepare(&self, key: u64, columns: &Columns) -> Option<Columns> {
        // Row `row` of the matrix has random digits before the diagonal, a one on it, nothing after it.
        let rows: Columns = core::array::from_fn(|row| {
            let diagonal = 1_u64 << (63 - row);
            (hash(key, row as u64) & !(diagonal - 1)) | diagonal
        });
        let matrix = transposed(rows);
        Some(columns.map(|column| product(&matrix, column)))
    }

    #[inline(always)]
    fn scramble(&self, key: u64, digits: u64) -> u64 {
        digits ^ key
    }
}

/// The matrix of these columns times a column: the sum of those where it has ones.
fn product(matrix: &Columns, mut column: u64) -> u64 {
    let mut sum = 0;
    while column != 0 {
        let place = column.leading_zeros();
        sum ^= matrix[place as usize];
        column ^= 1 << (63 - place);
    }
    sum
}

/// Rows to columns: swaps the two quarters off the diagonal, then those of each quarter, down to single bits.[^warren]
///
/// [^warren]: Warren, Henry (2012). *Hacker's Delight*, 2nd edition, section 7-3. ISBN 978-0-321-84268-8.
fn transposed(mut matrix: Columns) -> Columns {
    let mut half = 32;
    let mut right = u64::MAX >> half;
    while half > 0 {
        for upper in (0..64).filter(|row| row & half == 0) {
            let lower = upper + half;
            let swapped = (matrix[upper] ^ matrix[lower] >> half) & right;
            matrix[upper] ^= swapped;
            matrix[lower] ^= swapped << half;
        }
        half /= 2;
        right ^= right << half;
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the definition: a digit of the product is the parity of a row and the column.
    #[test]
    fn a_product_has_the_parities_of_the_rows() {
        let rows: Columns = core::array::from_fn(|row| hash(1, row as u64));
        let matrix = transposed(rows);
        for column in (0..100).map(|place| hash(2, place)).chain([0, 1, 1 << 63]) {
            let digits = product(&matrix, column);
            for (row, entries) in rows.into_iter().enumerate() {
                let parity = u64::from((entries & column).count_ones() % 2);
                assert_eq!(digits >> (63 - row) & 1, parity, "row {row} of {column:x}");
            }
        }
        assert_eq!(transposed(matrix), rows);
    }
}
