//! Russian roulette: which light paths go on.

mod pilot;

use crate::Sampler;
use crate::integrands::Survival;

pub(crate) use pilot::Witness;

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

    /// By what a path carries times a factor for the segment, after every segment. Before the fifth paths that are
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

    /// The probability with which a path goes on after a segment, as [`play`](Self::play) has it.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    pub(in crate::path) fn chance(&self, segment: u32, carried: f32) -> f32 {
        if segment < self.from {
            return 1.0;
        }
        self.survival(segment, carried).min(1.0) as f32
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives one coordinate and counts how often.
    struct Once(f64, u32);

    impl Sampler for Once {
        fn next_1d(&mut self) -> f64 {
            self.1 += 1;
            self.0
        }
    }

    #[test]
    fn the_weight_is_the_inverse_of_the_chance() {
        let rules = [
            Rule::of_throughput(1),
            Rule::of_throughput(5),
            Rule::learned([0.3; TOLD_APART]),
            Rule::learned([7.0; TOLD_APART]),
        ];
        for rule in rules {
            for (segment, carried) in [(1, 0.5), (2, 0.1), (4, 3.0), (5, 0.9), (16, 1.0), (40, 2.0)]
            {
                let below = rule.survival(segment, carried).min(1.0);
                let weight = rule.play(segment, carried, &mut Once(below * (1.0 - 1e-9), 0));
                let weight = f64::from(weight.expect("a coordinate below the chance"));
                assert!(
                    (weight * below - 1.0).abs() < 1e-6,
                    "{rule:?} {segment} {carried}"
                );
                let ends = rule.play(segment, carried, &mut Once(below, 0)).is_none();
                assert_eq!(ends, below < 1.0, "{rule:?} {segment} {carried}");
            }
        }
    }

    #[test]
    fn certain_survival_draws_nothing_and_ends_with_the_fifth_segment() {
        let rule = Rule::learned([7.0; TOLD_APART]);
        for segment in 1..100 {
            let mut u = Once(0.94, 0);
            assert!(rule.play(segment, 1.0, &mut u).is_some());
            assert_eq!(u.1, u32::from(segment >= 5), "segment {segment}");
            let ends = rule
                .play(segment, f32::INFINITY, &mut Once(0.96, 0))
                .is_none();
            assert_eq!(ends, segment >= 5, "segment {segment}");
        }
        // Without learning every path may end from the first segment played on.
        let mut u = Once(0.96, 0);
        assert!(Rule::of_throughput(1).play(1, 1.0, &mut u).is_none());
    }

    #[test]
    fn black_paths_end_and_nan_goes_on() {
        let mut u = Once(0.5, 0);
        for rule in [Rule::of_throughput(0), Rule::learned([0.1; TOLD_APART])] {
            for segment in [0, 1, 5, u32::MAX] {
                assert_eq!(rule.play(segment, 0.0, &mut u), None);
                assert_eq!(rule.play(segment, -1.0, &mut u), None);
                assert!(rule.play(segment, f32::NAN, &mut Once(0.5, 0)).is_some());
            }
        }
    }
}
