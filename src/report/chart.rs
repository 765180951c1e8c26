//! Curves over two logarithmic axes, as SVG.

use std::fmt::Write;
use std::io;
use std::path::Path;

use super::axis::{Axis, ticks};
use super::{escaped, files, looks, number};
use crate::convergence::{Convergence, Curve, Sample};

/// Curves over two logarithmic axes: an SVG whose text is text, and whose colours follow the reader's light or dark.
///
/// ```
/// use estimand::report::{Axis, Chart, Line, Point};
///
/// let halves = (0..8).map(|k| Point::new(2_f64.powi(k), 0.5_f64.powi(k)));
/// let mut chart = Chart::new("Halves", Axis::new("count"), Axis::new("error"));
/// chart.line(Line::new("one half", halves));
/// assert!(chart.svg().contains("<svg"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    title: String,
    x: Axis,
    y: Axis,
    lines: Vec<Line>,
    levels: Vec<(String, f64)>,
}

/// One curve of a [`Chart`].
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    name: String,
    note: String,
    points: Vec<Point>,
}

/// One point of a [`Line`], with its band from `low` to `high`.
///
/// Numbers that are not positive and finite have no place on a logarithmic axis; such points are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where, to the right.
    pub x: f64,
    /// Where, upwards.
    pub y: f64,
    /// The lower end of the band.
    pub low: f64,
    /// The upper end of the band.
    pub high: f64,
}

impl Point {
    /// A point without a band.
    pub const fn new(x: f64, y: f64) -> Self {
        Self {
            x,
            y,
            low: y,
            high: y,
        }
    }

    fn is_drawn(&self) -> bool {
        [self.x, self.y].iter().all(|v| *v > 0.0 && v.is_finite())
    }
}

impl Line {
    /// A curve through some points, in their order.
    pub fn new(name: impl Into<String>, points: impl IntoIterator<Item = Point>) -> Self {
        Self {
            name: name.into(),
            note: String::new(),
            points: points.into_iter().filter(Point::is_drawn).collect(),
        }
    }

    /// The same with a remark for the legend: a slope, say.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }
}

const WIDTH: f64 = 560.0;
const LEFT: f64 = 66.0;
/// Leaves room for half of a label below the right end: "300 ms".
const RIGHT: f64 = 532.0;
const TOP: f64 = 10.0;
const BOTTOM: f64 = 320.0;
/// Where the legend begins, and how high its rows are.
const LEGEND: f64 = 376.0;
const ROW: f64 = 20.0;

impl Chart {
    /// A chart without curves.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            lines: Vec::new(),
            levels: Vec::new(),
        }
    }

    /// The error of every method over the time of a run, with the bands of the errors.
    pub fn over_time(title: impl Into<String>, convergence: &Convergence) -> Self {
        let axis = Axis::seconds("time of one run (wall clock)");
        let mut chart = Self::new(title, axis, error_axis(convergence));
        for curve in &convergence.curves {
            chart.line(curve_line(convergence, curve, |sample| sample.seconds));
        }
        chart.with_noise(convergence)
    }

    /// The error of every method over its evaluations, with the fitted slopes in the legend.
    pub fn over_evaluations(title: impl Into<String>, convergence: &Convergence) -> Self {
        let axis = Axis::new("evaluations of the integrand (count)");
        let mut chart = Self::new(title, axis, error_axis(convergence));
        for curve in &convergence.curves {
            let slope = curve.slope.map(|slope| number::fixed(slope.value, 2));
            let line = curve_line(convergence, curve, |sample| sample.evaluations as f64);
            chart.line(line.note(slope.unwrap_or_default()));
        }
        chart.with_noise(convergence)
    }

    fn with_noise(mut self, convergence: &Convergence) -> Self {
        if convergence.noise > 0.0 {
            let noise = convergence.noise / scale(convergence);
            self.level("noise of the reference", noise);
        }
        self
    }

    /// Adds a curve. Its look is that of its place among the curves.
    pub fn line(&mut self, line: Line) -> &mut Self {
        self.lines.push(line);
        self
    }

    /// Adds a dotted level line, drawn where it lies within the range of the curves.
    pub fn level(&mut self, name: impl Into<String>, y: f64) -> &mut Self {
        self.levels.push((name.into(), y));
        self
    }

    /// The title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The chart as an `svg` element for a [`Page`](super::Page), which has the style it needs.
    pub fn svg(&self) -> String {
        self.drawn("")
    }

    /// Writes the chart as a file of its own.
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    pub fn write_svg(&self, path: impl AsRef<Path>) -> io::Result<()> {
        let style = format!("<style>{}</style>", include_str!("chart.css"));
        files::write(path.as_ref(), self.drawn(&style).as_bytes())
    }

    fn drawn(&self, style: &str) -> String {
        let points = || self.lines.iter().flat_map(|line| &line.points);
        let x = Scale::new(points().map(|point| point.x), [LEFT, RIGHT]);
        let y = Scale::new(points().map(|point| point.y), [BOTTOM, TOP]);
        let levels: Vec<_> = self
            .levels
            .iter()
            .filter(|level| y.holds(level.1))
            .collect();
        let rows = (self.lines.len() + levels.len()).div_ceil(2);
        let height = LEGEND + ROW * rows as f64;
        let title = escaped(&self.title);
        let mut svg = format!(
            "<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">\
             <title>{title}</title>{style}<rect class=\"paper\" width=\"{WIDTH}\" height=\"{height}\"/>"
        );
        self.draw_axes(&mut svg, &x, &y);
        for (index, line) in self.lines.iter().enumerate() {
            draw_line(&mut svg, index, line, &x, &y);
        }
        for (_, level) in &levels {
            let at = y.place(*level);
            let _ = write!(svg, "<path class=\"level\" d=\"M{LEFT} {at:.1}H{RIGHT}\"/>");
        }
        self.draw_legend(&mut svg, &levels);
        svg + "</svg>\n"
    }

    fn draw_axes(&self, svg: &mut String, x: &Scale, y: &Scale) {
        let mut grid = String::new();
        let mut text = String::new();
        for tick in ticks(&self.x, x.low, x.high) {
            let at = x.at(tick.at);
            let _ = write!(grid, "M{at:.1} {TOP}V{BOTTOM}");
            if !tick.text.is_empty() {
                let _ = write!(
                    text,
                    "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                    BOTTOM + 20.0,
                    tick.text
                );
            }
        }
        for tick in ticks(&self.y, y.low, y.high) {
            let at = y.at(tick.at);
            let _ = write!(grid, "M{LEFT} {at:.1}H{RIGHT}");
            if !tick.text.is_empty() {
                let _ = write!(
                    text,
                    "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                    LEFT - 6.0,
                    at + 4.5,
                    tick.text
                );
            }
        }
        let _ = write!(
            svg,
            "<path class=\"grid\" d=\"{grid}\"/><rect class=\"frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\"/>{text}\
             <text class=\"label\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
             <text class=\"label\" transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            RIGHT - LEFT,
            BOTTOM - TOP,
            0.5 * (LEFT + RIGHT),
            BOTTOM + 38.0,
            escaped(&self.x.label),
            0.5 * (TOP + BOTTOM),
            escaped(&self.y.label),
        );
    }

    fn draw_legend(&self, svg: &mut String, levels: &[&(String, f64)]) {
        let rows = (self.lines.len() + levels.len()).div_ceil(2);
        let place = |entry: usize| {
            let column = (entry / rows.max(1)) as f64;
            (
                10.0 + 286.0 * column,
                LEGEND + ROW * (entry % rows.max(1)) as f64,
            )
        };
        let name = |svg: &mut String, (x, y): (f64, f64), name: &str, note: &str| {
            let _ = write!(
                svg,
                "<text x=\"{}\" y=\"{}\">{}</text><text class=\"soft\" x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
                x + 36.0,
                y + 4.5,
                escaped(name),
                x + 254.0,
                y + 4.5,
                escaped(note)
            );
        };
        for (index, line) in self.lines.iter().enumerate() {
            let (x, y) = place(index);
            let _ = write!(
                svg,
                "<g class=\"s{}\"><path class=\"line\" stroke-dasharray=\"{}\" d=\"M{x} {y}h30\"/>{}</g>",
                index % looks::LOOKS,
                looks::dash(index),
                markers(index, [(x + 15.0, y)])
            );
            name(svg, (x, y), &line.name, &line.note);
        }
        for (index, level) in levels.iter().enumerate() {
            let (x, y) = place(self.lines.len() + index);
            let _ = write!(svg, "<path class=\"level\" d=\"M{x} {y}h30\"/>");
            name(svg, (x, y), &level.0, "");
        }
    }
}

/// What errors are drawn over: their scale, or 1 where there is none or it is 0.
fn scale(convergence: &Convergence) -> f64 {
    convergence
        .scale
        .map(f64::abs)
        .filter(|&scale| scale > 0.0)
        .unwrap_or(1.0)
}

fn error_axis(convergence: &Convergence) -> Axis {
    #[expect(clippy::float_cmp, reason = "exactly 1 where there is no scale")]
    if scale(convergence) == 1.0 {
        Axis::new("RMSE (unit of the integral)")
    } else {
        Axis::new("RMSE / integral (1 = 100 %)")
    }
}

fn curve_line(convergence: &Convergence, curve: &Curve, x: impl Fn(&Sample) -> f64) -> Line {
    let scale = scale(convergence);
    let points = curve.samples.iter().map(|sample| Point {
        x: x(sample),
        y: sample.rmse / scale,
        low: sample.rmse_low / scale,
        high: sample.rmse_high / scale,
    });
    Line::new(curve.method.clone(), points)
}

fn draw_line(svg: &mut String, index: usize, line: &Line, x: &Scale, y: &Scale) {
    let places: Vec<(f64, f64)> = line
        .points
        .iter()
        .map(|point| (x.place(point.x), y.place(point.y)))
        .collect();
    let path = |places: &mut dyn Iterator<Item = (f64, f64)>| {
        let places: Vec<String> = places.map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
        format!("M{}", places.join("L"))
    };
    if places.is_empty() {
        return;
    }
    let ends = line.points.iter().map(|point| (x.place(point.x), point));
    let upper = ends.clone().map(|(x, point)| (x, y.place(point.high)));
    let lower = ends.rev().map(|(x, point)| (x, y.place(point.low)));
    let _ = write!(
        svg,
        "<g class=\"s{}\"><title>{}</title><path class=\"band\" d=\"{}Z\"/>\
         <path class=\"line\" stroke-dasharray=\"{}\" d=\"{}\"/>{}</g>",
        index % looks::LOOKS,
        escaped(&line.name),
        path(&mut upper.chain(lower)),
        looks::dash(index),
        path(&mut places.iter().copied()),
        markers(index, places.iter().copied())
    );
}

fn markers(index: usize, places: impl IntoIterator<Item = (f64, f64)>) -> String {
    let paths: String = places
        .into_iter()
        .map(|(x, y)| looks::marker(index, x, y))
        .collect();
    let class = if looks::is_filled(index) {
        "full"
    } else {
        "open"
    };
    format!("<path class=\"{class}\" d=\"{paths}\"/>")
}

/// From numbers to places on the chart.
struct Scale {
    /// Decimal logarithms.
    low: f64,
    high: f64,
    places: [f64; 2],
}

impl Scale {
    /// A scale with room for all of `values`, from the first of `places` to the second.
    fn new(values: impl Iterator<Item = f64>, places: [f64; 2]) -> Self {
        let (low, high) = values
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), log| {
                (low.min(log), high.max(log))
            });
        if low > high {
            return Self {
                low: 0.0,
                high: 1.0,
                places,
            };
        }
        let room = (0.04 * (high - low)).max(0.05);
        Self {
            low: low - room,
            high: high + room,
            places,
        }
    }

    fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value.log10())
    }

    /// The place of a number; the nearest end for one outside.
    fn place(&self, value: f64) -> f64 {
        self.at(value.log10().clamp(self.low, self.high))
    }

    fn at(&self, log: f64) -> f64 {
        let [first, second] = self.places;
        first + (second - first) * (log - self.low) / (self.high - self.low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_where_they_should() {
        let scale = Scale::new([1.0, 100.0].into_iter(), [0.0, 100.0]);
        assert_eq!(scale.place(10.0), 50.0);
        assert_eq!(scale.place(1e9), 100.0);
        assert!(scale.holds(1.0) && !scale.holds(1000.0));
        assert_eq!(Scale::new([].into_iter(), [0.0, 1.0]).high, 1.0);
    }

    #[test]
    fn a_label_at_the_right_end_has_room() {
        // Nothing is drawn farther to the right than `RIGHT`; a character of 13 px is at most 8 px wide.
        let ends = [Point::new(0.003, 0.001), Point::new(0.3, 1.0)];
        let mut chart = Chart::new("t", Axis::seconds("x"), Axis::new("y"));
        let svg = chart.line(Line::new("l", ends)).svg();
        assert!(svg.contains(">300 ms<"), "{svg}");
        assert!(RIGHT + 0.5 * 8.0 * "300 ms".len() as f64 <= WIDTH);
    }

    #[test]
    fn what_has_no_logarithm_is_left_out_and_names_are_escaped() {
        let points = [(0.0, 1.0), (1.0, 0.0), (2.0, f64::NAN), (1.0, 3.0)];
        let points = points.map(|(x, y)| Point::new(x, y));
        let line = Line::new("a < b & c", points);
        assert_eq!(line.points, [Point::new(1.0, 3.0)]);
        let mut chart = Chart::new("t", Axis::new("x"), Axis::new("y"));
        let svg = chart.line(line).level("outside", 1e9).svg();
        assert!(svg.contains("a &lt; b &amp; c") && !svg.contains("outside"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
