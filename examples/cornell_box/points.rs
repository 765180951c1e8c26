//! The point sets to compare, each randomised anew in every pixel.

use clap::ValueEnum;
use estimand::path::{Image, Unfinished};
use estimand::points::{Halton, Hammersley, HashedOwen, NRooks, Owen, PointSet, Sobol, Stratified};
use estimand::{Average, MonteCarlo, hash};

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

/// A point set for each seed, of one type for all: the loop over paths is compiled once for it.
type Randomised<'a> = &'a (dyn Fn(u64) -> Box<dyn PointSet> + Sync);

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
        let size = [size; 2];
        let average = |points: Randomised<'_>| {
            room.render_while(size, seed, |key| Average::new(points(key), spp), &proceed)
        };
        match self {
            Self::MonteCarlo => {
                room.render_while(size, seed, |key| MonteCarlo::new(spp, key), &proceed)
            }
            Self::Stratified => {
                average(&|key| Box::new(Stratified::new(spp, 2, key).expect(VALID)))
            }
            Self::NRooks => average(&|key| Box::new(NRooks::new(spp, key).expect(VALID))),
            Self::Halton => {
                let points = Halton::new(DIMENSIONS).expect(VALID);
                average(&|seed| Box::new(points.clone().scrambled(Owen { seed })))
            }
            Self::Hammersley => {
                let points = Hammersley::new(spp, DIMENSIONS).expect(VALID);
                average(&|seed| {
                    let offset = hash::unit(hash::hash(seed, 0));
                    let points = points.clone().offset(offset).expect(VALID);
                    Box::new(points.scrambled(Owen { seed }))
                })
            }
            Self::Sobol => {
                let points = Sobol::new(DIMENSIONS).expect(VALID);
                average(&|seed| Box::new(points.clone().scrambled(HashedOwen { seed })))
            }
        }
    }
}

const VALID: &str = "the count is positive, the dimensions are few, the offset is a fraction";
