//! Independent points; the error bar is their sample variance's.

use core::fmt;
use core::marker::PhantomData;
use core::ops::Range;

use rand::rngs::Xoshiro256PlusPlus;
use rand::{Rng, SeedableRng};

use crate::evaluate::{Source, Visit, conclude, evaluate};
use crate::{Error, Estimate, Estimator, Integrand, NonFinite, Outcome, Stream, hash};

/// The mean over independent uniform points, with the standard error of their sample variance.
///
/// The error falls as `count^(-1/2)`, whatever the dimension and however rough the integrand, as long as its
/// square has an integral.
///
/// The points come from a generator of `rand`: by default [`Xoshiro256PlusPlus`], whose words are documented
/// to stay the same in every version and on every machine. It is seeded anew, from a hash, for every block of
/// 1024 points, so that the estimate does not depend on the number of threads.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, cube};
///
/// use rand::rngs::Xoshiro128PlusPlus;
///
/// let square = cube(|[x]| x * x);
/// let estimate = MonteCarlo::new(100_000, 1).estimate(&square)?;
/// assert!((estimate.mean - 1.0 / 3.0).abs() < 4.0 * estimate.std_error.unwrap());
///
/// let other = MonteCarlo::new(100_000, 1).generator::<Xoshiro128PlusPlus>().estimate(&square)?;
/// assert_ne!(estimate.mean, other.mean);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// # Errors of the estimate
///
/// [`Error::Refused`] for a count of 0; see [`Estimator::estimate`].
#[must_use]
pub struct MonteCarlo<R = Xoshiro256PlusPlus> {
    count: u64,
    seed: u64,
    non_finite: NonFinite,
    generator: PhantomData<fn() -> R>,
}

impl MonteCarlo {
    /// `count` independent points, selected by `seed`.
    pub const fn new(count: u64, seed: u64) -> Self {
        Self {
            count,
            seed,
            non_finite: NonFinite::Fail,
            generator: PhantomData,
        }
    }
}

impl<R> MonteCarlo<R> {
    /// The same with the points of another generator.
    pub const fn generator<T: Rng + SeedableRng>(self) -> MonteCarlo<T> {
        let Self {
            count,
            seed,
            non_finite,
            ..
        } = self;
        MonteCarlo {
            count,
            seed,
            non_finite,
            generator: PhantomData,
        }
    }

    /// The same with another rule for values that are not finite.
    pub const fn non_finite(mut self, rule: NonFinite) -> Self {
        self.non_finite = rule;
        self
    }
}

impl<R: Rng + SeedableRng> Estimator for MonteCarlo<R> {
    fn estimate<I: Integrand>(&self, integrand: &I) -> Outcome<I::Value> {
        if self.count == 0 {
            return Err(Error::refused("count", "at least 1", 0).into());
        }
        let source = Streams {
            seed: self.seed,
            generator: self.generator,
        };
        conclude(
            evaluate(&[source], self.count, integrand, self.non_finite),
            |tallies| {
                let [tally] = tallies else { return None };
                (tally.moments.count() > 0).then(|| Estimate {
                    mean: tally.moments.mean(),
                    std_error: tally.moments.std_error(),
                    requested: self.count,
                    used: tally.used(),
                    rejected: tally.rejected,
                })
            },
        )
    }
}

impl<R> fmt::Debug for MonteCarlo<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MonteCarlo")
            .field("count", &self.count)
            .field("seed", &self.seed)
            .field("non_finite", &self.non_finite)
            .finish_non_exhaustive()
    }
}

impl<R> Clone for MonteCarlo<R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R> Copy for MonteCarlo<R> {}

/// One generator a block, each seeded with all the bits it takes.
struct Streams<R> {
    seed: u64,
    generator: PhantomData<fn() -> R>,
}

impl<R: Rng + SeedableRng> Source for Streams<R> {
    fn points(&self, indices: Range<u64>, _: u32, visit: &mut impl Visit) {
        let mut stream = Stream(seeded::<R>(hash::hash(self.seed, indices.start)));
        for index in indices {
            if visit.point(index, &mut stream).is_break() {
                return;
            }
        }
    }
}

fn seeded<R: SeedableRng>(key: u64) -> R {
    let mut seed = R::Seed::default();
    for (word, bytes) in (0..).zip(seed.as_mut().chunks_mut(8)) {
        bytes.copy_from_slice(&hash::hash(key, word).to_le_bytes()[..bytes.len()]);
    }
    R::from_seed(seed)
}
