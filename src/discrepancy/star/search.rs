//! Which algorithm answers, within which budget of work.

use super::cells::{self, Found};
use super::grid::Grid;
use super::threshold_accepting;
use super::{AnchoredBox, Boundary, StarDiscrepancy, line, plane};
use crate::discrepancy::Points;
use crate::{Error, hash, reduce};

/// How the star discrepancy is searched for: with how much work, and with which random walk.
///
/// The star discrepancy is `sup_y | vol [0, y) - #{x in [0, y)} / n |`, the supremum over all corners `y` in `[0, 1]^d`. It is
/// the maximum over *open* boxes of volume minus share of points, and over *closed* boxes of share minus volume,
/// both with corners on the grid of the points' coordinates and 1.[^doerr] Boxes with corners at the points alone
/// are not enough, and give values that are up to 30 % too low.
///
/// - One dimension: sorting, `O(n log n)`.[^niederreiter]
/// - Two dimensions: a sweep over a kinetic tree, `O(n log^2 n)` as measured.
/// - More dimensions: branch and bound over cells of corners. A cell in which no point is undecided along two
///   dimensions is solved by the dynamic programme of Dobkin, Eppstein and Mitchell;[^dobkin] others are cut until
///   they are of that kind, or hold nothing better than the best corner known. Where the first rule for cuts does not get
///   there soon, theirs takes over: `O(n^(1 + d/2))` for a fixed `d`, whatever the points. The constant grows with `d`
///   about as fast as `2^d (d + 1)!`, at most; what is pruned makes it far less as a rule. The problem is NP-hard in the dimension, so
///   that this ends only for few points or few dimensions: see [`measure`](Self::measure).
/// - Out of reach of that, a walk of threshold accepting.[^gnewuch] It gives a lower bound, often the value itself, and
///   never knows.
///
/// # Work
///
/// The budget is counted in steps, of which a core takes between 2 10^8 and 10^9 a second: by a count and not by a clock, so that
/// the same budget gives the same answer on every machine and for any number of threads. The default is
/// 10^10 steps. Memory is `O(d n)`, and `O(n)` for the recursion.
///
/// ```
/// use estimand::discrepancy::{Points, Star};
/// use estimand::points::Independent;
///
/// let points = Points::from_set(&Independent::new(1), 0..20, 4)?;
/// let exact = Star::default().exact(&points)?.lower();
///
/// // A budget too small for the value gives two bounds, and never the wrong number.
/// let bracket = Star::default().work(100_000).measure(&points);
/// assert!(bracket.lower() <= exact && bracket.upper().is_none_or(|upper| exact <= upper));
/// assert!(Star::default().work(1000).exact(&points).is_err());
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^doerr]: Doerr, Carola; Gnewuch, Michael; Wahlström, Magnus (2014). *Calculation of Discrepancy Measures and
///     Applications*. <https://arxiv.org/abs/1405.1653>
/// [^niederreiter]: Niederreiter, Harald (1992). *Random Number Generation and Quasi-Monte Carlo Methods*, theorem
///     2.6. <https://doi.org/10.1137/1.9781611970081>
/// [^dobkin]: Dobkin, David; Eppstein, David; Mitchell, Don (1996). *Computing the Discrepancy with Applications to
///     Supersampling Patterns*. ACM Transactions on Graphics 15(4), 354-376.
/// [^gnewuch]: Gnewuch, Michael; Wahlström, Magnus; Winzen, Carola (2012). *A New Randomized Algorithm to Approximate
///     the Star Discrepancy Based on Threshold Accepting*. <https://doi.org/10.1137/110833865>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Star {
    work: u64,
    seed: u64,
}

impl Default for Star {
    fn default() -> Self {
        Self {
            work: 10_000_000_000,
            seed: 0,
        }
    }
}

/// The star discrepancy, exact or bracketed with the default [`Star`].
///
/// ```
/// use estimand::discrepancy::{Points, star};
///
/// // The first four points of Halton's sequence in the bases 2 and 3. The closed box to (3/4, 1/3) holds three of them
/// // in a volume of 1/4: 3/4 - 1/4.
/// let halton = [[0.0, 0.0], [0.5, 1.0 / 3.0], [0.25, 2.0 / 3.0], [0.75, 1.0 / 9.0]];
/// let star = star(&Points::from_arrays(&halton)?);
/// assert!((star.lower() - 0.5).abs() < 1e-15);
/// assert_eq!(star.upper(), Some(star.lower()));
/// # Ok::<(), estimand::Error>(())
/// ```
pub fn star(points: &Points<'_>) -> StarDiscrepancy {
    Star::default().measure(points)
}

/// Iterations of a walk that is all there is, as its authors have them; and the most of one that only begins a search.
const LONG_WALK: u64 = 100_000;
const SHORT_WALK: u64 = 4_096;
/// Walks for each kind of box.
const WALKS: u64 = 4;
/// The gap between the bounds is halved, or multiplied by a root of that, up to this one.
const SMALLEST_STEP: f64 = 0.8;

impl Star {
    /// The same with another budget of work, in steps.
    pub const fn work(mut self, steps: u64) -> Self {
        self.work = steps;
        self
    }

    /// The same with another walk; the default is 0. Only a [`LowerBound`](StarDiscrepancy::LowerBound), and the lower of two
    /// bounds, can depend on it.
    pub const fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// What the budget allows: the exact value, or else close bounds, or else, and always in more than 64 dimensions, a lower
    /// bound.
    pub fn measure(&self, points: &Points<'_>) -> StarDiscrepancy {
        let mut state = match self.begin(points) {
            Ok(state) => state,
            Err(exact) => return exact,
        };
        // Ever closer bounds, as long as the next ones may be had with what is left of the budget.
        let mut gap = 0.5 * (1.0 - state.lower());
        let (mut ratio, mut before) = (0.5_f64, None);
        loop {
            let start = state.work;
            if !state.narrow(gap, self.work) || gap == 0.0 {
                break;
            }
            let took = (state.work - start) as f64;
            let left = self.work.saturating_sub(state.work) as f64;
            // As much dearer as the last ones were than those before them, and the less so the smaller the step.
            let mut growth = before.map_or(4.0, |before: f64| (took / before).max(1.0 / ratio));
            while took * growth > left && ratio < SMALLEST_STEP {
                ratio = ratio.sqrt();
                growth = growth.sqrt();
            }
            if took * growth > left {
                break;
            }
            gap *= ratio;
            if gap < state.lower() / 8.0 {
                gap = 0.0;
            }
            before = Some(took);
        }
        if state.upper >= 1.0 && state.lower() < 1.0 {
            // That much is known of any points.
            state.upper = f64::INFINITY;
        }
        state.conclude()
    }

    /// The exact value.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if the budget does not suffice, and for more than 64 dimensions.
    pub fn exact(&self, points: &Points<'_>) -> Result<StarDiscrepancy, Error> {
        let mut state = match self.begin(points) {
            Ok(state) => state,
            Err(exact) => return Ok(exact),
        };
        if state.narrow(0.0, self.work) {
            Ok(state.conclude())
        } else {
            Err(self.too_little(points, "large enough for the exact star discrepancy"))
        }
    }

    /// Two bounds that are at most `gap` apart.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a gap below zero or NaN, if the budget does not suffice, and for more than 64 dimensions.
    pub fn bounds(&self, points: &Points<'_>, gap: f64) -> Result<StarDiscrepancy, Error> {
        if !(gap >= 0.0) {
            return Err(Error::refused("gap between the bounds", "at least 0", gap));
        }
        let mut state = match self.begin(points) {
            Ok(state) => state,
            Err(exact) => return Ok(exact),
        };
        if state.narrow(gap, self.work) {
            Ok(state.conclude())
        } else {
            Err(self.too_little(
                points,
                "large enough for bounds of the star discrepancy so close",
            ))
        }
    }

    /// The best corner of several walks of threshold accepting: `max_y | vol [0, y) - #{x in [0, y)} / n |` over the corners
    /// that they visit.[^gnewuch]
    ///
    /// ```
    /// use estimand::discrepancy::{Points, Star};
    ///
    /// // The closed box to the only point holds it all in a volume of 1/4: 1 - 1/4.
    /// let points = Points::from_rows(&[0.5, 0.5], 2)?;
    /// let found = Star::default().lower_bound(&points);
    /// assert_eq!((found.lower(), found.upper()), (0.75, None));
    /// # Ok::<(), estimand::Error>(())
    /// ```
    ///
    /// It was tuned on Halton's points. Of 80 other sets, independent ones and Sobol's in Owen's scrambling with 128 points in
    /// 3 dimensions to 24 in 7, it found the value in 79, and was above it in none, as it cannot be but for rounding.
    ///
    /// [^gnewuch]: Gnewuch, Michael; Wahlström, Magnus; Winzen, Carola (2012). *A New Randomized Algorithm to Approximate
    ///     the Star Discrepancy Based on Threshold Accepting*. <https://doi.org/10.1137/110833865>
    pub fn lower_bound(&self, points: &Points<'_>) -> StarDiscrepancy {
        let mut state = State::new(points);
        state.walk(LONG_WALK, self.work, self.seed);
        state.upper = f64::INFINITY;
        state.conclude()
    }

    fn too_little(&self, points: &Points<'_>, domain: &'static str) -> Error {
        if points.dimensions() > cells::DIMENSIONS {
            return Error::refused(
                "number of dimensions",
                "at most 64 for more than a lower bound of the star discrepancy",
                points.dimensions(),
            );
        }
        Error::refused(
            "budget of work",
            domain,
            format_args!("{} steps", self.work),
        )
    }

    /// The exact value where it is cheap, or what a short walk finds.
    fn begin<'a>(&self, points: &'a Points<'a>) -> Result<State<'a>, StarDiscrepancy> {
        let attained = match points.dimensions() {
            1 => line::attained(points),
            2 => plane::attained(points),
            _ => {
                let mut state = State::new(points);
                let short = 4 * (points.count() * points.dimensions()) as u64;
                state.walk(short.min(SHORT_WALK), self.work / 8, self.seed);
                return Ok(state);
            }
        };
        Err(StarDiscrepancy::Exact {
            value: attained.excess(points.count()),
            attained,
        })
    }
}

/// What is known so far.
struct State<'a> {
    points: &'a Points<'a>,
    grids: [Grid; 2],
    best: Option<(f64, Vec<u32>, usize)>,
    upper: f64,
    work: u64,
}

impl<'a> State<'a> {
    fn new(points: &'a Points<'a>) -> Self {
        let grids = [Boundary::Open, Boundary::Closed].map(|kind| Grid::new(points, kind));
        Self {
            points,
            grids,
            best: None,
            upper: f64::INFINITY,
            work: 0,
        }
    }

    fn lower(&self) -> f64 {
        self.best.as_ref().map_or(0.0, |best| best.0)
    }

    fn offer(&mut self, excess: f64, corner: Vec<u32>, grid: usize) {
        if self.best.as_ref().is_none_or(|best| excess > best.0) {
            self.best = Some((excess, corner, grid));
        }
    }

    /// Walks of at most so many iterations in as much work.
    fn walk(&mut self, iterations: u64, work: u64, seed: u64) {
        let walks = 2 * WALKS;
        let cost = threshold_accepting::steps_per_iteration(&self.grids[0]);
        let iterations = iterations.min(work / walks / cost).max(1);
        let found = reduce::each(walks, |walk| {
            let grid = &self.grids[usize::from(walk >= WALKS)];
            threshold_accepting::walk(grid, iterations, hash::hash(seed, walk))
        });
        self.work += walks * iterations * cost;
        for (walk, (excess, corner)) in (0..).zip(found) {
            self.offer(excess, corner, usize::from(walk >= WALKS));
        }
    }

    /// Searches for bounds that are no further apart than `gap`; returns whether they are.
    fn narrow(&mut self, gap: f64, budget: u64) -> bool {
        if self.points.dimensions() > cells::DIMENSIONS {
            self.work = budget;
            return false;
        }
        let (mut upper, mut close) = (f64::NEG_INFINITY, true);
        for grid in 0..2 {
            let left = budget.saturating_sub(self.work);
            // Half of what is left for the first kind of boxes, all for the second.
            let limit = if grid == 0 { left / 2 } else { left };
            let Found {
                lower,
                corner,
                upper: above,
                complete,
                work,
            } = cells::search(&self.grids[grid], self.lower(), gap, limit);
            self.work += work;
            upper = upper.max(above);
            close &= complete;
            if let Some(corner) = corner {
                self.offer(lower, corner, grid);
            }
        }
        self.upper = self.upper.min(upper).min(1.0).max(self.lower());
        close
    }

    fn conclude(self) -> StarDiscrepancy {
        let (_, corner, grid) = self.best.as_ref().expect("a walk has found a corner");
        let attained: AnchoredBox = self.grids[*grid].anchored(self.points, corner);
        let value = attained.excess(self.points.count());
        if self.upper <= self.lower() {
            StarDiscrepancy::Exact { value, attained }
        } else if self.upper.is_finite() {
            StarDiscrepancy::Bounds {
                lower: value,
                upper: self.upper,
                attained,
            }
        } else {
            StarDiscrepancy::LowerBound { value, attained }
        }
    }
}
