//! A lower bound by threshold accepting: a random walk over the corners that may step down, ever less.

use super::Boundary;
use super::grid::Grid;
use crate::hash::{hash, unit};

/// Steps, about a nanosecond each, that one iteration takes.
pub(super) fn steps_per_iteration(grid: &Grid) -> u64 {
    300 + (grid.count() * grid.dimensions()) as u64
}

/// The thresholds as a share of the differences between random neighbours: of 1, 0.3, 0.1 and 0 this is the one that
/// found the exact value in all of 18 trials with Halton's points in 3 to 9 dimensions.
const PATIENCE: f64 = 0.1;

/// One walk of about `iterations` steps, and the best corner on its way.[^gnewuch]
///
/// Every corner is first snapped: an open box grows until every face has a point on it, a closed one shrinks to the
/// points inside. The excess of a snapped corner is never below that of the corner itself, and the best corner of all is
/// a snapped one.
///
/// [^gnewuch]: Gnewuch, Michael; Wahlström, Magnus; Winzen, Carola (2012). *A New Randomized Algorithm to Approximate
///     the Star Discrepancy Based on Threshold Accepting*. <https://doi.org/10.1137/110833865>
pub(super) fn walk(grid: &Grid, iterations: u64, seed: u64) -> (f64, Vec<u32>) {
    let mut walk = Walk::new(grid, seed);
    let outer = iterations.isqrt().max(1);
    // The thresholds: how far apart neighbours are.
    let mut thresholds: Vec<f64> = (0..outer)
        .map(|trial| {
            walk.restart();
            let here = walk.excess;
            walk.propose(1.0 - trial as f64 / outer as f64);
            -PATIENCE * (walk.proposed_excess - here).abs()
        })
        .collect();
    thresholds.sort_unstable_by(f64::total_cmp);
    walk.restart();
    let inner = iterations.div_ceil(outer).saturating_sub(1).max(1);
    for (step, threshold) in thresholds.into_iter().enumerate() {
        let width = 1.0 - step as f64 / outer as f64;
        for _ in 0..inner {
            walk.propose(width);
            if walk.proposed_excess - walk.excess >= threshold {
                walk.accept();
            }
        }
    }
    (walk.best_excess, walk.best)
}

struct Walk<'a> {
    grid: &'a Grid,
    /// The ranks of all points along one dimension after the other.
    columns: Vec<u32>,
    seed: u64,
    drawn: u64,
    corner: Vec<u32>,
    excess: f64,
    proposed: Vec<u32>,
    proposed_excess: f64,
    best: Vec<u32>,
    best_excess: f64,
    /// Along how many dimensions each point is outside the proposed box.
    outside: Vec<u32>,
    order: Vec<usize>,
}

impl<'a> Walk<'a> {
    fn new(grid: &'a Grid, seed: u64) -> Self {
        let count = u32::try_from(grid.count()).expect("fewer than 2^32 points");
        let dimensions = grid.dimensions();
        Self {
            grid,
            columns: (0..dimensions)
                .flat_map(|j| (0..count).map(move |point| grid.rank(point, j)))
                .collect(),
            seed,
            drawn: 0,
            corner: vec![0; dimensions],
            excess: f64::NEG_INFINITY,
            proposed: vec![0; dimensions],
            proposed_excess: f64::NEG_INFINITY,
            best: (0..dimensions).map(|j| grid.last(j)).collect(),
            best_excess: f64::NEG_INFINITY,
            outside: vec![0; grid.count()],
            order: (0..dimensions).collect(),
        }
    }

    fn draw(&mut self) -> f64 {
        self.drawn += 1;
        unit(hash(self.seed, self.drawn))
    }

    /// A whole number below `bound`.
    #[expect(clippy::cast_possible_truncation, reason = "below the bound")]
    fn below(&mut self, bound: usize) -> usize {
        (self.draw() * bound as f64) as usize
    }

    /// Goes to a random corner, whose volume is about evenly distributed.
    fn restart(&mut self) {
        let dimensions = self.grid.dimensions();
        for j in 0..dimensions {
            let u = self.draw().powf(1.0 / dimensions as f64);
            self.proposed[j] = self.index(j, u);
        }
        self.finish();
        self.accept();
    }

    /// The index at the share `u` of those along a dimension.
    #[expect(clippy::cast_possible_truncation, reason = "clamped to the indices")]
    fn index(&self, dimension: usize, u: f64) -> u32 {
        let (first, last) = (self.grid.first(), self.grid.last(dimension));
        let index = f64::from(first) + u * f64::from(last - first);
        (index.round() as u32).clamp(first, last)
    }

    /// Proposes a neighbour: some indices moved by up to `width` of half of all.
    fn propose(&mut self, width: f64) {
        let dimensions = self.grid.dimensions();
        self.proposed.copy_from_slice(&self.corner);
        // From two coordinates at the end of the walk to all of them at its beginning.
        let least = dimensions.min(2);
        #[expect(clippy::cast_possible_truncation, reason = "at most the dimensions")]
        let moved = least + ((dimensions - least) as f64 * width * self.draw()).round() as usize;
        self.shuffle();
        for at in 0..moved {
            let j = self.order[at];
            let (first, last) = (self.grid.first(), self.grid.last(j));
            let reach = (0.5 * width * f64::from(last - first)).max(1.0);
            let step = (2.0 * self.draw() - 1.0) * (reach + 0.5);
            let index = f64::from(self.corner[j]) + step;
            #[expect(clippy::cast_possible_truncation, reason = "clamped to the indices")]
            let index = index.round().clamp(f64::from(first), f64::from(last)) as u32;
            self.proposed[j] = index;
        }
        self.finish();
    }

    fn shuffle(&mut self) {
        for at in (1..self.order.len()).rev() {
            let with = self.below(at + 1);
            self.order.swap(at, with);
        }
    }

    /// Snaps what is proposed, and measures it.
    fn finish(&mut self) {
        self.outside.fill(0);
        let columns = self.columns.chunks_exact(self.grid.count());
        for (column, &index) in columns.zip(&self.proposed) {
            for (outside, &rank) in self.outside.iter_mut().zip(column) {
                *outside += u32::from(rank >= index);
            }
        }
        self.shuffle();
        match self.grid.boundary() {
            Boundary::Open => self.grow(),
            Boundary::Closed => self.shrink(),
        }
        let inside = self.outside.iter().map(|&o| u32::from(o == 0)).sum();
        let volume = self.grid.volume(&self.proposed);
        self.proposed_excess = self.grid.excess(volume, inside);
        if self.proposed_excess > self.best_excess {
            self.best_excess = self.proposed_excess;
            self.best.copy_from_slice(&self.proposed);
        }
    }

    /// Moves every face of the open box outwards until it meets a point.
    fn grow(&mut self) {
        for &j in &self.order {
            let column = &self.columns[j * self.grid.count()..][..self.grid.count()];
            let index = self.proposed[j];
            // A point that this face alone keeps outside stops it.
            let stop = self
                .outside
                .iter()
                .zip(column)
                .map(|(&outside, &rank)| {
                    if outside == 1 && rank >= index {
                        rank
                    } else {
                        u32::MAX
                    }
                })
                .fold(u32::MAX, u32::min)
                .min(self.grid.last(j));
            for (outside, &rank) in self.outside.iter_mut().zip(column) {
                *outside -= u32::from(index <= rank && rank < stop);
            }
            self.proposed[j] = stop;
        }
    }

    /// Moves every face of the closed box inwards to the last point inside.
    fn shrink(&mut self) {
        let columns = self.columns.chunks_exact(self.grid.count());
        for (column, index) in columns.zip(&mut self.proposed) {
            *index = self
                .outside
                .iter()
                .zip(column)
                .map(|(&outside, &rank)| if outside == 0 { rank + 1 } else { 0 })
                .fold(self.grid.first(), u32::max);
        }
    }

    fn accept(&mut self) {
        self.corner.copy_from_slice(&self.proposed);
        self.excess = self.proposed_excess;
    }
}
