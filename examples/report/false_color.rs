//! Numbers as colours.

use std::path::Path;

use estimand::path::Image;
use glam::DVec3;

use crate::Failure;

/// Colours of sRGB between which is interpolated.
type Scale = [[u8; 3]; 5];

/// Blue, white, red: `RdBu` of `ColorBrewer`, for what can be negative.
const SIGNED: Scale = [
    [33, 102, 172],
    [146, 197, 222],
    [247, 247, 247],
    [244, 165, 130],
    [178, 24, 43],
];

/// Dark to bright: `inferno` of matplotlib, for what cannot.
const POSITIVE: Scale = [
    [0, 0, 4],
    [87, 16, 110],
    [188, 55, 84],
    [249, 142, 9],
    [252, 255, 164],
];

/// Values in `[-limit, limit]` as colours; blue is below zero, red above.
pub(crate) fn signed(width: usize, values: &[f64], limit: f64) -> Result<Image, Failure> {
    colored(width, values, SIGNED, |value| 0.5 + 0.5 * value / limit)
}

/// Values in `[0, limit]` as colours, dark to bright.
pub(crate) fn positive(width: usize, values: &[f64], limit: f64) -> Result<Image, Failure> {
    colored(width, values, POSITIVE, |value| value / limit)
}

fn colored(
    width: usize,
    values: &[f64],
    scale: Scale,
    place: impl Fn(f64) -> f64,
) -> Result<Image, Failure> {
    let pixels = values
        .iter()
        .map(|&value| color(scale, place(value)))
        .collect();
    Ok(Image::new(width, pixels)?)
}

/// The colour at a place in `[0, 1]`, in linear components, as images have them.
fn color(scale: Scale, place: f64) -> DVec3 {
    let at = place.clamp(0.0, 1.0) * (scale.len() - 1) as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 to 3"
    )]
    let below = (at.floor() as usize).min(scale.len() - 2);
    let [low, high] = [scale[below], scale[below + 1]].map(|c| DVec3::from(c.map(f64::from)));
    (low.lerp(high, at - below as f64) / 255.0).map(|encoded| {
        if encoded <= 0.040_45 {
            encoded / 12.92
        } else {
            ((encoded + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// The brightness of a linear colour.
pub(crate) fn luminance(color: DVec3) -> f64 {
    color.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// Writes the picture as a PNG file, and returns its bytes.
pub(crate) fn png(image: &Image, path: &Path) -> Result<Vec<u8>, Failure> {
    image.write_png(path)?;
    Ok(std::fs::read(path)?)
}
