//! A density that is constant in each of many cells of a square.

use super::piecewise::largest;
use super::{Piecewise, Warp};
use crate::Error;

/// A density on the unit square that is constant in each cell of a regular grid: that of an image, for
/// instance.
///
/// The second coordinate is drawn from the sums of the rows, then the first from within the row. A cell or a
/// whole row of weight zero is never hit.
///
/// ```
/// use estimand::warp::{Piecewise2d, Warp};
///
/// let density = Piecewise2d::new(&[0.0, 1.0, 0.0, 3.0], 2)?;
/// assert_eq!(density.density([0.75, 0.75]), 3.0);
/// assert_eq!(density.density([0.25, 0.75]), 0.0);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Piecewise2d {
    rows: Vec<Option<Piecewise>>,
    marginal: Piecewise,
}

impl Piecewise2d {
    /// The density proportional to `weights`, row after row with `columns` cells each. The first row is that
    /// of the smallest second coordinates.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] as [`Piecewise::new`], and if the weights make no whole number of rows.
    pub fn new(weights: &[f64], columns: usize) -> Result<Self, Error> {
        if columns == 0 || !weights.len().is_multiple_of(columns) {
            return Err(Error::refused(
                "number of columns",
                "a divisor of the number of weights",
                columns,
            ));
        }
        let scale = largest(weights)?;
        let sums: Vec<f64> = weights
            .chunks_exact(columns)
            .map(|row| row.iter().map(|weight| weight / scale).sum())
            .collect();
        let rows = weights
            .chunks_exact(columns)
            .map(|row| Piecewise::new(row).ok())
            .collect();
        Ok(Self {
            rows,
            marginal: Piecewise::new(&sums)?,
        })
    }
}

/// A cell, and where in it, in `[0, 1)`.
#[cfg(feature = "path")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Place {
    pub(crate) column: usize,
    pub(crate) row: usize,
    pub(crate) within: [f64; 2],
}

#[cfg(feature = "path")]
impl Piecewise2d {
    /// The places that [`sample`](Warp::sample) draws, of `N` points or fewer, as many as there are places.
    ///
    /// Step by step for all of them, so that what one waits for in memory the others wait for at the same time.
    #[inline]
    pub(crate) fn locate<const N: usize>(&self, points: &[[f64; 2]; N], places: &mut [Place]) {
        let mut brackets = [[0; 2]; N];
        for ((&[u, v], place), bracket) in points.iter().zip(&mut *places).zip(&mut brackets) {
            (place.row, place.within[1]) = self.marginal.locate(v);
            if let Some(row) = &self.rows[place.row] {
                *bracket = row.bracket(u);
            }
        }
        for ((&[u, _], place), &bracket) in points.iter().zip(places).zip(&brackets) {
            let row = self.rows[place.row].as_ref();
            let found = row.map(|row| row.locate_in(bracket, u));
            (place.column, place.within[0]) = found.unwrap_or((0, 0.5));
        }
    }
}

impl Warp<2> for Piecewise2d {
    type Point = [f64; 2];

    #[inline]
    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (row, within) = self.marginal.locate(v);
        let y = self.marginal.place(row, within);
        // A row that is hit has weight; the middle is for rows whose weight vanished in the sum.
        let x = self.rows[row].as_ref().map_or(0.5, |row| row.sample([u]));
        [x, y]
    }

    #[inline]
    fn density(&self, [x, y]: [f64; 2]) -> f64 {
        let Some(row) = self.marginal.cell(y) else {
            return 0.0;
        };
        let within = self.rows[row].as_ref().map_or(0.0, |row| row.density(x));
        within * self.marginal.density(y)
    }

    fn invert(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let row = self.marginal.cell(y)?;
        let [u] = self.rows[row].as_ref()?.invert(x)?;
        let [v] = self.marginal.invert(y)?;
        Some([u, v])
    }
}
