//! Whether `f32` tells the points of a scene apart.

use core::ops::RangeInclusive;

use glam::Vec3A;

use crate::Error;

/// How far a scene may be from the origin, in units of its size. Its surfaces are then known to about a 256th of it, 2^-21 of
/// their coordinates: see [`Surface::margin`](super::Surface::margin).
const FARTHEST: f64 = 8192.0;

/// How far an object may be from the origin, in units of its size. It is then no larger than what is known of its points.
const FINEST: f64 = 2_097_152.0;

/// The sizes of scenes whose volumes, and densities, are numbers of full precision.
const SIZES: RangeInclusive<f64> = 1e-11..=1e11;

/// A box, as far as numbers go.
struct Extent {
    /// Its diagonal.
    size: f64,
    /// Its largest coordinate.
    reach: f64,
}

impl Extent {
    /// `None` for the box around nothing.
    fn of([low, high]: [Vec3A; 2]) -> Option<Self> {
        low.cmple(high).all().then(|| Self {
            size: (high.as_dvec3() - low.as_dvec3()).length(),
            reach: low.abs().max(high.abs()).max_element().into(),
        })
    }

    fn within(&self, times: f64, name: &'static str, domain: &'static str) -> Result<(), Error> {
        if self.reach <= times * self.size {
            return Ok(());
        }
        let Self { size, reach } = self;
        Err(Error::refused(
            name,
            domain,
            format_args!("a size of {size:e} at a distance of {reach:e}"),
        ))
    }
}

/// # Errors
///
/// [`Error::Refused`] if a scene, or a group that is copied, in the box is too far from the origin, too small or too large.
pub(super) fn check_scene(bounds: [Vec3A; 2]) -> Result<(), Error> {
    let Some(extent) = Extent::of(bounds) else {
        return Ok(());
    };
    if !SIZES.contains(&extent.size) {
        return Err(Error::refused(
            "size of a scene",
            "in [1e-11, 1e11]",
            format_args!("{:e}", extent.size),
        ));
    }
    extent.within(
        FARTHEST,
        "distance of a scene from the origin",
        "at most 8192 times its size, or else f32 does not tell its points apart",
    )
}

/// # Errors
///
/// [`Error::Refused`] if an object in the box is too small for where it is.
pub(super) fn check_object(bounds: [Vec3A; 2]) -> Result<(), Error> {
    let Some(extent) = Extent::of(bounds) else {
        return Ok(());
    };
    extent.within(
        FINEST,
        "distance of an object from the origin",
        "at most 2^21 times its size, or else f32 does not tell its points apart",
    )
}
