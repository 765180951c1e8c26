//! The point sets that pictures are compared by, each randomised anew in every pixel.

use clap::ValueEnum;
use estimand::path::bsdf::Bsdf;
use estimand::path::filter::Filter;
use estimand::path::light::{Environment, Light};
use estimand::path::sensor::Sensor;
use estimand::path::{Image, Unfinished, View};
use estimand::points::{Halton, Hammersley, HashedOwen, NRooks, Owen, PointSet, Sobol, Stratified};
use estimand::{MonteCarlo, hash};

/// A point set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
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

const VALID: &str = "the count is positive, the dimensions are few, the offset is a fraction";

impl Points {
    pub(crate) const ALL: [Self; 6] = [
        Self::MonteCarlo,
        Self::Stratified,
        Self::NRooks,
        Self::Halton,
        Self::Hammersley,
        Self::Sobol,
    ];

    /// The name on the command line.
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

    /// The name in a text.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::MonteCarlo => "plain Monte Carlo",
            Self::Stratified => "stratified",
            Self::NRooks => "N-rooks",
            Self::Halton => "Halton, Owen",
            Self::Hammersley => "Hammersley, Owen",
            Self::Sobol => "Sobol', hashed Owen",
        }
    }

    /// A square picture with about `spp` samples a pixel.
    pub(crate) fn render<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter>(
        self,
        view: &View<B, L, E, C, F>,
        size: u32,
        spp: u64,
        seed: u64,
    ) -> Result<Image, Unfinished> {
        self.render_while(view, size, spp, seed, |_| true)
    }

    /// The same, as [`View::render_while`].
    pub(crate) fn render_while<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter>(
        self,
        view: &View<B, L, E, C, F>,
        size: u32,
        spp: u64,
        seed: u64,
        proceed: impl Fn(u32) -> bool + Sync,
    ) -> Result<Image, Unfinished> {
        let size = [size; 2];
        let average = |points: Randomised<'_>| {
            view.render_points(size, seed, spp, |key| Ok(points(key)), &proceed)
        };
        match self {
            Self::MonteCarlo => {
                view.render_while(size, seed, |key| MonteCarlo::new(spp, key), &proceed)
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
