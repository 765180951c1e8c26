//! The same for many directions at once, one a lane, with the bits of single ones.

use glam::{Mat3A, Vec3};
use pulp::{Arch, Simd, WithSimd};

use super::{Sky, cell};
use crate::path::color;
use crate::path::frame::lanes::{turn, turns};
use crate::path::lanes::{Real, Row, Vector, WIDEST};
use crate::warp::Place;

/// Light of a sky, in some lanes.
pub(in crate::path) struct Seen {
    /// The directions to it, where they were drawn.
    pub(in crate::path) direction: [Row<f32>; 3],
    pub(in crate::path) radiance: [Row<f32>; 3],
    /// Zero where nothing was drawn.
    pub(in crate::path) density: Row<f32>,
}

impl Seen {
    const NOTHING: Self = Self {
        direction: [Row::<f32>::ZERO; 3],
        radiance: [Row::<f32>::ZERO; 3],
        density: Row::<f32>::ZERO,
    };
}

impl Sky {
    /// The radiance from the directions of the active lanes, and the density with which they are drawn.
    #[inline(never)]
    pub(in crate::path) fn emitted_in_lanes(
        &self,
        arch: Arch,
        directions: &[Row<f32>; 3],
        active: &Row<f32>,
    ) -> Seen {
        arch.dispatch(Emitted {
            sky: self,
            directions,
            active,
        })
    }

    /// Directions drawn from coordinates, in some lanes.
    #[inline(never)]
    pub(in crate::path) fn drawn_in_lanes(
        &self,
        arch: Arch,
        lanes: &[usize],
        coordinates: &[[f64; 2]; WIDEST],
    ) -> Seen {
        arch.dispatch(Drawn {
            sky: self,
            lanes,
            coordinates,
        })
    }
}

struct Emitted<'a> {
    sky: &'a Sky,
    directions: &'a [Row<f32>; 3],
    active: &'a Row<f32>,
}

impl WithSimd for Emitted<'_> {
    type Output = Seen;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Seen {
        let Self {
            sky,
            directions,
            active,
        } = self;
        let d = turned(&sky.inward, Vector::load(simd, directions));
        let sine = (d.x * d.x + d.z * d.z).sqrt();
        let longitude = turns(d.x, -d.z) - 0.5 / sky.width as f32;
        let zero = longitude.all(0.0);
        let longitude = longitude.lt(zero).select(longitude + 1.0, longitude);
        let latitude = 2.0 * turns(sine, d.y);
        let sizes = [sky.width, sky.density.len()];
        let below_one = zero.all(1.0 - f32::EPSILON / 2.0);
        let places = [
            (longitude.max(zero).min(below_one) * sizes[0] as f32).row(),
            (latitude.max(zero).min(below_one) * sizes[1] as f32).row(),
        ];
        let mut squares = Squares::NONE;
        let lanes = || (0..S::F32_LANES).filter(|&lane| active.0[lane] > 0.0);
        for lane in lanes() {
            let (column, s) = cell(places[0].0[lane], sizes[0]);
            let (row, t) = cell(places[1].0[lane], sizes[1]);
            squares.set(sky, lane, [column, row], [s, t]);
        }
        let mut seen = Seen::NOTHING;
        squares.emission(simd, sine, lanes(), &mut seen);
        seen
    }
}

struct Drawn<'a> {
    sky: &'a Sky,
    lanes: &'a [usize],
    coordinates: &'a [[f64; 2]; WIDEST],
}

impl WithSimd for Drawn<'_> {
    type Output = Seen;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Seen {
        let Self {
            sky,
            lanes,
            coordinates,
        } = self;
        let mut places = [Place::default(); WIDEST];
        sky.directions
            .locate(coordinates, &mut places[..lanes.len()]);
        let mut squares = Squares::NONE;
        let (mut down, mut along, mut upper) =
            (Row::<f32>::ZERO, Row::<f32>::ZERO, Row::<f32>::ZERO);
        for (place, &lane) in places.iter().zip(lanes) {
            let (from_pole, is_upper, turn) = sky.angles(place);
            (down.0[lane], along.0[lane]) = (from_pole, turn);
            upper.0[lane] = if is_upper { 1.0 } else { 0.0 };
            #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
            let within = place.within.map(|x| x as f32);
            squares.set(sky, lane, [place.column, place.row], within);
        }
        let [height, sine] = turn(Real::load(simd, &down));
        let upper = Real::load(simd, &upper).gt(sine.all(0.0));
        let cosine = upper.select(height, -height);
        let [against, along] = turn(Real::load(simd, &along));
        let direction = Vector {
            x: along * sine,
            y: cosine,
            z: -against * sine,
        };
        let direction = turned(&sky.outward, direction);
        let mut seen = Seen::NOTHING;
        (direction / direction.length()).store(&mut seen.direction);
        squares.emission(simd, sine, lanes.iter().copied(), &mut seen);
        for density in &mut seen.density.0 {
            if !(*density < f32::INFINITY) {
                *density = 0.0;
            }
        }
        seen
    }
}

/// The pixels around squares of a picture, and places in the squares.
struct Squares {
    /// Two above, two below.
    corners: [[Row<f32>; 3]; 4],
    within: [Row<f32>; 2],
    /// The density for a unit of mean luminance, times the sine.
    density: [f64; WIDEST],
}

impl Squares {
    const NONE: Self = Self {
        corners: [[Row::<f32>::ZERO; 3]; 4],
        within: [Row::<f32>::ZERO; 2],
        density: [0.0; WIDEST],
    };

    #[inline(always)]
    fn set(&mut self, sky: &Sky, lane: usize, [column, row]: [usize; 2], within: [f32; 2]) {
        let pixels = super::around(&sky.pixels, sky.width, row, column);
        for (corner, &Vec3 { x, y, z }) in self.corners.iter_mut().zip(pixels) {
            (corner[0].0[lane], corner[1].0[lane], corner[2].0[lane]) = (x, y, z);
        }
        (self.within[0].0[lane], self.within[1].0[lane]) = (within[0], within[1]);
        self.density[lane] = sky.density[row];
    }

    /// The light from the places, whose angles to the zenith have the given sines.
    #[inline(always)]
    fn emission<S: Simd>(
        &self,
        simd: S,
        sine: Real<S>,
        lanes: impl Iterator<Item = usize>,
        seen: &mut Seen,
    ) {
        let [s, t] = self.within.each_ref().map(|row| Real::load(simd, row));
        let [a, b, c, d] = self.corners.each_ref().map(|rows| Vector::load(simd, rows));
        a.lerp(b, s).lerp(c.lerp(d, s), t).store(&mut seen.radiance);
        let quarter = s.all(0.25);
        let mean = (a * quarter + b * quarter) + (c * quarter + d * quarter);
        let luminance = mean.dot(Vector::splat(simd, color::LUMINANCE)).row();
        let sine = sine.row();
        for lane in lanes {
            if sine.0[lane] > 0.0 {
                let luminance = f64::from(luminance.0[lane]);
                #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
                let density = (luminance * self.density[lane] / f64::from(sine.0[lane])) as f32;
                seen.density.0[lane] = density;
            }
        }
    }
}

#[inline(always)]
fn turned<S: Simd>(matrix: &Mat3A, vector: Vector<S>) -> Vector<S> {
    let simd = vector.x.simd();
    let [x, y, z] =
        [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| Vector::splat(simd, axis));
    x * vector.x + y * vector.y + z * vector.z
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, Vec3A};

    use super::*;
    use crate::hash::{hash, unit};
    use crate::path::light::{Emission, Environment};

    /// What a seed selects, in `[0, 1)`; some of it the ends.
    fn random(seed: u64, k: u64) -> f64 {
        match hash(seed, k) % 8 {
            0 => 0.0,
            1 => 1.0 - f64::EPSILON / 2.0,
            _ => unit(hash(k, seed)),
        }
    }

    fn skies() -> [Sky; 3] {
        let pixels = |width: usize, rows: usize| -> Vec<[f32; 3]> {
            let pixel =
                |i: usize| [i % 7, i % 5, i % 3].map(|x| f32::from(u8::try_from(x).unwrap()));
            (0..width * rows).map(pixel).collect()
        };
        let turn = DMat3::from_rotation_x(0.3) * DMat3::from_rotation_y(2.0);
        [
            Sky::new(1, &pixels(1, 3), DMat3::IDENTITY).unwrap(),
            Sky::new(16, &pixels(16, 9), turn).unwrap(),
            Sky::new(37, &pixels(37, 20), DMat3::IDENTITY).unwrap(),
        ]
    }

    #[test]
    fn lanes_have_the_bits_of_single_directions() {
        let arch = Arch::new();
        let axes = [Vec3A::X, Vec3A::Y, Vec3A::Z];
        let mut drawn = 0;
        for (sky, seed) in skies()
            .iter()
            .flat_map(|sky| (0..200).map(move |seed| (sky, seed)))
        {
            // The others have nothing.
            let lanes: Vec<usize> = (0..WIDEST)
                .filter(|&lane| lane < lanes_of(arch) && !hash(seed, lane as u64).is_multiple_of(4))
                .collect();
            let mut coordinates = [[0.0; 2]; WIDEST];
            for (k, point) in coordinates.iter_mut().enumerate() {
                *point = [0, 100].map(|axis| random(seed, axis + k as u64));
            }
            let seen = sky.drawn_in_lanes(arch, &lanes, &coordinates);
            for (&lane, point) in lanes.iter().zip(&coordinates) {
                let mut place = [Place::default()];
                sky.directions.locate(&[*point], &mut place);
                let (direction, sine) = sky.direction(&place[0]);
                let square = super::super::Square::from(place[0]);
                let Emission { radiance, density } = sky.emission(&square, sine);
                if density > 0.0 && density < f32::INFINITY {
                    assert_eq!(Row::vector(&seen.direction, lane), direction, "{point:?}");
                    assert_eq!(Row::vector(&seen.radiance, lane), radiance, "{point:?}");
                    assert_eq!(seen.density.0[lane], density, "{point:?}");
                    drawn += 1;
                } else {
                    assert_eq!(seen.density.0[lane], 0.0, "{point:?}");
                }
            }

            let mut directions = [Row::<f32>::ZERO; 3];
            let mut active = Row::<f32>::ZERO;
            for &lane in &lanes {
                let word = hash(seed, 200 + lane as u64);
                let vector = match usize::try_from(word % 16).unwrap() {
                    axis @ 0..3 => axes[axis],
                    axis @ 3..6 => -axes[axis - 3],
                    _ => Row::vector(&seen.direction, lane),
                };
                Row::set_vector(&mut directions, lane, vector);
                active.0[lane] = 1.0;
            }
            let seen = sky.emitted_in_lanes(arch, &directions, &active);
            for &lane in &lanes {
                let direction = Row::vector(&directions, lane);
                let Emission { radiance, density } = sky.emitted(direction);
                assert_eq!(Row::vector(&seen.radiance, lane), radiance, "{direction}");
                assert_eq!(seen.density.0[lane], density, "{direction}");
            }
        }
        assert!(drawn > 1000, "{drawn} directions are drawn");
    }

    fn lanes_of(arch: Arch) -> usize {
        struct Lanes;
        impl WithSimd for Lanes {
            type Output = usize;
            fn with_simd<S: Simd>(self, _: S) -> usize {
                S::F32_LANES
            }
        }
        arch.dispatch(Lanes)
    }
}
