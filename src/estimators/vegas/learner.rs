//! An integrand under a map, and where its squares are.

use super::adaptation::Adaptation;
use super::images::Images;
use super::squares::Squares;
use crate::evaluate::Wide;
use crate::integrands::Bin;
use crate::points::Independent;
use crate::recorder::Recorder;
use crate::stratum::{Look, Run, Visitor};
use crate::{Cursor, Integrand, Value};

/// An integrand in one stratum after the other, under a map; adds up its squares.
pub(super) struct Learner<'a, I: Integrand> {
    integrand: &'a I,
    images: Images<'a>,
    /// The reciprocal scale of each component.
    scale: Wide<I>,
    /// The squares of the values at hand.
    given: Vec<f64>,
    /// Those of all bins, one axis after the other, then those of coordinates that were not read.
    squares: Vec<Squares>,
}

impl<'a, I: Integrand> Learner<'a, I> {
    pub(super) fn new(adaptation: &Adaptation<Wide<I>>, integrand: &'a I, bins: &'a [Bin]) -> Self {
        Self {
            integrand,
            images: Images::new(&adaptation.strata, bins, adaptation.map.bins()),
            scale: adaptation.scale.map(|scale| {
                if scale > 0.0 {
                    1.0 / scale.max(f64::MIN_POSITIVE)
                } else {
                    // Nothing is known of a component that was zero everywhere.
                    1.0
                }
            }),
            given: Vec::new(),
            squares: vec![Squares::default(); bins.len() + 1],
        }
    }

    /// The squares in all bins, one axis after the other.
    pub(super) fn squares(mut self) -> Vec<Squares> {
        self.squares.pop();
        self.squares
    }
}

impl<I: Integrand> Visitor for Learner<'_, I> {
    type Value = Wide<I>;

    fn place(&mut self, runs: &[Run], rows: &mut [f64]) {
        self.images.place(runs, rows);
    }

    #[inline]
    fn value(&mut self, place: usize, mut u: Cursor<'_, Independent>) -> Wide<I> {
        let value = self.integrand.evaluate(&mut u).widen();
        if u.is_behind() {
            self.images.forget(place, u.dimension() as usize);
        }
        value
    }

    fn leave(&mut self, values: &mut [Wide<I>]) {
        for (value, &jacobian) in values.iter_mut().zip(self.images.jacobians()) {
            *value = value.map(|value| value * jacobian);
        }
        self.given.clear();
        let scale = self.scale;
        self.given
            .extend(values.iter().map(|&value| square(value, scale)));
        self.images.add_up(&self.given, &mut self.squares);
    }

    fn look(&mut self, place: usize, u: Cursor<'_, Independent>) -> Look<Wide<I>> {
        let mut coordinates = Vec::new();
        let mut u = Recorder {
            inner: u,
            coordinates: &mut coordinates,
        };
        let value = self.integrand.evaluate(&mut u).widen();
        let weight = self.images.jacobians()[place];
        Look {
            coordinates,
            // One that is finite is not what was complained of.
            value: if value.is_finite() {
                value.map(|value| value * weight)
            } else {
                value
            },
            weight,
        }
    }
}

/// The square of a value on the reciprocal `scale` of each component; 0 if it is not finite.
#[inline]
fn square<V: Value>(value: V, scale: V) -> f64 {
    let mut square = 0.0;
    let _ = value.zip(scale, |value, scale| {
        // Capped: the scale may be that of points that all missed the peak.
        let relative = (value * scale).abs().min(1e140);
        square += relative * relative;
        value
    });
    if value.is_finite() { square } else { 0.0 }
}
