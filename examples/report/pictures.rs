//! Section 2: the Cornell box by every method in the same time, and adaptive against uniform sampling.

use std::time::Instant;

use estimand::path::{Adaptive, Direct, Ending, Image, Recursive, Unfinished, scenes};
use estimand::report::Picture;
use estimand::report::number::{seconds, significant};
use estimand::{Estimator, Moments, MonteCarlo, hash};
use glam::DVec3;

use crate::boxes::reference;
use crate::false_color::{luminance, png, positive, signed};
use crate::points::Points;
use crate::{Failure, Report};

const METHODS: u64 = 8;
pub(crate) const STEPS: u64 = METHODS + 1;

/// How to render with a number of samples per pixel and a seed.
type Render<'a> = Box<dyn Fn(u64, u64) -> Result<Image, Unfinished> + 'a>;

/// Several pictures of one method.
struct Shots {
    name: &'static str,
    spp: u64,
    seconds: f64,
    first: Image,
    rmse: f64,
    /// Of one picture, pixel by pixel.
    std_error: Vec<DVec3>,
}

pub(crate) fn add(report: &mut Report) -> Result<(), Failure> {
    let (size, time) = (report.effort.large, report.effort.equal_time);
    let reference = reference("cornell_box", size)?;
    let view = scenes::cornell_box();
    let tree = |rays, direct| {
        let tree = Recursive::new(rays, Ending::Roulette(3), direct).expect("at least one ray");
        let view = &view;
        move |spp: u64, seed: u64| {
            Image::of_pixels([size; 2], seed, |position, key| {
                MonteCarlo::new(spp, key).estimate(&tree.pixel(view.pixel(position, [size; 2])))
            })
        }
    };
    let mut methods: Vec<(&'static str, Render<'_>)> = Vec::new();
    for points in Points::ALL {
        let view = &view;
        let render = move |spp, seed| points.render(view, size, spp, seed);
        methods.push((points.title(), Box::new(render)));
    }
    methods.push((
        "branching: 4 rays a surface",
        Box::new(tree(4, Direct::NextEvent)),
    ));
    methods.push(("lights met by chance", Box::new(tree(1, Direct::Chance))));

    report.page.section("Pictures");
    report.page.subsection("In equal time").text(&format!(
        "The Cornell box, {size} × {size} pixels, by every method in about {} a picture. Beside every picture: its error, pixel by pixel, \
         against Mitsuba's, blue where it is too dark and red where it is too bright; and the standard error of its pixels, from {} \
         pictures with other seeds, dark to bright. Each kind has one scale, written below it. The last two find the light by recursion; \
         all others by the path tracer, with next-event estimation and Russian roulette.",
        seconds(time, 2),
        report.effort.repeats
    ));
    let mut shots = Vec::new();
    for (name, render) in &methods {
        report.doing(format!("picture: {name}"));
        shots.push(shoot(report, name, render, &reference)?);
    }
    let limits = Limits::of(&shots[0], &reference);
    let mut pictures = vec![Picture {
        png: png(&reference, &report.file("picture_reference.png"))?,
        caption: "Mitsuba 3: the reference".to_owned(),
    }];
    if let Some(errors) = reference.std_error() {
        let values: Vec<f64> = errors.pixels().iter().map(|&e| luminance(e)).collect();
        let image = positive(reference.width(), &values, limits.std_error)?;
        pictures.push(Picture {
            png: png(&image, &report.file("picture_reference_std_error.png"))?,
            caption: format!(
                "its standard error, 0 to {}",
                significant(limits.std_error, 2)
            ),
        });
    }
    report.page.pictures(&pictures);
    for (number, shot) in (1..).zip(&shots) {
        let pictures = shot.pictures(report, &limits, &reference, number)?;
        report.page.pictures(&pictures);
    }
    report.doing("adaptive sampling");
    adaptive(report, &reference, &limits)
}

fn shoot(
    report: &Report,
    name: &'static str,
    render: &Render<'_>,
    reference: &Image,
) -> Result<Shots, Failure> {
    let time = report.effort.equal_time;
    let clocked = |spp: u64, seed: u64| -> Result<(Image, f64), Failure> {
        let start = Instant::now();
        let image = render(spp, seed)?;
        Ok((image, start.elapsed().as_secs_f64()))
    };
    let seed = |run| hash::hash(report.seed, run);
    // Guesses of how many samples fill the time: the second from a quarter of it, the last from all of it.
    let mut spp = 4;
    clocked(spp, seed(100))?;
    for share in [0.25, 1.0, 1.0] {
        let (_, took) = clocked(spp, seed(101))?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive count"
        )]
        let more = (spp as f64 * share * time / took) as u64;
        spp = more.max(1);
    }
    let (mut squares, mut times) = (0.0, Vec::new());
    let mut moments = vec![Moments::<DVec3>::new(); reference.pixels().len()];
    let mut first = None;
    for run in 0..report.effort.repeats {
        let (image, took) = clocked(spp, seed(run))?;
        squares += image.rmse(reference)?.powi(2);
        times.push(took);
        for (moments, &pixel) in moments.iter_mut().zip(image.pixels()) {
            moments.push(pixel);
        }
        first.get_or_insert(image);
    }
    times.sort_by(f64::total_cmp);
    let first = first.ok_or("no picture")?;
    Ok(Shots {
        name,
        spp: first.used() / first.pixels().len() as u64,
        seconds: times[times.len() / 2],
        first,
        rmse: (squares / report.effort.repeats as f64).sqrt(),
        std_error: moments
            .iter()
            .map(|moments| moments.std_dev().unwrap_or(DVec3::ZERO))
            .collect(),
    })
}

/// Where the colour scales end.
struct Limits {
    error: f64,
    std_error: f64,
}

impl Limits {
    /// Those in which the pixels of a picture but for the worst lie.
    fn of(shot: &Shots, reference: &Image) -> Self {
        let mut errors: Vec<f64> = errors(&shot.first, reference).map(f64::abs).collect();
        let mut spread: Vec<f64> = shot.std_error.iter().map(|&e| luminance(e)).collect();
        let high = |values: &mut Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values[values.len() * 97 / 100]
        };
        Self {
            error: high(&mut errors),
            std_error: high(&mut spread),
        }
    }
}

fn errors(image: &Image, reference: &Image) -> impl Iterator<Item = f64> {
    let pixels = image.pixels().iter().zip(reference.pixels());
    pixels.map(|(&here, &there)| luminance(here - there))
}

impl Shots {
    fn pictures(
        &self,
        report: &Report,
        limits: &Limits,
        reference: &Image,
        number: u32,
    ) -> Result<Vec<Picture>, Failure> {
        let width = reference.width();
        let stem = format!("picture_{number}");
        self.first.write_exr(report.file(&format!("{stem}.exr")))?;
        let values: Vec<f64> = errors(&self.first, reference).collect();
        let error = signed(width, &values, limits.error)?;
        let values: Vec<f64> = self.std_error.iter().map(|&e| luminance(e)).collect();
        let std_error = positive(width, &values, limits.std_error)?;
        let (error_limit, spread_limit) = (
            significant(limits.error, 2),
            significant(limits.std_error, 2),
        );
        Ok(vec![
            Picture {
                png: png(&self.first, &report.file(&format!("{stem}.png")))?,
                caption: format!(
                    "{}: {} samples a pixel in {}, RMSE {}",
                    self.name,
                    self.spp,
                    seconds(self.seconds, 2),
                    significant(self.rmse, 2)
                ),
            },
            Picture {
                png: png(&error, &report.file(&format!("{stem}_error.png")))?,
                caption: format!("its error, −{error_limit} (blue) to +{error_limit} (red)"),
            },
            Picture {
                png: png(&std_error, &report.file(&format!("{stem}_std_error.png")))?,
                caption: format!("its standard error, 0 (dark) to {spread_limit} (bright)"),
            },
        ])
    }
}

fn adaptive(report: &mut Report, reference: &Image, limits: &Limits) -> Result<(), Failure> {
    const SPP: u64 = 64;
    let (size, view) = ([report.effort.large; 2], scenes::cornell_box());
    let adaptive = Adaptive::new(SPP, 8)?;
    let (mut even, mut odd) = (Vec::new(), Vec::new());
    let mut squares = [0.0; 2];
    let mut times = [0.0; 2];
    let mut samples = Vec::new();
    for run in 0..report.effort.repeats {
        let seed = hash::hash(report.seed, 200 + run);
        let start = Instant::now();
        let uniform = view.render(size, seed, |key| MonteCarlo::new(SPP, key))?;
        let middle = Instant::now();
        let adapted = view.render_adaptive(size, seed, adaptive, |key, count| {
            MonteCarlo::new(count, key)
        })?;
        times[0] += (middle - start).as_secs_f64();
        times[1] += middle.elapsed().as_secs_f64();
        squares[0] += uniform.rmse(reference)?.powi(2);
        squares[1] += adapted.image.rmse(reference)?.powi(2);
        even.push(uniform);
        odd.push(adapted.image);
        samples = adapted.samples;
    }
    let runs = report.effort.repeats as f64;
    let rmse = squares.map(|sum| (sum / runs).sqrt());
    let counts: Vec<f64> = samples.iter().map(|&count| count as f64).collect();
    let most = counts.iter().copied().fold(0.0, f64::max);
    let fewest = counts.iter().copied().fold(f64::INFINITY, f64::min);
    let width = reference.width();
    let mut pictures = Vec::new();
    for (kind, images) in [("uniform", &even), ("adaptive", &odd)] {
        let image = &images[0];
        let which = usize::from(kind == "adaptive");
        let error: Vec<f64> = errors(image, reference).collect();
        let error = signed(width, &error, limits.error)?;
        image.write_exr(report.file(&format!("{kind}.exr")))?;
        pictures.push(Picture {
            png: png(image, &report.file(&format!("{kind}.png")))?,
            caption: format!(
                "{kind}: {SPP} samples a pixel in {}, RMSE {}",
                seconds(times[which] / runs, 2),
                significant(rmse[which], 2)
            ),
        });
        pictures.push(Picture {
            png: png(&error, &report.file(&format!("{kind}_error.png")))?,
            caption: format!(
                "its error, on the scale of the others, ±{}",
                significant(limits.error, 2)
            ),
        });
    }
    let limit = 3.0 * SPP as f64;
    let map = positive(width, &counts, limit)?;
    pictures.push(Picture {
        png: png(&map, &report.file("adaptive_samples.png"))?,
        caption: format!(
            "samples of the adaptive picture, 0 (dark) to {limit} and more (bright); from {fewest} to {most}"
        ),
    });
    let text: Vec<String> = samples
        .chunks(width)
        .map(|row| row.iter().map(u64::to_string).collect::<Vec<_>>().join(","))
        .collect();
    std::fs::write(report.file("adaptive_samples.csv"), text.join("\n") + "\n")?;
    report
        .page
        .subsection("Adaptive against uniform")
        .text(
            "64 independent samples a pixel in the mean: the same for all pixels, or eight for all, and the others dealt as those of the pixels around say. \
             No sample has a say in the number of its own pixel, so that there is no bias. Section 3 measures what there is.",
        )
        .pictures(&pictures)
        .files(["uniform.exr", "adaptive.exr", "adaptive_samples.csv"]);
    Ok(())
}
