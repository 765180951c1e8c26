//! Colours: linear red, green and blue.

use glam::Vec3A;

use crate::Error;

/// Three fractions in `[0, 1]`.
pub(in crate::path) fn fraction(name: &'static str, rgb: [f32; 3]) -> Result<Vec3A, Error> {
    within(name, "in [0, 1] in every component", rgb, 1.0)
}

/// Three finite components, zero or more.
pub(in crate::path) fn radiance(rgb: [f32; 3]) -> Result<Vec3A, Error> {
    within(
        "radiance",
        "finite and not negative in every component",
        rgb,
        f32::MAX,
    )
}

fn within(
    name: &'static str,
    domain: &'static str,
    rgb: [f32; 3],
    high: f32,
) -> Result<Vec3A, Error> {
    if rgb.iter().all(|component| (0.0..=high).contains(component)) {
        Ok(Vec3A::from(rgb))
    } else {
        Err(Error::refused(name, domain, format_args!("{rgb:?}")))
    }
}

/// The luminance of linear sRGB, by its second row of the matrix to XYZ, as Mitsuba rounds it.
pub(in crate::path) const LUMINANCE: Vec3A = Vec3A::new(0.212_671, 0.715_160, 0.072_169);
