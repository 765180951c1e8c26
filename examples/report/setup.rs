//! What was measured, where and when: the top of the page.

use std::process::Command;

use estimand::report::{Cell, Column, Table};

use crate::Report;

pub(crate) fn add(report: &mut Report) {
    let mut table = Table::new([Column::text("this run"), Column::text("")]);
    let mut row = |name: &str, value: String| {
        table.row([Cell::from(name), Cell::from(value)]);
    };
    row(
        "date",
        jiff::Timestamp::now()
            .strftime("%Y-%m-%d %H:%M UTC")
            .to_string(),
    );
    row("machine", machine());
    row(
        "threads",
        format!("{} for pictures, 1 for integrals", threads()),
    );
    row("crate", format!("estimand {}", env!("CARGO_PKG_VERSION")));
    row("compiler", first_line("rustc", "--version"));
    row("build", build());
    row("seed", report.seed.to_string());
    row(
        "extent",
        if report.effort.powers[1] < 16 {
            "quick: few runs and small pictures; figures are rough".into()
        } else {
            "default".to_owned()
        },
    );
    row("other programs", report.peers.description());
    report
        .page
        .text(
            "How far an estimate is off after how much time, method by method: for integrals whose value is known in closed form, \
             and for pictures, which are compared with pictures by another renderer, Mitsuba 3. Errors are root mean squares \
             over independent runs (RMSE); bands and brackets are 95 % intervals. Times are wall clock: each method was run before it was \
             measured, short runs were repeated, methods took turns, and of the runs the median is given.",
        )
        .table(&table);
}

fn machine() -> String {
    let model = std::fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        });
    let model = model.unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{model}, {cores} processors, {}", std::env::consts::OS)
}

fn build() -> String {
    let mut build = String::from(if cfg!(debug_assertions) {
        "debug: times mean nothing"
    } else {
        "release"
    });
    for (feature, is_on) in [
        ("parallel", cfg!(feature = "parallel")),
        ("simd", cfg!(feature = "simd")),
    ] {
        build += &format!(", {} {feature}", if is_on { "with" } else { "without" });
    }
    build
}

fn first_line(program: &str, argument: &str) -> String {
    let output = Command::new(program).arg(argument).output().ok();
    output
        .filter(|output| output.status.success())
        .and_then(|output| String::from_utf8(output.stdout).ok())
        .and_then(|text| text.lines().next().map(str::to_owned))
        .unwrap_or_else(|| "not known".to_owned())
}

/// The threads of the current pool.
#[cfg(feature = "parallel")]
pub(crate) fn threads() -> usize {
    rayon::current_num_threads()
}

#[cfg(not(feature = "parallel"))]
pub(crate) fn threads() -> usize {
    1
}

/// Runs `job` on one thread, so that its time is that of one.
#[cfg(feature = "parallel")]
pub(crate) fn on_one_thread<T: Send>(job: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("one thread can be had").install(job)
}

#[cfg(not(feature = "parallel"))]
pub(crate) fn on_one_thread<T>(job: impl FnOnce() -> T) -> T {
    job()
}
