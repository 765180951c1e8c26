//! What tells curves apart: a colour, a dash and a marker each, any one of which is enough.

use std::fmt::Write;

/// How many looks there are before they repeat.
pub(super) const LOOKS: usize = 12;

/// The pattern of the line of curve number `index`, as SVG's `stroke-dasharray` has it.
pub(super) fn dash(index: usize) -> &'static str {
    ["none", "7 3", "2 3", "9 3 2 3", "5 2 1 2 1 2"][index % 5]
}

/// The marker of curve number `index` at a place, as the data of an SVG path.
pub(super) fn marker(index: usize, x: f64, y: f64) -> String {
    // Corners relative to the place.
    let polygon = |corners: &[[f64; 2]]| {
        let mut path = String::new();
        for (corner, [dx, dy]) in corners.iter().enumerate() {
            let letter = if corner == 0 { 'M' } else { 'L' };
            let _ = write!(path, "{letter}{:.1} {:.1}", x + dx, y + dy);
        }
        path + "Z"
    };
    let strokes = |ends: &[[f64; 4]]| {
        let mut path = String::new();
        for [a, b, c, d] in ends {
            let _ = write!(path, "M{:.1} {:.1}L{:.1} {:.1}", x + a, y + b, x + c, y + d);
        }
        path
    };
    let circle = |r: f64| {
        format!(
            "M{:.1} {y:.1}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z",
            x - r,
            d = 2.0 * r
        )
    };
    match index % LOOKS {
        0 | 5 => circle(3.6),
        1 | 8 => polygon(&[[-3.4, -3.4], [3.4, -3.4], [3.4, 3.4], [-3.4, 3.4]]),
        2 | 9 => polygon(&[[0.0, -4.8], [4.4, 3.2], [-4.4, 3.2]]),
        3 | 10 => polygon(&[[0.0, -5.0], [4.4, 0.0], [0.0, 5.0], [-4.4, 0.0]]),
        4 => strokes(&[[-3.6, -3.6, 3.6, 3.6], [-3.6, 3.6, 3.6, -3.6]]),
        6 => strokes(&[[-4.6, 0.0, 4.6, 0.0], [0.0, -4.6, 0.0, 4.6]]),
        7 => polygon(&[[0.0, 4.8], [4.4, -3.2], [-4.4, -3.2]]),
        _ => strokes(&[
            [-4.6, 0.0, 4.6, 0.0],
            [-2.3, -4.0, 2.3, 4.0],
            [-2.3, 4.0, 2.3, -4.0],
        ]),
    }
}

/// Whether the marker of curve number `index` is filled.
pub(super) fn is_filled(index: usize) -> bool {
    matches!(index % LOOKS, 0..=3 | 7)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_two_looks_are_alike() {
        let looks: BTreeSet<_> = (0..LOOKS)
            .map(|index| (marker(index, 0.0, 0.0), is_filled(index)))
            .collect();
        assert_eq!(looks.len(), LOOKS);
        // Neighbours differ in their dashes too.
        assert!((1..LOOKS).all(|index| dash(index) != dash(index - 1)));
    }
}
