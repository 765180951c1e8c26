//! What the first samples of a picture say of its pixels.

use super::chessboard::{self, Board, COLOURS};
use super::dealing::{counts, powers};
use crate::Error;
use crate::path::Image;

/// How samples are to be dealt to the pixels of a picture, as its first ones show: more where values spread more.
///
/// A pixel that decides by its own samples whether it needs more of them stops where they happen to agree, and is too
/// dark on average where bright paths are rare.[^kirk] So the pixels are those of a chessboard, and each colour is dealt its half of all samples
/// by what the errors of the other colour's first samples are: no sample has a say in the number of its own pixel, nor in any of its colour, and the
/// picture has no bias, if the number in the mean is none that samples decide. It is the mean of all samples of a pixel, the first ones and those that
/// are added. Pixels nearby of unlike colours are not quite independent of one another: where one has met what is rare, the other has more samples.
///
/// No pixel gets more than 64 times the mean, since the first samples may have met what is rare; where almost all of a picture
/// is without error, samples may be left.
///
/// ```
/// use estimand::path::{Allocation, Image, scenes};
/// use estimand::points::Rescrambled;
/// use estimand::{Average, Estimator, Replicated};
///
/// let (view, size) = (scenes::cornell_box(), [16, 16]);
/// // Two sets of four points tell of the errors.
/// let points = Rescrambled::new(4, 1)?;
/// let first = view.render(size, 1, |key| {
///     Replicated::new(2, 4, move |seed| points.reseeded(seed)).seed(key)
/// })?;
/// let counts = Allocation::new(&first, 8)?.powers(64, 2);
/// // Rendered anew; it would do to go on.
/// let picture = Image::of_pixels(size, 2, |[x, y], key| {
///     let count = counts[(y * size[0] + x) as usize];
///     Average::new(points.reseeded(key), count).estimate(&view.pixel([x, y], size))
/// })?;
/// assert_eq!(picture.used(), counts.iter().sum::<u64>());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// [^kirk]: Kirk, David; Arvo, James (1991). *Unbiased Sampling Techniques for Image Synthesis*.
///     <https://doi.org/10.1145/122718.122735>
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Saved"))]
#[must_use]
pub struct Allocation {
    /// Of each colour in proportion to what its pixels' deviations are taken for: the largest is 1.
    deviations: [Vec<f64>; 2],
    board: Board,
    first: u64,
}

/// One that was saved, and may have been damaged.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Saved {
    deviations: [Vec<f64>; 2],
    board: Board,
    first: u64,
}

#[cfg(feature = "serde")]
impl TryFrom<Saved> for Allocation {
    type Error = &'static str;

    fn try_from(saved: Saved) -> Result<Self, Self::Error> {
        let Saved {
            deviations,
            board,
            first,
        } = saved;
        let pixels: usize = deviations.iter().map(Vec::len).sum();
        let Board { width, field } = board;
        let sound = width > 0 && field > 0 && first > 0;
        let whole = sound && pixels > 0 && pixels.is_multiple_of(width);
        let of_colour = |own: usize| (0..pixels).filter(move |&pixel| board.colour(pixel) == own);
        let fits = whole
            && COLOURS.map(|own| of_colour(own).count()) == deviations.each_ref().map(Vec::len);
        let in_range = |&deviation: &f64| deviation == 0.0 || (1e-300..=1.0).contains(&deviation);
        let sound = deviations.iter().flatten().all(in_range);
        match fits && sound {
            true => Ok(Self {
                deviations,
                board,
                first,
            }),
            false => Err("an allocation that is damaged"),
        }
    }
}

impl Allocation {
    /// As the standard errors of `picture` tell, which has `first` samples in each pixel. Those that are not finite tell nothing. If its paths were
    /// [reused](crate::path::Paths::reused_by), take [`of_groups`](Self::of_groups): pixels of both colours have samples in common.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a picture without standard errors, as [`Average`](crate::Average) makes it, and for no samples.
    pub fn new(picture: &Image, first: u64) -> Result<Self, Error> {
        Self::of_groups(picture, first, 1)
    }

    /// The same with fields of the chessboard that are `columns` wide, as many as pixels [go together](crate::path::Paths::columns_together) in, or a
    /// multiple of it: no sample has a say in the number of any pixel that uses it. A picture of one row that is no wider has one colour, and nobody to tell of it.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), and for no columns.
    pub fn of_groups(picture: &Image, first: u64, columns: u32) -> Result<Self, Error> {
        if columns == 0 {
            let what = "number of columns of a field";
            return Err(Error::refused(what, "at least 1", columns));
        }
        if first == 0 {
            return Err(Error::refused(
                "number of first samples",
                "at least 1",
                first,
            ));
        }
        let errors = picture.std_error().ok_or_else(|| {
            let what = "first picture of an adaptive one";
            Error::refused(what, "one with standard errors", "without any")
        })?;
        let squares = errors.pixels().iter().map(|error| error.length_squared());
        let squares: Vec<f64> = squares.collect();
        let board = Board {
            width: picture.width(),
            field: columns as usize,
        };
        let deviations = chessboard::deviations(&squares, board);
        Ok(Self::of(&deviations, board, first))
    }

    /// Pixels without a finite deviation are like the mean of the others; if all are zero, they tell nothing: then all pixels of a colour are alike.
    fn of(all: &[f64], board: Board, first: u64) -> Self {
        let deviations = COLOURS.map(|own| {
            let pixels = all.iter().enumerate();
            let pixels = pixels.filter(|&(pixel, _)| board.colour(pixel) == own);
            let mut deviations: Vec<f64> = pixels.map(|(_, &deviation)| deviation).collect();
            let finite = || deviations.iter().filter(|deviation| deviation.is_finite());
            let largest = finite().copied().fold(0.0, f64::max);
            let mean = finite().map(|deviation| deviation / largest).sum::<f64>()
                / finite().count() as f64;
            for deviation in &mut deviations {
                *deviation = match *deviation {
                    _ if largest == 0.0 => 1.0,
                    told if told.is_finite() => told / largest,
                    _ => mean,
                };
            }
            deviations
        });
        Self {
            deviations,
            board,
            first,
        }
    }

    /// The width and the height of the picture, in pixels.
    pub fn size(&self) -> [usize; 2] {
        let pixels: usize = self.deviations.iter().map(Vec::len).sum();
        [self.board.width, pixels / self.board.width]
    }

    /// How many samples each pixel gets, row by row, the first ones included, `mean` in the mean, but no pixel less than it has: in proportion to the
    /// standard deviation, which is best for the mean square error of the whole picture with independent samples. Deviations are
    /// uncertain, and taken to the power of 3/4.
    pub fn counts(&self, mean: u64) -> Vec<u64> {
        self.each(|deviations| counts(deviations, self.first, mean))
    }

    /// The same, but no pixel gets a single sample more than it has, which alone would tell of no error: of such pixels one in two gets two, and the
    /// others none.
    pub(super) fn counts_without_single_ones(&self, mean: u64) -> Vec<u64> {
        self.each(|deviations| {
            let mut counts = counts(deviations, self.first, mean);
            let single = |count: &&mut u64| **count - self.first == 1;
            for (which, count) in counts.iter_mut().filter(single).enumerate() {
                *count = self.first + which as u64 % 2 * 2;
            }
            counts
        })
    }

    /// The same for nets, which are best in powers of `radix` points: each number is one, the next to its share, so that it may be
    /// above the most by the root of the radix, and the mean of few pixels off by as much. If a pixel has no power of points, it gets
    /// the next one at least.
    ///
    /// The numbers go with a lower power of the deviation, 10/11: right where the variance falls as the number to the power of -6/5. That of
    /// three scenes fell as the powers from -1.1 to -1.2 between 64 and 256 samples a pixel.
    ///
    /// # Panics
    ///
    /// If the radix is below 2.
    pub fn powers(&self, mean: u64, radix: u32) -> Vec<u64> {
        assert!(radix >= 2, "a radix of {radix}");
        self.each(|deviations| powers(deviations, self.first, mean, radix))
    }

    /// What is dealt to each colour, in the order of the picture.
    fn each(&self, deal: impl Fn(&[f64]) -> Vec<u64>) -> Vec<u64> {
        let mut dealt = self.deviations.each_ref().map(|own| deal(own).into_iter());
        let pixels = 0..self.deviations.iter().map(Vec::len).sum();
        let mut next = |pixel| dealt[self.board.colour(pixel)].next();
        pixels
            .map(|pixel| next(pixel).expect("each colour has its pixels"))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The chessboard of single pixels.
    fn pixels_of(width: usize) -> Board {
        Board { width, field: 1 }
    }

    #[test]
    fn counts_follow_the_deviations() {
        // Every second one is of the same colour, in a row.
        let allocation = |deviations: &[f64], first| {
            let row: Vec<f64> = deviations.iter().flat_map(|&d| [d, 1.0]).collect();
            Allocation::of(&row, pixels_of(row.len()), first)
        };
        let of_colour = |counts: Vec<u64>| -> Vec<u64> { counts.into_iter().step_by(2).collect() };
        // 62 for eight parts.
        let counts = allocation(&[0.0, 1.0, 2.0, 5.0], 2).counts(16);
        assert_eq!(counts, [2, 16, 8, 16, 15, 16, 39, 16]);
        // None gets more than 64 times the mean: there is more for the others.
        let mut rare = vec![1e-9; 99];
        rare.push(1.0);
        let counts = of_colour(allocation(&rare, 1).counts(10));
        assert_eq!((counts[99], counts.iter().sum::<u64>()), (640, 1000));
        assert!(counts[..99].iter().all(|&count| count == 3 || count == 4));
        // What tells nothing.
        assert_eq!(
            Allocation::of(&[1.0, f64::NAN, 3.0, 1.0, f64::INFINITY], pixels_of(5), 1).deviations
                [0],
            [1.0 / 3.0, 1.0, 2.0 / 3.0]
        );
        for deviation in [0.0, 3.0, 1e-300, f64::INFINITY, f64::NAN] {
            let even = Allocation::of(&[deviation; 5], pixels_of(5), 1);
            assert_eq!(
                (even.counts(7), even.powers(8, 2)),
                (vec![7; 5], vec![8; 5])
            );
            assert_eq!(
                (even.counts(0), even.powers(1, 3)),
                (vec![1; 5], vec![1; 5])
            );
        }
        // All that there are, or more than are wanted, were first.
        for mean in [0, 5, 6] {
            let all = allocation(&[1.0, 2.0], 6);
            assert_eq!(
                (all.counts(mean), all.powers(mean, 2)),
                (vec![6; 4], vec![8; 4])
            );
        }
        for first in [1, u64::MAX] {
            let most = allocation(&[1.0, 2.0], first);
            for counts in [most.counts(u64::MAX), most.powers(u64::MAX, 2)] {
                assert!(
                    counts.iter().all(|&count| count >= u64::MAX / 2),
                    "{counts:?}"
                );
            }
        }
    }

    #[test]
    fn pictures_need_errors() {
        let pixels = || vec![glam::DVec3::ONE; 6];
        let image = Image::new(3, pixels()).unwrap();
        let error = Allocation::new(&image, 4).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the first picture of an adaptive one must be one with standard errors; it was without any"
        );
        let errors = Image::new(3, pixels()).unwrap();
        let image = image.with_std_error(errors).unwrap();
        assert_eq!(Allocation::new(&image, 4).unwrap().counts(7), [7; 6]);
        assert!(Allocation::new(&image, 0).is_err());
        assert!(Allocation::of_groups(&image, 4, 0).is_err());
    }

    /// As pictures are dealt, to the last count.
    #[test]
    fn no_pixel_has_a_say_in_the_counts_of_its_colour() {
        use crate::hash::{hash, unit};
        for (width, together) in [(6, 1), (7, 1), (7, 3), (16, 8)] {
            let field = together as usize;
            let board = Board { width, field };
            let pixels = width * 6;
            let dealt = |changed: Option<usize>| {
                let error = |pixel| match changed {
                    Some(one) if one == pixel => 1e9,
                    _ => unit(hash(2, pixel as u64)).exp2(),
                };
                let errors = (0..pixels).map(|pixel| glam::DVec3::splat(error(pixel)));
                let image = Image::new(width, vec![glam::DVec3::ONE; pixels]).unwrap();
                let errors = Image::new(width, errors.collect()).unwrap();
                let image = image.with_std_error(errors).unwrap();
                let allocation = Allocation::of_groups(&image, 3, together).unwrap();
                [
                    allocation.counts(50),
                    allocation.counts_without_single_ones(4),
                    allocation.powers(50, 2),
                ]
            };
            let before = dealt(None);
            for pixel in 0..pixels {
                let after = dealt(Some(pixel));
                assert_ne!(before, after);
                for (before, after) in before.iter().zip(&after) {
                    let mut both = before.iter().zip(after).enumerate();
                    let own = board.colour(pixel);
                    assert!(both.all(|(other, (a, b))| board.colour(other) != own || a == b));
                }
            }
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn what_is_saved_comes_back_unless_it_is_damaged() {
        let allocation = Allocation::of(&[1.0, 0.3, 0.0, 0.7, 0.2, 0.9], pixels_of(3), 4);
        assert_eq!(allocation.size(), [3, 2]);
        let saved = serde_json::to_string(&allocation).unwrap();
        assert_eq!(
            serde_json::from_str::<Allocation>(&saved).unwrap(),
            allocation
        );
        for (from, to) in [
            ("\"width\":3", "\"width\":0"),
            ("\"width\":3", "\"width\":4"),
            ("\"field\":1", "\"field\":0"),
            ("\"first\":4", "\"first\":0"),
            ("[1.0,", "[1.5,"),
            ("[1.0,", "[1e-310,"),
            ("[1.0,", "["),
        ] {
            assert!(saved.contains(from), "{saved}");
            let damaged = saved.replacen(from, to, 1);
            assert!(
                serde_json::from_str::<Allocation>(&damaged).is_err(),
                "{damaged}"
            );
        }
    }

    #[test]
    fn powers_keep_the_mean() {
        let steep = (0..4096).map(|i| (f64::from(i) / 500.0).exp()).collect();
        for deviations in [steep, vec![1.0; 4096], vec![0.0; 4096]] {
            let allocation = Allocation::of(&deviations, pixels_of(64), 1);
            for (mean, radix) in [(64, 2), (56, 2), (6, 2), (1, 2), (64, 3), (64, 101)] {
                let counts = allocation.powers(mean, radix);
                let radix = u64::from(radix);
                let is_power = |count: u64| radix.pow(count.ilog(radix)) == count;
                assert!(
                    counts.iter().all(|&count| is_power(count)),
                    "{mean} {radix}"
                );
                let (given, most) = (counts.iter().sum::<u64>(), counts.iter().max());
                // Half of the step that the pixel that is next would make, in each colour.
                let off = given.abs_diff(4096 * mean);
                let step = (radix - 1) * most.unwrap();
                // With a large radix a single pixel may take all.
                assert!(radix > 3 || off <= step, "{mean} {radix}: {given}");
            }
        }
    }

    /// The variance of a picture whose pixels have the given ones with a sample each.
    fn variance(deviations: &[f64], counts: &[u64], power: f64) -> f64 {
        let pixels = deviations.iter().zip(counts);
        pixels
            .map(|(deviation, &count)| deviation * deviation * (count as f64).powf(-power))
            .sum()
    }

    #[test]
    fn the_variance_is_near_the_least() {
        let deviations: Vec<f64> = (0..4096).map(|i| 1.0 + f64::from(i % 64)).collect();
        let allocation = Allocation::of(&deviations, pixels_of(64), 1);
        // Lagrange: the counts in proportion to the deviations to the power 2 / (1 + power).
        let least = |power: f64| {
            let shares = deviations.iter().map(|d| d.powf(2.0 / (1.0 + power)));
            let sum: f64 = shares.sum();
            (sum / (4096.0 * 64.0)).powf(power) * sum
        };
        let plain = variance(&deviations, &allocation.counts(64), 1.0) / least(1.0);
        assert!((1.0..1.02).contains(&plain), "{plain}");
        // Counts off by up to the root of two cost some 6 %.
        let nets = variance(&deviations, &allocation.powers(64, 2), 1.2) / least(1.2);
        assert!((1.0..1.08).contains(&nets), "{nets}");
        let even = variance(&deviations, &[64; 4096], 1.0) / least(1.0);
        assert!(even > 1.2, "{even}");
    }
}
