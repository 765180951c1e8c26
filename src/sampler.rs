//! A point of the unit cube, read one coordinate at a time.

use rand::Rng;

use crate::hash::unit;
use crate::points::PointSet;

/// A point of the unit cube, read one coordinate at a time.
///
/// Every coordinate is in `[0, 1)`. An integrand reads as many as it needs: a function of the unit
/// square two, a light path of unknown length as many as it lives.
///
/// # Writing your own
///
/// ```
/// use estimand::Sampler;
///
/// /// Always the centre of the cube: what is left of an integrand without its randomness.
/// struct Centre;
///
/// impl Sampler for Centre {
///     fn next_1d(&mut self) -> f64 { 0.5 }
/// }
///
/// assert_eq!(Centre.next_2d(), [0.5, 0.5]);
/// ```
pub trait Sampler {
    /// The next coordinate, in `[0, 1)`.
    fn next_1d(&mut self) -> f64;

    /// The next two coordinates, each in `[0, 1)`.
    #[inline]
    fn next_2d(&mut self) -> [f64; 2] {
        [self.next_1d(), self.next_1d()]
    }

    /// Writes the next coordinates, each in `[0, 1)`: as many as `out` holds, those of [`next_1d`](Self::next_1d).
    #[inline]
    fn next_nd(&mut self, out: &mut [f64]) {
        for coordinate in out {
            *coordinate = self.next_1d();
        }
    }

    /// The next coordinates, each in `[0, 1)`: the same as an array, which a machine keeps in its registers.
    #[inline]
    fn next_array<const N: usize>(&mut self) -> [f64; N]
    where
        Self: Sized,
    {
        let mut coordinates = [0.0; N];
        self.next_nd(&mut coordinates);
        coordinates
    }
}

impl<S: Sampler + ?Sized> Sampler for &mut S {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        (**self).next_1d()
    }

    #[inline]
    fn next_2d(&mut self) -> [f64; 2] {
        (**self).next_2d()
    }

    #[inline]
    fn next_nd(&mut self, out: &mut [f64]) {
        (**self).next_nd(out);
    }
}

/// One point of a [`PointSet`], from its first dimension on; reading more than 2^32 - 1 coordinates panics.
///
/// Made by [`PointSet::point`]. An estimator may hand over coordinates that it has computed in a
/// block ([`with_prefix`](Self::with_prefix)); past them every coordinate is asked of the set. Which of
/// the two happens is not to be seen in the values.
#[derive(Debug)]
pub struct Cursor<'a, P: ?Sized> {
    points: &'a P,
    index: u64,
    /// What is left of the coordinates at hand.
    ahead: core::slice::Iter<'a, f64>,
    /// The dimension of the first coordinate past them.
    dimension: u32,
}

impl<'a, P: PointSet + ?Sized> Cursor<'a, P> {
    /// The point `index` of `points`, at its first dimension.
    #[inline]
    pub fn new(points: &'a P, index: u64) -> Self {
        Self::with_prefix(points, index, &[])
    }

    /// The same, with the coordinates of the first `prefix.len()` dimensions already at hand.
    ///
    /// `prefix` must hold what [`PointSet::fill`] writes for this point.
    #[inline]
    pub fn with_prefix(points: &'a P, index: u64, prefix: &'a [f64]) -> Self {
        Self {
            points,
            index,
            ahead: prefix.iter(),
            dimension: u32::try_from(prefix.len()).unwrap_or(u32::MAX),
        }
    }

    /// The same for a prefix of `width` coordinates.
    #[inline]
    pub(crate) fn with_row(points: &'a P, index: u64, row: &'a [f64], width: u32) -> Self {
        debug_assert_eq!(row.len(), width as usize);
        Self {
            points,
            index,
            ahead: row.iter(),
            dimension: width,
        }
    }

    /// The dimension that the next coordinate will be read from, which is the number read so far.
    pub fn dimension(&self) -> u32 {
        // As many as were counted in at the beginning.
        let left = u32::try_from(self.ahead.len()).unwrap_or(u32::MAX);
        self.dimension - left
    }

    /// Whether there are coordinates at hand that were not read.
    #[inline]
    pub(crate) fn is_behind(&self) -> bool {
        !self.ahead.as_slice().is_empty()
    }

    fn copy(&self) -> Self {
        Self {
            ahead: self.ahead.clone(),
            ..*self
        }
    }

    /// The next coordinates, some of them past those at hand, and the cursor after them.
    #[cold]
    #[inline(never)]
    fn across<const N: usize>(mut self) -> ([f64; N], Self) {
        (core::array::from_fn(|_| self.next_1d()), self)
    }

    /// The next coordinate past those at hand.
    #[inline]
    fn beyond(&mut self) -> f64 {
        let dimension = self.dimension;
        self.dimension = dimension
            .checked_add(1)
            .expect("a point has at most 2^32 - 1 coordinates");
        self.points.coordinate(self.index, dimension)
    }
}

impl<P: PointSet + ?Sized> Sampler for Cursor<'_, P> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        match self.ahead.next() {
            Some(&coordinate) => coordinate,
            None => self.beyond(),
        }
    }

    #[inline]
    fn next_2d(&mut self) -> [f64; 2] {
        let mut pair = [0.0; 2];
        self.next_nd(&mut pair);
        pair
    }

    /// One look at how many coordinates are at hand, not one for each.
    #[inline]
    fn next_nd(&mut self, out: &mut [f64]) {
        match self.ahead.as_slice().split_at_checked(out.len()) {
            Some((here, ahead)) => {
                out.copy_from_slice(here);
                self.ahead = ahead.iter();
            }
            None => out.fill_with(|| self.next_1d()),
        }
    }

    /// By value: through memory, what is read would straddle what was written just before, and wait for it.
    #[inline]
    fn next_array<const N: usize>(&mut self) -> [f64; N] {
        match self.ahead.as_slice().split_first_chunk() {
            Some((&here, ahead)) => {
                self.ahead = ahead.iter();
                here
            }
            None => {
                // Of a copy, so that a cursor that never comes here can live in registers.
                let coordinates;
                (coordinates, *self) = self.copy().across();
                coordinates
            }
        }
    }
}

/// A stream of independent uniform coordinates from any generator of the `rand` crates.
///
/// Each coordinate is the top 53 bits of one word, divided by 2^53: in `[0, 1)`, never `1.0`.
///
/// ```
/// use estimand::{Sampler, Stream};
/// use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};
///
/// let mut u = Stream(Xoshiro256PlusPlus::seed_from_u64(1));
/// assert!((0.0..1.0).contains(&u.next_1d()));
/// ```
#[derive(Clone, Debug)]
pub struct Stream<R>(pub R);

impl<R: Rng> Sampler for Stream<R> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        unit(self.0.next_u64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::Independent;

    struct Words(u64);

    impl rand::rand_core::TryRng for Words {
        type Error = core::convert::Infallible;
        fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
            Ok(0)
        }
        fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
            Ok(self.0)
        }
        fn try_fill_bytes(&mut self, _: &mut [u8]) -> Result<(), Self::Error> {
            Ok(())
        }
    }

    #[test]
    fn the_largest_word_of_a_generator_is_below_one() {
        assert_eq!(Stream(Words(u64::MAX)).next_1d(), 1.0 - f64::EPSILON / 2.0);
        assert_eq!(Stream(Words(0)).next_2d(), [0.0, 0.0]);
    }

    #[test]
    fn a_prefix_is_not_seen_in_the_values() {
        let points = Independent::new(3);
        let mut prefix = [0.0; 4];
        points.fill(9, 0..4, &mut prefix);
        let mut plain = points.point(9);
        let mut ahead = Cursor::with_prefix(&points, 9, &prefix);
        for _ in 0..8 {
            assert_eq!(plain.next_1d(), ahead.next_1d());
        }
        assert_eq!(ahead.dimension(), 8);
        // Within the prefix, across its end, and past it.
        let (mut plain, mut ahead) = (points.point(9), Cursor::with_prefix(&points, 9, &prefix));
        for _ in 0..3 {
            assert_eq!(plain.next_array::<3>(), ahead.next_array::<3>());
        }
        assert_eq!(ahead.dimension(), 9);
    }
}
