//! Tables.

use std::fmt::Write;

use super::{escaped, number};
use crate::convergence::{Convergence, Curve};

/// A table: a heading for each column, and rows of cells.
///
/// ```
/// use estimand::report::{Cell, Column, Table};
///
/// let mut table = Table::new([Column::text("method"), Column::number("RMSE")]);
/// table.row([Cell::from("plain"), Cell::from("0.01")]);
/// table.row([Cell::from("sobol"), Cell::best("0.001")]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
}

/// The heading of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    heading: String,
    class: &'static str,
}

impl Column {
    /// A column of words.
    pub fn text(heading: impl Into<String>) -> Self {
        Self {
            heading: heading.into(),
            class: "",
        }
    }

    /// A column of sentences, kept wide enough to be read on narrow screens too.
    pub fn prose(heading: impl Into<String>) -> Self {
        Self {
            heading: heading.into(),
            class: "prose",
        }
    }

    /// A column of numbers, set to the right.
    pub fn number(heading: impl Into<String>) -> Self {
        Self {
            heading: heading.into(),
            class: "number",
        }
    }
}

/// A cell: a text, perhaps with a verdict.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    text: String,
    class: &'static str,
}

impl Cell {
    /// The best of its kind: marked by a star and a colour.
    pub fn best(text: impl Into<String>) -> Self {
        Self {
            text: text.into() + " ★",
            class: "best",
        }
    }

    /// As it should be: marked by a tick and a colour.
    pub fn good(text: impl Into<String>) -> Self {
        Self {
            text: "✓ ".to_owned() + &text.into(),
            class: "good",
        }
    }

    /// Not as it should be: marked by a cross and a colour.
    pub fn bad(text: impl Into<String>) -> Self {
        Self {
            text: "✗ ".to_owned() + &text.into(),
            class: "bad",
        }
    }
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self {
            text: text.into(),
            class: "",
        }
    }
}

impl Table {
    /// A table without rows.
    pub fn new(columns: impl IntoIterator<Item = Column>) -> Self {
        Self {
            columns: columns.into_iter().collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row. Cells that are missing stay empty; cells past the last column are not shown.
    pub fn row<C: Into<Cell>>(&mut self, cells: impl IntoIterator<Item = C>) -> &mut Self {
        self.rows.push(cells.into_iter().map(Into::into).collect());
        self
    }

    /// What a study has found, a row a method: slope, and at the largest count the error, what was claimed, how often that
    /// held, the efficiency, and the time of a point.
    pub fn of_study(convergence: &Convergence) -> Self {
        let mut table = Self::new([
            Column::text("method"),
            Column::number("slope [95 %]"),
            Column::number("evaluations"),
            Column::number("time"),
            Column::number("RMSE [95 %]"),
            Column::number("claimed"),
            Column::number("covered"),
            Column::number("1/(MSE·s)"),
            Column::number("points, each"),
        ]);
        for curve in &convergence.curves {
            let Some(last) = curve.samples.last() else {
                continue;
            };
            let slope = curve.slope.map_or_else(String::new, |slope| {
                let value = number::fixed(slope.value, 2);
                slope.interval.map_or_else(
                    || value.clone(),
                    |i| {
                        format!(
                            "{value} [{}, {}]",
                            number::fixed(i.low, 2),
                            number::fixed(i.high, 2)
                        )
                    },
                )
            });
            let or_dash = |text: Option<String>| text.unwrap_or_else(|| "—".to_owned());
            let coverage = last.coverage.map(|covered| {
                let text = number::percent(covered, 0);
                // Five standard deviations of the fraction below what was promised.
                let spread = (0.95 * 0.05 / convergence.seeds as f64).sqrt();
                if covered < 0.95 - 5.0 * spread {
                    Cell::bad(text)
                } else {
                    Cell::from(text)
                }
            });
            let star = if last.limited { " *" } else { "" };
            table.row([
                Cell::from(curve.method.clone()),
                slope.into(),
                last.evaluations.to_string().into(),
                number::seconds(last.seconds, 2).into(),
                format!(
                    "{} [{}, {}]{star}",
                    number::significant(last.rmse, 2),
                    number::significant(last.rmse_low, 2),
                    number::significant(last.rmse_high, 2)
                )
                .into(),
                or_dash(last.claimed.map(|claimed| number::significant(claimed, 2))).into(),
                coverage.unwrap_or_else(|| "—".into()),
                or_dash(last.efficiency.map(|e| number::significant(e, 2))).into(),
                or_dash(
                    // In a loop of many, an evaluation may take less than it does by itself.
                    convergence.points_seconds(last).map(|s| {
                        if s > 0.0 {
                            number::seconds(s, 2)
                        } else {
                            "≈ 0".to_owned()
                        }
                    }),
                )
                .into(),
            ]);
        }
        table
    }

    /// How long every method takes to bring its error below given shares of the [scale](Convergence::scale); the fastest
    /// that did is marked. What was not reached is [extrapolated](Curve::seconds_by_slope_to), marked by `≈`, or a dash.
    pub fn of_times(convergence: &Convergence, targets: &[f64]) -> Self {
        let columns = targets.iter().map(|&target| {
            let digits = u32::from(target < 0.01);
            Column::number(format!("time to {}", number::percent(target, digits)))
        });
        let mut table = Self::new([Column::text("method")].into_iter().chain(columns));
        let times = |curve: &Curve| -> Vec<Option<f64>> {
            let scale = convergence.scale.unwrap_or(1.0).abs();
            targets
                .iter()
                .map(|target| curve.seconds_to(target * scale))
                .collect()
        };
        let times: Vec<_> = convergence.curves.iter().map(times).collect();
        for (curve, own) in convergence.curves.iter().zip(&times) {
            let cells = own.iter().enumerate().map(|(target, time)| match time {
                None => {
                    let error = targets[target] * convergence.scale.unwrap_or(1.0).abs();
                    let time = curve.seconds_by_slope_to(error);
                    let text = time.map(|time| format!("≈ {}", number::seconds(time, 1)));
                    text.unwrap_or_else(|| "—".to_owned()).into()
                }
                Some(time) => {
                    let text = number::seconds(*time, 2);
                    let least = times
                        .iter()
                        .filter_map(|times| times[target])
                        .fold(f64::INFINITY, f64::min);
                    if *time <= least {
                        Cell::best(text)
                    } else {
                        text.into()
                    }
                }
            });
            table.row([Cell::from(curve.method.clone())].into_iter().chain(cells));
        }
        table
    }

    pub(super) fn html(&self) -> String {
        let mut html = String::from("<div class=\"scroll\"><table><thead><tr>");
        for column in &self.columns {
            let _ = write!(
                html,
                "<th scope=\"col\" class=\"{}\">{}</th>",
                column.class,
                escaped(&column.heading)
            );
        }
        html.push_str("</tr></thead><tbody>\n");
        for row in &self.rows {
            html.push_str("<tr>");
            for (column, cell) in self.columns.iter().zip(row) {
                let _ = write!(
                    html,
                    "<td class=\"{} {}\">{}</td>",
                    column.class,
                    cell.class,
                    escaped(&cell.text)
                );
            }
            html.push_str("</tr>\n");
        }
        html + "</tbody></table></div>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convergence::{Study, Truth};
    use crate::{MonteCarlo, cube};

    #[test]
    fn the_fastest_is_marked() {
        let f = cube(|[x]| x);
        let study = Study::new([4, 64], 4).unwrap().shortest(0.0);
        let study = study.integral(&f, Truth::exact(0.5));
        let found = study.method("a<b", MonteCarlo::new).run().unwrap();
        let html = Table::of_times(&found, &[10.0, 1e-9]).html();
        assert!(html.contains("time to 1000 %") && html.contains("a&lt;b"));
        assert_eq!(html.matches('★').count(), 1);
        assert_eq!(html.matches("—").count(), 1);
        let html = Table::of_study(&found).html();
        assert_eq!(html.matches("<th ").count(), 9);
        assert_eq!(html.matches("<td ").count(), 9);
    }
}
