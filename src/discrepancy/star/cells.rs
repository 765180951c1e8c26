//! Branch and bound over cells of corners: exact values and certified bounds in any dimension.

use super::Boundary;
use super::grid::Grid;
use super::separable::Separable;
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
/// known; where no point is undecided along two dimensions, [`Separable`] finds the best corner at once.
pub(super) fn search(grid: &Grid, lower: f64, gap: f64, limit: u64) -> Found {
    let mut found = Found {
        lower,
        corner: None,
        upper: lower,
        complete: true,
        work: 0,
    };
    let mut frontier = Search::new(grid, lower, gap, u64::MAX);
    let mut cells = vec![Cell::all(grid)];
    while !cells.is_empty() && cells.len() < JOBS {
        cells = cells
            .iter()
            .flat_map(|cell| frontier.halve(cell))
            .flatten()
            .collect();
    }
    found.take(&frontier);
    cells.sort_by(|a, b| b.bound.total_cmp(&a.bound));
    for wave in cells.chunks(WAVE) {
        let left = limit.saturating_sub(found.work) / wave.len() as u64;
        let lower = found.lower;
        let searches = reduce::each(wave.len() as u64, |job| {
            let cell = &wave[usize::try_from(job).expect("a cell is in memory")];
            let mut search = Search::new(grid, lower, gap, left);
            search.run(cell);
            search
        });
        searches.iter().for_each(|search| found.take(search));
    }
    found.upper = found.upper.max(found.lower);
    found
}

impl Found {
    fn take(&mut self, search: &Search<'_>) {
        self.work += search.work;
        self.complete &= search.complete;
        self.upper = self.upper.max(search.upper);
        if search.lower > self.lower {
            self.lower = search.lower;
            self.corner.clone_from(&search.corner);
        }
    }
}

/// The corners from `low` to `high`, both included.
struct Cell {
    low: Vec<u32>,
    high: Vec<u32>,
    /// Points inside for all corners.
    sure: u32,
    undecided: Vec<Undecided>,
    /// No excess in the cell is above this one.
    bound: f64,
}

/// A point that is inside for some corners of a cell and not for others.
#[derive(Clone, Copy)]
struct Undecided {
    point: u32,
    /// The dimensions along which that is so.
    along: u64,
}

impl Cell {
    fn all(grid: &Grid) -> Self {
        let dimensions = grid.dimensions();
        let low = vec![grid.first(); dimensions];
        let high: Vec<u32> = (0..dimensions).map(|j| grid.last(j)).collect();
        let mut cell = Self {
            low,
            high,
            sure: 0,
            undecided: Vec::new(),
            bound: 1.0,
        };
        let count = u32::try_from(grid.count()).expect("fewer than 2^32 points");
        for point in 0..count {
            let row = grid.row(point);
            if (0..dimensions).any(|j| row[j] >= cell.high[j]) {
                continue;
            }
            let along = (0..dimensions)
                .filter(|&j| row[j] >= cell.low[j])
                .fold(0, |along, j| along | 1 << j);
            if along == 0 {
                cell.sure += 1;
            } else {
                cell.undecided.push(Undecided { point, along });
            }
        }
        cell
    }
}

/// A search of one cell, depth first.
struct Search<'a> {
    grid: &'a Grid,
    gap: f64,
    limit: u64,
    work: u64,
    lower: f64,
    corner: Option<Vec<u32>>,
    /// The largest bound of a cell that was left aside.
    upper: f64,
    /// Whether none was left aside for want of steps.
    complete: bool,
    /// The undecided points of all cells between the first one and the present one.
    stack: Vec<Undecided>,
    separable: Separable,
    /// Points undecided along a dimension and another one.
    crossing: Vec<u32>,
    pivots: Vec<u32>,
}

/// Where to halve a cell: the indices up to `index` along `dimension`, and those above.
#[derive(Clone, Copy)]
struct Cut {
    dimension: usize,
    index: u32,
}

impl<'a> Search<'a> {
    fn new(grid: &'a Grid, lower: f64, gap: f64, limit: u64) -> Self {
        Self {
            grid,
            gap,
            limit,
            work: 0,
            lower,
            corner: None,
            upper: f64::NEG_INFINITY,
            complete: true,
            stack: Vec::new(),
            separable: Separable::default(),
            crossing: vec![0; grid.dimensions()],
            pivots: Vec::new(),
        }
    }

    fn run(&mut self, cell: &Cell) {
        self.stack.clear();
        self.stack.extend_from_slice(&cell.undecided);
        let (mut low, mut high) = (cell.low.clone(), cell.high.clone());
        self.descend(&mut low, &mut high, cell.sure, 0);
    }

    /// The two halves of a cell, of which those are left out that need no search.
    fn halve(&mut self, cell: &Cell) -> [Option<Cell>; 2] {
        let (low, high) = (&cell.low, &cell.high);
        self.stack.clear();
        self.stack.extend_from_slice(&cell.undecided);
        let Some(cut) = self.examine(low, high, cell.sure, 0) else {
            return [None, None];
        };
        [false, true].map(|above| {
            let (mut low, mut high) = (cell.low.clone(), cell.high.clone());
            self.stack.truncate(cell.undecided.len());
            let sure = cell.sure + self.half(cut, above, 0..cell.undecided.len());
            if above {
                low[cut.dimension] = cut.index + 1;
            } else {
                high[cut.dimension] = cut.index;
            }
            let undecided = self.stack[cell.undecided.len()..].to_vec();
            let bound = self.bound(&low, &high, sure, undecided.len());
            Some(Cell {
                low,
                high,
                sure,
                undecided,
                bound,
            })
        })
    }

    fn bound(&self, low: &[u32], high: &[u32], sure: u32, undecided: usize) -> f64 {
        match self.grid.boundary() {
            Boundary::Open => self.grid.excess(self.grid.volume(high), sure),
            Boundary::Closed => {
                let undecided = u32::try_from(undecided).expect("fewer than 2^32 points");
                self.grid.excess(self.grid.volume(low), sure + undecided)
            }
        }
    }

    /// Searches a cell whose undecided points are those from `first` on of the stack.
    fn descend(&mut self, low: &mut [u32], high: &mut [u32], sure: u32, first: usize) {
        let Some(cut) = self.examine(low, high, sure, first) else {
            return;
        };
        let last = self.stack.len();
        // The half that promises more comes first: large open boxes, small closed ones.
        let above_first = self.grid.boundary() == Boundary::Open;
        for above in [above_first, !above_first] {
            let sure = sure + self.half(cut, above, first..last);
            let end = if above {
                &mut low[cut.dimension]
            } else {
                &mut high[cut.dimension]
            };
            let kept = core::mem::replace(end, cut.index + u32::from(above));
            self.descend(low, high, sure, last);
            if above {
                low[cut.dimension] = kept;
            } else {
                high[cut.dimension] = kept;
            }
            self.stack.truncate(last);
        }
    }

    /// Puts the undecided points of one half of a cell on the stack, and counts those that are now inside for sure.
    fn half(&mut self, cut: Cut, above: bool, points: core::ops::Range<usize>) -> u32 {
        let bit = 1 << cut.dimension;
        let mut sure = 0;
        for at in points {
            let Undecided { point, along } = self.stack[at];
            if along & bit == 0 {
                self.stack.push(Undecided { point, along });
                continue;
            }
            let below = self.grid.rank(point, cut.dimension) < cut.index + u32::from(above);
            let along = match (below, above) {
                // Inside for all indices above the cut.
                (true, true) => along & !bit,
                // Inside for no index up to the cut.
                (false, false) => continue,
                _ => along,
            };
            if along == 0 {
                sure += 1;
            } else {
                self.stack.push(Undecided { point, along });
            }
        }
        sure
    }

    /// Where to cut the cell; `None` if it is done with.
    fn examine(&mut self, low: &[u32], high: &[u32], sure: u32, first: usize) -> Option<Cut> {
        let undecided = self.stack.len() - first;
        self.work += (undecided + low.len()) as u64;
        let bound = self.bound(low, high, sure, undecided);
        let hopeless = bound <= self.lower + self.gap;
        if hopeless || self.work > self.limit {
            self.upper = self.upper.max(bound);
            self.complete &= hopeless;
            return None;
        }
        self.crossing.fill(0);
        for &Undecided { along, .. } in &self.stack[first..] {
            if !along.is_power_of_two() {
                let mut rest = along;
                while rest != 0 {
                    self.crossing[rest.trailing_zeros() as usize] += 1;
                    rest &= rest - 1;
                }
            }
        }
        let dimension = (0..low.len())
            .max_by_key(|&j| self.crossing[j])
            .expect("there is a dimension");
        if self.crossing[dimension] == 0 {
            self.solve(low, high, sure, first);
            return None;
        }
        // The median of the points in question: it is decided along this dimension in both halves.
        let bit = 1 << dimension;
        self.pivots.clear();
        for &Undecided { point, along } in &self.stack[first..] {
            if along & bit != 0 && !along.is_power_of_two() {
                self.pivots.push(self.grid.rank(point, dimension));
            }
        }
        let middle = self.pivots.len() / 2;
        let (_, &mut index, _) = self.pivots.select_nth_unstable(middle);
        Some(Cut { dimension, index })
    }

    fn solve(&mut self, low: &[u32], high: &[u32], sure: u32, first: usize) {
        self.separable.clear(low.len());
        for &Undecided { point, along } in &self.stack[first..] {
            let dimension = along.trailing_zeros() as usize;
            self.separable
                .push(dimension, self.grid.rank(point, dimension));
        }
        let best = self.separable.solve(self.grid, low, high, sure);
        self.work += ((self.stack.len() - first) as u64).pow(2) / 2;
        if best.excess > self.lower {
            self.lower = best.excess;
            self.corner = Some(self.separable.corner(best));
        }
    }
}
