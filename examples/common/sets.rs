//! Point sets by name, as the programs' command lines have them.

use std::fmt;

use clap::{Args, ValueEnum};
use estimand::Error;
use estimand::points::{
    DigitPermutation, DigitalShift, Faure, Halton, Hammersley, HashedOwen, Independent, Kronecker,
    Lattice, LinearMatrix, MultiJittered, NRooks, OrthogonalArray, Owen, PointSet, Shifted, Sobol,
    Stratified, VanDerCorput,
};

/// The sets that a program can be told to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Set {
    Independent,
    Stratified,
    NRooks,
    MultiJittered,
    OrthogonalArray,
    VanDerCorput,
    Halton,
    Hammersley,
    Faure,
    Sobol,
    Lattice,
    Kronecker,
}

/// How a set is randomised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Scramble {
    /// Not at all, where the set is not random of itself
    None,
    /// A random shift modulo 1, for any set
    Shift,
    /// A random number is added digit by digit
    DigitalShift,
    /// A random permutation of the digits at every place
    DigitPermutation,
    /// A random triangular matrix and a digital shift
    LinearMatrix,
    /// Nested uniform scrambling
    Owen,
    /// Nested scrambling by a fast hash
    HashOwen,
}

/// The name on the command line.
fn name(value: &impl ValueEnum) -> String {
    value
        .to_possible_value()
        .map_or_else(String::new, |value| value.get_name().to_owned())
}

impl fmt::Display for Set {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&name(self))
    }
}

impl fmt::Display for Scramble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&name(self))
    }
}

/// How a set is randomised. Its name is each program's own argument.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Choice {
    /// How the points are randomised
    #[arg(long, value_enum, default_value_t = Scramble::None)]
    pub(crate) scramble: Scramble,
    /// What selects the randomisation, and the points of sets that are random of themselves
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
}

impl Choice {
    /// The set `set` of about `count` points in `dimensions` dimensions.
    ///
    /// A set that only has a meaning as a whole tells by its size how many points that are.
    ///
    /// # Errors
    ///
    /// What the set refuses; a scramble that is not made for the set.
    pub(crate) fn build(
        self,
        set: Set,
        dimensions: u32,
        count: u64,
    ) -> Result<Box<dyn PointSet>, Error> {
        let Self { scramble, seed } = self;
        match set {
            Set::Independent => self.shiftable(set, Independent::new(seed)),
            Set::Stratified => self.shiftable(set, Stratified::new(count, dimensions, seed)?),
            Set::NRooks => self.shiftable(set, NRooks::new(count, seed)?),
            Set::MultiJittered => self.shiftable(set, MultiJittered::new(count, seed)?),
            Set::OrthogonalArray => {
                self.shiftable(set, OrthogonalArray::new(count, dimensions, seed)?)
            }
            Set::VanDerCorput if dimensions != 1 => Err(Error::refused(
                "number of dimensions",
                "1 for van-der-corput",
                dimensions,
            )),
            Set::VanDerCorput => self.shiftable(set, VanDerCorput::new(2)?),
            // The published vector is made for powers of two. Others are found soon enough for few points.
            Set::Lattice if !count.is_power_of_two() && count <= 1 << 13 && dimensions <= 1024 => {
                self.shiftable(set, Lattice::component_by_component(count, dimensions)?)
            }
            Set::Lattice => self.shiftable(set, Lattice::published(count, dimensions)?),
            Set::Kronecker => self.shiftable(set, Kronecker::r(dimensions)?),
            Set::Sobol => {
                let sobol = Sobol::new(dimensions)?;
                Ok(match scramble {
                    Scramble::None => Box::new(sobol),
                    Scramble::Shift => Box::new(Shifted::new(sobol, seed)),
                    Scramble::DigitalShift => Box::new(sobol.scrambled(DigitalShift { seed })),
                    Scramble::LinearMatrix => Box::new(sobol.scrambled(LinearMatrix { seed })),
                    Scramble::Owen => Box::new(sobol.scrambled(Owen { seed })),
                    Scramble::HashOwen => Box::new(sobol.scrambled(HashedOwen { seed })),
                    Scramble::DigitPermutation => return Err(self.no_pair(set)),
                })
            }
            Set::Halton => {
                let halton = Halton::new(dimensions)?;
                self.digits(set, halton, |halton, scramble| match scramble {
                    Digits::Shift(scramble) => Box::new(halton.scrambled(scramble)),
                    Digits::Permutation(scramble) => Box::new(halton.scrambled(scramble)),
                    Digits::Owen(scramble) => Box::new(halton.scrambled(scramble)),
                })
            }
            Set::Faure => {
                let faure = Faure::new(dimensions)?;
                self.digits(set, faure, |faure, scramble| match scramble {
                    Digits::Shift(scramble) => Box::new(faure.scrambled(scramble)),
                    Digits::Permutation(scramble) => Box::new(faure.scrambled(scramble)),
                    Digits::Owen(scramble) => Box::new(faure.scrambled(scramble)),
                })
            }
            Set::Hammersley => {
                let hammersley = Hammersley::new(count, dimensions)?;
                self.digits(set, hammersley, |hammersley, scramble| match scramble {
                    Digits::Shift(scramble) => Box::new(hammersley.scrambled(scramble)),
                    Digits::Permutation(scramble) => Box::new(hammersley.scrambled(scramble)),
                    Digits::Owen(scramble) => Box::new(hammersley.scrambled(scramble)),
                })
            }
        }
    }

    /// A set that can be shifted and nothing else.
    fn shiftable(
        self,
        set: Set,
        points: impl PointSet + 'static,
    ) -> Result<Box<dyn PointSet>, Error> {
        match self.scramble {
            Scramble::None => Ok(Box::new(points)),
            Scramble::Shift => Ok(Box::new(Shifted::new(points, self.seed))),
            _ => Err(self.no_pair(set)),
        }
    }

    /// A set whose digits, in any base, can be scrambled: `build` does it.
    fn digits<P: PointSet + 'static>(
        self,
        set: Set,
        points: P,
        build: impl FnOnce(P, Digits) -> Box<dyn PointSet>,
    ) -> Result<Box<dyn PointSet>, Error> {
        let seed = self.seed;
        let scramble = match self.scramble {
            Scramble::DigitalShift => Digits::Shift(DigitalShift { seed }),
            Scramble::DigitPermutation => Digits::Permutation(DigitPermutation { seed }),
            Scramble::Owen => Digits::Owen(Owen { seed }),
            _ => return self.shiftable(set, points),
        };
        Ok(build(points, scramble))
    }

    fn no_pair(self, set: Set) -> Error {
        let domain = match set {
            Set::Sobol => {
                "none, shift, digital-shift, linear-matrix, owen or hash-owen for this set"
            }
            Set::Halton | Set::Hammersley | Set::Faure => {
                "none, shift, digital-shift, digit-permutation or owen for this set"
            }
            _ => "none or shift for this set",
        };
        Error::refused("scramble", domain, self.scramble)
    }
}

/// A randomisation of digits in any base.
enum Digits {
    Shift(DigitalShift),
    Permutation(DigitPermutation),
    Owen(Owen),
}
