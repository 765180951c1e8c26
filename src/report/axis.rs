//! Logarithmic axes: where their ticks are, and what is written there.

use super::number::{power_of_ten, seconds, significant};

/// A logarithmic axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub(super) label: String,
    pub(super) ticks: Ticks,
}

/// How an axis is labelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ticks {
    /// Powers of ten.
    Powers,
    /// Times in seconds, written with their units.
    Seconds,
}

impl Axis {
    /// An axis of numbers. `label` says what they are, and in which unit.
    pub fn new(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ticks: Ticks::Powers,
        }
    }

    /// An axis of times in seconds. `label` says of what.
    pub fn seconds(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ticks: Ticks::Seconds,
        }
    }

    fn text(&self, mantissa: u32, exponent: i32) -> String {
        let value = f64::from(mantissa) * 10_f64.powi(exponent);
        match self.ticks {
            Ticks::Seconds => seconds(value, 1),
            Ticks::Powers if (-3..4).contains(&exponent) => significant(value, 1),
            Ticks::Powers if mantissa == 1 => power_of_ten(exponent),
            Ticks::Powers => format!("{mantissa}·{}", power_of_ten(exponent)),
        }
    }
}

/// A line of the grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    /// The decimal logarithm of its place.
    pub(super) at: f64,
    /// What is written there; empty for a line between.
    pub(super) text: String,
}

/// The most labels that an axis has room for.
const LABELS: i32 = 7;

/// The ticks between two decimal logarithms.
pub(super) fn ticks(axis: &Axis, low: f64, high: f64) -> Vec<Tick> {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "saturates; an f64 has 632 decades"
    )]
    let (first, last) = (low.floor() as i32, high.ceil() as i32);
    let step = (last - first).div_euclid(LABELS) + 1;
    let mantissas: &[u32] = match high - low {
        span if span < 1.2 => &[1, 2, 3, 5],
        span if span < 2.5 => &[1, 3],
        _ => &[1],
    };
    let mut ticks = Vec::new();
    for exponent in first..=last {
        for mantissa in 1..10 {
            let at = f64::from(exponent) + f64::from(mantissa).log10();
            if !(low..=high).contains(&at) || (mantissa > 1 && last - first > LABELS) {
                continue;
            }
            let labelled = mantissas.contains(&mantissa) && exponent.rem_euclid(step) == 0;
            let text = if labelled {
                axis.text(mantissa, exponent)
            } else {
                String::new()
            };
            ticks.push(Tick { at, text });
        }
    }
    ticks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, low: f64, high: f64) -> Vec<String> {
        let ticks = ticks(axis, low, high).into_iter();
        ticks
            .map(|tick| tick.text)
            .filter(|text| !text.is_empty())
            .collect()
    }

    #[test]
    fn labels_are_few_and_have_units() {
        let times = Axis::seconds("time of a run");
        assert_eq!(
            labels(&times, -6.1, -2.9),
            ["1 µs", "10 µs", "100 µs", "1 ms"]
        );
        let numbers = Axis::new("RMSE");
        assert_eq!(labels(&numbers, -0.5, 0.6), ["0.5", "1", "2", "3"]);
        assert_eq!(
            labels(&numbers, -4.2, 0.1),
            ["10⁻⁴", "0.001", "0.01", "0.1", "1"]
        );
        let many = labels(&numbers, -16.0, 0.0);
        assert!(many.len() <= 8, "{many:?}");
        assert_eq!(
            labels(&numbers, -1.05, 0.1),
            ["0.1", "0.2", "0.3", "0.5", "1"]
        );
        assert_eq!(labels(&numbers, -1.2, 0.1), ["0.1", "0.3", "1"]);
        assert_eq!(many.last().unwrap(), "1");
    }
}
