//! A random shift, modulo 1, of any set.

use super::PointSet;
use super::radical_inverse::BELOW_ONE;
use crate::hash::{hash, mix, unit};

/// Any set, moved as a whole by a random amount along every axis, modulo 1.[^cranley]
///
/// Every point becomes uniform. The randomisation for lattices and other sets that tile space; on digital nets
/// and Halton's points it breaks elementary intervals, where their scrambles keep them.
///
/// Exact where coordinates are multiples of 2^-53, as those of nets are; others are rounded to the nearest number below 1.
///
/// ```
/// use estimand::points::{Halton, PointSet, Shifted};
///
/// let points = Shifted::new(Halton::new(2)?, 1);
/// let moved = points.coordinate(1, 0) - points.coordinate(0, 0);
/// assert!(moved == 0.5 || moved == -0.5);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^cranley]: Cranley, Roy; Patterson, Thomas (1976). *Randomization of Number Theoretic Methods for Multiple Integration*.
///     <https://doi.org/10.1137/0713071>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Shifted<P> {
    points: P,
    seed: u64,
}

impl<P: PointSet> Shifted<P> {
    /// `points`, moved by what `seed` selects.
    pub const fn new(points: P, seed: u64) -> Self {
        Self { points, seed }
    }

    /// How far the points are moved along the axis `dimension`.
    #[inline]
    fn shift(&self, dimension: u32) -> f64 {
        unit(mix(hash(self.seed, u64::from(dimension))))
    }
}

/// `u + shift` modulo 1. Multiples of 2^-53 in `[0, 1)` stay such, exactly; where another sum rounds up to 1, the largest number
/// below is taken.
#[inline]
fn wrap(u: f64, shift: f64) -> f64 {
    let back = 1.0 - shift;
    let sum = if u >= back { u - back } else { u + shift };
    sum.min(BELOW_ONE)
}

impl<P: PointSet> PointSet for Shifted<P> {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        wrap(
            self.points.coordinate(index, dimension),
            self.shift(dimension),
        )
    }

    fn size(&self) -> Option<u64> {
        self.points.size()
    }

    fn radix(&self) -> Option<u32> {
        self.points.radix()
    }

    fn dimensions(&self) -> u32 {
        self.points.dimensions()
    }

    fn fill(&self, first: u64, dimensions: core::ops::Range<u32>, out: &mut [f64]) {
        self.points.fill(first, dimensions.clone(), out);
        let shifts: Vec<f64> = dimensions.map(|dimension| self.shift(dimension)).collect();
        for row in out.chunks_exact_mut(shifts.len().max(1)) {
            for (u, &shift) in row.iter_mut().zip(&shifts) {
                *u = wrap(*u, shift);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_stay_in_the_cube() {
        let one = BELOW_ONE;
        for (u, shift) in [
            (one, one),
            (one, 0.0),
            (0.0, one),
            (0.5, 0.5),
            (1e-300, one),
        ] {
            assert!((0.0..1.0).contains(&wrap(u, shift)), "{u} {shift}");
        }
        assert_eq!(wrap(0.5, 0.5), 0.0);
        assert_eq!(wrap(0.75, 0.5), 0.25);
    }
}
