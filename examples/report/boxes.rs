//! Section 1, second half: three Cornell boxes, every point set.

use std::path::Path;

use estimand::convergence::{Convergence, Study};
use estimand::path::bsdf::Bsdf;
use estimand::path::light::{Environment, Light};
use estimand::path::sensor::Sensor;
use estimand::path::{Image, View, scenes};
use estimand::report::number::significant;
use estimand::report::{Chart, Table};

use crate::points::Points;
use crate::{Failure, Report};

pub(crate) const STEPS: u64 = 3;

/// One picture that is compared with Mitsuba's.
pub(crate) struct Room {
    /// The name of the reference.
    pub(crate) name: &'static str,
    heading: &'static str,
    pub(crate) about: &'static str,
    /// Mitsuba's scene, and what is set in it.
    pub(crate) scene: &'static str,
    pub(crate) depth: Option<u32>,
}

const DIFFUSE: Room = Room {
    name: "cornell_box",
    heading: "Cornell box",
    about: "The Cornell box, all of it diffuse.",
    scene: "cornell_box.xml",
    depth: None,
};
const SHORT: Room = Room {
    name: "cornell_box_depth_8",
    heading: "Cornell box of short paths",
    about: "The same, without the light of paths of more than eight segments.",
    scene: "cornell_box.xml",
    depth: Some(8),
};
const SPECULAR: Room = Room {
    name: "cornell_box_specular",
    heading: "Cornell box with mirror and glass",
    about: "The Cornell box with a mirror ball and a glass ball: what they throw on the floor is hard to find.",
    scene: "cornell_box_specular.xml",
    depth: None,
};

/// The errors, relative to the mean of the picture, to which times are given.
const TARGETS: [f64; 5] = [1.0, 0.3, 0.1, 0.01, 0.001];

pub(crate) fn add(report: &mut Report) -> Result<(), Failure> {
    let (size, seeds) = (report.effort.small, report.effort.picture_seeds);
    let spp: Vec<String> = report.effort.spp().map(|spp| spp.to_string()).collect();
    report.page.subsection("Three Cornell boxes").text(&format!(
        "Pictures of {size} × {size} pixels with {} samples a pixel, {seeds} of each with seeds of their own. The error is that against \
         Mitsuba's picture, over all pixels and components, relative to the mean of that. The noise of Mitsuba's picture is drawn \
         dotted; errors below three times of it are left out of slopes and times. One evaluation is one light path. A few pixels along the \
         rim of the light, a hundred times as bright as the rest, make up most of the error. What no picture reached is extrapolated by the \
         slope of its method, and marked ≈.",
        spp.join(", ")
    ));
    add_one(report, &DIFFUSE, &scenes::cornell_box())?;
    let mut short = scenes::cornell_box();
    short.paths = short.paths.longest(8)?;
    add_one(report, &SHORT, &short)?;
    add_one(report, &SPECULAR, &scenes::cornell_box_specular())
}

fn add_one<B: Bsdf, L: Light, E: Environment, C: Sensor>(
    report: &mut Report,
    of: &Room,
    view: &View<B, L, E, C>,
) -> Result<(), Failure> {
    report.doing(of.name);
    let size = report.effort.small;
    let reference = reference(of.name, size)?;
    let mut convergence = study(report, view, &reference)?;
    let file = report.file(&format!("{}_reference.exr", of.name));
    reference.write_exr(&file)?;
    let theirs =
        report
            .peers
            .pictures(of, &file, &report.effort, report.seed, reference.noise())?;
    convergence.curves.extend(theirs);
    convergence.write_csv(report.file(&format!("{}.csv", of.name)))?;
    convergence.write_json(report.file(&format!("{}.json", of.name)))?;
    if of.depth.is_none() && of.name == DIFFUSE.name {
        let chart = Chart::over_time("Cornell box: error against run time", &convergence);
        chart.write_svg(report.file("error_against_run_time.svg"))?;
    }
    let (csv, json) = (format!("{}.csv", of.name), format!("{}.json", of.name));
    report.page.subsection(of.heading);
    report
        .page
        .text(&format!(
            "{} The mean of the picture is {}.",
            of.about,
            significant(convergence.scale.unwrap_or(f64::NAN), 4)
        ))
        .charts([
            &Chart::over_time("Error over time", &convergence),
            &Chart::over_evaluations("Error over paths of light, with slopes", &convergence),
        ])
        .table(&Table::of_times(&convergence, &TARGETS))
        .table(&Table::of_study(&convergence))
        .files([csv.as_str(), json.as_str()]);
    Ok(())
}

fn study<B: Bsdf, L: Light, E: Environment, C: Sensor>(
    report: &Report,
    view: &View<B, L, E, C>,
    reference: &Image,
) -> Result<Convergence, estimand::Error> {
    let effort = &report.effort;
    let mut study = Study::new(effort.spp(), effort.picture_seeds)?
        .first_seed(report.seed.wrapping_mul(2_000_003))
        .shortest(effort.shortest)
        .pictures(reference);
    for points in Points::ALL {
        study = study.method(points.title(), move |spp, seed| {
            points.render(view, effort.small, spp, seed)
        });
    }
    study.run()
}

/// Mitsuba's picture at the given size, with its standard errors.
pub(crate) fn reference(name: &str, size: u32) -> Result<Image, Failure> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/images");
    let read = |suffix| Image::read_exr(folder.join(format!("{name}{suffix}.exr")));
    let image = read("")?.with_std_error(read("_std_error")?)?;
    Ok(image.downsampled(image.width() / size as usize)?)
}
