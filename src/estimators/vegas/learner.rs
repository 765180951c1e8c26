//! An integrand under a map, and where its squares are.

use super::adaptation::Adaptation;
use super::grid::{Axis, enter};
use crate::block::smaller;
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

/// Numbers as large as this have no digits behind the point, and keep whole ones up to 2^51 in their lowest bits.
const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

/// No bin has this number.
const UNREAD: u32 = u32::MAX;

/// An integrand in one stratum after the other, under a map; adds up its squares.
pub(super) struct Learner<'a, I: Integrand> {
    integrand: &'a I,
    /// The bins of all axes, one axis after the other.
    bins: &'a [Bin],
    /// How many bins an axis has.
    number: usize,
    place: Vec<Axis>,
    /// The reciprocal scale of each component.
    scale: Wide<I>,
    /// The bin that each coordinate of the points at hand is in, of those of all axes, point after point; [`UNREAD`] if the
    /// integrand did not ask for it.
    hits: Vec<u32>,
    /// What each of these points weighs.
    jacobians: Vec<f64>,
    /// The square of the value at each of these points.
    given: Vec<f64>,
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
            given: Vec::new(),
            squares: vec![Squares::default(); bins.len()],
        }
    }

    /// What the point `place` weighs if its integrand read so many coordinates.
    fn weight(&self, place: usize, read: usize) -> f64 {
        let hits = &self.hits[place * self.place.len()..][..read];
        hits.iter()
            // An axis that was not read has no bin.
            .map(|&hit| self.bins.get(hit as usize).map_or(1.0, |bin| bin.jacobian))
            .product()
    }
}

impl<I: Integrand> Visitor for Learner<'_, I> {
    type Value = Wide<I>;

    fn enter(&mut self, stratum: usize) {
        enter(stratum, &mut self.place);
    }

    fn begin(&mut self, number: usize) {
        // Placing the points writes them, but for points without axes.
        self.jacobians.resize(number, 1.0);
        self.given.resize(number, 0.0);
        self.hits.resize(number * self.place.len(), UNREAD);
    }

    #[inline]
    fn place(&mut self, first: usize, rows: &mut [f64]) {
        let axes = self.place.len();
        if axes == 0 {
            return;
        }
        let last = u32::try_from(self.number - 1).unwrap_or(u32::MAX);
        let rows = rows.chunks_exact_mut(axes);
        let hits = self.hits[first * axes..].chunks_exact_mut(axes);
        for ((row, hits), jacobian) in rows.zip(hits).zip(&mut self.jacobians[first..]) {
            let mut product = 1.0;
            for ((x, hit), axis) in row.iter_mut().zip(hits).zip(&self.place) {
                let scaled = (axis.cell + *x) * axis.scale;
                // Down to a whole number, which is in the lowest bits then: a conversion would check what cannot be. The very end of
                // a bin may go to either of the two.
                let shifted = (scaled - 0.5) + WHOLE;
                #[expect(clippy::cast_possible_truncation, reason = "below the number of bins")]
                let number = (shifted.to_bits() as u32).min(last);
                *hit = axis.first + number;
                let bin = self.bins[*hit as usize];
                *x = bin.image(scaled - smaller(shifted - WHOLE, f64::from(last)));
                product *= bin.jacobian;
            }
            *jacobian = product;
        }
    }

    #[inline]
    fn value(&mut self, place: usize, mut u: Cursor<'_, Independent>) -> Wide<I> {
        let value = self.integrand.evaluate(&mut u).widen();
        let jacobian = if u.is_behind() {
            let (read, axes) = (u.dimension() as usize, self.place.len());
            self.hits[place * axes..][read..axes].fill(UNREAD);
            self.weight(place, read)
        } else {
            self.jacobians[place]
        };
        let value: Wide<I> = value.map(|value| value * jacobian);
        let mut square = 0.0;
        let _ = value.zip(self.scale, |value, scale| {
            // Capped: the scale may be that of points that all missed the peak.
            let relative = (value * scale).abs().min(1e140);
            square += relative * relative;
            value
        });
        self.given[place] = if value.is_finite() { square } else { 0.0 };
        value
    }

    #[inline]
    fn leave(&mut self) {
        let points = self.hits.chunks_exact(self.place.len().max(1));
        for (hits, square) in points.zip(&self.given) {
            for &hit in hits {
                if let Some(squares) = self.squares.get_mut(hit as usize) {
                    squares.sum += square;
                    squares.count += 1.0;
                }
            }
        }
    }

    fn look(&mut self, place: usize, u: Cursor<'_, Independent>) -> Look<Wide<I>> {
        let mut coordinates = Vec::new();
        let mut u = Recorder {
            inner: u,
            coordinates: &mut coordinates,
        };
        let value = self.integrand.evaluate(&mut u).widen();
        let read = (u.inner.dimension() as usize).min(self.place.len());
        let weight = self.weight(place, read);
        Look {
            coordinates,
            value,
            weight,
        }
    }
}
