//! The centres of pixels.

use super::{Filter, Filtered};

/// The radiance at the centre of the pixel: no mean over anything, so that edges are jagged and details between the centres
/// are lost. No picture of this kind converges to the mean over the pixels; it is here to be compared with. Takes no
/// memory; its two coordinates are drawn and not used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Centre;

impl Filter for Centre {
    #[inline]
    fn sample(&self, position: [u32; 2], _: [u32; 2], _: [f64; 2]) -> Filtered {
        Filtered {
            point: position.map(|at| f64::from(at) + 0.5),
            weight: 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_is_at_the_centre() {
        for u in [[0.0, 0.0], [0.3, 0.99]] {
            let seen = Centre.sample([3, 7], [10, 10], u);
            assert_eq!((seen.point, seen.weight), ([3.5, 7.5], 1.0));
        }
    }
}
