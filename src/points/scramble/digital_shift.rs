//! One random number, added digit by digit.

use super::{BinaryScramble, DigitScramble};
use crate::hash::mix;

/// One random number for each dimension, added digit by digit without carry.[^lecuyer]
///
/// The cheapest randomisation that keeps elementary intervals. Points that are close stay close: the regular patterns
/// of the set remain, moved. The variance of an average is of the order of the squared error of the plain set.
///
/// ```
/// use estimand::points::{DigitalShift, PointSet, Sobol};
///
/// let points = Sobol::new(2)?.scrambled(DigitalShift { seed: 1 });
/// assert_ne!(points.coordinate(0, 0), 0.0);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^lecuyer]: L'Ecuyer, Pierre; Lemieux, Christiane (2002). *Recent Advances in Randomized Quasi-Monte Carlo
///     Methods*. <https://doi.org/10.1007/0-306-48102-2_20>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DigitalShift {
    /// What selects the random numbers.
    pub seed: u64,
}

impl BinaryScramble for DigitalShift {
    fn seed(&self) -> u64 {
        self.seed
    }

    #[inline(always)]
    fn scramble(&self, key: u64, digits: u64) -> u64 {
        digits ^ key
    }
}

impl DigitScramble for DigitalShift {
    const NESTED: bool = false;

    fn seed(&self) -> u64 {
        self.seed
    }

    #[inline]
    fn shift(&self, key: u64) -> u64 {
        mix(key)
    }

    #[inline]
    fn permute(&self, _: u64, _: u32, _: u32, digit: u32) -> u32 {
        digit
    }
}
