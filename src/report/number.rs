//! Numbers as people read them: with the digits that mean something, and with units.

/// `value` with so many significant digits; in powers of ten where it is below 0.001 or from 100 000 on.
///
/// ```
/// use estimand::report::number::significant;
///
/// assert_eq!(significant(0.123_456, 3), "0.123");
/// assert_eq!(significant(1234.5, 2), "1200");
/// assert_eq!(significant(-1.234e-7, 2), "−1.2·10⁻⁷");
/// assert_eq!(significant(9.99e5, 2), "1.0·10⁶");
/// assert_eq!(significant(f64::NAN, 2), "NaN");
/// ```
pub fn significant(value: f64, digits: u32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string().replace("inf", "∞").replace('-', "−");
    }
    let digits = digits.max(1) as usize;
    // Rounding first: 9.99 with two digits is 10, of another exponent.
    let rounded = format!("{:.*e}", digits - 1, value.abs());
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let sign = if value < 0.0 { "−" } else { "" };
    if (-3..5).contains(&exponent) {
        let behind = usize::try_from(digits as i64 - 1 - i64::from(exponent)).unwrap_or(0);
        let rounded: f64 = rounded.parse().unwrap_or(f64::NAN);
        return format!("{sign}{rounded:.behind$}");
    }
    format!("{sign}{mantissa}·{}", power_of_ten(exponent))
}

/// 10 to a power, in superscript digits.
///
/// ```
/// assert_eq!(estimand::report::number::power_of_ten(-12), "10⁻¹²");
/// ```
pub fn power_of_ten(exponent: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    };
    format!(
        "10{}",
        exponent.to_string().chars().map(raised).collect::<String>()
    )
}

/// A time with its unit and so many significant digits.
///
/// ```
/// use estimand::report::number::seconds;
///
/// assert_eq!(seconds(1.234e-8, 2), "12 ns");
/// assert_eq!(seconds(0.0035, 2), "3.5 ms");
/// assert_eq!(seconds(61.0, 2), "61 s");
/// assert_eq!(seconds(7200.0, 2), "120 min");
/// ```
pub fn seconds(time: f64, digits: u32) -> String {
    let (scale, unit) = match time.abs() {
        t if t < 0.9995e-6 => (1e9, "ns"),
        t if t < 0.9995e-3 => (1e6, "µs"),
        t if t < 0.9995 => (1e3, "ms"),
        t if t < 600.0 => (1.0, "s"),
        _ => (1.0 / 60.0, "min"),
    };
    format!("{} {unit}", significant(time * scale, digits))
}

/// A share as so many per cent, with so many digits behind the point.
///
/// ```
/// use estimand::report::number::percent;
///
/// assert_eq!(percent(0.9512, 1), "95.1 %");
/// assert_eq!(percent(-0.02, 0), "−2 %");
/// ```
pub fn percent(share: f64, digits: u32) -> String {
    format!("{:.*} %", digits as usize, 100.0 * share).replace('-', "−")
}

/// A number with so many digits behind the point, its sign a minus, not a hyphen.
pub fn fixed(value: f64, digits: u32) -> String {
    format!("{value:.*}", digits as usize).replace('-', "−")
}
