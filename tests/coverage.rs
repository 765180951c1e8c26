//! How often the error bars hold the truth: 95 % intervals of every kind over many independent runs, on Genz' six
//! families, indicators and stiff integrands.
//!
//! An interval must hold the truth in 93 % of the runs, or carry a warning where it does not: at most 7 % of the runs may
//! miss it without a warning. Both at fixed seeds; for a true coverage of 95 % a false alarm has a probability of 0.3 % a
//! row at 1000 runs.
//!
//! `COVERAGE_TABLE=docs/coverage.md cargo test --release --all-features --test coverage` writes the table that is shipped;
//! `COVERAGE_ONLY=vegas` looks at the rows whose names contain that. Without
//! optimisation only 100 runs are made, and 88 % is asked for.

use std::fmt::Write;

use estimand::{Integrand, each};

#[path = "../examples/common/integrands.rs"]
#[allow(dead_code, reason = "shared with the programs")]
mod integrands;
#[path = "../examples/common/methods.rs"]
mod methods;
#[path = "../examples/common/stiff.rs"]
#[allow(dead_code, reason = "shared with the programs")]
mod stiff;

use integrands::{Family, Problem};
use methods::Method;

const RUNS: u64 = if cfg!(debug_assertions) { 100 } else { 1000 };
const UNWARNED: f64 = if cfg!(debug_assertions) { 0.12 } else { 0.07 };
const COUNT: u64 = 1 << 12;
const LEVEL: f64 = 0.95;

/// What many runs of one method on one integrand gave.
struct Row {
    integrand: String,
    method: Method,
    covered: f64,
    warned: f64,
    missed_without_warning: f64,
    /// Root mean square error relative to the integral, and the mean half width of the intervals.
    error: f64,
    width: f64,
}

fn row(
    name: &str,
    integrand: &impl Integrand<Value = f64>,
    truth: f64,
    bounds: Option<[f64; 2]>,
    method: Method,
) -> Option<Row> {
    let only = std::env::var("COVERAGE_ONLY").unwrap_or_default();
    if !format!("{name}, {}", method.name()).contains(&only) {
        return None;
    }
    let _ = method.estimate(integrand, bounds, COUNT, 0)?.ok()?;
    let runs = each(RUNS, |run| {
        let estimate = method
            .estimate(integrand, bounds, COUNT, 1000 + run)
            .expect("the method applies")
            .expect("the integrand is finite");
        let interval = estimate.interval(LEVEL).expect("an error bar");
        // What an interval of width zero around a rounded mean cannot hold.
        let rounding = 4.0 * f64::EPSILON * truth.abs();
        assert!(estimate.mean.is_finite() && interval.low <= interval.high);
        let covered = interval.low - rounding <= truth && truth <= interval.high + rounding;
        let warned = !estimate.warnings.is_empty();
        let half = 0.5 * (interval.high - interval.low);
        (covered, warned, estimate.mean - truth, half)
    });
    let count = RUNS as f64;
    let share = |f: &dyn Fn(bool, bool) -> bool| {
        runs.iter().filter(|run| f(run.0, run.1)).count() as f64 / count
    };
    let scale = if truth == 0.0 { 1.0 } else { truth.abs() };
    let square: f64 = runs.iter().map(|run| (run.2 / scale).powi(2)).sum();
    let width: f64 = runs.iter().map(|run| run.3 / scale).sum();
    Some(Row {
        integrand: name.to_owned(),
        method,
        covered: share(&|covered, _| covered),
        warned: share(&|_, warned| warned),
        missed_without_warning: share(&|covered, warned| !covered && !warned),
        error: (square / count).sqrt(),
        width: width / count,
    })
}

fn check(rows: &[Row]) {
    let failures: Vec<String> = rows
        .iter()
        .filter(|row| row.missed_without_warning > UNWARNED)
        .map(|row| {
            format!(
                "{}, {}: covered {:.3}, warned {:.3}, missed without a warning {:.3}",
                row.integrand,
                row.method.name(),
                row.covered,
                row.warned,
                row.missed_without_warning
            )
        })
        .collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

const FAMILIES: [Family; 6] = [
    Family::Oscillatory,
    Family::ProductPeak,
    Family::CornerPeak,
    Family::Gaussian,
    Family::Continuous,
    Family::Discontinuous,
];

fn genz() -> Vec<Row> {
    let mut rows = Vec::new();
    for family in FAMILIES {
        for dims in [2, 5, 10] {
            let problem = Problem::new(family, dims);
            let truth = problem
                .integral()
                .expect("Genz' families have closed forms");
            let bounds = match family {
                Family::Oscillatory => Some([-1.0, 1.0]),
                Family::CornerPeak | Family::Gaussian | Family::Continuous => Some([0.0, 1.0]),
                _ => None,
            };
            let name = format!("{family}, d = {dims}");
            rows.extend(
                Method::ALL
                    .iter()
                    .filter_map(|&method| row(&name, &problem, truth, bounds, method)),
            );
        }
    }
    rows
}

fn stiff() -> Vec<Row> {
    let mut rows = Vec::new();
    for case in stiff::cases().iter().filter(|case| case.dims <= 10) {
        let bounds = case.name.starts_with("indicator").then_some([0.0, 1.0]);
        rows.extend(
            Method::ALL
                .iter()
                .filter_map(|&method| row(&case.name, case, case.integral, bounds, method)),
        );
    }
    rows
}

#[test]
fn intervals_hold_the_truth_or_say_that_they_may_not() {
    let (genz, stiff) = (genz(), stiff());
    if let Some(file) = std::env::var_os("COVERAGE_TABLE") {
        std::fs::write(&file, table(&genz, &stiff)).expect("a file that can be written");
    }
    check(&genz);
    check(&stiff);
}

fn table(genz: &[Row], stiff: &[Row]) -> String {
    let mut text = format!(
        "# How often the error bars hold the truth\n\n\
         {RUNS} independent runs of about {COUNT} evaluations each; intervals at {} %.\n\
         Made by `COVERAGE_TABLE=docs/coverage.md cargo test --release --all-features --test coverage`.\n\n\
         *covered*: part of the runs whose interval holds the integral. *warned*: part of the runs that came with a \
         warning. *missed, unwarned*: part of the runs that did neither, which the test keeps at {:.0} % or less. \
         *error*: root mean square error, *width*: mean half width of the intervals, both relative to the integral \
         (absolute where it is zero).\n\n\
         Where less than 93 % is covered, theory says that it must be so: the variance is infinite (x^a from -0.5 \
         on) or the feature is rarer than the points can show. There the runs carry warnings.\n",
        100.0 * LEVEL,
        100.0 * UNWARNED
    );
    for (title, rows) in [
        ("Genz' families", genz),
        ("Stiff and extreme integrands", stiff),
    ] {
        let _ = write!(
            text,
            "\n## {title}\n\n| integrand | method | covered | warned | missed, unwarned | error | width |\n\
             |---|---|---:|---:|---:|---:|---:|\n"
        );
        for row in rows {
            let _ = writeln!(
                text,
                "| {} | {} | {:.3} | {:.3} | {:.3} | {:.1e} | {:.1e} |",
                row.integrand,
                row.method.name(),
                row.covered,
                row.warned,
                row.missed_without_warning,
                row.error,
                row.width
            );
        }
    }
    text
}
