//! An integrand under a map, and where its squares are.

use super::adaptation::Adaptation;
use super::grid::{Axis, Grid};
use crate::evaluate::Wide;
use crate::integrands::Bin;
use crate::points::Independent;
use crate::recorder::Recorder;
use crate::stratum::{Look, Visitor};
use crate::{Cursor, Integrand, Value};

/// Squares of values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Squares {
    sum: f64,
    count: f64,
}

impl Squares {
    pub(super) fn add(&mut self, other: &Self) {
        self.sum += other.sum;
        self.count += other.count;
    }

    pub(super) fn mean(&self) -> Option<f64> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

/// An integrand in one stratum after the other, under a map; adds up its squares.
pub(super) struct Learner<'a, I: Integrand> {
    integrand: &'a I,
    /// The bins of all axes, one axis after the other.
    bins: &'a [Bin],
    /// How many bins an axis has.
    number: usize,
    strata: &'a Grid,
    place: Vec<Axis>,
    /// The reciprocal scale of each component.
    scale: Wide<I>,
    /// The bin of its axis that each coordinate of the points at hand is in.
    hits: Vec<u32>,
    /// What each of these points weighs.
    jacobians: Vec<f64>,
    pub(super) squares: Vec<Squares>,
}

impl<'a, I: Integrand> Learner<'a, I> {
    pub(super) fn new(
        adaptation: &'a Adaptation<Wide<I>>,
        integrand: &'a I,
        bins: &'a [Bin],
    ) -> Self {
        let (map, strata) = (&adaptation.map, &adaptation.strata);
        Self {
            integrand,
            bins,
            number: map.bins(),
            strata,
            place: strata.axes(map.bins()),
            scale: adaptation.scale.map(|scale| {
                if scale > 0.0 {
                    1.0 / scale.max(f64::MIN_POSITIVE)
                } else {
                    // Nothing is known of a component that was zero everywhere.
                    1.0
                }
            }),
            hits: Vec::new(),
            jacobians: Vec::new(),
            squares: vec![Squares::default(); bins.len()],
        }
    }

    /// The bins of those coordinates of the point `place` that its integrand read, and what the point weighs.
    #[inline]
    fn read(&self, place: usize, u: &Cursor<'_, Independent>) -> (&[u32], f64) {
        let axes = self.place.len();
        let hits = &self.hits[place * axes..][..axes];
        match hits.split_at_checked(u.dimension() as usize) {
            Some((hits, [_, ..])) => {
                let bins = self.bins.chunks_exact(self.number).zip(hits);
                let factors = bins.map(|(bins, &hit)| bins[hit as usize].jacobian);
                (hits, factors.product())
            }
            _ => (hits, self.jacobians[place]),
        }
    }
}

impl<I: Integrand> Visitor for Learner<'_, I> {
    type Value = Wide<I>;

    fn enter(&mut self, stratum: usize) {
        self.strata.enter(stratum, &mut self.place);
    }

    #[inline]
    fn place(&mut self, rows: &mut [f64]) {
        let axes = self.place.len();
        let points = rows.len() / axes.max(1);
        self.hits.resize(points * axes, 0);
        self.jacobians.resize(points, 1.0);
        if axes == 0 {
            return;
        }
        // Signed, as the machine converts them.
        let last = i32::try_from(self.number - 1).unwrap_or(i32::MAX);
        let rows = rows.chunks_exact_mut(axes);
        let hits = self.hits.chunks_exact_mut(axes);
        for ((row, hits), jacobian) in rows.zip(hits).zip(&mut self.jacobians) {
            *jacobian = 1.0;
            let bins = self.bins.chunks_exact(self.number);
            let place = self.place.iter().zip(bins);
            for ((x, hit), (axis, bins)) in row.iter_mut().zip(hits).zip(place) {
                let scaled = (axis.cell + *x) * axis.scale;
                #[expect(clippy::cast_possible_truncation, reason = "below the number of bins")]
                let number = (scaled as i32).min(last);
                *hit = number.cast_unsigned();
                let bin = bins[*hit as usize];
                *x = bin.image(scaled - f64::from(number));
                *jacobian *= bin.jacobian;
            }
        }
    }

    #[inline]
    fn value(&mut self, place: usize, mut u: Cursor<'_, Independent>) -> Wide<I> {
        let value = self.integrand.evaluate(&mut u).widen();
        let (hits, jacobian) = self.read(place, &u);
        let value: Wide<I> = value.map(|value| value * jacobian);
        let mut square = 0.0;
        let _ = value.zip(self.scale, |value, scale| {
            // Capped: the scale may be that of points that all missed the peak.
            let relative = (value * scale).abs().min(1e140);
            square += relative * relative;
            value
        });
        if !value.is_finite() {
            square = 0.0;
        }
        let read = hits.len();
        let hits = self.hits[place * self.place.len()..][..read].iter();
        for (squares, &hit) in self.squares.chunks_exact_mut(self.number).zip(hits) {
            let squares = &mut squares[hit as usize];
            squares.sum += square;
            squares.count += 1.0;
        }
        value
    }

    fn look(&mut self, place: usize, u: Cursor<'_, Independent>) -> Look<Wide<I>> {
        let mut coordinates = Vec::new();
        let mut u = Recorder {
            inner: u,
            coordinates: &mut coordinates,
        };
        let value = self.integrand.evaluate(&mut u).widen();
        let (_, weight) = self.read(place, &u.inner);
        Look {
            coordinates,
            value,
            weight,
        }
    }
}
