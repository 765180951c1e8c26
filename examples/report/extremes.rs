//! Section 4: integrands that are hard to integrate, every method.

use estimand::each;
use estimand::report::number::significant;
use estimand::report::{Cell, Column, Table};
use serde_json::json;

use crate::methods::Method;
use crate::stiff::{self, Case};
use crate::{Failure, Report};

pub(crate) const STEPS: u64 = 1;

/// What many runs of one method on one integrand gave.
struct Outcome {
    /// The RMSE, relative to the integral; absolute where that is zero.
    error: f64,
    /// Which part of the 95 % intervals held the integral.
    covered: f64,
    /// Which part of the runs came with a warning.
    warned: f64,
}

impl Outcome {
    /// Whether as many intervals held the integral as should, give or take three standard deviations of their fraction.
    fn holds(&self, runs: u64) -> bool {
        self.covered >= 0.95 - 3.0 * (0.95 * 0.05 / runs as f64).sqrt()
    }

    /// A wrong interval is only bad if nothing warned of it.
    fn cell(&self, runs: u64) -> Cell {
        let text = format!(
            "{:.0} % · {}",
            100.0 * self.covered,
            significant(self.error, 1)
        );
        if self.holds(runs) {
            Cell::good(text)
        } else if self.warned > 0.5 {
            Cell::from(format!("! {text}"))
        } else {
            Cell::bad(text)
        }
    }
}

pub(crate) fn add(report: &mut Report) -> Result<(), Failure> {
    report.doing("extreme integrands");
    let (runs, count) = (report.effort.extreme_runs, report.effort.extreme_count);
    report.page.section("Stiff and extreme cases").text(&format!(
        "{runs} runs of about {count} evaluations each; a quarter of that in more than ten dimensions. In every cell: how many of \
         the 95 % intervals held the integral, and the RMSE relative to it (absolute where it is 0). ✓: as promised. !: fewer, and most \
         runs warned. ✗: fewer, without a warning in most runs. The longer run, with what to use instead, is `docs/stability.md`."
    ));
    let cases = stiff::cases();
    let mut columns = vec![Column::text("integrand")];
    columns.extend(Method::ALL.map(|method| Column::number(method.name())));
    columns.push(Column::text("where all fail"));
    let mut table = Table::new(columns);
    let mut data = Vec::new();
    let mut silent = 0;
    for case in &cases {
        let mut cells = vec![Cell::from(case.name.clone())];
        let mut all_fail = true;
        for method in Method::ALL {
            let Some(outcome) = outcome(case, method, runs, count) else {
                cells.push("—".into());
                continue;
            };
            all_fail &= !outcome.holds(runs);
            silent += u32::from(outcome.covered < 0.5 && outcome.warned <= 0.5);
            data.push(json!({
                "integrand": case.name, "method": method.name(), "error": outcome.error, "covered": outcome.covered,
                "warned": outcome.warned,
            }));
            cells.push(outcome.cell(runs));
        }
        cells.push(if all_fail { case.instead } else { "" }.into());
        table.row(cells);
    }
    report.page.table(&table);
    report.page.text(&format!(
        "Less than half covered and no warning in most runs: {silent} of {} cells.",
        data.len()
    ));
    let text =
        serde_json::to_string_pretty(&json!({ "runs": runs, "count": count, "cells": data }))?;
    std::fs::write(report.file("extremes.json"), text)?;
    report.page.files(["extremes.json"]);
    Ok(())
}

fn outcome(case: &Case, method: Method, runs: u64, count: u64) -> Option<Outcome> {
    let bounds = case.name.starts_with("indicator").then_some([0.0, 1.0]);
    let runs = if case.dims > 10 {
        (runs / 4).max(4)
    } else {
        runs
    };
    let results = each(runs, |run| {
        let estimate = method.estimate(case, bounds, count, 1 + run)?.ok()?;
        let interval = estimate.interval(0.95)?;
        Some((estimate, interval))
    });
    let results: Vec<_> = results.into_iter().flatten().collect();
    if results.is_empty() {
        return None;
    }
    let truth = case.integral;
    let scale = if truth == 0.0 { 1.0 } else { truth.abs() };
    // What rounding does to the mean of values of this size, which no interval of width zero can hold.
    let rounding = 4.0 * f64::EPSILON * scale;
    let share = |holds: &dyn Fn(usize) -> bool| {
        (0..results.len()).filter(|&run| holds(run)).count() as f64 / results.len() as f64
    };
    let squares: f64 = results
        .iter()
        .map(|(estimate, _)| ((estimate.mean - truth) / scale).powi(2))
        .sum();
    Some(Outcome {
        error: (squares / results.len() as f64).sqrt(),
        covered: share(&|run| {
            let interval = results[run].1;
            interval.low - rounding <= truth && truth <= interval.high + rounding
        }),
        warned: share(&|run| !results[run].0.warnings.is_empty()),
    })
}
