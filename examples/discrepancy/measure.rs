//! One measure of one list of points, as the command line names it.

use std::error::Error;

use clap::ValueEnum;
use estimand::discrepancy::{
    Boundary, L2, Points, Star, StarDiscrepancy, minimum_distance, t_value,
    toroidal_minimum_distance,
};
use serde_json::{Map, Value, json};

/// What can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Metric {
    /// The worst box with a corner at the origin
    Star,
    /// The root mean square over boxes with a corner at the origin
    L2Star,
    /// Boxes at the nearest corner of the cube, in all projections
    Centred,
    /// Boxes wrapped around the torus, in all projections
    WrapAround,
    /// A mixture of centred and wrap-around
    Mixture,
    /// Unions of boxes at opposite corners, in all projections
    Symmetric,
    /// All boxes
    Extreme,
    /// Waves
    Diaphony,
    /// The quality parameter of a net in base `--base`
    TValue,
    /// The least distance between two points
    MinimumDistance,
    /// The least distance between two points on the torus
    ToroidalMinimumDistance,
}

impl Metric {
    pub(crate) fn name(self) -> String {
        self.to_possible_value()
            .map_or_else(String::new, |value| value.get_name().to_owned())
    }

    fn l2(self) -> Option<L2> {
        Some(match self {
            Self::L2Star => L2::Star,
            Self::Centred => L2::Centred,
            Self::WrapAround => L2::WrapAround,
            Self::Mixture => L2::Mixture,
            Self::Symmetric => L2::Symmetric,
            Self::Extreme => L2::Extreme,
            Self::Diaphony => L2::Diaphony,
            _ => return None,
        })
    }
}

/// Which kind of answer is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
    /// The value, or an error
    Exact,
    /// Two bounds at most `--gap` apart, or an error
    Bounds,
    /// The best of some random walks
    LowerBound,
}

/// How to measure.
#[derive(Clone, Debug)]
pub(crate) struct Measure {
    pub(crate) metric: Metric,
    pub(crate) kind: Option<Kind>,
    pub(crate) gap: f64,
    /// Seconds, as the library counts them in steps.
    pub(crate) budget: f64,
    pub(crate) squared: bool,
    pub(crate) weights: Option<Vec<f64>>,
    pub(crate) base: u32,
    pub(crate) seed: u64,
}

/// Steps that a core takes in a second, at least about.
const STEPS_PER_SECOND: f64 = 2e8;

/// So many things.
pub(crate) fn counted(count: usize, thing: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {thing}{plural}")
}

fn boundary(boundary: Boundary) -> &'static str {
    match boundary {
        Boundary::Open => "open",
        Boundary::Closed => "closed",
    }
}

/// A measured value.
pub(crate) struct Answer {
    pub(crate) squared: bool,
    pub(crate) weights: Option<Vec<f64>>,
    pub(crate) found: Found,
}

pub(crate) enum Found {
    Value(f64),
    Star(StarDiscrepancy),
}

impl Measure {
    pub(crate) fn of(&self, points: &Points<'_>) -> Result<Answer, Box<dyn Error>> {
        if self.metric != Metric::Star && self.kind.is_some_and(|kind| kind != Kind::Exact) {
            return Err("only the star discrepancy has bounds: leave out --kind".into());
        }
        let kernel = self.metric.l2();
        if kernel.is_none() && (self.squared || self.weights.is_some()) {
            return Err("only L2 discrepancies have a square and weights".into());
        }
        let found = match (self.metric, kernel) {
            (_, Some(l2)) => {
                let squared = match &self.weights {
                    Some(weights) => l2.squared_weighted(points, weights)?,
                    None => l2.squared(points),
                };
                Found::Value(if self.squared {
                    squared
                } else {
                    squared.sqrt()
                })
            }
            (Metric::TValue, _) => Found::Value(f64::from(t_value(points, self.base)?)),
            (Metric::MinimumDistance, _) => Found::Value(minimum_distance(points)),
            (Metric::ToroidalMinimumDistance, _) => Found::Value(toroidal_minimum_distance(points)),
            _ => Found::Star(self.star(points)?),
        };
        Ok(Answer {
            squared: self.squared,
            weights: self.weights.clone(),
            found,
        })
    }

    fn star(&self, points: &Points<'_>) -> Result<StarDiscrepancy, estimand::Error> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates, and was checked not to be negative"
        )]
        let steps = (self.budget * STEPS_PER_SECOND) as u64;
        let star = Star::default().work(steps).seed(self.seed);
        match self.kind {
            None => Ok(star.measure(points)),
            Some(Kind::Exact) => star.exact(points),
            Some(Kind::Bounds) => star.bounds(points, self.gap),
            Some(Kind::LowerBound) => Ok(star.lower_bound(points)),
        }
    }
}

impl Answer {
    /// The value, or the lower one of two.
    pub(crate) fn lower(&self) -> f64 {
        match &self.found {
            Found::Value(value) => *value,
            Found::Star(star) => star.lower(),
        }
    }

    /// `exact`, `bounds` or `lower-bound`.
    pub(crate) fn kind(&self) -> &'static str {
        match &self.found {
            Found::Star(StarDiscrepancy::Bounds { .. }) => "bounds",
            Found::Star(StarDiscrepancy::LowerBound { .. }) => "lower-bound",
            _ => "exact",
        }
    }

    /// The answer as data.
    pub(crate) fn json(&self) -> Map<String, Value> {
        let mut object = Map::new();
        object.insert("kind".into(), json!(self.kind()));
        match &self.found {
            Found::Star(StarDiscrepancy::Bounds { lower, upper, .. }) => {
                object.insert("lower".into(), json!(lower));
                object.insert("upper".into(), json!(upper));
            }
            _ => {
                object.insert("value".into(), json!(self.lower()));
            }
        }
        object.insert("squared".into(), json!(self.squared));
        if let Some(weights) = &self.weights {
            object.insert("weights".into(), json!(weights));
        }
        if let Found::Star(star) = &self.found {
            let attained = star.attained();
            object.insert(
                "box".into(),
                json!({
                    "corner": attained.corner,
                    "boundary": boundary(attained.boundary),
                    "volume": attained.volume(),
                    "inside": attained.inside,
                }),
            );
        }
        object
    }

    /// The answer in words.
    pub(crate) fn text(&self) -> String {
        match &self.found {
            Found::Value(value) => format!("{value}"),
            Found::Star(star) => {
                let attained = star.attained();
                let shown = format!(
                    "the {} box to {:?} holds {} in a volume of {}",
                    boundary(attained.boundary),
                    attained.corner,
                    counted(attained.inside, "point"),
                    attained.volume()
                );
                match star {
                    StarDiscrepancy::Bounds { lower, upper, .. } => {
                        format!("between {lower} and {upper}; {shown}")
                    }
                    StarDiscrepancy::LowerBound { value, .. } => {
                        format!("at least {value}; {shown}")
                    }
                    _ => format!("{}; {shown}", star.lower()),
                }
            }
        }
    }
}
