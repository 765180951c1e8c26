//! Flat lights, drawn by solid angle for what is near.

use estimand::path::shape::{Flat, Shape};
use estimand::points::{Independent, PointSet};
use estimand::warp::{SphericalRectangle, SphericalTriangle, Warp};
use estimand::{Estimator, MonteCarlo, Sampler, cube};
use glam::{DMat3, DVec3, EulerRot, Vec3, Vec3A};

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

/// The light that a lamp throws onto a point below it: from the middle of a square of side 2 at height `z`, by
/// [Lambert's formula](vector_irradiance) written out, with 1 / 1.5 of the standard error by area at most.
#[test]
fn light_from_nearby_has_less_noise_by_solid_angle() {
    let lamp = Flat::parallelogram([-1.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, -2.0, 0.0]).unwrap();
    for z in [0.2_f64, 0.5, 1.0] {
        let from = Vec3A::new(0.0, 0.0, single(-z));
        let side = 1.0 / z.hypot(1.0);
        let truth = 4.0 * side * side.atan();
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

/// The integral of the direction over the directions to a polygon, and the solid angle, both in closed form: by Lambert's formula for
/// the light of polygons (Arvo, James (1995). *Applications of Irradiance Tensors to the Simulation of Non-Lambertian Phenomena*,
/// equation 2. <https://doi.org/10.1145/218380.218467>) and van Oosterom's and Strackee's for triangles (1983), into which a fan
/// from the first corner divides it.
fn vector_irradiance(corners: &[DVec3]) -> (DVec3, f64) {
    let seen: Vec<DVec3> = corners.iter().map(|corner| corner.normalize()).collect();
    let next = seen.iter().cycle().skip(1);
    let sides = seen.iter().zip(next).map(|(a, b)| {
        let normal = a.cross(*b);
        normal.normalize() * normal.length().atan2(a.dot(*b))
    });
    let solid_angle = (1..seen.len() - 1).map(|k| {
        let [a, b, c] = [seen[0], seen[k], seen[k + 1]];
        let below = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
        2.0 * a.cross(b).dot(c).abs().atan2(below)
    });
    (0.5 * sides.sum::<DVec3>(), solid_angle.sum())
}

/// The directions that are drawn have the mean and the density that the closed forms give, down to where the drawing from the area
/// begins: low above the plane and for thin shapes, whichever corner is the first.
#[test]
fn low_points_and_thin_shapes_are_drawn_by_solid_angle_without_bias() {
    /// Midpoints of a grid of so many cells, whose error is below the bound.
    const SIDE: u32 = 256;
    let [mut near, mut by_area] = [0, 0];
    for index in 0..320_usize {
        let [a, b, c, d, e, f, g, turned] = coordinates(9, index as u64);
        let width = [1.0, 0.3, 0.1, 0.03, 0.021, 0.01, 1e-3, 1e-4][index % 8];
        let height = [0.3, 0.1, 0.03, 0.015, 0.011, 3e-3, 1e-3, 1e-4][index / 8 % 8];
        let turn = DMat3::from_euler(EulerRot::XYZ, 6.3 * a, 6.3 * b, 6.3 * c);
        let [x, y] = [turn.x_axis, turn.y_axis * width].map(|edge| edge.as_vec3());
        let corner = DVec3::new(d, e, f).as_vec3();
        let triangle = [corner, corner + x, corner + (x * single(g) + y)];
        // Three corners, or four of a rectangle.
        let (flat, corners) = if turned < 0.7 {
            let first = index / 64 % 3;
            let corners = [0, 1, 2].map(|k| triangle[(k + first) % 3]);
            let flat = Flat::triangle(corners.map(|corner| corner.to_array())).unwrap();
            (flat, corners.to_vec())
        } else {
            let flat = Flat::parallelogram(corner.into(), x.into(), y.into()).unwrap();
            (flat, vec![corner, corner + x, corner + x + y, corner + y])
        };
        let middle = corners.iter().sum::<Vec3>() / corners.len() as f32;
        // Beside the middle as far as it is near.
        let reach = (f64::from(flat.area()) * height / 0.2).cbrt().max(height);
        let aside = (reach * reach - height * height).sqrt() * (2.0 * g - 1.0);
        let from = middle + (turn.z_axis * height + turn.x_axis * aside).as_vec3();
        let from = Vec3A::from(from);
        let flat_by_angle = flat.by_solid_angle();
        let u = [0.25, 0.75];
        let longest = corners.iter().zip(corners.iter().cycle().skip(1));
        let longest = longest.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        if flat_by_angle.sample(from, u) == flat.sample(from, u) {
            by_area += 1;
            continue;
        }
        near += 1;
        assert!(
            height > 0.009 * f64::from(longest) && width > 0.019,
            "{height} and {width}"
        );
        let seen: Vec<DVec3> = corners
            .iter()
            .map(|corner| corner.as_dvec3() - from.as_dvec3())
            .collect();
        let (light, solid_angle) = vector_irradiance(&seen);
        let mut mean = DVec3::ZERO;
        for cell in 0..SIDE * SIDE {
            let u = [cell % SIDE, cell / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32);
            let (point, density) = flat_by_angle.sample_with_density(from, u);
            assert_eq!(point, flat_by_angle.sample(from, u));
            assert_eq!(density, flat_by_angle.density(from, &point));
            let off = (f64::from(density) * solid_angle - 1.0).abs();
            assert!(off < 1e-4, "{index}: density {density}, off by {off}");
            mean += (point.point - from).as_dvec3().normalize();
        }
        mean /= f64::from(SIDE * SIDE);
        let off = (mean - light * light.dot(mean).signum() / solid_angle).length();
        assert!(
            off < 1.5e-4,
            "{index}: width {width}, height {height}: {mean} is off by {off}"
        );
    }
    assert!(near > 80 && by_area > 80, "{near} near, {by_area} not");
}

/// However near to the plane, points are finite and have a density, from the area where `f32` has too few digits for the solid angle.
#[test]
fn points_next_to_a_shape_have_a_density() {
    let square = Flat::parallelogram([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let triangle = Flat::triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    for (area, middle) in [(square, 0.5), (triangle, 1.0 / 3.0)] {
        let flat = area.by_solid_angle();
        for power in 0..40 {
            let height = 0.3 * 0.5_f32.powi(power);
            let from = Vec3A::new(middle + 1e-3, middle, height);
            for u in [[0.0, 0.0], [0.3, 0.8], [1.0 - f32::EPSILON / 2.0; 2]] {
                let (point, density) = flat.sample_with_density(from, u);
                assert!(point.point.is_finite(), "{point:?} from {from}");
                assert!(
                    density > 0.0 && density.is_finite(),
                    "{density} from {height}"
                );
            }
            let u = [0.3, 0.8];
            let is_near = flat.sample(from, u) != area.sample(from, u);
            assert_eq!(is_near, height > 0.015, "from {height}");
        }
    }
}
