//! Numbers as text.

use core::fmt;

use glam::DVec3;

/// A text that is no number, or none that can be used.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct NoNumber(String);

impl fmt::Display for NoNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The parts of a list, between commas and white space.
pub(super) fn tokens(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_ascii_whitespace())
        .filter(|token| !token.is_empty())
}

/// A finite number that a 32-bit float can hold.
pub(super) fn number(text: &str) -> Result<f64, NoNumber> {
    let text = text.trim();
    let value: f64 = text
        .parse()
        .map_err(|_| NoNumber(format!("`{text}` is not a number")))?;
    if !(value.abs() <= f64::from(f32::MAX)) {
        return Err(NoNumber(format!("`{text}` is not a finite 32-bit number")));
    }
    Ok(value)
}

/// A list of numbers.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, NoNumber> {
    tokens(text).map(number).collect()
}

/// Three numbers.
pub(super) fn triple(text: &str) -> Result<DVec3, NoNumber> {
    match numbers(text)?[..] {
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        ref other => Err(NoNumber(format!(
            "`{text}` has {} numbers instead of 3",
            other.len()
        ))),
    }
}

/// Three numbers, or one that stands for three.
pub(super) fn one_or_three(text: &str) -> Result<DVec3, NoNumber> {
    match numbers(text)?[..] {
        [value] => Ok(DVec3::splat(value)),
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        ref other => Err(NoNumber(format!(
            "`{text}` has {} numbers instead of 1 or 3",
            other.len()
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_parted_by_commas_and_spaces() {
        assert_eq!(numbers(" 1, -2.5\n,3e2 ").unwrap(), [1.0, -2.5, 300.0]);
        assert_eq!(triple("1 2 3").unwrap(), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(one_or_three("0.5").unwrap(), DVec3::splat(0.5));
        assert!(triple("1 2").is_err() && one_or_three("1,2").is_err());
    }

    #[test]
    fn only_finite_numbers_count() {
        for text in ["nan", "inf", "-inf", "1e39", "", "1.0x", "#ff0000", "--1"] {
            assert!(number(text).is_err(), "{text}");
        }
    }
}
