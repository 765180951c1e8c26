//! Points in their strata, under the map.

use super::grid::{Axis, Grid, enter};
use super::squares::{Squares, add_up};
use crate::block::smaller;
use crate::integrands::Bin;
use crate::points::vectorised;
use crate::stratum::Run;

/// Numbers as large as this have no digits behind the point, and keep whole ones up to 2^51 in their lowest bits.
const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

/// What some points are moved to, and by how much the map stretches the cube there.
pub(super) struct Images<'a> {
    /// The bins of all axes, one axis after the other.
    bins: &'a [Bin],
    /// How many bins an axis has.
    number: usize,
    axes: Vec<Axis>,
    /// The bin that each coordinate of the points is in, of those of all axes, point after point; one past them all if it was not
    /// read.
    hits: Vec<u32>,
    /// What each of the points weighs.
    jacobians: Vec<f64>,
}

impl<'a> Images<'a> {
    /// In the `strata`, under the map of the `bins` of all axes, `number` to each.
    pub(super) fn new(strata: &Grid, bins: &'a [Bin], number: usize) -> Self {
        Self {
            bins,
            number,
            axes: strata.axes(number),
            hits: Vec::new(),
            jacobians: Vec::new(),
        }
    }

    /// Moves the points of `runs` from the unit cube to their images.
    pub(super) fn place(&mut self, runs: &[Run], rows: &mut [f64]) {
        let points = runs.last().map_or(0, |run| run.points.end);
        self.jacobians.resize(points, 1.0);
        self.hits.resize(points * self.axes.len(), 0);
        // Unrolled for the usual numbers of axes.
        vectorised(
            #[inline(always)]
            || match self.axes.len() {
                0 => {}
                1 => self.place_along(1, runs, rows),
                2 => self.place_along(2, runs, rows),
                3 => self.place_along(3, runs, rows),
                4 => self.place_along(4, runs, rows),
                5 => self.place_along(5, runs, rows),
                6 => self.place_along(6, runs, rows),
                7 => self.place_along(7, runs, rows),
                8 => self.place_along(8, runs, rows),
                axes => self.place_along(axes, runs, rows),
            },
        );
    }

    #[inline(always)]
    fn place_along(&mut self, width: usize, runs: &[Run], rows: &mut [f64]) {
        let most = WHOLE + (self.number - 1) as f64;
        let axes = &mut self.axes[..width];
        for run in runs {
            enter(run.stratum, axes);
            let all = run.points.start * width..run.points.end * width;
            let rows = rows[all.clone()].chunks_exact_mut(width);
            let hits = self.hits[all].chunks_exact_mut(width);
            let jacobians = &mut self.jacobians[run.points.clone()];
            for ((row, hits), jacobian) in rows.zip(hits).zip(jacobians) {
                let mut product = 1.0;
                for ((x, hit), axis) in row.iter_mut().zip(hits).zip(&*axes) {
                    let scaled = (axis.cell + *x) * axis.scale;
                    // Down to a whole number, which is in the lowest bits then: a conversion would check what cannot be. The very end
                    // of a bin may go to either of the two.
                    let shifted = smaller((scaled - 0.5) + WHOLE, most);
                    #[expect(clippy::cast_possible_truncation, reason = "below the number of bins")]
                    let place = shifted.to_bits() as u32;
                    *hit = axis.first + place;
                    let bin = &self.bins[*hit as usize];
                    *x = bin.image(scaled - (shifted - WHOLE));
                    product *= bin.jacobian;
                }
                *jacobian = product;
            }
        }
    }

    /// The coordinates of a point from that of the axis `read` on were not read: it weighs what the others make it.
    #[cold]
    pub(super) fn forget(&mut self, point: usize, read: usize) {
        let axes = self.axes.len();
        let unread = u32::try_from(self.bins.len()).unwrap_or(u32::MAX);
        self.hits[point * axes..][read..axes].fill(unread);
        let hits = &self.hits[point * axes..][..read];
        let jacobians = hits.iter().map(|&hit| self.bins[hit as usize].jacobian);
        self.jacobians[point] = jacobians.product();
    }

    /// What the points weigh.
    pub(super) fn jacobians(&self) -> &[f64] {
        &self.jacobians
    }

    /// Adds the square of each point to the `bins` that its coordinates are in.
    pub(super) fn add_up(&self, squares: &[f64], bins: &mut [Squares]) {
        add_up(bins, self.axes.len(), &self.hits, squares);
    }
}
