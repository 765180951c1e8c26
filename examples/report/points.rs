//! The point sets that pictures are rendered with.

use estimand::path::bsdf::Bsdf;
use estimand::path::filter::Filter;
use estimand::path::light::{Environment, Light};
use estimand::path::sensor::Sensor;
use estimand::path::{Image, Unfinished, View};
use estimand::points::{Halton, Hammersley, HashedOwen, NRooks, Owen, PointSet, Sobol, Stratified};
use estimand::{Average, MonteCarlo, hash};

/// A point set, randomised anew for every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Points {
    Plain,
    Stratified,
    NRooks,
    Halton,
    Hammersley,
    Sobol,
}

/// A point set for each seed, of one type for all: the loop over paths is compiled once for it.
type Randomised<'a> = &'a (dyn Fn(u64) -> Box<dyn PointSet> + Sync);

/// Where the well-spread dimensions end; paths that live longer go on with independent ones.
const DIMENSIONS: u32 = 32;

const VALID: &str = "the count is positive, the dimensions are few";

impl Points {
    pub(crate) const ALL: [Self; 6] = [
        Self::Plain,
        Self::Stratified,
        Self::NRooks,
        Self::Halton,
        Self::Hammersley,
        Self::Sobol,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain Monte Carlo",
            Self::Stratified => "stratified",
            Self::NRooks => "N-rooks",
            Self::Halton => "Halton, Owen",
            Self::Hammersley => "Hammersley, Owen",
            Self::Sobol => "Sobol', hashed Owen",
        }
    }

    /// A square picture with about `spp` samples per pixel.
    pub(crate) fn render<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter>(
        self,
        view: &View<B, L, E, C, F>,
        size: u32,
        spp: u64,
        seed: u64,
    ) -> Result<Image, Unfinished> {
        let size = [size; 2];
        let average =
            |points: Randomised<'_>| view.render(size, seed, |key| Average::new(points(key), spp));
        match self {
            Self::Plain => view.render(size, seed, |key| MonteCarlo::new(spp, key)),
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
