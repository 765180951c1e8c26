//! The box filter.

use super::{Filter, Filtered};

/// The mean over the square of the pixel: nothing of it is seen in its neighbours. Takes no memory and no time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoxFilter;

impl Filter for BoxFilter {
    #[inline]
    fn sample(&self, position: [u32; 2], _: [u32; 2], u: [f64; 2]) -> Filtered {
        Filtered {
            point: core::array::from_fn(|axis| f64::from(position[axis]) + u[axis]),
            weight: 1.0,
        }
    }
}
