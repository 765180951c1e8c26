//! A density that is constant in each of many cells of an interval.

use super::{Warp, coordinate};
use crate::Error;

/// A density on `[0, 1)` that is constant in each of equally wide cells.
///
/// A cell of weight zero is never hit. The cell is found in about the same time however many there are:[^chen] a sample keeps the order of its coordinate,
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
///
/// [^chen]: Chen, Hui-Chuan; Asau, Yoshinori (1974). *On Generating Random Variates from an Empirical Distribution*.
///     <https://doi.org/10.1080/05695557408974949>
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Piecewise {
    /// The distribution function at the ends of the cells, from 0 to 1.
    cumulative: Vec<f64>,
    /// For each of as many equal parts of `[0, 1)` as there are cells, how many ends lie in the parts before it; then the
    /// number of ends in all of them.
    guide: Vec<u32>,
}

impl Piecewise {
    /// The density whose value in cell `i` is proportional to `weights[i]`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no weights, for a weight that is negative or not finite, and if all are zero.
    pub fn new(weights: &[f64]) -> Result<Self, Error> {
        let largest = largest(weights)?;
        let cells = weights.len();
        if u32::try_from(cells).is_err() {
            return Err(Error::refused("number of weights", "below 2^32", cells));
        }
        let mut sum = 0.0;
        let mut cumulative = vec![0.0];
        for weight in weights {
            sum += weight / largest;
            cumulative.push(sum);
        }
        for end in &mut cumulative {
            *end /= sum;
        }
        let mut guide = vec![0; cells + 1];
        for &end in &cumulative[..cells] {
            guide[part(end, cells) + 1] += 1;
        }
        for place in 1..=cells {
            guide[place] += guide[place - 1];
        }
        Ok(Self { cumulative, guide })
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
    #[inline]
    pub(super) fn locate(&self, u: f64) -> (usize, f64) {
        self.locate_in(self.bracket(u), u)
    }

    /// The first of the ends that may be above `u`, and the one after the last. Ends in parts before that of `u` are below it, those in
    /// parts after it above.
    #[inline]
    pub(super) fn bracket(&self, u: f64) -> [u32; 2] {
        let part = part(u, self.cells());
        [self.guide[part], self.guide[part + 1]]
    }

    /// As [`locate`](Self::locate), with the [bracket](Self::bracket) of `u`.
    #[inline]
    pub(super) fn locate_in(&self, bracket: [u32; 2], u: f64) -> (usize, f64) {
        // The first end above u: the cell before it has room for u, so it is none of weight zero.
        let [first, last] = bracket.map(|end| end as usize);
        let within = match self.cumulative.get(first..first + FEW) {
            // Without branches. Ends past the last are above u, if that is below 1.
            Some(ends) if last - first <= FEW => {
                let below = ends.iter().filter(|&&end| end <= u).count();
                below.min(last - first)
            }
            _ => self.cumulative[first..last].partition_point(|&end| end <= u),
        };
        let cell = first + within - 1;
        let within = (u - self.cumulative[cell]) / self.probability(cell);
        (cell, coordinate(within))
    }

    /// The point of a cell.
    #[inline]
    pub(super) fn place(&self, cell: usize, within: f64) -> f64 {
        let cells = self.cells() as f64;
        let x = (cell as f64 + within) / cells;
        // Rounding must not carry it into the next cell, where the density may be zero.
        x.min(((cell + 1) as f64 / cells).next_down())
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

/// So many ends are compared at once.
const FEW: usize = 4;

/// Which of `parts` equal parts of `[0, 1)` a number lies in, up to rounding, which keeps the order; the last if the number
/// is 1.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "within the number of parts"
)]
fn part(u: f64, parts: usize) -> usize {
    ((u * parts as f64) as usize).min(parts - 1)
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
        self.place(cell, within)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{hash, unit};

    #[test]
    fn the_guide_leads_to_the_cell_that_bisection_finds() {
        for cells in [1, 2, 3, 7, 64, 1000] {
            // Many zeros, and a few cells that hold nearly everything.
            let weight = |cell| unit(hash(cells, cell)).mul_add(4.0, -2.0).max(0.0).powi(30);
            let weights: Vec<f64> = (0..cells).map(weight).chain([1e-3]).collect();
            let density = Piecewise::new(&weights).unwrap();
            let ends = density.cumulative.iter().copied();
            let others = (0..2000)
                .map(|k| unit(hash(1, k)))
                .chain([1.0_f64.next_down()]);
            for u in ends.filter(|&end| end < 1.0).chain(others) {
                let expected = density.cumulative.partition_point(|&end| end <= u) - 1;
                assert_eq!(density.locate(u).0, expected, "{cells} {u}");
            }
        }
    }
}
