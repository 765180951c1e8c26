//! How much is measured: what the default run and the quick one take.

/// Counts, sizes and repetitions.
pub(crate) struct Effort {
    /// Evaluations of the scalar integrals: powers of two from the first to before the second.
    pub(crate) powers: [u32; 2],
    /// Runs of each.
    pub(crate) seeds: u64,
    /// The least time of a measurement, in seconds.
    pub(crate) shortest: f64,
    /// Width and height of the pictures of the studies.
    pub(crate) small: u32,
    /// Samples per pixel of the studies: powers of four below this one.
    pub(crate) spp_powers: u32,
    pub(crate) picture_seeds: u64,
    /// Width and height of the pictures to look at.
    pub(crate) large: u32,
    /// How long each of them takes, in seconds.
    pub(crate) equal_time: f64,
    /// Pictures from which a standard error is taken.
    pub(crate) repeats: u64,
    /// Width and height of the pictures behind the lecture's claims, and their runs.
    pub(crate) claim: u32,
    pub(crate) claim_runs: u64,
    /// Runs and evaluations of each extreme case.
    pub(crate) extreme_runs: u64,
    pub(crate) extreme_count: u64,
}

impl Effort {
    pub(crate) fn new(quick: bool) -> Self {
        if quick {
            Self {
                powers: [6, 14],
                seeds: 8,
                shortest: 2e-4,
                small: 16,
                spp_powers: 4,
                picture_seeds: 3,
                large: 64,
                equal_time: 0.15,
                repeats: 3,
                claim: 32,
                claim_runs: 6,
                extreme_runs: 20,
                extreme_count: 2048,
            }
        } else {
            Self {
                powers: [6, 18],
                seeds: 20,
                shortest: 1e-3,
                small: 32,
                spp_powers: 6,
                picture_seeds: 4,
                large: 128,
                equal_time: 1.0,
                repeats: 6,
                claim: 64,
                claim_runs: 16,
                extreme_runs: 100,
                extreme_count: 4096,
            }
        }
    }

    /// Samples per pixel of the studies.
    pub(crate) fn spp(&self) -> impl Iterator<Item = u64> + use<> {
        (0..self.spp_powers).map(|power| 4_u64.pow(power))
    }
}
