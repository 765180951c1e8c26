//! Russian roulette: which light paths go on.

mod pilot;

use crate::Sampler;
use crate::integrands::Survival;

pub(crate) use pilot::Steps;
pub(in crate::path) use pilot::Witness;

/// Segments that a rule tells apart; later ones are as the last.
const TOLD_APART: usize = 16;

/// The largest probability of survival where a path may end.
const LARGEST: f64 = 0.95;

/// How likely a path is to go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::path) struct Rule {
    /// The first segment after which it is played.
    pub(in crate::path) from: u32,
    /// The first segment after which every path may end, so that none goes on for ever.
    ending: u32,
    /// By which what a path carries is multiplied, for the probability of survival after each segment.
    factors: [f64; TOLD_APART],
}

impl Rule {
    /// By what a path carries alone.
    pub(in crate::path) const fn of_throughput(from: u32) -> Self {
        Self {
            from,
            ending: from,
            factors: [1.0; TOLD_APART],
        }
    }

    /// By what a path carries times a factor for the segment, after every segment. Up to the fifth paths that are
    /// certain to survive draw no coordinate.
    fn learned(factors: [f64; TOLD_APART]) -> Self {
        Self {
            from: 1,
            ending: 5,
            factors,
        }
    }

    /// The probability of survival after a segment, of a path that carries so much; 1 and more where it is certain.
    #[inline]
    fn survival(&self, segment: u32, carried: f32) -> f64 {
        let survival = f64::from(carried) * self.factors[place(segment)];
        if segment < self.ending && survival >= 1.0 {
            return survival;
        }
        survival.min(LARGEST)
    }

    /// The weight of a path that goes on, `None` for one that ends, from what it carries after a segment.
    #[inline]
    pub(in crate::path) fn play<S: Sampler>(
        &self,
        segment: u32,
        carried: f32,
        u: &mut S,
    ) -> Option<f32> {
        // A black path is common, and an error for each would be slow. NaN goes on, to be seen.
        if carried <= 0.0 {
            return None;
        }
        let survival = self.survival(segment, carried);
        if survival >= 1.0 {
            return Some(1.0);
        }
        let weight = Survival::new(survival).ok()?.play(u.next_1d())?;
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        Some(weight as f32)
    }
}

/// The place of a segment in tables.
#[inline]
fn place(segment: u32) -> usize {
    (segment as usize).clamp(1, TOLD_APART) - 1
}
