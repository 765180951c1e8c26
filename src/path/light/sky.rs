//! Pictures of what is around a scene.

#[cfg(feature = "simd")]
mod lanes;

use core::f64::consts::PI;

use glam::{DMat3, Mat3A, Vec3, Vec3A};

use super::{Emission, Environment, Illumination};
use crate::path::frame::{floor, single, turn, turns};
use crate::path::{Segment, Surface, color};
use crate::warp::{Piecewise2d, Place};
use crate::{Error, Sampler};

#[cfg(feature = "simd")]
pub(in crate::path) use lanes::Seen;

/// Light from all around, by a picture of equal steps in latitude and longitude, interpolated linearly.
///
/// Draws two coordinates: a direction in proportion to luminance times solid angle, constant within each square between four
/// pixels.
///
/// The first row of pixels lies at the zenith, which is the y axis, the last at the nadir. A row starts at the -z
/// axis, half a pixel before its first pixel, and turns towards the x axis, as Mitsuba has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    width: usize,
    pixels: Vec<Vec3>,
    /// From directions of the scene to those of the picture, and back.
    inward: Mat3A,
    outward: Mat3A,
    /// Of the squares between pixels: the first row of them lies between the first two rows of pixels.
    directions: Piecewise2d,
    /// For each row of squares, the density per latitude and longitude for a unit of mean luminance.
    density: Vec<f64>,
}

impl Sky {
    /// The sky with the given picture, linear red, green and blue row by row, turned by `outward`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for pixels that make no whole number of rows of `width` pixels, at least two rows of one; for a
    /// component that is negative or not finite; for a picture that is all black; and for a matrix that is no
    /// rotation, up to a thousandth.
    pub fn new(width: usize, pixels: &[[f32; 3]], outward: DMat3) -> Result<Self, Error> {
        if width == 0 || pixels.len() < 2 * width || !pixels.len().is_multiple_of(width) {
            return Err(Error::refused(
                "number of pixels of a sky",
                "a multiple of the width, at least twice",
                format_args!("{} at a width of {width}", pixels.len()),
            ));
        }
        let pixels = pixels
            .iter()
            .map(|&pixel| color::radiance(pixel).map(Vec3::from))
            .collect::<Result<Vec<_>, _>>()?;
        let identity = (outward.transpose() * outward - DMat3::IDENTITY).to_cols_array();
        if !identity.iter().all(|entry| entry.abs() < 1e-3) {
            return Err(Error::refused("turn of a sky", "a rotation", outward));
        }
        let rows = pixels.len() / width - 1;
        let solid_angle = |row: usize| (PI * (row as f64 + 0.5) / rows as f64).sin();
        let weights: Vec<f64> = (0..rows * width)
            .map(|square| {
                let (row, column) = (square / width, square % width);
                let luminance =
                    mean_luminance(around(&pixels, width, row, column).map(|&p| Vec3A::from(p)));
                f64::from(luminance) * solid_angle(row)
            })
            .collect();
        let directions = Piecewise2d::new(&weights, width)?;
        // Scaled, since the sum of the largest numbers is none.
        let largest = weights.iter().copied().fold(0.0, f64::max);
        let sum: f64 = weights.iter().map(|weight| weight / largest).sum();
        let squares = weights.len() as f64;
        let density = (0..rows)
            .map(|row| solid_angle(row) * (squares / sum) / largest / (2.0 * PI * PI))
            .collect();
        Ok(Self {
            width,
            pixels,
            inward: outward.inverse().as_mat3().into(),
            outward: outward.as_mat3().into(),
            directions,
            density,
        })
    }

    /// The place that a direction has in the picture, and the sine of its angle to the zenith.
    #[inline]
    fn place(&self, direction: Vec3A) -> (Square, f32) {
        let d = self.inward * direction;
        let sine = (d.x * d.x + d.z * d.z).sqrt();
        let longitude = turns(d.x, -d.z) - 0.5 / self.width as f32;
        let latitude = 2.0 * turns(sine, d.y);
        let below_one = |u: f32| u.clamp(0.0, 1.0 - f32::EPSILON / 2.0);
        let longitude = below_one(longitude - floor(longitude));
        let (column, s) = cell(longitude * self.width as f32, self.width);
        let rows = self.density.len();
        let (row, t) = cell(below_one(latitude) * rows as f32, rows);
        let within = [s, t];
        let square = Square {
            column,
            row,
            within,
        };
        (square, sine)
    }

    /// The direction of a place, and the sine of its angle to the zenith.
    #[inline]
    fn direction(&self, place: &Place) -> (Vec3A, f32) {
        let (from_pole, upper, longitude) = self.angles(place);
        let [height, sine] = turn(from_pole);
        let cosine = if upper { height } else { -height };
        let [against, along] = turn(longitude);
        let direction = Vec3A::new(along * sine, cosine, -against * sine);
        ((self.outward * direction).normalize(), sine)
    }

    /// The angle of a place to the nearer pole, where angles keep their digits, whether that is the zenith, and the longitude: in turns.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn angles(&self, place: &Place) -> (f32, bool, f32) {
        let [s, t] = place.within;
        let (y, rows) = (place.row as f64 + t, self.density.len() as f64);
        let from_pole = (0.5 * y.min(rows - y) / rows) as f32;
        let x = (place.column as f64 + s + 0.5) / self.width as f64;
        (
            from_pole,
            y + y < rows,
            single(if x < 1.0 { x } else { x - 1.0 }),
        )
    }

    /// The light from a place in a square, whose angle to the zenith has the given sine. The density is that of `directions`, by the
    /// pixels that are at hand anyway.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn emission(&self, square: &Square, sine: f32) -> Emission {
        let [s, t] = square.within;
        let corners = around(&self.pixels, self.width, square.row, square.column);
        let corners = corners.map(|&pixel| Vec3A::from(pixel));
        let above = corners[0].lerp(corners[1], s);
        let below = corners[2].lerp(corners[3], s);
        let density = if sine > 0.0 {
            let luminance = f64::from(mean_luminance(corners));
            (luminance * self.density[square.row] / f64::from(sine)) as f32
        } else {
            0.0
        };
        Emission {
            radiance: above.lerp(below, t),
            density,
        }
    }
}

/// The cell of some that a place is in, and where in it.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "rounds down to a pixel"
)]
fn cell(place: f32, count: usize) -> (usize, f32) {
    let cell = (place as usize).min(count - 1);
    (cell, place - cell as f32)
}

/// A square between four pixels, and a place in it, in `[0, 1]` each way.
#[derive(Clone, Copy, Debug)]
struct Square {
    column: usize,
    row: usize,
    within: [f32; 2],
}

impl From<Place> for Square {
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn from(place: Place) -> Self {
        Self {
            column: place.column,
            row: place.row,
            within: place.within.map(|x| x as f32),
        }
    }
}

/// The pixels around a square: two above, two below.
#[inline]
fn around(pixels: &[Vec3], width: usize, row: usize, column: usize) -> [&Vec3; 4] {
    let next = if column + 1 == width { 0 } else { column + 1 };
    let [above, below] = [row, row + 1].map(|row| &pixels[row * width..][..width]);
    [&above[column], &above[next], &below[column], &below[next]]
}

/// The luminance of the mean of some pixels.
#[inline]
fn mean_luminance(corners: [Vec3A; 4]) -> f32 {
    let [a, b, c, d] = corners.map(|pixel| 0.25 * pixel);
    ((a + b) + (c + d)).dot(color::LUMINANCE)
}

impl Environment for Sky {
    fn as_sky(&self) -> Option<&Sky> {
        Some(self)
    }

    #[inline]
    fn emitted(&self, direction: Vec3A) -> Emission {
        let (square, sine) = self.place(direction);
        self.emission(&square, sine)
    }

    #[inline]
    fn sample<D, S: Sampler>(&self, from: &Surface<D>, u: &mut S) -> Option<Illumination> {
        let mut place = [Place::default()];
        self.directions.locate(&[u.next_2d()], &mut place);
        let [place] = place;
        let square = Square::from(place);
        let (direction, sine) = self.direction(&place);
        let Emission { radiance, density } = self.emission(&square, sine);
        (density > 0.0 && density < f32::INFINITY).then(|| Illumination {
            way: Segment::along(from, direction),
            weight: radiance / density,
            density,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    use crate::path::Surface;
    use crate::points::{HashedOwen, PointSet, Sobol};
    use crate::warp::Warp;

    fn here() -> Surface {
        Surface {
            point: Vec3A::ZERO,
            normal: Vec3A::Y,
            margin: 0.0,
            detail: (),
        }
    }

    fn sky(turn: DMat3) -> Sky {
        let pixels: Vec<[f32; 3]> = (0_u8..15)
            .map(|i| {
                let x = f32::from(i * 7 % 15);
                [x, 0.5 * x, if i % 3 == 0 { 0.0 } else { 2.0 }]
            })
            .collect();
        Sky::new(5, &pixels, turn).unwrap()
    }

    /// The light from a place of the unit square.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "rounds down to a pixel"
    )]
    fn emission(sky: &Sky, [x, y]: [f64; 2], sine: f32) -> Emission {
        let (x, y) = (x * sky.width as f64, y * sky.density.len() as f64);
        let square = Square {
            row: y as usize,
            column: x as usize,
            within: [x.fract() as f32, y.fract() as f32],
        };
        sky.emission(&square, sine)
    }

    #[test]
    fn a_pixel_lies_where_mitsuba_has_it() {
        // Mitsuba 3.9.1, `envmap` of 8 x 5 pixels: pixel (2, 1) is at longitude (2 + 0.5) / 8 of a turn, latitude 1/4 of pi.
        let mut pixels = vec![[0.0; 3]; 40];
        pixels[8 + 2] = [1.0; 3];
        let sky = Sky::new(8, &pixels, DMat3::IDENTITY).unwrap();
        let (longitude, latitude) = (2.0 * PI * 2.5 / 8.0, PI / 4.0);
        let direction = DVec3::new(
            longitude.sin() * latitude.sin(),
            latitude.cos(),
            -longitude.cos() * latitude.sin(),
        );
        let emission = sky.emitted(direction.as_vec3a());
        assert!((emission.radiance.x - 1.0).abs() < 1e-5);
        assert!(emission.density > 0.0);
        assert_eq!(sky.emitted(Vec3A::NEG_Y).radiance, Vec3A::ZERO);
    }

    #[test]
    fn samples_have_the_density_and_the_radiance_of_their_direction() {
        let sky = sky(DMat3::from_rotation_x(0.3) * DMat3::from_rotation_y(2.0));
        let points = Sobol::new(2).unwrap().scrambled(HashedOwen { seed: 1 });
        let mut integral = Vec3A::ZERO;
        let count: u16 = 1 << 14;
        for index in 0..count {
            let light = sky
                .sample(&here(), &mut points.point(index.into()))
                .unwrap();
            let emission = sky.emitted(light.way.ray.direction);
            assert!((light.density / emission.density - 1.0).abs() < 1e-3);
            assert!((light.weight * light.density - emission.radiance).length() < 1e-2);
            integral += light.weight / f32::from(count);
        }
        // The same by the midpoint rule.
        let mut expected = Vec3A::ZERO;
        let steps = 200_u16;
        for row in 0..steps {
            for column in 0..2 * steps {
                let (x, y) = (
                    (f64::from(column) + 0.5) / f64::from(2 * steps),
                    (f64::from(row) + 0.5) / f64::from(steps),
                );
                let area = (PI * y).sin() * (PI / f64::from(steps)).powi(2);
                #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
                let area = area as f32;
                expected += emission(&sky, [x, y], 1.0).radiance * area;
            }
        }
        assert!((integral / expected - 1.0).abs().max_element() < 2e-3);
    }

    #[test]
    fn the_density_of_pixels_is_that_of_the_samples() {
        for scale in [1e-30, 1.0, 1e37] {
            let pixels: Vec<[f32; 3]> = (0_u8..24)
                .map(|i| [0.0, 0.5, 2.5].map(|x| x * scale * f32::from(i * 7 % 13)))
                .collect();
            let sky = Sky::new(6, &pixels, DMat3::IDENTITY).unwrap();
            for place in [[0.01, 0.02], [0.4, 0.3], [0.99, 0.5], [0.7, 0.98]] {
                let sine = (PI * place[1]).sin();
                let expected = sky.directions.density(place) / (2.0 * PI * PI * sine);
                #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
                let emission = emission(&sky, place, sine as f32);
                let ratio = f64::from(emission.density) / expected;
                assert!((ratio - 1.0).abs() < 1e-5, "{place:?}: {ratio}");
            }
        }
    }

    #[test]
    fn bad_skies_are_refused() {
        let identity = DMat3::IDENTITY;
        assert!(Sky::new(2, &[[1.0; 3]; 3], identity).is_err());
        assert!(Sky::new(0, &[], identity).is_err());
        assert!(Sky::new(2, &[[1.0; 3]; 2], identity).is_err());
        assert!(Sky::new(1, &[[f32::NAN; 3]; 2], identity).is_err());
        assert!(Sky::new(1, &[[-1.0; 3]; 2], identity).is_err());
        assert!(Sky::new(1, &[[0.0; 3]; 2], identity).is_err());
        assert!(Sky::new(1, &[[1.0; 3]; 2], 2.0 * identity).is_err());
        assert!(Sky::new(1, &[[1.0; 3]; 2], identity).is_ok());
    }
}
