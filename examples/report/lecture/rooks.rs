//! Sets of points: rooks, grids, van der Corput's table.

use estimand::points::{Independent, MultiJittered, NRooks, PointSet, Stratified, VanDerCorput};
use estimand::report::number::significant;
use estimand::{Average, Estimator, Moments, cube, hash};

use super::{Claim, Verdict};
use crate::spread::Spread;
use crate::{Failure, Report};

pub(super) const STEPS: u64 = 1;

pub(super) fn claims(report: &Report) -> Result<Vec<Claim>, Failure> {
    report.doing("claims about points");
    Ok(vec![
        table()?,
        board()?,
        edges(report)?,
        strata()?,
        sums(report)?,
    ])
}

/// Which part of `count` intervals of one axis hold a point of the first `count` ones.
fn hit(points: &impl PointSet, count: u64, dimension: u32) -> u64 {
    let mut hit = vec![false; usize::try_from(count).unwrap_or(0)];
    for index in 0..count {
        let at = points.coordinate(index, dimension) * count as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "below the count"
        )]
        let at = at as usize;
        hit[at] = true;
    }
    hit.iter().filter(|&&hit| hit).count() as u64
}

fn table() -> Result<Claim, Failure> {
    let eighths = [0, 4, 2, 6, 1, 5, 3, 7].map(|n| f64::from(n) / 8.0);
    let points = VanDerCorput::new(2)?;
    let agree = (0..)
        .zip(eighths)
        .all(|(index, x)| points.coordinate(index, 0) == x);
    Ok(Claim {
        claim: "Van der Corput's table: the binary digits of 0, 1, 2, … behind the point, in reverse, are 0, 1/2, 1/4, 3/4, 1/8, 5/8, 3/8, 7/8."
            .into(),
        measured: format!(
            "the first eight are {}",
            (0..8).map(|index| points.coordinate(index, 0).to_string()).collect::<Vec<_>>().join(", ")
        ),
        confidence: "exact, to the bit".into(),
        verdict: Verdict::of(agree, !agree),
    })
}

const SEEDS: u64 = 1000;

fn board() -> Result<Claim, Failure> {
    let mut text = Vec::new();
    let mut always = true;
    for count in [9, 36] {
        let mut grid = Moments::<f64>::new();
        for seed in 0..SEEDS {
            let rooks = NRooks::new(count, seed)?;
            always &= (0..2).all(|dimension| hit(&rooks, count, dimension) == count);
            grid.push(hit(&Stratified::new(count, 2, seed)?, count, 0) as f64);
        }
        text.push(format!(
            "{count} rooks: {}; {count} points of a grid reach {} of the {count} columns in the mean",
            if always { "every row and column has one" } else { "some rows or columns are empty" },
            significant(grid.mean(), 3)
        ));
    }
    Ok(Claim {
        claim: "9 and 36 rooks: each row and each column of the board has exactly one point; a grid of 3 × 3 or 6 × 6 has not.".into(),
        measured: text.join(". "),
        confidence: format!("all of {SEEDS} seeds"),
        verdict: Verdict::of(always, !always),
    })
}

/// RMSE of the area on one side of random lines, upright or slanted.
fn edge_error<P: PointSet>(
    runs: u64,
    upright: bool,
    points: impl Fn(u64) -> P,
    count: u64,
) -> Spread {
    let squares = (0..runs).map(|run| {
        let [a, b] = [0, 1].map(|k| hash::unit(hash::hash(run, k)));
        // The line through the point (a, 1/2) with slope at random, as x < a + t (y - 1/2).
        let t = if upright { 0.0 } else { 2.0 * b - 1.0 };
        let covered = |y: f64| (a + t * (y - 0.5)).clamp(0.0, 1.0);
        // The area, by so many lines that their error does not count.
        let area = (0..512)
            .map(|k| covered((f64::from(k) + 0.5) / 512.0))
            .sum::<f64>()
            / 512.0;
        let f = cube(|[x, y]| f64::from(u8::from(x < covered(y))));
        let estimate = Average::new(points(run), count)
            .estimate(&f)
            .expect("a finite integrand");
        (estimate.mean - area).powi(2)
    });
    let square = Spread::of(squares);
    Spread {
        value: square.value.sqrt(),
        low: square.low.max(0.0).sqrt(),
        high: square.high.sqrt(),
    }
}

fn edges(report: &Report) -> Result<Claim, Failure> {
    let runs = 1000 * report.effort.claim_runs;
    let mut text = Vec::new();
    let mut better_upright = true;
    let mut worse_slanted = true;
    for count in [9, 36] {
        for upright in [true, false] {
            let plain = edge_error(runs, upright, Independent::new, count);
            let grid = edge_error(
                runs,
                upright,
                |seed| Stratified::new(count, 2, seed).expect("a count"),
                count,
            );
            let rooks = edge_error(
                runs,
                upright,
                |seed| NRooks::new(count, seed).expect("a count"),
                count,
            );
            let both = edge_error(
                runs,
                upright,
                |seed| MultiJittered::new(count, seed).expect("a count"),
                count,
            );
            if upright {
                better_upright &= rooks.high < grid.low;
            } else {
                worse_slanted &= rooks.low > grid.high;
            }
            text.push(format!(
                "{count} points, {} edges: plain {}, grid {}, rooks {}, both at once (multi-jittered) {}",
                if upright { "upright" } else { "slanted" },
                plain.text(),
                grid.text(),
                rooks.text(),
                both.text()
            ));
        }
    }
    Ok(Claim {
        claim: "Across an edge in a pixel, rooks beat the grid if the edge is upright, and lose if it is slanted.".into(),
        measured: format!("RMSE of the covered area. {}", text.join(". ")),
        confidence: format!("{runs} random edges each; every figure to about {} %", significant(140.0 / (runs as f64).sqrt(), 1)),
        verdict: Verdict::of(better_upright && worse_slanted, false),
    })
}

fn strata() -> Result<Claim, Failure> {
    const COUNT: u64 = 16;
    const DIMENSIONS: u32 = 4;
    let full =
        |points: &dyn Fn(u32) -> u64| (0..DIMENSIONS).all(|dimension| points(dimension) == COUNT);
    let rooks = NRooks::new(COUNT, 1)?;
    let by_rooks = full(&|dimension| hit(&rooks, COUNT, dimension));
    let grid = Stratified::new(COUNT, DIMENSIONS, 1)?;
    let reached: Vec<String> = (0..DIMENSIONS)
        .map(|d| hit(&grid, COUNT, d).to_string())
        .collect();
    let power = COUNT.pow(DIMENSIONS);
    // All cells of the large grid have a point: its columns have too.
    let large = Stratified::new(power, DIMENSIONS, 1)?;
    let by_grid = large.size() == Some(power);
    Ok(Claim {
        claim: format!(
            "To have a point in each of {COUNT} intervals of each of {DIMENSIONS} axes, N-rooks need N = {COUNT} points, a grid of such cells N^d = {power}."
        ),
        measured: format!(
            "{COUNT} rooks hit all {COUNT} intervals of every axis: {by_rooks}; {COUNT} points of a grid hit {} of them; the grid that has {COUNT} cells \
             along every axis has {} points",
            reached.join(", "),
            large.size().unwrap_or(0)
        ),
        confidence: "exact, by construction".into(),
        verdict: Verdict::of(by_rooks && by_grid, !by_rooks),
    })
}

/// What that is worth: the error of a sum of functions of one coordinate each.
fn sums(report: &Report) -> Result<Claim, Failure> {
    let f = cube(|x: [f64; 4]| x.iter().map(|x| x * x).sum::<f64>() - 4.0 / 3.0);
    let runs = 4 * report.effort.claim_runs;
    let rmse = |estimate: &dyn Fn(u64) -> f64| {
        let squares: f64 = (0..runs).map(|seed| estimate(seed).powi(2)).sum();
        (squares / runs as f64).sqrt()
    };
    let rooks = |count: u64| {
        rmse(&|seed| {
            let points = NRooks::new(count, seed).expect("a count");
            Average::new(points, count)
                .estimate(&f)
                .map_or(f64::NAN, |e| e.mean)
        })
    };
    let grid = |count: u64| {
        rmse(&|seed| {
            let points = Stratified::new(count, 4, seed).expect("a count");
            Average::new(points, count)
                .estimate(&f)
                .map_or(f64::NAN, |e| e.mean)
        })
    };
    let (few, same, square) = (rooks(64), grid(64), grid(4096));
    // An RMSE of so many runs is off by this factor at most, in 95 of 100 cases.
    let room = 1.0 + 2.0 / (2.0 * runs as f64).sqrt();
    Ok(Claim {
        claim: "For sums of functions of one coordinate, N rooks are worth far more than N points of a grid: in d dimensions the grid needs N^(3d / (d + 2)), \
                not N^d, points for the same error."
            .into(),
        measured: format!(
            "4 dimensions, RMSE of sum x^2: 64 rooks {}, a grid of 64 {}, a grid of 4096 = 64² {}",
            significant(few, 2),
            significant(same, 2),
            significant(square, 2)
        ),
        confidence: format!("{runs} runs each; figures to about {} %", significant(100.0 * (room - 1.0), 1)),
        verdict: Verdict::of(
            few * room * 2.0 < same / room && (0.5..2.0).contains(&(square / few)),
            few > same * room,
        ),
    })
}
