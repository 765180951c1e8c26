//! Optical constants of metals by name.

use glam::DVec3;

/// What a metal is made of, for light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Metal {
    /// The index of refraction.
    pub(super) eta: DVec3,
    /// The extinction coefficient.
    pub(super) k: DVec3,
}

/// The constants of a metal in red, green and blue, as Mitsuba's RGB variants have them. The measured spectra behind them
/// are those of the databases Luxpop and SOPRA and of E. D. Palik; `reference/conductors.py` prints this table.
pub(super) fn named(material: &str) -> Option<Metal> {
    let line = lines().find(|line| line.split(' ').next() == Some(material))?;
    let mut numbers = line.split(' ').skip(1).map(str::parse);
    let mut triple = || {
        let mut next = || numbers.next()?.ok();
        Some(DVec3::new(next()?, next()?, next()?))
    };
    Some(Metal {
        eta: triple()?,
        k: triple()?,
    })
}

/// The names of the metals.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    lines().filter_map(|line| line.split(' ').next())
}

fn lines() -> impl Iterator<Item = &'static str> {
    include_str!("conductors.txt")
        .lines()
        .filter(|line| !line.starts_with('#'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_is_a_metal() {
        assert_eq!(names().count(), 71);
        for name in names() {
            let metal = named(name).unwrap();
            assert!(metal.eta.is_finite() && metal.k.is_finite(), "{name}");
        }
        assert_eq!(named("Unobtainium"), None);
    }
}
