//! Strata of equal weight: what their points have given, and how points are shared out among them.

use std::collections::BTreeMap;

use crate::block::Block;
use crate::{Moments, Value};

mod apportion;
mod parts;
mod together;
mod walk;

pub(crate) use apportion::{apportion, between, evenly};
pub(crate) use together::Stratified;
pub(crate) use walk::{Look, Rows, Run, Visitor, Walk};

/// What the points of a stratum have given.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Stratum<V> {
    pub(crate) moments: Moments<V>,
    pub(crate) low: V,
    pub(crate) high: V,
}

impl<V: Value> Stratum<V> {
    pub(crate) const EMPTY: Self = Self {
        moments: Moments::new(),
        low: V::ZERO,
        high: V::ZERO,
    };

    /// What `values`, all of them finite, have given.
    pub(crate) fn of(values: &[V]) -> Self {
        Self::sums(values).unwrap_or_else(|| {
            let first = values.first().copied().unwrap_or(V::ZERO);
            Self {
                moments: values.iter().copied().collect(),
                low: values.iter().fold(first, |low, x| low.zip(*x, f64::min)),
                high: values.iter().fold(first, |high, x| high.zip(*x, f64::max)),
            }
        })
    }

    /// The same of any values in plain arithmetic; `None` where that does not do, as for values that are not finite.
    #[inline]
    pub(crate) fn sums(values: &[V]) -> Option<Self> {
        let mut block = Block::EMPTY;
        block.extend(values, |value| value);
        let piece = block.piece()?;
        Some(Self {
            moments: piece.moments,
            low: piece.low,
            high: piece.high,
        })
    }

    /// The largest absolute value, per component.
    pub(crate) fn size(&self) -> V {
        self.low
            .zip(self.high, |low, high| low.abs().max(high.abs()))
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        if self.moments.count() == 0 {
            *self = *other;
        } else if other.moments.count() > 0 {
            self.moments.merge(other.moments);
            self.low = self.low.zip(other.low, f64::min);
            self.high = self.high.zip(other.high, f64::max);
        }
    }
}

/// What the points of all strata have given.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Visited<V> {
    strata: Vec<Stratum<V>>,
    /// The weights of the points whose values were not finite, of the strata that had such.
    left_out: BTreeMap<usize, Moments<f64>>,
    /// How many parts of the walk under way are in it.
    parts: u64,
    /// The same without the part that could not be completed, if there was one.
    before: Option<Box<Self>>,
}

impl<V: Value> Visited<V> {
    /// None of these.
    pub(crate) fn new(strata: usize) -> Self {
        Self {
            strata: vec![Stratum::EMPTY; strata],
            left_out: BTreeMap::new(),
            parts: 0,
            before: None,
        }
    }

    /// None, and the room that all have taken.
    pub(crate) fn clear(&mut self) {
        self.strata.clear();
        self.left_out.clear();
        (self.parts, self.before) = (0, None);
    }

    /// All, once they were visited; of those that were not some may be missing at the end.
    pub(crate) fn strata(&self) -> &[Stratum<V>] {
        &self.strata
    }

    /// How many points were evaluated.
    pub(crate) fn used(&self) -> u64 {
        let values = self.strata.iter().map(|stratum| stratum.moments.count());
        values.sum::<u64>() + self.rejected()
    }

    /// How many values were not finite and left out.
    pub(crate) fn rejected(&self) -> u64 {
        self.left_out.values().map(Moments::count).sum()
    }

    /// Ready for the next walk through the same strata.
    pub(crate) fn again(&mut self) {
        self.parts = 0;
    }
}
