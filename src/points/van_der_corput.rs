//! Van der Corput's sequence in any base.

use super::radical_inverse::radical_inverse;
use super::{Independent, PointSet};
use crate::Error;

/// Van der Corput's sequence: the [radical inverses](radical_inverse) of the indices in one base.[^corput]
///
/// One dimension; past it, independent hashed coordinates. The first `base^m` points lie at the multiples of `base^-m`,
/// in an order such that every block of points is spread evenly.
///
/// | index | in base 2 | mirrored | coordinate |
/// |---|---|---|---|
/// | 0 | 0 | 0.0 | 0 |
/// | 1 | 1 | 0.1 | 1/2 |
/// | 2 | 10 | 0.01 | 1/4 |
/// | 3 | 11 | 0.11 | 3/4 |
/// | 4 | 100 | 0.001 | 1/8 |
/// | 5 | 101 | 0.101 | 5/8 |
/// | 6 | 110 | 0.011 | 3/8 |
/// | 7 | 111 | 0.111 | 7/8 |
///
/// Use it to see how low-discrepancy sequences work, and for integrals over an interval. Each coordinate is the
/// nearest number to the exact fraction, however large the index.
///
/// ```
/// use estimand::points::{PointSet, VanDerCorput};
///
/// let points = VanDerCorput::new(2)?;
/// let first: Vec<f64> = (0..5).map(|index| points.coordinate(index, 0)).collect();
/// assert_eq!(first, [0.0, 0.5, 0.25, 0.75, 0.125]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^corput]: van der Corput, Johannes (1935). *Verteilungsfunktionen*.
///     <https://dwc.knaw.nl/DL/publications/PU00016669.pdf>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct VanDerCorput {
    base: u32,
}

impl VanDerCorput {
    /// The sequence in `base`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a base below 2.
    pub fn new(base: u32) -> Result<Self, Error> {
        if base < 2 {
            return Err(Error::refused(
                "base of van der Corput's sequence",
                "at least 2",
                base,
            ));
        }
        Ok(Self { base })
    }
}

impl PointSet for VanDerCorput {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        if dimension > 0 {
            return Independent::past(0).coordinate(index, dimension);
        }
        radical_inverse(self.base, index)
    }

    fn radix(&self) -> Option<u32> {
        Some(self.base)
    }

    fn dimensions(&self) -> u32 {
        1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases_below_two_are_refused() {
        for base in [0, 1] {
            let refused = VanDerCorput::new(base).unwrap_err().to_string();
            assert!(refused.ends_with(&format!("it was {base}")), "{refused}");
        }
    }
}
