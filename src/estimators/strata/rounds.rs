//! The points of many strata, dealt out in rounds.

use crate::stratum::between;

/// So many points in each stratum, dealt out in rounds: two each in the first, and with each further one four times as many
/// as with those before it, in proportion to what they are due.
pub(super) struct Rounds<'a> {
    /// The numbers of points that are due up to and with each stratum.
    ends: &'a [u64],
}

impl<'a> Rounds<'a> {
    /// Two points at least in each stratum: `ends` are their numbers up to and with each.
    pub(super) fn new(ends: &'a [u64]) -> Self {
        Self { ends }
    }

    /// How many strata there are.
    fn strata(&self) -> usize {
        self.ends.len()
    }

    /// How many points there are in all.
    fn total(&self) -> u64 {
        self.ends.last().copied().unwrap_or(0)
    }

    /// How many rounds there are.
    pub(super) fn number(&self) -> u32 {
        (0..)
            .find(|&round| self.about(round) >= self.total())
            .map_or(0, |round| round + 1)
    }

    /// About how many points there are after `round`.
    fn about(&self, round: u32) -> u64 {
        let first = 2 * self.strata() as u64;
        4_u64
            .checked_pow(round)
            .map_or(u64::MAX, |times| first.saturating_mul(times))
    }

    /// The part of all points that there is after `round`.
    fn part(&self, round: u32) -> f64 {
        self.about(round) as f64 / self.total() as f64
    }

    /// How many points each stratum has before `round`.
    fn sofar(&self, round: u32) -> impl Fn(usize) -> u64 {
        let part = round.checked_sub(1).map(|last| self.part(last));
        move |stratum| part.map_or(0, |part| dealt(part, between(self.ends, stratum)))
    }

    /// How many points there are before `round`.
    pub(super) fn before(&self, round: u32) -> u64 {
        (0..self.strata()).map(self.sofar(round)).sum()
    }

    /// How many points each stratum gets in `round`.
    pub(super) fn counts(&self, round: u32) -> impl Fn(usize) -> u64 {
        let (part, sofar) = (self.part(round), self.sofar(round));
        move |stratum| dealt(part, between(self.ends, stratum)) - sofar(stratum)
    }
}

/// How many of the points that a stratum is `due` it has when there is a `part` of all.
fn dealt(part: f64, due: u64) -> u64 {
    if part >= 1.0 {
        return due;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of what is due"
    )]
    let here = (due as f64 * part) as u64;
    here.clamp(2, due)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_deal_out_what_is_due() {
        for due in [
            vec![2, 2, 2],
            vec![3, 2, 2],
            vec![2, 1000, 37, 3],
            vec![5; 100],
            vec![u64::MAX / 8; 3],
        ] {
            let ends: Vec<u64> = (1..=due.len()).map(|k| due[..k].iter().sum()).collect();
            let rounds = Rounds::new(&ends);
            let mut dealt = vec![0; due.len()];
            for round in 0..rounds.number() {
                assert_eq!(rounds.before(round), dealt.iter().sum::<u64>());
                let counts = (0..due.len()).map(rounds.counts(round));
                for (dealt, here) in dealt.iter_mut().zip(counts) {
                    *dealt += here;
                }
                assert!(dealt.iter().all(|&dealt| dealt >= 2));
            }
            assert_eq!(dealt, due);
        }
        let alike: Vec<u64> = (1..=512).map(|k| 512 * k).collect();
        assert_eq!(Rounds::new(&alike).number(), 5);
    }
}
