//! The point sets of pixels, randomised anew in each.

use std::fmt;
use std::ops::Range;

use clap::ValueEnum;
use estimand::points::{
    BlueNoise, Halton, Hammersley, HashedOwen, Independent, MultiJittered, NRooks, Owen, PointSet,
    Rescrambled, Skipped, Sobol, Stratified, pixel,
};
use estimand::{Error, hash};

/// A point set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Points {
    /// Sobol's points, four dimensions at a time, dealt to the pixels so that the error is blue noise
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

    /// Whether some of `count` points can be taken now and the others later, with errors that the parts tell of. Any number can be taken of a
    /// sequence. Of the sets of a number of points blue noise alone has parts that are nearly as even.
    pub(crate) fn go_on(self, count: Option<u64>) -> bool {
        match self {
            Self::Sobol | Self::Rescrambled | Self::Halton | Self::Independent => true,
            Self::BlueNoise => {
                count.is_some_and(|count| count.is_power_of_two() && count <= 1 << 32)
            }
            Self::Hammersley | Self::MultiJittered | Self::Stratified | Self::NRooks => false,
        }
    }

    /// About `count` points for the pixel at `position` of an image that `seed` selects.
    pub(crate) fn of_pixel(
        self,
        position: [u32; 2],
        seed: u64,
        count: u64,
    ) -> Result<Box<dyn PointSet>, Error> {
        let key = pixel::seed(position, seed);
        Ok(match self {
            Self::BlueNoise => Box::new(BlueNoise::new(count, seed)?.pixel(position)),
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

    /// A part of about `count` points, and what comes after it. Only what is all of a finite set has a size: of that all is taken.
    pub(crate) fn of_part(
        self,
        position: [u32; 2],
        seed: u64,
        count: u64,
        part: Range<u64>,
    ) -> Result<Box<dyn PointSet>, Error> {
        let points = self.of_pixel(position, seed, count)?;
        let whole = points.size().is_none_or(|size| size <= part.end);
        Ok(match part.start {
            0 if whole => points,
            skip => Box::new(Skipped::new(points, skip)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_those_of_the_whole() {
        let in_parts = Points::value_variants()
            .iter()
            .filter(|points| points.go_on(Some(128)));
        for &points in in_parts {
            let whole = points.of_pixel([3, 4], 5, 128).unwrap();
            for part in [0..128, 0..64, 64..128] {
                let some = points.of_part([3, 4], 5, 128, part.clone()).unwrap();
                let all = part == (0..128) && points == Points::BlueNoise;
                assert_eq!(some.size(), all.then_some(128), "{points} {part:?}");
                for index in 0..3 {
                    let [one, other] = [
                        some.coordinate(index, 7),
                        whole.coordinate(part.start + index, 7),
                    ];
                    assert_eq!(one, other, "{points} {part:?}");
                }
            }
        }
    }
}
