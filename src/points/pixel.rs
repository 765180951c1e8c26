//! Decorrelated coordinates for the pixels of an image, without any state.

use std::sync::LazyLock;

use super::Rescrambled;
use crate::hash::{hash, unit, unit_f32};

/// How many dimensions are scrambled together: a choice of a light and a point on it, or of a lobe and a direction, have
/// four at most.
const WIDTH: u32 = 4;

static POINTS: LazyLock<Rescrambled> =
    LazyLock::new(|| Rescrambled::new(WIDTH, 0).expect("Sobol' points have four dimensions"));

/// The seed of the pixel `pixel` of an image that `seed` selects: for any set that takes a seed.
///
/// ```
/// use estimand::points::{NRooks, pixel};
///
/// let points = NRooks::new(16, pixel::seed([3, 4], 1))?;
/// # Ok::<(), estimand::Error>(())
/// ```
#[inline]
pub fn seed(pixel: [u32; 2], seed: u64) -> u64 {
    let [x, y] = pixel.map(u64::from);
    hash(seed, x << 32 | y)
}

/// The coordinate `dimension` of the sample `sample` of a pixel, in `[0, 1)`: that of [`Rescrambled`] points in
/// groups of four dimensions, with a seed of the pixel's own.
///
/// Pixels are independent of one another; the samples of one, taken in powers of two, are nets. For the same
/// pixel over and over, [`reseeded`](Rescrambled::reseeded) points spare some hashing.
///
/// ```
/// use estimand::points::pixel;
///
/// let u = pixel::coordinate([3, 4], 0, 7, 1);
/// assert!((0.0..1.0).contains(&u));
/// ```
#[inline]
pub fn coordinate(pixel: [u32; 2], sample: u64, dimension: u32, seed: u64) -> f64 {
    unit(digits(pixel, sample, dimension, seed))
}

/// The same in single precision, truncated: in `[0, 1)`, never `1.0`, at most 2^-24 below the other.
#[inline]
pub fn coordinate_f32(pixel: [u32; 2], sample: u64, dimension: u32, seed: u64) -> f32 {
    unit_f32(digits(pixel, sample, dimension, seed))
}

#[inline]
fn digits(pixel: [u32; 2], sample: u64, dimension: u32, image: u64) -> u64 {
    POINTS.digits(seed(pixel, image), sample, dimension)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::PointSet;

    #[test]
    fn pixels_have_the_points_of_their_seed() {
        let points = Rescrambled::new(WIDTH, seed([5, 9], 3)).unwrap();
        for (sample, dimension) in [(0, 0), (17, 3), (u64::MAX, 4), (1 << 53, 101)] {
            let u = coordinate([5, 9], sample, dimension, 3);
            assert_eq!(u, points.coordinate(sample, dimension));
            let narrow = f64::from(coordinate_f32([5, 9], sample, dimension, 3));
            assert!(narrow <= u && u - narrow < f64::from(f32::EPSILON) / 2.0);
        }
    }

    #[test]
    fn pixels_are_uncorrelated() {
        // The mean over 4096 neighbours of the product of centred coordinates has a standard deviation of
        // 1 / 12 / 64 = 0.0013; 6 of them are exceeded with a probability of 2e-9 in each of the 8 cases.
        for dimension in 0..4 {
            for [dx, dy] in [[1, 0], [0, 1]] {
                let centred = |x, y| coordinate([x, y], 0, dimension, 1) - 0.5;
                let sum: f64 = (0..64)
                    .flat_map(|y| (0..64).map(move |x| (x, y)))
                    .map(|(x, y)| centred(x, y) * centred(x + dx, y + dy))
                    .sum();
                assert!((sum / 4096.0).abs() < 6.0 * 0.0013);
            }
        }
    }
}
