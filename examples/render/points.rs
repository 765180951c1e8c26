//! The point sets of pixels, randomised anew in each.

use std::fmt;

use clap::ValueEnum;
use estimand::points::{
    BlueNoise, Halton, Hammersley, HashedOwen, Independent, MultiJittered, NRooks, Owen, PointSet,
    Rescrambled, Sobol, Stratified, pixel,
};
use estimand::{Error, hash};

/// A point set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Points {
    /// Sobol's points, two dimensions at a time, dealt to the pixels so that the error is blue noise
    BlueNoise,
    /// Sobol's points, Owen-scrambled by hashing
    Sobol,
    /// Sobol's points, four dimensions at a time, scrambled and shuffled for each
    Rescrambled,
    /// Halton's points, Owen-scrambled
    Halton,
    /// Hammersley's points, Owen-scrambled, with a random offset of the axis
    Hammersley,
    /// Correlated multi-jittered points
    MultiJittered,
    /// One point in every cell of a grid, in every pair of dimensions
    Stratified,
    /// N rooks: one point in every stratum of every dimension
    NRooks,
    /// Independent points: plain Monte Carlo
    Independent,
}

/// Dimensions of the sets that have a number of them: those of the paths that matter. Longer ones go on with independent
/// coordinates.
const DIMENSIONS: u32 = 32;

impl fmt::Display for Points {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.to_possible_value() {
            Some(value) => f.write_str(value.get_name()),
            None => Ok(()),
        }
    }
}

impl Points {
    /// Whether they come in powers of two.
    pub(crate) fn are_powers_of_two(self) -> bool {
        self == Self::BlueNoise
    }

    /// Whether they are a sequence that any number of points can be taken of, some now and some later.
    pub(crate) fn go_on(self) -> bool {
        match self {
            Self::Sobol | Self::Rescrambled | Self::Halton | Self::Independent => true,
            Self::BlueNoise
            | Self::Hammersley
            | Self::MultiJittered
            | Self::Stratified
            | Self::NRooks => false,
        }
    }

    /// Whether the halves of a set are as good as sets of that size: sequences, and blue noise.
    pub(crate) fn come_in_parts(self) -> bool {
        self.go_on() || self == Self::BlueNoise
    }

    /// About `count` points for the pixel at `position` of an image that `seed` selects.
    pub(crate) fn of_pixel(
        self,
        position: [u32; 2],
        seed: u64,
        count: u64,
    ) -> Result<Box<dyn PointSet>, Error> {
        match self {
            Self::BlueNoise => Ok(Box::new(BlueNoise::new(count, seed)?.pixel(position))),
            others => others.of_key(pixel::seed(position, seed), count),
        }
    }

    /// About `count` points that `key` selects, blue noise at the corner of its picture.
    pub(crate) fn of_key(self, key: u64, count: u64) -> Result<Box<dyn PointSet>, Error> {
        Ok(match self {
            Self::BlueNoise => Box::new(BlueNoise::new(count, key)?.pixel([0, 0])),
            Self::Sobol => Box::new(Sobol::new(DIMENSIONS)?.scrambled(HashedOwen { seed: key })),
            Self::Rescrambled => Box::new(Rescrambled::new(4, key)?),
            Self::Halton => Box::new(Halton::new(DIMENSIONS)?.scrambled(Owen { seed: key })),
            Self::Hammersley => {
                let offset = hash::unit(hash::hash(key, 0));
                let points = Hammersley::new(count, DIMENSIONS)?.offset(offset)?;
                Box::new(points.scrambled(Owen { seed: key }))
            }
            Self::MultiJittered => Box::new(MultiJittered::new(count, key)?),
            Self::Stratified => Box::new(Stratified::new(count, 2, key)?),
            Self::NRooks => Box::new(NRooks::new(count, key)?),
            Self::Independent => Box::new(Independent::new(key)),
        })
    }
}
