//! Any reconstruction filter.

use crate::Error;
use crate::mitsuba::Filter as Described;
use crate::path::filter::{
    BoxFilter, Filter, Filtered, Gaussian, Lanczos, Mitchell, Separable, Tent,
};

/// Any of the filters that a film may have.
#[derive(Debug)]
pub(super) enum AnyFilter {
    Box(BoxFilter),
    Tent(Separable<Tent>),
    Gaussian(Separable<Gaussian>),
    Mitchell(Separable<Mitchell>),
    Lanczos(Separable<Lanczos>),
}

impl AnyFilter {
    pub(super) fn of(filter: Described) -> Result<Self, Error> {
        Ok(match filter {
            Described::Box => Self::Box(BoxFilter),
            Described::Tent { radius } => Self::Tent(Separable::new(Tent::new(radius)?)?),
            Described::Gaussian { stddev } => {
                Self::Gaussian(Separable::new(Gaussian::new(stddev)?)?)
            }
            Described::Mitchell { b, c } => Self::Mitchell(Separable::new(Mitchell::new(b, c)?)?),
            Described::CatmullRom => Self::Mitchell(Separable::new(Mitchell::new(0.0, 0.5)?)?),
            Described::Lanczos { lobes } => Self::Lanczos(Separable::new(Lanczos::new(lobes)?)?),
        })
    }
}

impl Filter for AnyFilter {
    #[inline]
    fn sample(&self, position: [u32; 2], size: [u32; 2], u: [f64; 2]) -> Filtered {
        match self {
            Self::Box(filter) => filter.sample(position, size, u),
            Self::Tent(filter) => filter.sample(position, size, u),
            Self::Gaussian(filter) => filter.sample(position, size, u),
            Self::Mitchell(filter) => filter.sample(position, size, u),
            Self::Lanczos(filter) => filter.sample(position, size, u),
        }
    }
}
