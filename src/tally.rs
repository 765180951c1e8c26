//! What the points of one source have given so far, to be gone on with at any point.

use crate::block::{Block, larger, smaller};
use crate::{Moments, Value};

/// How many of the largest and of the smallest values are remembered, one a block.
const EXTREMES: usize = 16;

/// What the points of one source have given so far.
///
/// Whole blocks are merged into the moments; of a block that was begun everything is kept that it takes to
/// end it as if it had not been interrupted.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Tally<V> {
    whole: Piece<V>,
    blocks: u64,
    /// The largest values of the blocks, the smallest negated; each component falling.
    highest: Vec<V>,
    lowest: Vec<V>,
    pub(crate) open: Option<Open<V>>,
}

impl<V: Value> Tally<V> {
    pub(crate) const EMPTY: Self = Self {
        whole: Piece::EMPTY,
        blocks: 0,
        highest: Vec::new(),
        lowest: Vec::new(),
        open: None,
    };

    /// How many points were evaluated.
    pub(crate) fn used(&self) -> u64 {
        self.whole.used() + self.open.as_ref().map_or(0, Open::used)
    }

    /// Adds a block that is complete, in the place of the one that was begun.
    pub(crate) fn close(&mut self, piece: Piece<V>) {
        self.open = None;
        self.whole.moments.merge(piece.moments);
        self.whole.rejected += piece.rejected;
        if piece.moments.count() > 0 {
            self.blocks += 1;
            insert(&mut self.highest, piece.high);
            insert(&mut self.lowest, piece.low.map(|low| -low));
        }
    }

    /// Moments and extremes of all points, those of the block that was begun included.
    pub(crate) fn closed(&self) -> Self {
        let mut all = self.clone();
        if let Some(open) = &self.open {
            all.close(open.piece());
        }
        all
    }

    /// Adds another tally, both [closed](Self::closed).
    pub(crate) fn merge(&mut self, other: &Self) {
        self.whole.moments.merge(other.whole.moments);
        self.whole.rejected += other.whole.rejected;
        self.blocks += other.blocks;
        for &high in &other.highest {
            insert(&mut self.highest, high);
        }
        for &low in &other.lowest {
            insert(&mut self.lowest, low);
        }
    }

    /// The moments of a [closed](Self::closed) tally.
    pub(crate) fn moments(&self) -> &Moments<V> {
        &self.whole.moments
    }

    /// How many values of a [closed](Self::closed) tally were not finite and left out.
    pub(crate) fn rejected(&self) -> u64 {
        self.whole.rejected
    }

    /// From how many blocks the extremes come.
    pub(crate) fn blocks(&self) -> u64 {
        self.blocks
    }

    /// The largest of the blocks' largest values, falling in each component.
    pub(crate) fn highest(&self) -> &[V] {
        &self.highest
    }

    /// The largest of the blocks' smallest values negated, falling in each component.
    pub(crate) fn lowest(&self) -> &[V] {
        &self.lowest
    }
}

/// Inserts `value` into the falling list, component by component, and keeps [`EXTREMES`].
fn insert<V: Value>(list: &mut Vec<V>, mut value: V) {
    for place in list.iter_mut() {
        let larger = place.zip(value, larger);
        value = place.zip(value, smaller);
        *place = larger;
    }
    if list.len() < EXTREMES {
        list.push(value);
    }
}

/// What one block has given.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Piece<V> {
    pub(crate) moments: Moments<V>,
    pub(crate) rejected: u64,
    /// The smallest and the largest value, per component.
    pub(crate) low: V,
    pub(crate) high: V,
}

impl<V: Value> Piece<V> {
    const EMPTY: Self = Self {
        moments: Moments::new(),
        rejected: 0,
        low: V::ZERO,
        high: V::ZERO,
    };

    fn used(&self) -> u64 {
        self.moments.count() + self.rejected
    }
}

/// A block that was begun: both what the fast and what the careful evaluation of the whole block need.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Open<V> {
    /// `None` once plain arithmetic does not do for the whole block.
    fast: Option<Block<V>>,
    careful: Piece<V>,
    /// How many coordinates its points have read.
    pub(crate) drawn: u64,
}

impl<V: Value> Open<V> {
    pub(crate) const EMPTY: Self = Self {
        fast: Some(Block::EMPTY),
        careful: Piece::EMPTY,
        drawn: 0,
    };

    pub(crate) fn used(&self) -> u64 {
        self.careful.used()
    }

    pub(crate) fn push(&mut self, value: V, drawn: u64) {
        self.drawn += drawn;
        if let Some(fast) = &mut self.fast {
            fast.push(value);
            self.fast = self.fast.filter(Block::is_finite);
        }
        let careful = &mut self.careful;
        if !value.is_finite() {
            careful.rejected += 1;
            return;
        }
        if careful.moments.count() == 0 {
            (careful.low, careful.high) = (value, value);
        }
        careful.moments.push(value);
        careful.low = careful.low.zip(value, smaller);
        careful.high = careful.high.zip(value, larger);
    }

    /// The block as it is, to the bit what an evaluation of all its points at once gives.
    pub(crate) fn piece(&self) -> Piece<V> {
        self.fast
            .and_then(|fast| fast.piece())
            .unwrap_or(self.careful)
    }
}
