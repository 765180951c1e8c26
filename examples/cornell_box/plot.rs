//! The plot of error against run time, both axes logarithmic.

use std::error::Error;
use std::ops::Range;
use std::path::Path;

use plotters::coord::Shift;
use plotters::element::{Drawable, PointCollection};
use plotters::prelude::*;
use plotters::style::FontStyle;
use plotters_backend::{BackendCoord, DrawingErrorKind};

use crate::measure::Curve;
use crate::points::Points;

const SIZE: (u32, u32) = (960, 720);

type Failure = Box<dyn Error>;

/// Writes the plot as SVG.
pub(crate) fn svg(path: &Path, curves: &[Curve], reference_noise: f64) -> Result<(), Failure> {
    draw(
        &SVGBackend::new(path, SIZE).into_drawing_area(),
        curves,
        reference_noise,
    )
    .map_err(|error| format!("{}: {error}", path.display()).into())
}

/// Writes the plot as PNG.
pub(crate) fn png(path: &Path, curves: &[Curve], reference_noise: f64) -> Result<(), Failure> {
    let (width, height) = SIZE;
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    draw(
        &BitMapBackend::with_buffer(&mut pixels, SIZE).into_drawing_area(),
        curves,
        reference_noise,
    )?;
    image::save_buffer(path, &pixels, width, height, image::ColorType::Rgb8)
        .map_err(|error| format!("{}: {error}", path.display()).into())
}

/// A colour and a marker that stay apart for colour-blind eyes: the colours are those of Okabe and Ito (2008).
fn look(points: Points) -> (RGBColor, Marker) {
    match points {
        Points::MonteCarlo => (RGBColor(0, 0, 0), Marker::Circle),
        Points::Stratified => (RGBColor(230, 159, 0), Marker::Square),
        Points::NRooks => (RGBColor(86, 180, 233), Marker::Triangle),
        Points::Halton => (RGBColor(0, 158, 115), Marker::Diamond),
        Points::Hammersley => (RGBColor(213, 94, 0), Marker::Cross),
        Points::Sobol => (RGBColor(204, 121, 167), Marker::Plus),
    }
}

#[derive(Clone, Copy)]
enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    Cross,
    Plus,
}

/// A marker of some pixels around a point of the chart or of the picture.
struct Mark<C> {
    at: C,
    marker: Marker,
    color: RGBColor,
}

impl<'a, C> PointCollection<'a, C> for &'a Mark<C> {
    type Point = &'a C;
    type IntoIter = std::iter::Once<&'a C>;
    fn point_iter(self) -> Self::IntoIter {
        std::iter::once(&self.at)
    }
}

impl<C, DB: DrawingBackend> Drawable<DB> for Mark<C> {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        mut points: I,
        backend: &mut DB,
        _: (u32, u32),
    ) -> Result<(), DrawingErrorKind<DB::ErrorType>> {
        let Some((x, y)) = points.next() else {
            return Ok(());
        };
        let shifted = |offsets: &[BackendCoord]| -> Vec<BackendCoord> {
            offsets.iter().map(|&(dx, dy)| (x + dx, y + dy)).collect()
        };
        let pen = self.color.stroke_width(3);
        match self.marker {
            Marker::Circle => backend.draw_circle((x, y), 6, &self.color, true),
            Marker::Square => backend.draw_rect((x - 6, y - 6), (x + 6, y + 6), &self.color, true),
            Marker::Triangle => {
                backend.fill_polygon(shifted(&[(-7, 6), (7, 6), (0, -8)]), &self.color)
            }
            Marker::Diamond => {
                backend.fill_polygon(shifted(&[(0, -8), (8, 0), (0, 8), (-8, 0)]), &self.color)
            }
            Marker::Cross => {
                backend.draw_path(shifted(&[(-6, -6), (6, 6)]), &pen)?;
                backend.draw_path(shifted(&[(-6, 6), (6, -6)]), &pen)
            }
            Marker::Plus => {
                backend.draw_path(shifted(&[(-8, 0), (8, 0)]), &pen)?;
                backend.draw_path(shifted(&[(0, -8), (0, 8)]), &pen)
            }
        }
    }
}

/// A range around positive values, with room at both ends.
fn around(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low < f64::INFINITY {
        low / 1.5..high * 1.5
    } else {
        0.1..1.0
    }
}

fn draw<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    curves: &[Curve],
    reference_noise: f64,
) -> Result<(), Failure>
where
    DB::ErrorType: 'static,
{
    let _ = plotters::style::register_font(
        "sans-serif",
        FontStyle::Normal,
        epaint_default_fonts::UBUNTU_LIGHT,
    );
    let samples = || curves.iter().flat_map(|curve| &curve.samples);
    let times = around(samples().map(|sample| sample.seconds));
    let errors = around(samples().map(|sample| sample.rmse));
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(area)
        .caption("Cornell box: error against run time", ("sans-serif", 26))
        .margin(16)
        .x_label_area_size(56)
        .y_label_area_size(84)
        .build_cartesian_2d(times.clone().log_scale(), errors.clone().log_scale())?;
    chart
        .configure_mesh()
        .x_desc("seconds")
        .y_desc("RMSE against Mitsuba 3")
        .x_label_formatter(&|value| short(*value))
        .y_label_formatter(&|value| short(*value))
        .label_style(("sans-serif", 18))
        .axis_desc_style(("sans-serif", 20))
        .light_line_style(RGBColor(235, 235, 235))
        .bold_line_style(RGBColor(200, 200, 200))
        .draw()?;
    for curve in curves {
        let (color, marker) = look(curve.points);
        let line: Vec<(f64, f64)> = curve
            .samples
            .iter()
            .map(|sample| (sample.seconds, sample.rmse))
            .collect();
        let label = match curve.slope(reference_noise) {
            Some(slope) => format!("{}, slope {slope:.2}", curve.points.name()),
            None => curve.points.name().to_owned(),
        };
        chart
            .draw_series(LineSeries::new(line.clone(), color.stroke_width(2)))?
            .label(label)
            .legend(move |(x, y)| Mark {
                at: (x + 10, y),
                marker,
                color,
            });
        chart.draw_series(line.into_iter().map(|at| Mark { at, marker, color }))?;
    }
    if errors.contains(&reference_noise) {
        let grey = RGBColor(120, 120, 120);
        let level = [(times.start, reference_noise), (times.end, reference_noise)];
        chart
            .draw_series(DashedLineSeries::new(level, 8, 6, grey.stroke_width(2)))?
            .label("noise of the reference")
            .legend(move |(x, y)| {
                PathElement::new(vec![(x, y), (x + 20, y)], grey.stroke_width(2))
            });
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

/// A number with as many digits as it needs.
fn short(value: f64) -> String {
    let digits = (-value.log10().floor()).clamp(0.0, 8.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 to 8"
    )]
    let digits = digits as usize;
    format!("{value:.digits$}")
}
