//! An integrand in the cells of a grid.

use crate::block::smaller;
use crate::evaluate::Wide;
use crate::points::Independent;
use crate::recorder::Recorder;
use crate::stratum::{Look, Run, Visitor};
use crate::{Cursor, Integrand, Value};

/// An integrand in one cell of a grid after the other.
pub(super) struct Cell<'a, I> {
    /// How many cells there are along an axis.
    cells: u64,
    /// How long a cell is.
    side: f64,
    /// Which of them it is, axis by axis.
    corner: Vec<f64>,
    /// How many coordinates of a point are moved at once, those past the grid as well.
    width: usize,
    integrand: &'a I,
}

impl<'a, I: Integrand> Cell<'a, I> {
    /// `integrand` in a grid of `cells` along each of the first `axes` axes, for rows of `width` coordinates.
    pub(super) fn new(cells: u64, axes: u32, width: u32, integrand: &'a I) -> Self {
        Self {
            cells,
            side: 1.0 / cells as f64,
            corner: vec![0.0; axes as usize],
            width: width as usize,
            integrand,
        }
    }

    /// A coordinate of the whole axis moved to the `place`-th of its cells.
    #[inline]
    fn confine(&self, u: f64, place: f64) -> f64 {
        const ALMOST_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
        smaller(ALMOST_ONE, (place + u) * self.side)
    }

    fn enter(&mut self, stratum: usize) {
        let mut rest = stratum as u64;
        for place in &mut self.corner {
            *place = (rest % self.cells) as f64;
            rest /= self.cells;
        }
    }

    /// Moves points into the cell.
    #[inline(always)]
    fn confine_along(&self, axes: usize, rows: &mut [f64]) {
        let corner = &self.corner[..axes];
        for row in rows.chunks_exact_mut(self.width) {
            for (u, &place) in row[..axes].iter_mut().zip(corner) {
                *u = self.confine(*u, place);
            }
        }
    }
}

impl<I: Integrand> Visitor for Cell<'_, I> {
    type Value = Wide<I>;

    fn place(&mut self, runs: &[Run], rows: &mut [f64]) {
        for run in runs {
            self.enter(run.stratum);
            let rows = &mut rows[run.points.start * self.width..run.points.end * self.width];
            // Unrolled for the usual numbers of axes.
            match self.corner.len() {
                0 => {}
                1 => self.confine_along(1, rows),
                2 => self.confine_along(2, rows),
                3 => self.confine_along(3, rows),
                axes => self.confine_along(axes, rows),
            }
        }
    }

    #[inline]
    fn value(&mut self, _: usize, mut u: Cursor<'_, Independent>) -> Wide<I> {
        self.integrand.evaluate(&mut u).widen()
    }

    fn look(&mut self, _: usize, u: Cursor<'_, Independent>) -> Look<Wide<I>> {
        let mut coordinates = Vec::new();
        let value = self.integrand.evaluate(&mut Recorder {
            inner: u,
            coordinates: &mut coordinates,
        });
        Look {
            coordinates,
            value: value.widen(),
            weight: 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cube;

    #[test]
    fn points_are_moved_into_their_cell_and_no_further() {
        let f = cube(|x: [f64; 3]| x);
        let mut cell = Cell::new(7, 2, 3, &f);
        let run = Run {
            visit: 0,
            stratum: 2 + 7 * 6,
            points: 0..3,
        };
        let most = 1.0 - f64::EPSILON / 2.0;
        let mut rows = [0.0, 0.0, 0.25, 0.5, 0.5, 0.5, most, most, most];
        cell.place(&[run], &mut rows);
        let expected = [2.0, 6.0, 1.75, 2.5, 6.5, 3.5, 3.0, 7.0, 7.0].map(|x| x / 7.0);
        for (x, expected) in rows.into_iter().zip(expected) {
            assert!(
                (x - expected).abs() < 1e-15 && x < 1.0,
                "{x}, not {expected}"
            );
        }
    }
}
