//! How many evaluations are made between two questions to clock and callback.

/// Seconds between two questions.
const PATIENCE: f64 = 0.05;

/// The same, where less would leave threads idle.
const MOST: f64 = 1.0;

pub(super) struct Pace {
    /// How many evaluations are next.
    pub(super) stride: u64,
    /// How long those before took, and how many they were.
    before: Option<(f64, u64)>,
    /// Those that a thread makes at a time, at the most.
    portion: u64,
    threads: u64,
}

impl Pace {
    pub(super) fn new(portion: u64, threads: usize) -> Self {
        Self {
            stride: 16,
            before: None,
            portion: portion.max(1),
            threads: threads as u64,
        }
    }

    /// After `asked` evaluations were asked for, and some `made` in so many `seconds`, with so many `left`.
    pub(super) fn adapt(&mut self, asked: u64, made: u64, seconds: f64, left: f64) {
        // What takes as long for fewer evaluations, or for more, is done once a stride: it is worth a longer one.
        let in_vain = self.before.is_some_and(|(before, made_before)| {
            let expected = before * made as f64 / made_before as f64;
            (seconds - before).abs() < 0.5 * (expected - before).abs()
        });
        self.before = (made > 0).then_some((seconds, made));
        // A portion for each thread, if it does not take too long.
        let most = MOST.min(left);
        let filled = seconds * (self.portion as f64 / made.max(1) as f64).max(1.0);
        let full = self.portion.saturating_mul(self.threads);
        let worth = self.threads > 1 && filled <= most;
        let grows = worth && self.stride < full && seconds < 0.5 * most;
        self.stride = if seconds < PATIENCE || in_vain || grows {
            self.stride.saturating_mul(2)
        } else {
            let least = if made > asked {
                // They come in portions that are not cut: the other threads can have theirs in the same time.
                made.min(self.portion).saturating_mul(self.threads)
            } else if worth {
                full.min(self.stride)
            } else {
                1
            };
            (self.stride / 2).max(least)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An estimator that makes portions of so many evaluations at a time, of so many seconds each, and takes some `once` a stride.
    struct Made {
        portion: u64,
        /// Whether portions are not cut.
        whole: bool,
        each: f64,
        once: f64,
        threads: usize,
    }

    impl Made {
        /// The longest stride, and the last two, after it has had some time to settle.
        fn strides(&self, left: f64) -> (f64, [u64; 2]) {
            let mut pace = Pace::new(self.portion, self.threads);
            let (mut longest, mut last) = (0.0_f64, [0; 2]);
            for step in 0..80 {
                let asked = pace.stride;
                let portions = asked.div_ceil(self.portion);
                let made = if self.whole {
                    portions * self.portion
                } else {
                    asked
                };
                let rounds = portions.div_ceil(self.threads as u64);
                let seconds = self.once + self.each * (rounds * self.portion.min(made)) as f64;
                pace.adapt(asked, made, seconds, left);
                if step > 20 {
                    longest = longest.max(seconds);
                    last = [last[1], asked];
                }
            }
            (longest, last)
        }
    }

    const ONE: Made = Made {
        portion: 1024,
        whole: false,
        each: 1e-6,
        once: 0.0,
        threads: 2,
    };

    #[test]
    fn clock_and_callback_are_asked_often_and_threads_have_work() {
        // Quick: a twentieth of a second, within a factor of two.
        let (longest, [one, other]) = ONE.strides(1e9);
        assert!((0.05..0.11).contains(&longest), "{longest}");
        assert!(one.min(other) > 40_000, "{one} {other}");
        // A portion takes half a second: every thread has one.
        for (threads, full) in [(2, 2048), (64, 65_536)] {
            let slow = Made {
                each: 4e-4,
                threads,
                ..ONE
            };
            let (longest, last) = slow.strides(1e9);
            assert!(
                longest <= 1.0 && last.iter().all(|&last| last >= full),
                "{last:?}"
            );
        }
        // A portion takes a minute: one evaluation after the other; and so does a single thread.
        let slowest = Made {
            each: 0.06,
            threads: 64,
            ..ONE
        };
        assert_eq!(slowest.strides(1e9), (0.06, [1, 1]));
        let alone = Made {
            each: 4e-4,
            threads: 1,
            ..ONE
        };
        assert!(alone.strides(1e9).0 < 0.11);
        // Where there is little time left nobody waits for all threads.
        let slow = Made { each: 4e-4, ..ONE };
        assert!(slow.strides(0.1).0 < 0.15);
    }

    #[test]
    fn as_many_replicates_as_threads_keep_them_busy_with_few_evaluations() {
        let replicated = Made {
            portion: 1,
            each: 0.06,
            threads: 64,
            ..ONE
        };
        let (longest, last) = replicated.strides(1e9);
        assert!(
            longest < 0.13 && last.iter().any(|&last| last >= 64),
            "{longest} {last:?}"
        );
    }

    #[test]
    fn portions_that_are_not_cut_go_to_all_threads() {
        let whole = Made {
            portion: 16_384,
            whole: true,
            each: 1e-3,
            threads: 8,
            once: 0.0,
        };
        // One more portion a thread is tried now and then, since one less was in vain.
        let (longest, last) = whole.strides(1e9);
        assert!(
            longest < 33.0 && last.iter().all(|&last| last >= 4 * 16_384),
            "{longest} {last:?}"
        );
        let alone = Made {
            threads: 1,
            ..whole
        };
        assert!(alone.strides(1e9).0 < 17.0);
    }

    #[test]
    fn what_is_done_once_a_stride_is_worth_a_longer_one() {
        let (longest, last) = Made {
            once: 0.1,
            threads: 1,
            ..ONE
        }
        .strides(1e9);
        assert!(longest > 0.15 && longest < 1.0, "{longest} {last:?}");
    }
}
