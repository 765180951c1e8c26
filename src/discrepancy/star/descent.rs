//! Branch and bound within one cell of corners, depth first.

use super::Boundary;
use super::cell::{Cell, Undecided};
use super::grid::Grid;
use super::separable::Separable;

/// Along which dimension a cell is halved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    /// The one along which most of the points are undecided that are so along another one as well.
    Busiest,
    /// The partition of Dobkin, Eppstein and Mitchell:[^dobkin] the first one along which more than `s = sqrt n` points
    /// are undecided, or a point that is so along an earlier one as well.
    ///
    /// A halving decides the point at which it is made, and shares the others undecided along its dimension between the halves,
    /// as evenly as can be. So under one cell that is done with along the dimensions before `j`, counted from 0, there are at
    /// most `j s` halvings for the points undecided along those as well, and `2 n / (s + 1)` for their number: at most
    /// `1 + (j + 2) (s + 1)` cells done with along `j`. Under the first cell this makes `O(n^(d/2))` cells. Each takes
    /// `O(n)` steps, and so does the separable programme, with at most `d s` undecided points.
    ///
    /// [^dobkin]: Dobkin, David; Eppstein, David; Mitchell, Don (1996). *Computing the Discrepancy with Applications to
    ///     Supersampling Patterns*. ACM Transactions on Graphics 15(4), 354-376.
    First,
}

/// A search of one cell, depth first.
pub(super) struct Search<'a> {
    grid: &'a Grid,
    rule: Rule,
    gap: f64,
    limit: u64,
    /// Steps taken.
    pub(super) work: u64,
    /// The largest excess found, at least the one that the search was given.
    pub(super) lower: f64,
    /// The corner, if it is above the one that the search was given.
    pub(super) corner: Option<Vec<u32>>,
    /// The largest bound of a cell that was left aside.
    pub(super) upper: f64,
    /// Whether none was left aside for want of steps.
    pub(super) complete: bool,
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
    pub(super) fn new(grid: &'a Grid, lower: f64, gap: f64, limit: u64) -> Self {
        Self {
            grid,
            rule: Rule::Busiest,
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

    pub(super) fn run(&mut self, cell: &Cell) {
        self.stack.clear();
        self.stack.extend_from_slice(&cell.undecided);
        let (mut low, mut high) = (cell.low.clone(), cell.high.clone());
        self.descend(&mut low, &mut high, cell.sure, 0);
    }

    /// Searches a cell once more by the rule for which the number of steps is bounded.
    pub(super) fn retry(&mut self, cell: &Cell, limit: u64) {
        let upper = core::mem::replace(&mut self.upper, f64::NEG_INFINITY);
        self.rule = Rule::First;
        self.limit = limit;
        self.complete = true;
        self.run(cell);
        // Both are bounds of all excesses in the cell, but for those found.
        self.upper = self.upper.min(upper);
    }

    /// The two halves of a cell, of which those are left out that need no search.
    pub(super) fn halve(&mut self, cell: &Cell) -> [Option<Cell>; 2] {
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
        let dimension = match self.rule {
            Rule::Busiest => self.pivots_of_busiest(low.len(), first),
            Rule::First => self.pivots_of_first(low.len(), first),
        };
        let Some(dimension) = dimension else {
            self.solve(low, high, sure, first);
            return None;
        };
        // The median of the points in question: it is decided along this dimension in both halves.
        let middle = self.pivots.len() / 2;
        let (_, &mut index, _) = self.pivots.select_nth_unstable(middle);
        Some(Cut { dimension, index })
    }

    /// The dimension by [`Rule::Busiest`], and the ranks along it of the points in question.
    fn pivots_of_busiest(&mut self, dimensions: usize, first: usize) -> Option<usize> {
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
        let dimension = (0..dimensions).max_by_key(|&j| self.crossing[j])?;
        self.collect(dimension, first, |along| !along.is_power_of_two());
        (!self.pivots.is_empty()).then_some(dimension)
    }

    /// The dimension by [`Rule::First`], and the ranks along it of the points in question.
    fn pivots_of_first(&mut self, dimensions: usize, first: usize) -> Option<usize> {
        let most = self.grid.count().isqrt();
        (0..dimensions).find(|&dimension| {
            let earlier = (1 << dimension) - 1;
            self.collect(dimension, first, |along| along & earlier != 0);
            if self.pivots.is_empty() {
                self.collect(dimension, first, |_| true);
                return self.pivots.len() > most;
            }
            true
        })
    }

    /// The ranks along a dimension of those points undecided along it whose dimensions are as asked for.
    fn collect(&mut self, dimension: usize, first: usize, asked: impl Fn(u64) -> bool) {
        self.pivots.clear();
        for &Undecided { point, along } in &self.stack[first..] {
            if along & 1 << dimension != 0 && asked(along) {
                self.pivots.push(self.grid.rank(point, dimension));
            }
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrepancy::Points;
    use crate::points::{Halton, Independent, PointSet};

    /// All corners by one rule, none left aside.
    fn unpruned(grid: &Grid, rule: Rule) -> Search<'_> {
        let mut search = Search::new(grid, f64::NEG_INFINITY, f64::NEG_INFINITY, u64::MAX);
        search.rule = rule;
        search.run(&Cell::all(grid));
        search
    }

    fn grids(set: &impl PointSet, count: u64, dimensions: u32) -> [Grid; 2] {
        let points = Points::from_set(set, 0..count, dimensions).unwrap();
        [Boundary::Open, Boundary::Closed].map(|kind| Grid::new(&points, kind))
    }

    #[test]
    fn both_rules_find_the_same() {
        for (count, dimensions) in [(1, 3), (40, 3), (24, 4), (12, 5)] {
            for seed in 0..10 {
                for grid in grids(&Independent::new(seed), count, dimensions) {
                    let lower = unpruned(&grid, Rule::Busiest).lower;
                    assert_eq!(unpruned(&grid, Rule::First).lower, lower);
                }
            }
        }
    }

    #[test]
    fn a_second_try_completes_what_the_first_left() {
        let [grid, _] = grids(&Independent::new(1), 60, 4);
        let lower = unpruned(&grid, Rule::Busiest).lower;
        let mut search = Search::new(&grid, 0.0, 0.0, 1000);
        search.run(&Cell::all(&grid));
        assert!(!search.complete);
        search.retry(&Cell::all(&grid), u64::MAX);
        assert!(search.complete);
        assert_eq!(search.lower, lower);
    }

    #[test]
    fn without_pruning_the_steps_are_those_of_the_proof() {
        for dimensions in [3, 4] {
            let halton = Halton::new(dimensions).unwrap();
            let counts = [16, 32, 64, 128];
            for count in &counts[..if dimensions == 3 { 4 } else { 3 }] {
                let sets = [
                    grids(&halton, *count, dimensions),
                    grids(&Independent::new(1), *count, dimensions),
                ];
                for grid in sets.iter().flatten() {
                    // Halvings, all at most the cells done with, and the steps of each cell.
                    let (n, d) = (*count as f64, f64::from(dimensions));
                    let s = n.sqrt().floor();
                    let cells: f64 = (0..dimensions)
                        .map(|j| 1.0 + (f64::from(j) + 2.0) * (s + 1.0))
                        .product();
                    let steps = 2.0 * cells * (n + d) + cells * (d * s).powi(2) / 2.0;
                    let work = unpruned(grid, Rule::First).work as f64;
                    assert!(work <= steps, "{dimensions} {count}: {work} {steps}");
                }
            }
        }
    }
}
