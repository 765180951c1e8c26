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
        Some(columns.map(|column| {
            (0..).zip(&rows).fold(0, |digits, (row, &entries)| {
                let digit = u64::from((entries & column).count_ones() & 1);
                digits | digit << (63 - row)
            })
        }))
    }

    #[inline(always)]
    fn scramble(&self, key: u64, digits: u64) -> u64 {
        digits ^ key
    }
}
