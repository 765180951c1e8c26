//! N rooks that do not attack one another.

use core::ops::Range;

use super::PointSet;
use super::finite::{self, CHUNK, Column, Finite};
use super::permutation::Permutation;
use super::strata::{within, write_within};
use crate::Error;
use crate::hash::{hash, permute, prepare, unit};

/// N-rooks points, also Latin hypercube samples: with `count` points, every one of `count` equal strata of every
/// axis holds exactly one.[^shirley] [^mckay]
///
/// Any count, any number of dimensions, constant memory: each axis is shuffled by a hash, not by a table.
///
/// Removes the part of the variance that is a sum of functions of one coordinate each, and never does much
/// worse than independent points: the variance is at most `count / (count - 1)` times theirs.[^owen] It does
/// nothing for what two coordinates do together; a [`Stratified`](super::Stratified) grid does, in few dimensions.
///
/// An index at or past the count belongs to another, independent set of `count` points.
///
/// ```
/// use estimand::points::{NRooks, PointSet};
///
/// let rooks = NRooks::new(9, 1)?;
/// let mut columns: Vec<u32> = (0..9).map(|rook| (rooks.coordinate(rook, 1) * 9.0) as u32).collect();
/// columns.sort();
/// assert_eq!(columns, [0, 1, 2, 3, 4, 5, 6, 7, 8]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^shirley]: Shirley, Peter (1991). *Discrepancy as a Quality Measure for Sample Distributions*. Eurographics '91.
///     <https://doi.org/10.2312/egtp.19911013>
/// [^mckay]: McKay, Michael; Beckman, Richard; Conover, William (1979). *A Comparison of Three Methods for
///     Selecting Values of Input Variables in the Analysis of Output from a Computer Code*.
///     <https://doi.org/10.1080/00401706.1979.10489755>
/// [^owen]: Owen, Art (1997). *Monte Carlo Variance of Scrambled Net Quadrature*.
///     <https://doi.org/10.1137/S0036142994277468>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct NRooks {
    count: u64,
    seed: u64,
}

impl NRooks {
    /// A set of `count` points that `seed` selects.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a count of 0.
    pub fn new(count: u64, seed: u64) -> Result<Self, Error> {
        if count == 0 {
            return Err(Error::refused(
                "count of N-rooks points",
                "at least 1",
                count,
            ));
        }
        Ok(Self { count, seed })
    }
}

impl NRooks {
    /// What selects the order of the strata in `dimension` of the set number `set`.
    #[inline]
    fn key(&self, set: u64, dimension: u32) -> u64 {
        hash(hash(self.seed, set), u64::from(dimension))
    }
}

impl PointSet for NRooks {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let (set, index) = (index / self.count, index % self.count);
        let key = self.key(set, dimension);
        let stratum = permute(index, self.count, key);
        within(stratum, self.count, unit(hash(!key, index)))
    }

    fn size(&self) -> Option<u64> {
        Some(self.count)
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        finite::fill(self, first, dimensions, out);
    }
}

impl Finite for NRooks {
    type Column = Rooks;

    fn column(&self, set: u64, dimension: u32) -> Rooks {
        let key = self.key(set, dimension);
        Rooks {
            count: self.count,
            strata: Permutation::new(self.count, key),
            offsets: prepare(!key),
        }
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}

/// What the points of one set have in common in one dimension.
pub(super) struct Rooks {
    count: u64,
    strata: Permutation,
    offsets: u64,
}

impl Column for Rooks {
    #[inline(always)]
    fn write(&self, places: &[u32; CHUNK], out: &mut [f64; CHUNK]) {
        let mut strata = *places;
        self.strata.apply(&mut strata);
        write_within(&strata, self.count, self.offsets, places, out);
    }
}
