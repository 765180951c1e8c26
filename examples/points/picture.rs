//! Panels of equal size, drawn into an image.

use estimand::discrepancy::Periodogram;
use image::{Rgb, RgbImage};

/// The highest frequency of a periodogram, in cycles over the square.
pub(crate) const HIGHEST: u32 = 64;

/// The side of a panel, and the margin around it, in pixels: three for each of the frequencies of a periodogram, positive and negative.
const PANEL: u32 = 3 * (2 * HIGHEST + 1);
const MARGIN: u32 = 16;

const PAPER: Rgb<u8> = Rgb([255; 3]);
const FRAME: Rgb<u8> = Rgb([120; 3]);
const STRATUM: Rgb<u8> = Rgb([205, 215, 235]);
const DOT: [f64; 3] = [20.0, 40.0, 110.0];

/// Dots in the unit square, the first coordinate to the right and the second upwards, on the boundaries of equal `strata` of
/// both axes.
pub(crate) fn scatter(points: &[[f64; 2]], strata: [u64; 2]) -> RgbImage {
    /// Narrower strata are not drawn.
    const MOST: u64 = 64;
    let mut panel = RgbImage::from_pixel(PANEL, PANEL, PAPER);
    let side = f64::from(PANEL);
    for (axis, count) in strata
        .into_iter()
        .enumerate()
        .filter(|&(_, count)| count <= MOST)
    {
        for boundary in 1..count {
            let place = pixel(boundary as f64 / count as f64 * side);
            for along in 0..PANEL {
                let (x, y) = if axis == 0 {
                    (place, along)
                } else {
                    (along, PANEL - 1 - place)
                };
                panel.put_pixel(x, y, STRATUM);
            }
        }
    }
    // Dots of a readable size that do not cover everything.
    let radius = (0.25 * side / (points.len() as f64).sqrt()).clamp(1.0, 5.0);
    for &[x, y] in points {
        dot(&mut panel, [x * side, (1.0 - y) * side], radius);
    }
    panel
}

/// A disc, smooth at its edge.
fn dot(panel: &mut RgbImage, [x, y]: [f64; 2], radius: f64) {
    let range = |centre: f64| pixel(centre - radius - 1.0)..=pixel(centre + radius + 1.0);
    for row in range(y) {
        for column in range(x) {
            let distance = (f64::from(column) + 0.5 - x).hypot(f64::from(row) + 0.5 - y);
            let cover = (radius + 0.5 - distance).clamp(0.0, 1.0);
            for (channel, ink) in panel.get_pixel_mut(column, row).0.iter_mut().zip(DOT) {
                *channel = level(f64::from(*channel) * (1.0 - cover) + ink * cover);
            }
        }
    }
}

/// The pixel of the panel that a place falls into, or the nearest.
#[expect(clippy::cast_possible_truncation, reason = "clamped to the panel")]
fn pixel(place: f64) -> u32 {
    place.clamp(0.0, f64::from(PANEL - 1)) as u32
}

#[expect(clippy::cast_possible_truncation, reason = "clamped to a byte")]
fn level(value: f64) -> u8 {
    value.round().clamp(0.0, 255.0) as u8
}

/// The mean of periodograms: black for no power, middle grey for that of independent points, white from four times that on. At
/// frequency 0, where the power is the number of points, it is left black.
pub(crate) fn shades(spectra: &[Periodogram]) -> RgbImage {
    let frequency = |pixel: u32| (pixel / 3).cast_signed() - HIGHEST.cast_signed();
    RgbImage::from_fn(PANEL, PANEL, |x, y| {
        let (first, second) = (frequency(x), frequency(PANEL - 1 - y));
        let sum: f64 = spectra
            .iter()
            .map(|spectrum| spectrum.power(first, second))
            .sum();
        let power = match (first, second) {
            (0, 0) => 0.0,
            _ => sum / spectra.len() as f64,
        };
        Rgb([level(127.5 * power.sqrt()); 3])
    })
}

/// One row of panels for each projection.
pub(crate) fn side_by_side(rows: &[[RgbImage; 2]]) -> RgbImage {
    let step = PANEL + MARGIN;
    let count = u32::try_from(rows.len()).expect("projections are given by hand");
    let mut whole = RgbImage::from_pixel(MARGIN + 2 * step, MARGIN + count * step, PAPER);
    for (top, row) in (MARGIN..).step_by(step as usize).zip(rows) {
        for (left, panel) in (MARGIN..).step_by(step as usize).zip(row) {
            for y in top - 1..=top + PANEL {
                for x in left - 1..=left + PANEL {
                    whole.put_pixel(x, y, FRAME);
                }
            }
            image::imageops::replace(&mut whole, panel, left.into(), top.into());
        }
    }
    whole
}
