//! Section 5: what a scene does not need.

use std::path::Path;
use std::time::Instant;

use estimand::mitsuba::{self, Instance, Loaded};
use estimand::points::{Independent, pixel};
use estimand::report::number::{seconds, significant};
use estimand::report::{Cell, Column, Table};
use estimand::{Moments, each};
use serde_json::json;

use crate::spread::Spread;
use crate::{Failure, Report};

pub(crate) const STEPS: u64 = 4;

/// The scenes that the references are made of.
const SCENES: [&str; 4] = [
    "cornell_box",
    "cornell_box_specular",
    "environment",
    "furnace",
];

pub(crate) fn add(report: &mut Report) -> Result<(), Failure> {
    report.page.section("What a scene does not need").text(
        "A scene is loaded as the smallest type that can render it: what it lacks costs no code, no memory and no coordinate. Here each is \
         rendered as that, and as the one type that can render every scene; turn by turn, with the same points. Times are of one \
         path of light on all threads, the median of several pictures.",
    );
    let mut table = Table::new([
        Column::text("scene"),
        Column::prose("left out"),
        Column::number("coordinates a path"),
        Column::number("in general"),
        Column::number("time of a path"),
        Column::number("in general"),
        Column::number("times as fast"),
    ]);
    let mut data = Vec::new();
    for name in SCENES {
        report.doing(format!("what {name} does not need"));
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("reference/scenes/{name}.xml"));
        let size = report.effort.claim.to_string();
        let description = mitsuba::read(&path, &[("size", &size)])?;
        let smallest = description.load(Instance::Smallest)?;
        let general = description.load(Instance::General)?;
        let read = [&smallest, &general].map(coordinates);
        let [lean, full] = times(report, [&smallest, &general])?;
        let gain = full.over(lean);
        data.push(json!({
            "scene": name, "left_out": smallest.left_out, "coordinates": read[0], "coordinates_general": read[1],
            "seconds": lean.value, "seconds_general": full.value, "gain": [gain.low, gain.value, gain.high],
        }));
        table.row([
            Cell::from(name.replace('_', " ")),
            smallest.left_out.join(", ").into(),
            significant(read[0], 3).into(),
            significant(read[1], 3).into(),
            seconds(lean.value, 2).into(),
            seconds(full.value, 2).into(),
            format!("{} {}", significant(gain.value, 2), gain.interval()).into(),
        ]);
    }
    std::fs::write(
        report.file("lean.json"),
        serde_json::to_string_pretty(&data)?,
    )?;
    report.page.table(&table).files(["lean.json"]);
    Ok(())
}

/// How many coordinates a path reads, in the mean over a grid of pixels.
fn coordinates(loaded: &Loaded) -> f64 {
    let [width, height] = loaded.size;
    let mut read = Moments::<f64>::new();
    for place in 0..1 << 12 {
        let position = [place % 64 * width / 64, place / 64 * height / 64];
        let points = Independent::new(pixel::seed(position, 0));
        let count = loaded
            .picture
            .coordinates(position, loaded.size, &points, place.into());
        read.push(count as f64);
    }
    read.mean()
}

/// How long a path takes in each of two scenes.
fn times(report: &Report, scenes: [&Loaded; 2]) -> Result<[Spread; 2], Failure> {
    const SPP: u64 = 32;
    let mut times = [Vec::new(), Vec::new()];
    for run in 0..=report.effort.claim_runs {
        for (loaded, times) in scenes.iter().zip(&mut times) {
            let [width, height] = loaded.size;
            let start = Instant::now();
            let rows = each(height.into(), |y| {
                let y = u32::try_from(y).expect("the height is a u32");
                (0..width).try_for_each(|x| {
                    let points = Independent::new(pixel::seed([x, y], run));
                    let pixel = loaded.picture.average([x, y], loaded.size, &points, SPP);
                    pixel.map(drop).map_err(|incomplete| incomplete.reason)
                })
            });
            rows.into_iter().collect::<Result<(), _>>()?;
            let paths = u64::from(width) * u64::from(height) * SPP;
            // The first is not counted.
            if run > 0 {
                times.push(start.elapsed().as_secs_f64() / paths as f64);
            }
        }
    }
    Ok(times.map(Spread::of_times))
}
