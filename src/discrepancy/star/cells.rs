//! Branch and bound over cells of corners: exact values and certified bounds in any dimension.

use super::cell::Cell;
use super::descent::Search;
use super::grid::Grid;
use crate::reduce;

/// Dimensions beyond which cells are not searched: the bits of a mask.
pub(super) const DIMENSIONS: usize = 64;

/// Cells that the search begins with, each a job of its own.
const JOBS: usize = 256;
/// Jobs that run before what they have found is told to the others. A constant, so that the search is the same on every
/// machine.
const WAVE: usize = 16;

/// What a search has found.
pub(super) struct Found {
    /// The largest excess of a corner, at least the one that the search was given.
    pub(super) lower: f64,
    /// The corner, if it is above the one that the search was given.
    pub(super) corner: Option<Vec<u32>>,
    /// No excess is above this one.
    pub(super) upper: f64,
    /// Whether that is as close as it was asked to be: the steps sufficed.
    pub(super) complete: bool,
    /// Steps taken.
    pub(super) work: u64,
}

/// Searches all corners for an excess above `lower`, leaving aside cells that cannot hold one above `lower + gap`, and all
/// that is left when `limit` steps are used up.
///
/// A cell is the set of corners between two. Some points are inside for all of them, some for none; the rest is
/// undecided, along one or several dimensions. A cell is halved until no corner in it can be better than the best
/// known; where no point is undecided along two dimensions, [`Separable`](super::separable::Separable) finds the best corner at
/// once.
///
/// For `n` points in a fixed dimension `d` this takes `O(n^(1 + d/2))` steps, whatever the points: each job begins with the
/// rule that is fast in practice, for which nothing is proved, and if it has not ended after `n^(1 + d/2)` steps begins
/// anew with the one for which this is proved. The number of jobs is bounded by a constant.
pub(super) fn search(grid: &Grid, lower: f64, gap: f64, limit: u64) -> Found {
    let mut found = Found {
        lower,
        corner: None,
        upper: lower,
        complete: true,
        work: 0,
    };
    let mut frontier = Search::new(grid, lower, gap, limit);
    let mut cells = vec![Cell::all(grid)];
    while !cells.is_empty() && cells.len() < JOBS {
        cells = cells
            .iter()
            .flat_map(|cell| frontier.halve(cell))
            .flatten()
            .collect();
    }
    found.take(&frontier);
    found.upper = found.upper.max(frontier.upper);
    cells.sort_by(|a, b| b.bound.total_cmp(&a.bound));
    let share =
        |found: &Found, jobs: usize| limit.saturating_sub(found.work) / jobs.clamp(1, WAVE) as u64;
    let mut given = share(&found, cells.len());
    while !cells.is_empty() {
        // For each cell that there were too few steps for, what no excess in it is above.
        let mut unfinished = Vec::with_capacity(cells.len());
        for wave in cells.chunks(WAVE) {
            let steps = share(&found, wave.len());
            let searches = reduce::each(wave.len() as u64, |job| {
                let cell = &wave[usize::try_from(job).expect("a cell is in memory")];
                within(grid, cell, found.lower, gap, steps)
            });
            searches.iter().for_each(|search| found.take(search));
            unfinished.extend(
                searches
                    .iter()
                    .map(|search| (!search.complete).then_some(search.upper)),
            );
        }
        cells = (cells.into_iter().zip(unfinished))
            .filter_map(|(cell, upper): (Cell, Option<f64>)| {
                let bound = cell.bound.min(upper?);
                Some(Cell { bound, ..cell })
            })
            .collect();
        // What the others have left goes to the jobs that had too little, as long as each gets twice as much.
        let next = share(&found, cells.len());
        if next / 2 < given.max(1) {
            break;
        }
        given = next;
    }
    let bounds = cells.iter().map(|cell| cell.bound);
    found.upper = bounds.fold(found.upper.max(found.lower), f64::max);
    found.complete = frontier.complete && found.upper <= found.lower + gap;
    found
}

/// Searches one cell, by the rule that is fast in practice first.
fn within<'a>(grid: &'a Grid, cell: &Cell, lower: f64, gap: f64, steps: u64) -> Search<'a> {
    let trial = trial(grid);
    let mut search = Search::new(grid, lower, gap, steps.min(trial));
    search.run(cell);
    if !search.complete && trial < steps {
        search.retry(cell, steps);
    }
    search
}

/// Steps that a job may take by the rule for which nothing is proved: `n^(1 + d/2)`.
fn trial(grid: &Grid) -> u64 {
    let power = u32::try_from(grid.dimensions() + 2).expect("few dimensions");
    let squared = (grid.count() as u128).saturating_pow(power);
    u64::try_from(squared.isqrt()).expect("the root of 128 bits has 64")
}

impl Found {
    fn take(&mut self, search: &Search<'_>) {
        self.work += search.work;
        if search.complete {
            self.upper = self.upper.max(search.upper);
        }
        if search.lower > self.lower {
            self.lower = search.lower;
            self.corner.clone_from(&search.corner);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrepancy::{Boundary, Points};
    use crate::points::{Halton, Independent, PointSet};

    /// The jobs are far from equal, and their shares of the steps are not wasted on those that need few.
    #[test]
    fn four_times_the_steps_taken_are_enough() {
        let sets: [&dyn PointSet; 2] = [&Halton::new(6).unwrap(), &Independent::new(1)];
        for set in sets {
            for (count, dimensions) in [(60, 3), (60, 4), (40, 6)] {
                let points = Points::from_set(set, 0..count, dimensions).unwrap();
                for boundary in [Boundary::Open, Boundary::Closed] {
                    let grid = Grid::new(&points, boundary);
                    let free = search(&grid, 0.0, 0.0, u64::MAX);
                    let bound = search(&grid, 0.0, 0.0, 4 * free.work);
                    assert!(free.complete && bound.complete, "{count} {dimensions}");
                    assert!(bound.work <= 4 * free.work);
                    assert_eq!(bound.lower, free.lower);
                }
            }
        }
    }
}
