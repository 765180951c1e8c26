//! Where the points come from: one set or adaptor of sets a file.
//!
//! # Which one
//!
//! | set | count | dimensions | take it | leave it |
//! |---|---|---|---|---|
//! | [`Independent`] | any | any | as plain Monte Carlo with random access; for comparison | where any other helps |
//! | [`Stratified`] | a grid | pairs and the like | one to three dimensions, rough integrands | in many dimensions |
//! | [`NRooks`] | any | any | sums of functions of one coordinate | where coordinates act together |
//! | [`MultiJittered`] | a grid | pairs | pairs of coordinates, counts that are no power of two | where powers of two will do |
//! | [`OrthogonalArray`] | prime squares | to p + 1 | many dimensions that act in pairs | smooth integrands |
//! | [`VanDerCorput`] | any | 1 | an interval; to see how it works | |
//! | [`Halton`] | any | to 65536 | counts not known beforehand, few dimensions | plain past about eight dimensions |
//! | [`Hammersley`] | as made | to 65536 | a known count, few dimensions | when more points may be wanted |
//! | [`Faure`] | powers of its base | to 65536 | few dimensions, for comparison | nearly always: scrambled Sobol' is better |
//! | [`Sobol`] | powers of two | to 1024 or 21201 | smooth integrands in any dimension: the first to try, scrambled | odd counts |
//! | [`Lattice`] | as made | to 1024 | smooth, periodic integrands; shifted and folded, others too | integrands with jumps |
//! | [`LatticeSequence`] | powers of two | to 1024 | the same, count not known beforehand | integrands with jumps |
//! | [`Kronecker`] | any | to about five | cheap points for pictures and low dimensions | more dimensions |
//! | [`Rescrambled`] | powers of two | any | light paths of any length | a fixed number of dimensions that act together |
//! | [`BlueNoise`] | powers of two | any | images at few samples a pixel | when rendering may stop early |
//!
//! # Adaptors
//!
//! [`Shifted`] randomises any set, [`Folded`] makes integrands periodic, [`Padded`] takes the first dimensions from one set
//! and the rest from another, [`Skipped`] goes on where an estimate ended. The digits of nets are randomised by a scramble
//! that is part of the set's type; one that is not made for a set does not compile:
//!
//! | randomisation | for | what it is |
//! |---|---|---|
//! | [`DigitalShift`] | base 2, base b | one random number is added, digit by digit |
//! | [`DigitPermutation`] | base b | a random permutation at every place |
//! | [`LinearMatrix`] | base 2 | a random triangular matrix, then a digital shift |
//! | [`Owen`] | base 2, base b | a random permutation at every node of the tree of digits |
//! | [`HashedOwen`] | base 2 | nearly the same, in a few multiplications |
//!
//! [`pixel`] has coordinates for renderers, a pure function of pixel, sample, dimension and seed.
//!
//! # Past 2^53 points
//!
//! A coordinate has 53 binary digits at most, so that more points than that cannot all differ in it. Every index is valid all the
//! same:
//!
//! - [`Sobol`], [`Rescrambled`], [`LatticeSequence`] and [`Kronecker`] are computed in 64 digits and truncated to 53.
//! - [`VanDerCorput`], [`Lattice`] and the axis of [`Hammersley`] are rounded to the nearest number; [`Halton`], and
//!   [`Faure`], are within 2^-51 of the exact fraction, relatively.
//! - Of [`NRooks`], [`Stratified`] and [`MultiJittered`] the order of the strata is exact for every count, but with more than 2^52
//!   strata on an axis a point may be rounded into a neighbouring one.
//! - [`OrthogonalArray`] has about 2^48 points at most, [`BlueNoise`] 2^32 for each pixel; [`Independent`] has no structure to lose.
//!
//! # Writing your own
//!
//! Implement [`PointSet::coordinate`], and keep the laws that [`PointSet`] states; nothing else is needed.
//! See the example there.

use core::ops::Range;

use crate::Cursor;

mod block;
mod blue_noise;
mod digits;
mod faure;
mod finite;
mod folded;
mod halton;
mod hammersley;
mod independent;
mod kronecker;
mod lattice;
mod multi_jittered;
mod n_rooks;
mod orthogonal_array;
mod padded;
mod permutation;
pub mod pixel;
mod radical_inverse;
mod rescrambled;
mod scramble;
mod shifted;
mod skipped;
mod sobol;
mod strata;
mod stratified;
mod van_der_corput;

pub(crate) use block::vectorised;
pub use blue_noise::{BlueNoise, BlueNoisePixel};
pub use faure::Faure;
pub use folded::Folded;
pub use halton::Halton;
pub use hammersley::Hammersley;
pub use independent::Independent;
pub use kronecker::Kronecker;
pub use lattice::{Lattice, LatticeSequence};
pub use multi_jittered::MultiJittered;
pub use n_rooks::NRooks;
pub use orthogonal_array::OrthogonalArray;
pub use padded::Padded;
pub(crate) use permutation::permuted;
pub use radical_inverse::radical_inverse;
pub use rescrambled::Rescrambled;
pub use scramble::{
    BinaryScramble, Columns, DigitOrder, DigitPermutation, DigitScramble, DigitalShift, HashedOwen,
    LinearMatrix, Owen, Plain,
};
pub use shifted::Shifted;
pub use skipped::Skipped;
pub use sobol::{DIMENSIONS as SOBOL_DIMENSIONS, Sobol};
pub use stratified::Stratified;
pub use van_der_corput::VanDerCorput;

/// A sequence, or a finite set, of points of the unit cube.
///
/// A pure function of `(index, dimension)`: random access, no state. Replay, threads, decorrelated
/// pixels and independent replicates are all another index or another seed.
///
/// # Laws
///
/// - Every coordinate is in `[0, 1)`, never `1.0`, for every index up to [`u64::MAX`] and every dimension.
/// - The same arguments give the same coordinate.
/// - [`fill`](Self::fill) writes what [`coordinate`](Self::coordinate) returns, to the bit.
/// - Past [`size`](Self::size) and past [`dimensions`](Self::dimensions) coordinates are still in `[0, 1)`; what
///   they are is documented by each set. The sets of this crate continue with independent coordinates
///   past their last dimension, and with another randomisation past the size of a randomised set.
///
/// # Writing your own
///
/// ```
/// use estimand::{Average, Estimator, cube, points::PointSet};
///
/// /// The multiples of the golden ratio, modulo 1.
/// struct Golden;
///
/// impl PointSet for Golden {
///     fn coordinate(&self, index: u64, dimension: u32) -> f64 {
///         assert_eq!(dimension, 0, "the golden ratio makes one dimension");
///         let word = index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
///         estimand::hash::unit(word)
///     }
///     fn dimensions(&self) -> u32 { 1 }
/// }
///
/// let estimate = Average::new(Golden, 1000).estimate(&cube(|[x]| x * x))?;
/// assert!((estimate.mean - 1.0 / 3.0).abs() < 1e-3);
/// # Ok::<(), estimand::Error>(())
/// ```
pub trait PointSet: Sync {
    /// The coordinate `dimension` of the point `index`, in `[0, 1)`.
    fn coordinate(&self, index: u64, dimension: u32) -> f64;

    /// `Some(n)` if only all of the first `n` points together are what the set promises.
    fn size(&self) -> Option<u64> {
        None
    }

    /// `Some(b)` if the first points of an endless set are spread evenly where their number is a power of `b`, and less so
    /// in between; estimates of other numbers of them say so ([`Warning::NoPower`](crate::Warning::NoPower)).
    fn radix(&self) -> Option<u32> {
        None
    }

    /// In how many dimensions the set keeps its promise.
    fn dimensions(&self) -> u32 {
        u32::MAX
    }

    /// Writes the coordinates in `dimensions` of as many points, from `first` on, as fit into `out`: one point
    /// after the other, `dimensions.len()` numbers each.
    ///
    /// # Panics
    ///
    /// If the length of `out` is no multiple of the number of dimensions, or if an index would pass
    /// [`u64::MAX`].
    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        fill_singly(self, first, dimensions, out);
    }

    /// The point `index`, to be read coordinate by coordinate.
    fn point(&self, index: u64) -> Cursor<'_, Self>
    where
        Self: Sized,
    {
        Cursor::new(self, index)
    }
}

/// A pointer to a set is that set.
macro_rules! pointer {
    ($($pointer:ty),*) => {$(
        impl<P: PointSet + ?Sized> PointSet for $pointer {
            #[inline]
            fn coordinate(&self, index: u64, dimension: u32) -> f64 {
                (**self).coordinate(index, dimension)
            }

            fn size(&self) -> Option<u64> {
                (**self).size()
            }

            fn radix(&self) -> Option<u32> {
                (**self).radix()
            }

            fn dimensions(&self) -> u32 {
                (**self).dimensions()
            }

            fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
                (**self).fill(first, dimensions, out);
            }
        }
    )*};
}

pointer!(&P, Box<P>);

/// [`PointSet::fill`] without any preparation for a block.
fn fill_singly<P: PointSet + ?Sized>(
    points: &P,
    first: u64,
    dimensions: Range<u32>,
    out: &mut [f64],
) {
    for (index, row) in rows(first, &dimensions, out) {
        for (dimension, coordinate) in dimensions.clone().zip(row) {
            *coordinate = points.coordinate(index, dimension);
        }
    }
}

/// The rows of `out` that [`PointSet::fill`] writes, each with the index of its point.
///
/// # Panics
///
/// As [`PointSet::fill`] does.
fn rows<'a>(
    first: u64,
    dimensions: &Range<u32>,
    out: &'a mut [f64],
) -> impl Iterator<Item = (u64, &'a mut [f64])> {
    check(first, dimensions, out);
    (0..)
        .zip(out.chunks_exact_mut(dimensions.len().max(1)))
        .map(move |(row, out)| (first + row, out))
}

/// Refuses what [`PointSet::fill`] refuses.
fn check(first: u64, dimensions: &Range<u32>, out: &[f64]) {
    let width = dimensions.len();
    assert!(
        out.is_empty() || out.len().is_multiple_of(width),
        "fill: room for {} coordinates, no whole number of points of {width}",
        out.len()
    );
    let count = out.len().checked_div(width).unwrap_or(0) as u64;
    assert!(
        count == 0 || first.checked_add(count - 1).is_some(),
        "fill: {count} points from index {first} on pass the last index"
    );
}
