//! Paths of any length from a few good dimensions.

use super::scramble::{HashedOwen, scramble, scramble_reversed};
use super::{PointSet, Sobol};
use crate::Error;
use crate::hash::{hash, unit};

/// The first few dimensions of Sobol's sequence again and again, each time scrambled and shuffled anew: any number of
/// dimensions.[^burley]
///
/// Within a group of `width` dimensions the points are those of a scrambled net; between groups they are
/// independent of one another, apart from being nets. So a light path that reads its coordinates in groups has every
/// one of its decisions well sampled, however long it gets, where late dimensions of a plain Sobol' sequence are
/// correlated for small counts. For an integrand in a fixed number of dimensions that do much together take
/// [`Sobol`] itself.
///
/// With groups of two this is a progressive (0,2) sequence in every pair: any aligned block of `2^m` points has one in
/// every elementary interval of area `2^-m`.[^pmj] Take powers of two.
///
/// Exact at every index; see [`Sobol`] for what holds past 2^53 points. Scrambled as by
/// [`HashedOwen`](super::HashedOwen); the order is shuffled among the points from `2^m` to
/// `2^(m + 1) - 1`, so that prefixes remain nets.
///
/// ```
/// use estimand::points::{PointSet, Rescrambled};
///
/// let points = Rescrambled::new(2, 1)?;
/// let mut quarters: Vec<u32> = (0..4).map(|index| (points.coordinate(index, 999) * 4.0) as u32).collect();
/// quarters.sort();
/// assert_eq!(quarters, [0, 1, 2, 3]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^burley]: Burley, Brent (2020). *Practical Hash-based Owen Scrambling*. <https://jcgt.org/published/0009/04/01/>
///
/// [^pmj]: Christensen, Per; Kensler, Andrew; Kilpatrick, Charlie (2018). *Progressive Multi-Jittered Sample Sequences*.
///     <https://doi.org/10.1111/cgf.13472>
#[derive(Clone, Debug)]
#[must_use]
pub struct Rescrambled {
    /// The scramble is there for its order of digits; the keys are those of the groups.
    sobol: Sobol<HashedOwen>,
    seed: u64,
}

impl Rescrambled {
    /// Groups of `width` dimensions, with the scrambles that `seed` selects.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a width that [`Sobol::new`] refuses.
    pub fn new(width: u32, seed: u64) -> Result<Self, Error> {
        Ok(Self {
            sobol: Sobol::new(width)?.scrambled(HashedOwen { seed }),
            seed,
        })
    }

    /// The same groups with other scrambles: cheap, the table is shared.
    pub fn reseeded(&self, seed: u64) -> Self {
        Self {
            sobol: self.sobol.clone(),
            seed,
        }
    }

    /// The scrambled digits of the coordinate under the scrambles that `seed` selects.
    #[inline]
    pub(super) fn digits(&self, seed: u64, index: u64, dimension: u32) -> u64 {
        let width = self.sobol.dimensions();
        let (group, axis) = (dimension / width, dimension % width);
        let key = hash(seed, u64::from(group));
        let digits = self.sobol.digits(shuffled(index, key), axis);
        scramble_reversed(digits, hash(key, u64::from(axis)))
    }
}

/// The index of the point that comes `index`-th: below its leading one the bits are scrambled, each by those above
/// it.
///
/// What becomes of the leading one and the zeros before it only moves the whole block of points, as the scrambles of
/// the coordinates do already.
#[inline]
fn shuffled(index: u64, key: u64) -> u64 {
    let below = u64::MAX.checked_shr(index.leading_zeros() + 1).unwrap_or(0);
    (index & !below) | (scramble(index, key) & below)
}

impl PointSet for Rescrambled {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        unit(self.digits(self.seed, index, dimension))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octaves_are_shuffled_within_themselves() {
        for key in 0..20 {
            let key = hash(1, key);
            for octave in 0..10 {
                let mut seen: Vec<u64> = ((1 << octave)..(2 << octave))
                    .map(|index| shuffled(index, key))
                    .collect();
                assert!(octave < 4 || seen.windows(2).any(|pair| pair[0] > pair[1]));
                seen.sort_unstable();
                assert!(seen.into_iter().eq((1 << octave)..(2 << octave)));
            }
            assert_eq!(shuffled(0, key), 0);
            assert_eq!(shuffled(u64::MAX, key) >> 63, 1);
        }
    }
}
