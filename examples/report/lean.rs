//! Section 5: what a scene does not need.

use std::time::Instant;

use estimand::path::bsdf::Bsdf;
use estimand::path::filter::Filter;
use estimand::path::light::{Environment, Light};
use estimand::path::sensor::Sensor;
use estimand::path::{View, scenes};
use estimand::report::number::{seconds, significant};
use estimand::report::{Cell, Column, Table};
use estimand::{Integrand, Moments, MonteCarlo, Sampler, hash};

use crate::{Failure, Report};

pub(crate) const STEPS: u64 = 1;

/// Independent coordinates, counted.
struct Counted {
    seed: u64,
    read: u64,
}

impl Sampler for Counted {
    fn next_1d(&mut self) -> f64 {
        self.read += 1;
        hash::unit(hash::hash(self.seed, self.read))
    }
}

pub(crate) fn add(report: &mut Report) -> Result<(), Failure> {
    report.doing("what scenes do not need");
    let mut table = Table::new([
        Column::text("scene"),
        Column::text("left out"),
        Column::number("coordinates a path"),
        Column::number("longest of 10 000"),
        Column::number("time of a path"),
    ]);
    row(
        report,
        &mut table,
        "cornell box",
        "mirrors, glass, environment",
        &scenes::cornell_box(),
    )?;
    row(
        report,
        &mut table,
        "cornell box specular",
        "environment",
        &scenes::cornell_box_specular(),
    )?;
    row(
        report,
        &mut table,
        "environment",
        "lights",
        &scenes::environment(),
    )?;
    row(
        report,
        &mut table,
        "furnace",
        "mirrors, glass, environment",
        &scenes::furnace(),
    )?;
    report.page.section("What a scene does not need").text(
        "A part that a scene lacks is a type without content: it costs no code, no memory and no coordinate. Coordinates are counted over \
         10 000 paths through the middle row of the picture.",
    );
    report.page.table(&table);
    Ok(())
}

fn row<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter>(
    report: &Report,
    table: &mut Table,
    name: &str,
    left_out: &str,
    view: &View<B, L, E, C, F>,
) -> Result<(), Failure> {
    let mut read = Moments::<f64>::new();
    let mut most = 0;
    for path in 0..10_000_u32 {
        let pixel = view.pixel([path % 100, 50], [100, 100]);
        let mut counted = Counted {
            seed: hash::hash(report.seed, path.into()),
            read: 0,
        };
        pixel.evaluate(&mut counted);
        read.push(counted.read as f64);
        most = most.max(counted.read);
    }
    let size = [report.effort.claim; 2];
    let mut times = Vec::new();
    for run in 0..5 {
        let start = Instant::now();
        let picture = view.render(size, run, |key| MonteCarlo::new(16, key))?;
        times.push(start.elapsed().as_secs_f64() / picture.used() as f64);
    }
    times.sort_by(f64::total_cmp);
    table.row([
        Cell::from(name),
        left_out.into(),
        significant(read.mean(), 3).into(),
        most.to_string().into(),
        seconds(times[2], 2).into(),
    ]);
    Ok(())
}
