//! Flat lights, drawn by solid angle for what is near.

use estimand::path::shape::{Flat, Shape};
use estimand::points::{Independent, PointSet};
use estimand::warp::{SphericalRectangle, SphericalTriangle, Warp};
use estimand::{Estimator, MonteCarlo, Sampler, cube};
use glam::{DVec3, Vec3A};

#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn single(x: f64) -> f32 {
    x as f32
}

/// Points of the unit cube from a fixed seed.
fn coordinates<const N: usize>(seed: u64, index: u64) -> [f64; N] {
    let points = Independent::new(seed);
    let mut u = points.point(index);
    core::array::from_fn(|_| u.next_1d())
}

/// In `f32` and by other formulas the maps of the square are those of `warp` in `f64`: from the same coordinates the same
/// direction, with the same density.
#[test]
fn flat_shapes_are_drawn_by_solid_angle_as_the_warps_do() {
    let mut near = 0;
    for index in 0..4000 {
        let [a, b, c, d, e, f, g, h, i, u, v] = coordinates(5, index);
        // An edge, another at a right angle, and a place in front.
        let first = DVec3::new(a - 0.5, b - 0.5, c - 0.5) * 4.0;
        let second = first
            .cross(DVec3::new(d - 0.5, e - 0.5, f - 0.5))
            .normalize_or_zero();
        let second = second * (0.5 + 2.0 * f);
        let corner = DVec3::new(g, h, i);
        let [corner, first, second] = [corner, first, second].map(|vector| vector.as_vec3());
        let Ok(rectangle) = Flat::parallelogram(corner.into(), first.into(), second.into()) else {
            continue;
        };
        let corners = [corner, corner + first, corner + second].map(|corner| corner.to_array());
        let triangle = Flat::triangle(corners).unwrap();
        let outward = first.cross(second).normalize();
        let inside = first * single(2.0 * d - 0.5) + second * single(2.0 * e - 0.5);
        let from = corner + inside + outward * single(0.02 + 2.0 * g * h);
        let [corner, first, second, seen] =
            [corner, first, second, from].map(|vector| vector.as_dvec3().to_array());
        let corners = corners.map(|corner| corner.map(f64::from));
        let rectangle_64 = SphericalRectangle::new(corner, first, second, seen).unwrap();
        let triangle_64 = SphericalTriangle::new(corners, seen).unwrap();
        for (flat, direction, solid_angle) in [
            (
                rectangle,
                rectangle_64.sample([u, v]),
                rectangle_64.solid_angle(),
            ),
            (
                triangle,
                triangle_64.sample([u, v]),
                triangle_64.solid_angle(),
            ),
        ] {
            let from = Vec3A::from(from);
            let by_area = flat.sample(from, [u, v].map(single));
            let flat = flat.by_solid_angle();
            let point = flat.sample(from, [u, v].map(single));
            if point == by_area {
                continue;
            }
            near += 1;
            let density = f64::from(flat.density(from, &point));
            assert!(
                (density * solid_angle - 1.0).abs() < 2e-5,
                "{index}: density {density}, not {}",
                1.0 / solid_angle
            );
            let found = (point.point - from).as_dvec3().normalize();
            let off = (found - DVec3::from(direction)).length();
            assert!(off < 1e-3, "{index}: {found}, not {direction:?}");
        }
    }
    assert!(near > 1000, "only {near} of them are near");
}

/// From afar, from behind, and for other parallelograms nothing changes; nor does turning a shape over.
#[test]
fn only_what_is_near_is_drawn_by_solid_angle() {
    let square = Flat::parallelogram([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let skewed = Flat::parallelogram([0.0; 3], [1.0, 0.3, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let (near, u) = (Vec3A::new(0.4, 0.6, 0.5), [0.3, 0.9]);
    for (flat, from, changes) in [
        (square, near, true),
        (square, Vec3A::new(0.4, 0.6, 5.0), false),
        (square, Vec3A::new(3.0, 0.6, 0.1), false),
        (square, Vec3A::new(0.4, 0.6, -0.5), false),
        (square.turned(), Vec3A::new(0.4, 0.6, -0.5), true),
        (skewed, near, false),
    ] {
        let other = flat.by_solid_angle();
        let (by_area, point) = (flat.sample(from, u), other.sample(from, u));
        assert_eq!(by_area != point, changes, "{flat:?} from {from}");
        let [before, after] = [flat, other].map(|flat| flat.density(from, &point));
        assert_eq!(before != after, changes, "{flat:?} from {from}");
    }
    assert_eq!(
        square.by_solid_angle().turned(),
        square.turned().by_solid_angle()
    );
}

/// The light that a lamp throws onto a point below it: from the middle of a square of side 2 at height `z`, by the closed form of
/// Lambert's polygon formula, with 1 / 1.5 of the standard error by area at most.
#[test]
fn light_from_nearby_has_less_noise_by_solid_angle() {
    let lamp = Flat::parallelogram([-1.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, -2.0, 0.0]).unwrap();
    for z in [0.2_f64, 0.5, 1.0] {
        let from = Vec3A::new(0.0, 0.0, single(-z));
        // Four times the corner's share: (2 / pi) (x / sqrt(1 + x^2)) atan(1 / sqrt(z^2 + 1)) twice, x = 1 / z.
        let side = 1.0 / z.hypot(1.0);
        let truth = 4.0 * side * (side).atan();
        let [by_area, by_solid_angle] = [lamp, lamp.by_solid_angle()].map(|lamp| {
            let irradiance = cube(move |[u, v]: [f64; 2]| {
                let point = lamp.sample(from, [u, v].map(single));
                let way = point.point - from;
                f64::from(way.z / way.length() / lamp.density(from, &point))
            });
            MonteCarlo::new(1 << 14, 3).estimate(&irradiance).unwrap()
        });
        for estimate in [&by_area, &by_solid_angle] {
            // False alarms: one in 15 000.
            let off = (estimate.mean - truth) / estimate.std_error.unwrap();
            assert!(
                off.abs() < 4.0,
                "height {z}: {} is {off} errors from {truth}",
                estimate.mean
            );
        }
        let [before, after] = [by_area, by_solid_angle].map(|estimate| estimate.std_error.unwrap());
        assert!(1.5 * after < before, "height {z}: {after} after {before}");
    }
}

/// Half of all directions go to what is next to a point, and no point is so near that nothing does.
#[test]
fn what_is_next_to_a_shape_is_lit_by_half_of_all_directions() {
    let square = Flat::parallelogram([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let triangle = Flat::triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    for (flat, middle) in [(square, 0.5), (triangle, 1.0 / 3.0)] {
        let flat = flat.by_solid_angle();
        for power in 0..40 {
            let height = 0.01 * 0.5_f32.powi(power);
            let from = Vec3A::new(middle + 1e-3, middle, height);
            for u in [[0.0, 0.0], [0.3, 0.8], [1.0 - f32::EPSILON / 2.0; 2]] {
                let point = flat.sample(from, u);
                assert!(point.point.is_finite(), "{point:?} from {from}");
                let density = flat.density(from, &point);
                if height > 2e-4 {
                    let half = density * core::f32::consts::TAU;
                    assert!(
                        (0.99..1.1).contains(&half),
                        "{half} of one half from {height}"
                    );
                } else {
                    // From the area: the denser, the farther to the side.
                    assert!(
                        density > 0.0 && density <= f32::MAX,
                        "{density} from {height}"
                    );
                }
            }
        }
    }
}
