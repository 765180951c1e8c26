//! Rank-1 lattices.

use core::ops::Range;
use std::sync::Arc;

use super::block::{Block, vectorised};
use super::radical_inverse::ratio;
use super::{Independent, PointSet, fill_singly};
use crate::Error;
use crate::hash::unit;

mod construct;
mod fourier;

/// A rank-1 lattice: coordinate `d` of the point `index` is the fractional part of `index * z_d / count`.[^sloan]
///
/// All points together tile space. For integrands that are periodic the error falls the faster the smoother
/// they are; to have it so for others, and to have an error bar, [shift](super::Shifted) the lattice at random and
/// [fold](super::Folded) it. For integrands with jumps nets are the better choice.
///
/// The set is as good as its generating vector `z`: [`published`](Self::published) ones fit counts that are powers of two,
/// [`component_by_component`](Self::component_by_component) makes one for any count.
///
/// An index past the count has its place modulo the count. Dimensions past the vector's are independent hashed
/// coordinates. Coordinates are the numbers nearest to the exact fractions, or the largest below 1.
///
/// # Memory
///
/// 8 bytes for a dimension, shared by all clones.
///
/// ```
/// use estimand::points::{Lattice, PointSet};
///
/// // Fibonacci's lattice with 8 points.
/// let points = Lattice::new(8, &[1, 5])?;
/// let third = [points.coordinate(3, 0), points.coordinate(3, 1)];
/// assert_eq!(third, [3.0 / 8.0, 7.0 / 8.0]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^sloan]: Sloan, Ian; Joe, Stephen (1994). *Lattice Methods for Multiple Integration*. Oxford University Press.
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use]
pub struct Lattice {
    count: u64,
    vector: Arc<[u64]>,
}

/// The generating vector `lattice-33002-1024-1048576.9125` of Kuo's page, its first 1024 components.
const PUBLISHED: &str = include_str!("lattice/lattice-33002-1024-1048576.txt");

/// How many dimensions the published vector has.
const PUBLISHED_DIMENSIONS: u32 = 1024;

/// The first `dimensions` components of the published vector.
fn published(dimensions: u32) -> Result<Vec<u64>, Error> {
    if !(1..=PUBLISHED_DIMENSIONS).contains(&dimensions) {
        return Err(Error::refused(
            "number of lattice dimensions",
            "1 to 1024",
            dimensions,
        ));
    }
    Ok(PUBLISHED
        .split_whitespace()
        .take(dimensions as usize)
        .map(|component| component.parse().expect("the file holds numbers"))
        .collect())
}

impl Lattice {
    /// The lattice of `count` points with the generating vector `vector`, one component for each dimension.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points or an empty vector.
    pub fn new(count: u64, vector: &[u64]) -> Result<Self, Error> {
        if count == 0 {
            return Err(Self::refuse_none());
        }
        if vector.is_empty() {
            return Err(Error::refused(
                "generating vector",
                "a component for each dimension",
                "empty",
            ));
        }
        Ok(Self {
            count,
            vector: vector.iter().map(|component| component % count).collect(),
        })
    }

    fn refuse_none() -> Error {
        Error::refused("count of lattice points", "at least 1", 0)
    }

    /// The lattice of `count` points with a published vector for 2^10 to 2^20 points, in up to 1024
    /// dimensions.[^cools]
    ///
    /// Good at powers of two in that range; usable, without promise, at other counts.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points, no dimensions, or more than 1024.
    ///
    /// [^cools]: Cools, Ronald; Kuo, Frances; Nuyens, Dirk (2006). *Constructing embedded lattice rules for multivariate
    ///     integration*. <https://doi.org/10.1137/06065074X>. The file lattice-33002-1024-1048576.9125 of
    ///     <https://web.maths.unsw.edu.au/~fkuo/lattice/>.
    pub fn published(count: u64, dimensions: u32) -> Result<Self, Error> {
        Self::new(count, &published(dimensions)?)
    }

    /// A lattice of `count` points in `dimensions` dimensions, made here: each component in turn is the one that makes
    /// the squared worst-case error the smallest.[^rezt]
    ///
    /// The integrands meant are those with one square-integrable mixed derivative, averaged over random shifts; dimension `d`, from
    /// 1, has the weight `1 / d^2`. Of components that are equally good, to 10^-12 of the sum over the points, the
    /// smallest is taken.
    ///
    /// Where the count is a prime or a power of one, takes of the order of `dimensions * count * log(count)`
    /// operations[^nuyens] and some hundred bytes a point: millions of points are no trouble. For other counts
    /// `dimensions * count^2`: thousands of points.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points or no dimensions.
    ///
    /// [^nuyens]: Nuyens, Dirk; Cools, Ronald (2006). *Fast algorithms for component-by-component construction of rank-1
    ///     lattice rules in shift-invariant reproducing kernel Hilbert spaces*.
    ///     <https://doi.org/10.1090/S0025-5718-06-01785-6>
    ///
    /// [^rezt]: Sloan, Ian; Reztsov, Andrew (2002). *Component-by-component construction of good lattice rules*.
    ///     <https://doi.org/10.1090/S0025-5718-01-01342-4>
    pub fn component_by_component(count: u64, dimensions: u32) -> Result<Self, Error> {
        if dimensions == 0 {
            return Err(Error::refused(
                "number of lattice dimensions",
                "at least 1",
                dimensions,
            ));
        }
        if count == 0 {
            return Err(Self::refuse_none());
        }
        let length = usize::try_from(count).map_err(|_| {
            Error::refused("count of lattice points", "small enough for memory", count)
        })?;
        Self::new(count, &construct::components(length, dimensions))
    }
}

impl PointSet for Lattice {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let Some(&component) = self.vector.get(dimension as usize) else {
            return Independent::past(0).coordinate(index, dimension);
        };
        let product = u128::from(index % self.count) * u128::from(component);
        ratio(product % u128::from(self.count), self.count.into())
    }

    fn size(&self) -> Option<u64> {
        Some(self.count)
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "more components do not fit into a u32's count"
    )]
    fn dimensions(&self) -> u32 {
        self.vector.len() as u32
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        if self.count > 1 << 53 {
            return fill_singly(self, first, dimensions, out);
        }
        let block = Block::new(first, dimensions, out, self.dimensions(), 0);
        let Range { start, end } = block.dimensions;
        let steps = &self.vector[start.min(end) as usize..end as usize];
        let numerator = |&step: &u64| {
            let product = u128::from(first % self.count) * u128::from(step);
            u64::try_from(product % u128::from(self.count)).expect("below the count")
        };
        // From one point to the next every numerator goes on by its component, modulo the count.
        let mut numerators: Vec<u64> = steps.iter().map(numerator).collect();
        let (count, denominator) = (self.count, self.count as f64);
        vectorised(
            #[inline(always)]
            || {
                for row in block.out.chunks_exact_mut(block.width.max(1)) {
                    for ((u, numerator), step) in row.iter_mut().zip(&mut numerators).zip(steps) {
                        *u = *numerator as f64 / denominator;
                        let next = *numerator + step;
                        *numerator = if next < count { next } else { next - count };
                    }
                }
            },
        );
    }
}

/// A lattice sequence in base 2: coordinate `d` is the fractional part of `phi(index) * z_d`, where `phi` is the radical
/// inverse in base 2.[^hickernell]
///
/// The first `2^m` points are a [`Lattice`], and so is every aligned block of as many, shifted: so the count need not be
/// known beforehand. Take powers of two. The vector is the [published](Lattice::published) one, made for up to
/// 2^20 points; more are fresh points still, but not better distributed for their number.
///
/// Exact in 64 binary digits, of which a coordinate keeps the first 53, truncated; in each dimension the first 2^53 points
/// are distinct. Dimensions past those asked for are independent hashed coordinates.
///
/// # Memory
///
/// 8 bytes for a dimension, shared by all clones.
///
/// ```
/// use estimand::points::{LatticeSequence, PointSet};
///
/// let points = LatticeSequence::new(3)?;
/// assert_eq!(points.coordinate(1, 2), 0.5);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^hickernell]: Hickernell, Fred; Hong, Hee Sun; L'Ecuyer, Pierre; Lemieux, Christiane (2000). *Extensible Lattice
///     Sequences for Quasi-Monte Carlo Quadrature*. <https://doi.org/10.1137/S1064827599356638>
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use]
pub struct LatticeSequence {
    vector: Arc<[u64]>,
}

impl LatticeSequence {
    /// The sequence in `dimensions` dimensions.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no dimensions, or more than 1024.
    pub fn new(dimensions: u32) -> Result<Self, Error> {
        Ok(Self {
            vector: published(dimensions)?.into(),
        })
    }
}

impl PointSet for LatticeSequence {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        match self.vector.get(dimension as usize) {
            // As fractions of 2^64, whose products wrap at 1.
            Some(component) => unit(index.reverse_bits().wrapping_mul(*component)),
            None => Independent::past(0).coordinate(index, dimension),
        }
    }

    fn radix(&self) -> Option<u32> {
        Some(2)
    }

    #[expect(clippy::cast_possible_truncation, reason = "1024 at most")]
    fn dimensions(&self) -> u32 {
        self.vector.len() as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_vector_is_whole() {
        let vector = published(PUBLISHED_DIMENSIONS).unwrap();
        assert_eq!(vector.len(), 1024);
        assert!(vector.iter().all(|component| component % 2 == 1));
        assert!(published(1025).is_err() && published(0).is_err());
    }

    #[test]
    fn the_sequence_starts_with_the_lattice() {
        let (lattice, sequence) = (
            Lattice::published(64, 5).unwrap(),
            LatticeSequence::new(5).unwrap(),
        );
        for index in 0..64_u64 {
            let place = index.reverse_bits() >> 58;
            for dimension in 0..5 {
                assert_eq!(
                    sequence.coordinate(index, dimension),
                    lattice.coordinate(place, dimension)
                );
            }
        }
    }

    #[test]
    fn large_counts_are_exact() {
        let lattice = Lattice::new(u64::MAX, &[u64::MAX - 1]).unwrap();
        // index * (count - 1) is -index modulo the count.
        assert_eq!(lattice.coordinate(u64::MAX / 3, 0), 2.0 / 3.0);
        assert!(lattice.coordinate(1, 0) < 1.0);
    }

    #[test]
    fn construction_finds_the_best_in_two_dimensions() {
        // Of all vectors (1, z) with these weights, none has a smaller squared worst-case error. Fibonacci's are the
        // best for equal weights (Zaremba 1966), and still are here for 21 points: z = 8 or 13.
        let error = |vector: &[u64], count: u64| {
            let lattice = Lattice::new(count, vector).unwrap();
            (0..count)
                .map(|index| {
                    (1.0 + construct::bernoulli_2(lattice.coordinate(index, 0)))
                        * (1.0 + construct::bernoulli_2(lattice.coordinate(index, 1)) / 4.0)
                })
                .sum::<f64>()
        };
        for count in [21, 32, 55] {
            let built = Lattice::component_by_component(count, 2).unwrap();
            assert_eq!(built.vector[0], 1);
            for component in 1..count {
                if construct::coprime(component, count) {
                    assert!(error(&built.vector, count) <= error(&[1, component], count) + 1e-9);
                }
            }
        }
        let fibonacci = Lattice::component_by_component(21, 2).unwrap();
        assert_eq!(*fibonacci.vector, [1, 8]);
    }

    #[test]
    fn bad_arguments_are_refused() {
        assert!(Lattice::new(0, &[1]).is_err());
        assert!(Lattice::new(4, &[]).is_err());
        assert!(Lattice::component_by_component(0, 1).is_err());
        assert!(Lattice::component_by_component(4, 0).is_err());
        assert!(Lattice::component_by_component(1, 3).is_ok());
    }
}
