//! The point sets to compare, each randomised anew in every pixel.

use clap::ValueEnum;
use estimand::path::{Image, Unfinished};
use estimand::points::{Halton, Hammersley, HashedOwen, NRooks, Owen, Sobol, Stratified};
use estimand::{Average, Estimator, MonteCarlo, hash};

use crate::measure::Room;

/// A point set.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Points {
    /// Independent points: plain Monte Carlo
    MonteCarlo,
    /// One point in every cell of a grid, in every pair of dimensions
    Stratified,
    /// N rooks: one point in every stratum of every dimension
    NRooks,
    /// Halton's points, Owen-scrambled
    Halton,
    /// Hammersley's points, Owen-scrambled, with a random offset of the axis
    Hammersley,
    /// Sobol's points, Owen-scrambled by hashing
    Sobol,
}

/// Dimensions of the sets: those of the paths that matter. Longer ones go on with independent coordinates.
const DIMENSIONS: u32 = 32;

impl Points {
    pub(crate) const ALL: [Self; 6] = [
        Self::MonteCarlo,
        Self::Stratified,
        Self::NRooks,
        Self::Halton,
        Self::Hammersley,
        Self::Sobol,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::MonteCarlo => "monte-carlo",
            Self::Stratified => "stratified",
            Self::NRooks => "n-rooks",
            Self::Halton => "halton",
            Self::Hammersley => "hammersley",
            Self::Sobol => "sobol",
        }
    }
}

impl Points {
    /// The picture, as [`View::render_while`](estimand::path::View::render_while).
    pub(crate) fn render(
        self,
        room: &Room,
        size: u32,
        spp: u64,
        seed: u64,
        proceed: impl Fn(u32) -> bool + Sync,
    ) -> Result<Image, Unfinished> {
        let picture = Picture {
            room,
            size,
            seed,
            proceed,
        };
        match self {
            Self::MonteCarlo => picture.render(|key| MonteCarlo::new(spp, key)),
            Self::Stratified => {
                picture.render(|key| Average::new(Stratified::new(spp, 2, key).expect(VALID), spp))
            }
            Self::NRooks => {
                picture.render(|key| Average::new(NRooks::new(spp, key).expect(VALID), spp))
            }
            Self::Halton => {
                let points = Halton::new(DIMENSIONS).expect(VALID);
                let points = |seed| points.clone().scrambled(Owen { seed });
                picture.render(|key| Average::new(points(key), spp))
            }
            Self::Hammersley => {
                let points = Hammersley::new(spp, DIMENSIONS).expect(VALID);
                let points = |seed| {
                    let offset = hash::unit(hash::hash(seed, 0));
                    let points = points.clone().offset(offset).expect(VALID);
                    points.scrambled(Owen { seed })
                };
                picture.render(|key| Average::new(points(key), spp))
            }
            Self::Sobol => {
                let points = Sobol::new(DIMENSIONS).expect(VALID);
                let points = |seed| points.clone().scrambled(HashedOwen { seed });
                picture.render(|key| Average::new(points(key), spp))
            }
        }
    }
}

const VALID: &str = "the count is positive, the dimensions are few, the offset is a fraction";

/// What the pictures of all sets have in common.
struct Picture<'a, F> {
    room: &'a Room,
    size: u32,
    seed: u64,
    proceed: F,
}

impl<F: Fn(u32) -> bool + Sync> Picture<'_, F> {
    fn render<T: Estimator>(
        self,
        estimator: impl Fn(u64) -> T + Sync,
    ) -> Result<Image, Unfinished> {
        self.room
            .render_while([self.size; 2], self.seed, estimator, self.proceed)
    }
}
