//! Section 3: what a lecture on Monte Carlo rendering claims, each claim measured.

mod light;
mod numbers;
mod rooks;

use estimand::report::{Cell, Column, Table};
use serde_json::json;

use crate::{Failure, Report};

pub(crate) const STEPS: u64 = numbers::STEPS + rooks::STEPS + light::STEPS;

/// A claim, with what was measured of it.
pub(crate) struct Claim {
    pub(crate) claim: String,
    pub(crate) measured: String,
    /// How sure that is.
    pub(crate) confidence: String,
    pub(crate) verdict: Verdict,
}

/// Whether a claim holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Holds,
    /// Under conditions, which what was measured names.
    Partly,
    Fails,
    /// The intervals are too wide to tell.
    Open,
}

impl Verdict {
    /// Holds if what must be so is sure, fails if its contrary is sure.
    pub(crate) fn of(sure: bool, contrary: bool) -> Self {
        match (sure, contrary) {
            (true, _) => Self::Holds,
            (_, true) => Self::Fails,
            _ => Self::Open,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Partly => "in part",
            Self::Fails => "does not hold",
            Self::Open => "not settled by this run",
        }
    }

    fn cell(self) -> Cell {
        match self {
            Self::Holds => Cell::good(self.word()),
            Self::Fails => Cell::bad(self.word()),
            _ => Cell::from(self.word()),
        }
    }
}

pub(crate) fn add(report: &mut Report) -> Result<(), Failure> {
    report.page.section("The lecture, measured").text(
        "Each row is a claim, what this run measured, and how sure that is; brackets are 95 % intervals. A claim holds, or does not, only if \
         the whole interval says so. Ratios of variances are those of one sample, whatever the number of samples; efficiency is one over \
         variance times time.",
    );
    let mut charts = Vec::new();
    let mut claims = rooks::claims(report)?;
    claims.extend(numbers::claims(report, &mut charts)?);
    claims.extend(light::claims(report)?);
    let mut table = Table::new([
        Column::prose("claim"),
        Column::text("verdict"),
        Column::prose("measured"),
        Column::text("confidence"),
    ]);
    let mut data = Vec::new();
    for claim in claims {
        data.push(json!({
            "claim": claim.claim, "measured": claim.measured, "confidence": claim.confidence, "verdict": claim.verdict.word(),
        }));
        table.row([
            Cell::from(claim.claim),
            claim.verdict.cell(),
            Cell::from(claim.measured),
            Cell::from(claim.confidence),
        ]);
    }
    std::fs::write(
        report.file("lecture.json"),
        serde_json::to_string_pretty(&data)?,
    )?;
    report
        .page
        .table(&table)
        .files(["lecture.json"])
        .charts(&charts);
    Ok(())
}
