//! Spectra, and the colours that the RGB variants of Mitsuba make of them.

mod cie;

use std::path::Path;

use glam::{DMat3, DVec3};

use super::number;

/// Values over wavelengths in nanometres, linear in between.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Spectrum {
    /// The same value at every wavelength.
    Uniform(f64),
    /// At least two, at growing wavelengths.
    Listed(Vec<Entry>),
}

/// One value of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    wavelength: f64,
    value: f64,
}

/// What a colour is for, which decides how it is made of a spectrum and which values it may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Role {
    /// A fraction of light, in `[0, 1]`.
    Fraction,
    /// A property of a material without bounds, such as an index of refraction.
    Unbounded,
    /// Light, at least 0.
    Emission,
}

impl Spectrum {
    /// A value for all wavelengths, or a list as in `400:0.1, 500:0.7`.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let pairs: Vec<_> = number::tokens(text).collect();
        if let [value] = pairs[..]
            && !value.contains(':')
        {
            return number::number(value)
                .map(Self::Uniform)
                .map_err(|e| e.to_string());
        }
        let entries = pairs.iter().map(|pair| {
            let (wavelength, value) = pair.split_once(':').ok_or_else(|| {
                format!("`{pair}` is no pair of a wavelength and a value, as in 400:0.1")
            })?;
            Entry::parse(wavelength, value)
        });
        Self::list(entries.collect::<Result<_, _>>()?)
    }

    /// The spectrum of a file with a wavelength and a value in each line; lines that begin with `#` are comments.
    pub(super) fn read(file: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(file).map_err(|e| e.to_string())?;
        let lines = text.lines().enumerate().filter_map(|(at, line)| {
            let line = line.trim();
            (!line.is_empty() && !line.starts_with('#')).then_some((at + 1, line))
        });
        let entries = lines.map(|(at, line)| {
            let mut parts = number::tokens(line);
            let (Some(wavelength), Some(value), None) = (parts.next(), parts.next(), parts.next())
            else {
                return Err(format!("line {at} is no pair of a wavelength and a value"));
            };
            Entry::parse(wavelength, value).map_err(|reason| format!("line {at}: {reason}"))
        });
        Self::list(entries.collect::<Result<_, _>>()?)
    }

    /// The spectrum with the given values.
    fn list(entries: Vec<Entry>) -> Result<Self, String> {
        if entries.len() < 2 {
            return Err("a spectrum has at least two values".to_owned());
        }
        match entries
            .windows(2)
            .find(|pair| !(pair[0].wavelength < pair[1].wavelength))
        {
            Some(pair) => Err(format!(
                "the wavelengths of a spectrum must grow; {} follows {}",
                pair[1].wavelength, pair[0].wavelength
            )),
            None => Ok(Self::Listed(entries)),
        }
    }

    /// The linear RGB that stands for the spectrum in the given role.
    ///
    /// Light is weighed by the colour matching functions alone, so that a uniform spectrum is reddish, since white is
    /// D65. Anything else is weighed by D65 as well, so that a uniform one is grey. Colours outside what RGB can show are
    /// clipped.
    pub(super) fn rgb(&self, role: Role) -> DVec3 {
        match (self, role) {
            (Self::Uniform(value), Role::Emission) => *value * (xyz_to_rgb() * DVec3::ONE),
            (Self::Uniform(value), _) => DVec3::splat(*value),
            (Self::Listed(entries), Role::Emission) => integrate(entries, |_| 1.0).max(DVec3::ZERO),
            (Self::Listed(entries), Role::Unbounded) => {
                integrate(entries, cie::d65).max(DVec3::ZERO)
            }
            (Self::Listed(entries), Role::Fraction) => {
                integrate(entries, cie::d65).clamp(DVec3::ZERO, DVec3::ONE)
            }
        }
    }
}

impl Entry {
    fn parse(wavelength: &str, value: &str) -> Result<Self, String> {
        let read = |text| number::number(text).map_err(|e| e.to_string());
        Ok(Self {
            wavelength: read(wavelength)?,
            value: read(value)?,
        })
    }
}

/// The RGB of light with the spectrum `entries` times `illuminant`, by 1000 steps over the visible wavelengths; outside its
/// wavelengths the spectrum is 0.
fn integrate(entries: &[Entry], illuminant: impl Fn(f64) -> f64) -> DVec3 {
    const STEPS: u32 = 1000;
    let [low, high] = cie::RANGE;
    let mut sum = DVec3::ZERO;
    for step in 0..STEPS {
        let wavelength = low + f64::from(step) / f64::from(STEPS - 1) * (high - low);
        if let Some(value) = interpolate(entries, wavelength) {
            sum += cie::xyz(wavelength) * (value * illuminant(wavelength));
        }
    }
    let xyz = sum * ((high - low) * cie::NORMALIZATION / f64::from(STEPS));
    xyz_to_rgb() * xyz
}

/// The value at a wavelength, if it is one of the spectrum's.
fn interpolate(entries: &[Entry], wavelength: f64) -> Option<f64> {
    let (first, last) = (entries.first()?, entries.last()?);
    if !(first.wavelength <= wavelength && wavelength <= last.wavelength) {
        return None;
    }
    let above = entries
        .partition_point(|entry| entry.wavelength <= wavelength)
        .clamp(1, entries.len() - 1);
    let (a, b) = (entries[above - 1], entries[above]);
    let t = (wavelength - a.wavelength) / (b.wavelength - a.wavelength);
    Some(a.value + t * (b.value - a.value))
}

/// From CIE XYZ to linear RGB with the primaries of ITU-R BT.709 and the white D65.
fn xyz_to_rgb() -> DMat3 {
    DMat3::from_cols_array(&[
        3.240_479, -0.969_256, 0.055_648, -1.537_150, 1.875_991, -0.204_043, -0.498_535, 0.041_556,
        1.057_311,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of Mitsuba 3.9.1, variant `scalar_rgb`: `mi.spectrum_list_to_srgb` with the arguments `bounded` and `d65` as in the
    /// role.
    #[test]
    fn colours_are_those_of_mitsuba() {
        let listed = "400:0, 500:8, 600:15.6, 700:18.4";
        let cases = [
            (listed, Role::Emission, MITSUBA[0]),
            (listed, Role::Unbounded, MITSUBA[1]),
            (
                "400:0.1, 450:0.9, 500:0.2, 700:0.4",
                Role::Fraction,
                MITSUBA[2],
            ),
            ("500:0, 510:3, 520:0", Role::Fraction, MITSUBA[3]),
            ("2", Role::Emission, MITSUBA[4]),
        ];
        for (text, role, expected) in cases {
            let rgb = Spectrum::parse(text).unwrap().rgb(role);
            let expected = DVec3::from(expected);
            assert!(
                (rgb - expected).abs().max_element() < 2e-6 * expected.max_element(),
                "{text} {role:?}: {rgb} instead of {expected}"
            );
        }
    }

    const MITSUBA: [[f64; 3]; 5] = [
        [20.710_821, 10.854_642, 2.771_151],
        [17.714_729, 11.354_427, 3.304_511],
        [0.352_805_3, 0.213_576_9, 0.695_655_5],
        [0.0, 0.287_194_9, 0.020_974_8],
        [2.409_588, 1.896_582, 1.817_832],
    ];

    #[test]
    fn uniform_fractions_are_grey() {
        assert_eq!(
            Spectrum::parse("0.3").unwrap().rgb(Role::Fraction),
            DVec3::splat(0.3)
        );
    }

    #[test]
    fn what_is_no_spectrum_is_refused() {
        for text in [
            "",
            "400:1",
            "500:1, 400:2",
            "400:1, 400:2",
            "400:1 500",
            "a",
            "400:1:2 500:3",
            "nan",
        ] {
            assert!(Spectrum::parse(text).is_err(), "{text}");
        }
    }
}
