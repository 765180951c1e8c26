//! A density that is constant in each of many cells of an interval.

use super::{Warp, coordinate};
use crate::Error;

/// A density on `[0, 1)` that is constant in each of equally wide cells.
///
/// A cell of weight zero is never hit. The cell is found by bisection; a sample keeps the order of its coordinate,
/// so that well spread points stay so. For choices without order [`AliasTable`](super::AliasTable) is faster.
///
/// ```
/// use estimand::warp::{Piecewise, Warp};
///
/// let density = Piecewise::new(&[1.0, 0.0, 3.0])?;
/// assert_eq!(density.sample([0.25]), 2.0 / 3.0);
/// assert_eq!(density.density(0.9), 9.0 / 4.0);
/// assert_eq!(density.density(0.5), 0.0);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Piecewise {
    /// The distribution function at the ends of the cells, from 0 to 1.
    cumulative: Vec<f64>,
}

impl Piecewise {
    /// The density whose value in cell `i` is proportional to `weights[i]`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no weights, for a weight that is negative or not finite, and if all are zero.
    pub fn new(weights: &[f64]) -> Result<Self, Error> {
        let largest = largest(weights)?;
        let mut sum = 0.0;
        let mut cumulative = vec![0.0];
        for weight in weights {
            sum += weight / largest;
            cumulative.push(sum);
        }
        for end in &mut cumulative {
            *end /= sum;
        }
        Ok(Self { cumulative })
    }

    /// How many cells there are.
    pub fn cells(&self) -> usize {
        self.cumulative.len() - 1
    }

    /// The probability of the cell `cell`.
    ///
    /// # Panics
    ///
    /// If there is no such cell.
    pub fn probability(&self, cell: usize) -> f64 {
        self.cumulative[cell + 1] - self.cumulative[cell]
    }

    /// The cell that `u` falls into, and where in the cell, in `[0, 1)`.
    pub(super) fn locate(&self, u: f64) -> (usize, f64) {
        // The first end above u: the cell before it has room for u, so it is none of weight zero.
        let cell = self.cumulative.partition_point(|&end| end <= u) - 1;
        let within = (u - self.cumulative[cell]) / self.probability(cell);
        (cell, coordinate(within))
    }

    /// The cell of a point in `[0, 1)`; `None` outside.
    pub(super) fn cell(&self, x: f64) -> Option<usize> {
        let cells = self.cells();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the number of cells"
        )]
        let cell = (x * cells as f64) as usize;
        (0.0..1.0).contains(&x).then(|| cell.min(cells - 1))
    }
}

/// The largest of weights that make a distribution.
pub(super) fn largest(weights: &[f64]) -> Result<f64, Error> {
    if let Some(&weight) = weights
        .iter()
        .find(|&&weight| !(0.0..f64::INFINITY).contains(&weight))
    {
        return Err(Error::refused("weight", "finite and not negative", weight));
    }
    let largest = weights.iter().copied().fold(0.0, f64::max);
    if largest > 0.0 {
        Ok(largest)
    } else {
        let domain = "at least one above zero";
        Err(Error::refused(
            "weights",
            domain,
            format!("{} of zero", weights.len()),
        ))
    }
}

impl Warp<1> for Piecewise {
    type Point = f64;

    #[inline]
    fn sample(&self, [u]: [f64; 1]) -> f64 {
        let (cell, within) = self.locate(u);
        let cells = self.cells() as f64;
        let x = (cell as f64 + within) / cells;
        // Rounding must not carry it into the next cell, where the density may be zero.
        x.min(((cell + 1) as f64 / cells).next_down())
    }

    #[inline]
    fn density(&self, x: f64) -> f64 {
        self.cell(x)
            .map_or(0.0, |cell| self.probability(cell) * self.cells() as f64)
    }

    fn invert(&self, x: f64) -> Option<[f64; 1]> {
        let cell = self.cell(x)?;
        let within = x * self.cells() as f64 - cell as f64;
        Some([coordinate(
            self.cumulative[cell] + within * self.probability(cell),
        )])
    }
}
