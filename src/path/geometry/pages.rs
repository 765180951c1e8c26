//! Lists that rays walk through, on large pages of memory.

use bytemuck::Pod;
#[cfg(target_os = "linux")]
use bytemuck::{cast_slice, cast_slice_mut};
#[cfg(target_os = "linux")]
use memmap2::{Advice, MmapMut};

/// A list that does not change, on pages of 2 MB where the system grants them.
///
/// Rays read a large tree here and there. On pages of 4 KB the machine has to look up where most of what they read is.
#[derive(Debug)]
pub(super) enum Pages<T> {
    List(Vec<T>),
    /// The bytes within a range of the map.
    #[cfg(target_os = "linux")]
    Map(MmapMut, core::ops::Range<usize>),
}

/// The size of a large page, in bytes.
#[cfg(target_os = "linux")]
const LARGE: usize = 1 << 21;

/// The shortest list that has a page of its own, in bytes: it leaves three quarters of the page unused.
#[cfg(target_os = "linux")]
const SHORTEST: usize = LARGE / 4;

impl<T: Pod> Pages<T> {
    pub(super) fn new(items: impl ExactSizeIterator<Item = T>) -> Self {
        #[cfg(target_os = "linux")]
        {
            let bytes = items.len() * size_of::<T>();
            // A page more, to begin where a page does.
            let room = bytes.next_multiple_of(LARGE) + LARGE;
            if bytes >= SHORTEST
                && let Ok(map) = MmapMut::map_anon(room)
            {
                return Self::on(map, bytes, items);
            }
        }
        Self::List(items.collect())
    }

    #[cfg(target_os = "linux")]
    fn on(mut map: MmapMut, bytes: usize, items: impl Iterator<Item = T>) -> Self {
        // A system that has no large pages leaves it at small ones.
        let _ = map.advise(Advice::HugePage);
        let start = map.as_ptr().align_offset(LARGE);
        let range = start..start + bytes;
        let slots: &mut [T] = cast_slice_mut(&mut map[range.clone()]);
        slots
            .iter_mut()
            .zip(items)
            .for_each(|(slot, item)| *slot = item);
        Self::Map(map, range)
    }

    #[inline]
    pub(super) fn as_slice(&self) -> &[T] {
        match self {
            Self::List(list) => list,
            #[cfg(target_os = "linux")]
            Self::Map(map, range) => cast_slice(&map[range.clone()]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_what_it_was_made_of_on_pages_of_any_size() {
        for count in [0_u32, 1, 1000, 131_071, 131_072, 1_000_000] {
            let pages = Pages::new((0..count).collect::<Vec<_>>().into_iter());
            assert!(pages.as_slice().iter().copied().eq(0..count), "{count}");
            #[cfg(target_os = "linux")]
            match pages {
                Pages::List(_) => assert!(count < 131_072, "{count}"),
                Pages::Map(..) => {
                    assert!(count >= 131_072, "{count}");
                    assert_eq!(pages.as_slice().as_ptr().align_offset(LARGE), 0);
                }
            }
        }
    }
}
