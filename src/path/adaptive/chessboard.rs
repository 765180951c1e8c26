//! What the pixels around one tell of it: those of the other colour, were the picture a chessboard.
//!
//! So no pixel has a say in what is told of its own colour, itself included.

/// The colours.
pub(super) const COLOURS: [usize; 2] = [0, 1];

/// A chessboard of the pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Board {
    /// How many pixels a row has.
    pub(super) width: usize,
    /// How many of them are a field.
    pub(super) field: usize,
}

impl Board {
    /// The colour of a pixel.
    pub(super) fn colour(self, pixel: usize) -> usize {
        let [row, column] = [pixel / self.width, pixel % self.width];
        (row + column / self.field) % 2
    }
}

/// The side of the squares of pixels that are taken together.
const SIDE: usize = 3;

/// How often the mean of the squares beside one another is taken: a standard deviation of the square root of 2 squares.
const BLURS: usize = 4;

/// The power of the deviations that is given for them.
const DAMPING: f64 = 0.75;

/// What the deviations of the pixels are to be taken for, row by row, up to a factor for each colour; `squares` are those of the errors of their
/// first samples, as they are estimated. What is not finite is not heeded; where nothing else is around, nor is what is told.
///
/// Few samples may have met what is rare, or missed it. So the root of the mean of the squares nearby, which is right where there
/// are enough samples and otherwise led by the one that met something, is moderated by the mean of the roots, which is not, in the geometric
/// mean of both. And that is taken to the power of 3/4: less than 1, because it is uncertain.
pub(super) fn deviations(squares: &[f64], board: Board) -> Vec<f64> {
    let width = board.width;
    let columns = width.div_ceil(SIDE);
    let square = |pixel: usize| pixel / width / SIDE * columns + pixel % width / SIDE;
    let told = COLOURS.map(|other| {
        let of_colour = squares.iter().enumerate();
        let of_colour = of_colour.filter(|&(pixel, _)| board.colour(pixel) == other);
        let known = of_colour.filter(|(_, square)| square.is_finite());
        let mut table = vec![[0.0; 3]; columns * (squares.len() / width).div_ceil(SIDE)];
        for (pixel, value) in known {
            let [mean_square, mean, count] = &mut table[square(pixel)];
            *mean_square += value;
            *mean += value.sqrt();
            *count += 1.0;
        }
        blur(&mut table, columns, BLURS);
        let moderated = table.iter().map(|[mean_square, mean, count]| {
            ((mean_square / count).sqrt() * (mean / count))
                .sqrt()
                .powf(DAMPING)
        });
        moderated.collect::<Vec<_>>()
    });
    let pixels = 0..squares.len();
    let deviation = |pixel| told[1 - board.colour(pixel)][square(pixel)];
    pixels.map(deviation).collect()
}

/// Takes the mean of each entry and those beside it, with half the weight each, along rows and columns of a table, several times.
/// What would be outside is as what is at the edge.
fn blur(table: &mut [[f64; 3]], columns: usize, times: usize) {
    let rows = table.len() / columns;
    for _ in 0..times {
        for row in table.chunks_exact_mut(columns) {
            smooth(row, 1);
        }
        for column in 0..columns {
            smooth(&mut table[column..][..(rows - 1) * columns + 1], columns);
        }
    }
}

/// The same along one line of it.
fn smooth(line: &mut [[f64; 3]], stride: usize) {
    let last = line.len() - 1;
    let mut before = line[0];
    for place in (0..line.len()).step_by(stride) {
        let own = line[place];
        let after = line[(place + stride).min(last)];
        line[place] = core::array::from_fn(|k| 0.25 * before[k] + 0.5 * own[k] + 0.25 * after[k]);
        before = own;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{hash, unit};

    /// That of single pixels.
    fn pixels_of(width: usize) -> Board {
        Board { width, field: 1 }
    }

    #[test]
    fn fields_are_as_wide_as_they_are_said_to_be() {
        let colours = |field| -> Vec<_> {
            let board = Board { width: 5, field };
            (0..10).map(|pixel| board.colour(pixel)).collect()
        };
        assert_eq!(colours(1), [0, 1, 0, 1, 0, 1, 0, 1, 0, 1]);
        assert_eq!(colours(2), [0, 0, 1, 1, 0, 1, 1, 0, 0, 1]);
        assert_eq!(colours(9), [0, 0, 0, 0, 0, 1, 1, 1, 1, 1]);
    }

    #[test]
    fn what_is_even_stays() {
        for [width, height] in [[2, 1], [7, 1], [1, 8], [30, 20]] {
            let mut squares = vec![4.0; width * height];
            let even = |squares: &[f64]| {
                let found = deviations(squares, pixels_of(width));
                let expected = 2_f64.powf(0.75);
                assert!(found.iter().all(|d| (d / expected - 1.0).abs() < 1e-14));
            };
            even(&squares);
            if width * height > 100 {
                for (pixel, unknown) in [(0, f64::INFINITY), (77, f64::NAN)] {
                    squares[pixel] = unknown;
                }
                even(&squares);
            }
        }
        // There is no other.
        assert!(deviations(&[4.0], pixels_of(1))[0].is_nan());
    }

    #[test]
    fn what_stands_out_is_moderated() {
        let width = 300;
        let mut squares = vec![0.0; width * width];
        let pixel = |x: usize, y: usize| y * width + x;
        // In the middle of a square, which has five pixels of that colour; those beside it have four.
        squares[pixel(151, 151)] = 1.0;
        let found = deviations(&squares, pixels_of(width));
        // Binomial weights, of eight coins along each axis. The count is what it is in the mean, up to a tenth of a pixel.
        let middle = 70.0 / 256.0;
        let mean = middle * middle / 4.5;
        let expected = (f64::sqrt(mean) * mean).powf(0.375);
        let ratio = found[pixel(150, 151)] / expected;
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
        // Pixels of its colour are told by those of the other one.
        assert_eq!(found[pixel(151, 151)], 0.0);
        // Five squares off it tells nothing.
        assert!(found[pixel(163, 150)] > 0.0);
        assert_eq!(found[pixel(166, 151)], 0.0);
    }

    #[test]
    fn no_pixel_has_a_say_in_its_colour() {
        let (width, height) = (13, 8);
        let of_seed = |seed, pixel: usize| unit(hash(seed, pixel as u64)).exp2();
        let squares: Vec<f64> = (0..width * height).map(|k| of_seed(1, k)).collect();
        for field in [1, 4, 13] {
            let board = Board { width, field };
            let before = deviations(&squares, board);
            for pixel in 0..squares.len() {
                let mut changed = squares.clone();
                changed[pixel] = 1e30;
                let after = deviations(&changed, board);
                for (other, (a, b)) in before.iter().zip(&after).enumerate() {
                    let alike = board.colour(other) == board.colour(pixel);
                    assert!(!alike || a.to_bits() == b.to_bits(), "{pixel} {other}");
                }
                assert_ne!(before, after);
            }
        }
    }
}
