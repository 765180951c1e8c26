//! The points of many strata, dealt out in rounds.

/// So many points in each stratum, dealt out in rounds: two each in the first, and with each further one four times as many
/// as with those before it, in proportion to what they are due.
pub(super) struct Rounds {
    due: Vec<u64>,
    total: u64,
}

impl Rounds {
    /// `due[k]` points in stratum `k`, two at least.
    pub(super) fn new(due: Vec<u64>) -> Self {
        let total = due.iter().sum();
        Self { due, total }
    }

    /// How many rounds there are.
    pub(super) fn number(&self) -> u32 {
        (0..)
            .find(|&round| self.about(round) >= self.total)
            .map_or(0, |round| round + 1)
    }

    /// About how many points there are after `round`.
    fn about(&self, round: u32) -> u64 {
        let first = 2 * self.due.len() as u64;
        4_u64
            .checked_pow(round)
            .map_or(u64::MAX, |times| first.saturating_mul(times))
    }

    /// How many points the stratum that is due `due` has after `round`.
    fn after(&self, round: u32, due: u64) -> u64 {
        let about = self.about(round);
        if about >= self.total {
            return due;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a part of what is due"
        )]
        let part = (due as f64 * (about as f64 / self.total as f64)) as u64;
        part.clamp(2, due)
    }

    /// How many points a stratum has before `round`.
    fn sofar(&self, round: u32, due: u64) -> u64 {
        round.checked_sub(1).map_or(0, |last| self.after(last, due))
    }

    /// How many points there are before `round`.
    pub(super) fn before(&self, round: u32) -> u64 {
        self.due.iter().map(|&due| self.sofar(round, due)).sum()
    }

    /// How many points each stratum gets in `round`.
    pub(super) fn counts(&self, round: u32) -> Vec<u64> {
        let here = |&due: &u64| self.after(round, due) - self.sofar(round, due);
        self.due.iter().map(here).collect()
    }
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
            let rounds = Rounds::new(due.clone());
            let mut dealt = vec![0; due.len()];
            for round in 0..rounds.number() {
                assert_eq!(rounds.before(round), dealt.iter().sum::<u64>());
                for (dealt, here) in dealt.iter_mut().zip(rounds.counts(round)) {
                    *dealt += here;
                }
                assert!(dealt.iter().all(|&dealt| dealt >= 2));
            }
            assert_eq!(dealt, due);
        }
        assert_eq!(Rounds::new(vec![512; 512]).number(), 5);
    }
}
