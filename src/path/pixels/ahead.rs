//! Coordinates that are computed ahead of paths.

use core::cell::Cell;

/// How many coordinates are computed ahead of paths: no result depends on it.
pub(in crate::path) struct Ahead {
    #[cfg_attr(
        not(feature = "simd"),
        expect(dead_code, reason = "paths go one after the other")
    )]
    width: Cell<u32>,
}

impl Ahead {
    /// So many to begin with.
    pub(super) fn new(width: u32) -> Self {
        Self {
            width: Cell::new(width),
        }
    }
}

#[cfg(feature = "simd")]
impl Ahead {
    /// A coordinate alone takes as long as so many of those that are computed together, about.
    const ALONE: usize = 32;

    /// Point sets compute so many together, and are slower with fewer.
    const TOGETHER: usize = 8;

    /// How many.
    pub(super) fn width(&self) -> u32 {
        self.width.get()
    }

    /// For the next paths, as many as those that were followed just now should have had: what so few of them have `read` is not worth
    /// computing for all.
    pub(super) fn learn(&self, read: impl ExactSizeIterator<Item = u32>) {
        const MOST: usize = 64;
        if read.len() == 0 {
            return;
        }
        let few = read.len() / Self::ALONE;
        let mut counts = [0; MOST + 1];
        for width in read {
            counts[MOST.min(width as usize)] += 1;
        }
        let mut longer = 0;
        let shorter = counts.iter().rposition(|count| {
            longer += count;
            longer > few
        });
        let width = shorter.unwrap_or(0).next_multiple_of(Self::TOGETHER);
        #[expect(clippy::cast_possible_truncation, reason = "at most 64")]
        self.width.set(width as u32);
    }
}

#[cfg(all(test, feature = "simd"))]
mod tests {
    use super::*;

    #[test]
    fn as_many_coordinates_are_computed_as_all_but_few_paths_read() {
        let learned = |read: &[u32]| {
            let ahead = Ahead::new(7);
            ahead.learn(read.iter().copied());
            ahead.width()
        };
        let with_long = |long: usize| {
            let read: Vec<_> = (0..64)
                .map(|path| if path < long { 20 } else { 6 })
                .collect();
            learned(&read)
        };
        assert_eq!([2, 3].map(with_long), [8, 24]);
        assert_eq!(
            [learned(&[]), learned(&[3, 9, 4]), learned(&[100])],
            [7, 16, 64]
        );
    }
}
