//! The discrepancy of several sets against the count of points, as a table, a picture and data.

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use estimand::discrepancy::Points;
use indicatif::{ProgressBar, ProgressStyle};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::FontStyle;
use serde_json::{Value, json};

use crate::marks::{LOOKS, Mark};
use crate::measure::Measure;
use crate::sets::{Choice, Set};

pub(crate) const SETS: [Set; 6] = [
    Set::Independent,
    Set::Stratified,
    Set::NRooks,
    Set::Halton,
    Set::Hammersley,
    Set::Sobol,
];

pub(crate) const COUNTS: [u64; 12] = [8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384];

const SIZE: (u32, u32) = (1000, 760);

/// What is measured.
pub(crate) struct Sweep<'a> {
    pub(crate) measure: Measure,
    pub(crate) sets: &'a [Set],
    pub(crate) counts: &'a [u64],
    pub(crate) replicates: u64,
    pub(crate) dimensions: u32,
    pub(crate) first: u64,
    pub(crate) choice: Choice,
}

/// One set at all counts.
pub(crate) struct Curve {
    set: Set,
    samples: Vec<Sample>,
}

struct Sample {
    /// How many points there are, which may be another number than what was asked for.
    count: u64,
    /// The mean over the replicates.
    value: f64,
    /// Over how many.
    replicates: u64,
    /// `exact`, unless one of the replicates was something less.
    kind: &'static str,
}

impl Curve {
    /// The slope of the logarithms, by least squares, over the upper half of the counts and at least two.
    ///
    /// `None` with a single count, and for values of 0.
    fn slope(&self) -> Option<f64> {
        let count = self.samples.len();
        let upper = &self.samples[(count / 2).min(count.saturating_sub(2))..];
        let logs: Vec<(f64, f64)> = upper
            .iter()
            .map(|sample| ((sample.count as f64).ln(), sample.value.ln()))
            .collect();
        let count = logs.len() as f64;
        let (x, y) = logs.iter().fold((0.0, 0.0), |(x, y), log| {
            (x + log.0 / count, y + log.1 / count)
        });
        let covariance: f64 = logs.iter().map(|log| (log.0 - x) * (log.1 - y)).sum();
        let variance: f64 = logs.iter().map(|log| (log.0 - x).powi(2)).sum();
        let slope = covariance / variance;
        slope.is_finite().then_some(slope)
    }

    /// The name of the set, with the slope if there is one.
    fn label(&self) -> String {
        match self.slope() {
            Some(slope) => format!("{}, slope {slope:.2}", self.set),
            None => self.set.to_string(),
        }
    }
}

impl Sweep<'_> {
    pub(crate) fn run(&self) -> Result<Vec<Curve>, Box<dyn Error>> {
        let bar = ProgressBar::new((self.sets.len() * self.counts.len()) as u64).with_style(
            ProgressStyle::with_template("{bar:40} {pos}/{len} {msg}, {eta} left")?,
        );
        let mut curves = Vec::new();
        for &set in self.sets {
            let mut samples = Vec::new();
            for &count in self.counts {
                bar.set_message(format!("{set}, {count} points"));
                samples.push(self.sample(set, count)?);
                bar.inc(1);
            }
            curves.push(Curve { set, samples });
        }
        bar.finish_and_clear();
        Ok(curves)
    }

    fn sample(&self, set: Set, count: u64) -> Result<Sample, Box<dyn Error>> {
        let random = matches!(set, Set::Independent | Set::Stratified | Set::NRooks)
            || self.choice.scramble != crate::sets::Scramble::None;
        let replicates = if random { self.replicates } else { 1 };
        let mut sample = Sample {
            count,
            value: 0.0,
            replicates,
            kind: "exact",
        };
        for replicate in 0..replicates {
            let choice = Choice {
                seed: self.choice.seed.wrapping_add(replicate),
                ..self.choice
            };
            let points = choice.build(set, self.dimensions, count)?;
            sample.count = points.size().unwrap_or(count);
            let end = self
                .first
                .checked_add(sample.count)
                .ok_or("the indices pass the last one")?;
            let points = Points::from_set(&*points, self.first..end, self.dimensions)?;
            let answer = self.measure.of(&points)?;
            sample.value += answer.lower() / replicates as f64;
            if answer.kind() != "exact" {
                sample.kind = "lower-bound";
            }
        }
        Ok(sample)
    }

    fn name(&self) -> String {
        let square = if self.measure.squared {
            ", squared"
        } else {
            ""
        };
        format!("{}{square}", self.measure.metric.name())
    }

    pub(crate) fn json(&self, curves: &[Curve]) -> Value {
        let curves: Vec<Value> = curves
            .iter()
            .map(|curve| {
                let samples: Vec<Value> = curve
                    .samples
                    .iter()
                    .map(|sample| {
                        json!({
                            "count": sample.count,
                            "value": sample.value,
                            "replicates": sample.replicates,
                            "kind": sample.kind,
                        })
                    })
                    .collect();
                json!({"set": curve.set.to_string(), "slope": curve.slope(), "samples": samples})
            })
            .collect();
        json!({
            "metric": self.measure.metric.name(),
            "squared": self.measure.squared,
            "dimensions": self.dimensions,
            "first": self.first,
            "curves": curves,
        })
    }

    /// The values, a row a count and a column a set. A star marks lower bounds.
    pub(crate) fn table(&self, curves: &[Curve]) -> String {
        let mut text = format!(
            "{} in {} dimensions\n{:>8}",
            self.name(),
            self.dimensions,
            "n"
        );
        for curve in curves {
            let _ = write!(text, "{:>17}", curve.set.to_string());
        }
        for (row, count) in self.counts.iter().enumerate() {
            let _ = write!(text, "\n{count:>8}");
            for curve in curves {
                let sample = &curve.samples[row];
                let mark = if sample.kind == "exact" { ' ' } else { '*' };
                let _ = write!(text, "{:>16.9}{mark}", sample.value);
            }
        }
        let _ = write!(text, "\n{:>8}", "slope");
        for curve in curves {
            let slope = curve
                .slope()
                .map_or("-".to_owned(), |slope| format!("{slope:.2}"));
            let _ = write!(text, "{slope:>16} ");
        }
        text.push('\n');
        let samples = || curves.iter().flat_map(|curve| &curve.samples);
        if samples().any(|sample| sample.kind != "exact") {
            text.push_str("* a lower bound\n");
        }
        for curve in curves {
            for (sample, count) in curve.samples.iter().zip(self.counts) {
                if sample.count != *count {
                    let _ = writeln!(
                        text,
                        "{} has {} points for {count}",
                        curve.set, sample.count
                    );
                }
            }
        }
        text
    }

    /// Writes the picture as PNG and as SVG.
    pub(crate) fn draw(
        &self,
        curves: &[Curve],
        out: &Path,
    ) -> Result<Vec<PathBuf>, Box<dyn Error>> {
        let stem = format!(
            "discrepancy-{}-{}d",
            self.measure.metric.name(),
            self.dimensions
        );
        let (svg, png) = (
            out.join(format!("{stem}.svg")),
            out.join(format!("{stem}.png")),
        );
        self.chart(&SVGBackend::new(&svg, SIZE).into_drawing_area(), curves)
            .map_err(|error| format!("{}: {error}", svg.display()))?;
        let (width, height) = SIZE;
        let mut pixels = vec![0; 3 * width as usize * height as usize];
        self.chart(
            &BitMapBackend::with_buffer(&mut pixels, SIZE).into_drawing_area(),
            curves,
        )?;
        image::save_buffer(&png, &pixels, width, height, image::ColorType::Rgb8)
            .map_err(|error| format!("{}: {error}", png.display()))?;
        Ok(vec![png, svg])
    }

    fn chart<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        curves: &[Curve],
    ) -> Result<(), Box<dyn Error>>
    where
        DB::ErrorType: 'static,
    {
        let _ = plotters::style::register_font(
            "sans-serif",
            FontStyle::Normal,
            epaint_default_fonts::UBUNTU_LIGHT,
        );
        let drawn = |sample: &&Sample| sample.value > 0.0 && sample.value.is_finite();
        let samples = || curves.iter().flat_map(|curve| &curve.samples).filter(drawn);
        let (mut counts, mut values) = (1.0..1.0, f64::INFINITY..0.0_f64);
        counts.start = samples().map(|s| s.count).min().unwrap_or(1) as f64 / 1.2;
        counts.end = samples().map(|s| s.count).max().unwrap_or(1) as f64 * 1.2;
        for sample in samples() {
            values = values.start.min(sample.value)..values.end.max(sample.value);
        }
        if values.end == 0.0 {
            return Err("nothing to draw: no value is above 0".into());
        }
        let values = values.start / 1.5..values.end * 1.5;
        area.fill(&WHITE)?;
        let mut caption = format!("{} in {} dimensions", self.name(), self.dimensions);
        if samples().any(|sample| sample.replicates > 1) {
            caption += &format!("; random sets: mean of {}", self.replicates);
        }
        if samples().any(|sample| sample.kind != "exact") {
            caption += "; lower bounds among them";
        }
        let mut chart = ChartBuilder::on(area)
            .caption(caption, ("sans-serif", 26))
            .margin(16)
            .x_label_area_size(56)
            .y_label_area_size(92)
            .build_cartesian_2d(counts.log_scale(), values.log_scale())?;
        chart
            .configure_mesh()
            .x_desc("number of points n")
            .y_desc(format!("discrepancy: {}", self.name()))
            .x_label_formatter(&|value| format!("{value:.0}"))
            .y_label_formatter(&|value| scientific(*value))
            .label_style(("sans-serif", 18))
            .axis_desc_style(("sans-serif", 20))
            .light_line_style(RGBColor(238, 238, 238))
            .bold_line_style(RGBColor(205, 205, 205))
            .draw()?;
        for (curve, &(color, marker)) in curves.iter().zip(LOOKS.iter().cycle()) {
            let line: Vec<(f64, f64)> = curve
                .samples
                .iter()
                .filter(drawn)
                .map(|sample| (sample.count as f64, sample.value))
                .collect();
            chart
                .draw_series(LineSeries::new(line.clone(), color.stroke_width(2)))?
                .label(curve.label())
                .legend(move |(x, y)| Mark {
                    at: (x + 10, y),
                    marker,
                    color,
                });
            chart.draw_series(line.into_iter().map(|at| Mark { at, marker, color }))?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerLeft)
            .label_font(("sans-serif", 18))
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK)
            .draw()?;
        area.present()?;
        Ok(())
    }
}

/// A power of ten, or as few digits as do.
fn scientific(value: f64) -> String {
    if (1e-3..1e4).contains(&value) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
