//! Every warp against its density, its inverse, and the edges of the cube.
//!
//! Chi-square: samples are counted in the cells of a grid over the domain and compared with the integral of the density over
//! each cell. The limit is the 1 - 1e-6 quantile for each warp; with some twenty warps a false alarm comes in 2e-5 of
//! all choices of the seed, which is fixed.

#![expect(
    clippy::cast_possible_truncation,
    reason = "numbers of cells are small"
)]

use core::f64::consts::{PI, TAU};

use estimand::hash::{hash, unit};
use estimand::integrands::Mixture;
use estimand::warp::{
    AliasTable, Cone, CosineHemisphere, Disk, Exponential, Hemisphere, Normal, Piecewise,
    Piecewise2d, Sphere, SphericalRectangle, SphericalTriangle, Tent, Triangle, Warp,
};

const EDGES: [f64; 7] = [
    0.0,
    5e-324,
    f64::MIN_POSITIVE,
    f64::EPSILON / 2.0,
    0.5,
    0.75,
    1.0 - f64::EPSILON / 2.0,
];
const SAMPLES: u64 = 200_000;
const CELLS: usize = 12;

fn uniform<const D: usize>(index: u64) -> [f64; D] {
    core::array::from_fn(|d| unit(hash(hash(77, index), d as u64)))
}

/// The quantile that chi-square passes once in 10^6 cases, by Wilson's and Hilferty's formula.
fn limit(freedom: f64) -> f64 {
    let part = 2.0 / (9.0 * freedom);
    freedom * (1.0 - part + 4.7534 * part.sqrt()).powi(3)
}

/// Compares counts with expectations, cells of less than five pooled.
fn chi_square(name: &str, counts: &[f64], expected: &[f64]) {
    let (mut sum, mut cells) = (0.0, 0.0);
    let (mut pooled, mut pooled_expected) = (0.0, 0.0);
    for (&count, &expected) in counts.iter().zip(expected) {
        if expected < 5.0 {
            pooled += count;
            pooled_expected += expected;
        } else {
            sum += (count - expected).powi(2) / expected;
            cells += 1.0;
        }
    }
    if pooled_expected > 0.0 {
        sum += (pooled - pooled_expected).powi(2) / pooled_expected;
        cells += 1.0;
    }
    let limit = limit(cells - 1.0);
    assert!(
        sum < limit,
        "{name}: chi-square {sum} for {cells} cells, limit {limit}"
    );
}

/// A domain seen as the unit square by a map that keeps measure up to the factor `measure`.
struct Chart<P> {
    measure: f64,
    to: fn(P) -> [f64; 2],
    from: fn([f64; 2]) -> P,
}

fn check_2d<P: Copy + core::fmt::Debug>(
    name: &str,
    warp: &impl Warp<2, Point = P>,
    chart: &Chart<P>,
) {
    let mut counts = vec![0.0; CELLS * CELLS];
    for index in 0..SAMPLES {
        let u = uniform(index);
        let point = warp.sample(u);
        assert!(
            warp.density(point) > 0.0,
            "{name}: no density at {point:?} from {u:?}"
        );
        let [a, b] = (chart.to)(point);
        let cell = |t: f64| ((t * CELLS as f64) as usize).min(CELLS - 1);
        counts[cell(a) * CELLS + cell(b)] += 1.0;
        let back = warp
            .invert(point)
            .unwrap_or_else(|| panic!("{name}: {point:?} has no inverse"));
        let again = warp.sample(back);
        let ([c, d], [a, b]) = ((chart.to)(again), (chart.to)(point));
        // Charts may be cut open along a line: 0 and 1 are neighbours there.
        let off = |a: f64, b: f64| (a - b).abs().min(1.0 - (a - b).abs());
        assert!(
            off(a, c) < 1e-6 && off(b, d) < 1e-6,
            "{name}: {u:?} to {point:?}, back at {back:?} and {again:?}"
        );
    }
    // The midpoint rule on a grid within each cell.
    const FINE: usize = 64;
    let mut expected = vec![0.0; CELLS * CELLS];
    for (index, expected) in expected.iter_mut().enumerate() {
        for i in 0..FINE * FINE {
            let place = |cell: usize, i: usize| {
                (cell as f64 + (i as f64 + 0.5) / FINE as f64) / CELLS as f64
            };
            let point = (chart.from)([
                place(index / CELLS, i / FINE),
                place(index % CELLS, i % FINE),
            ]);
            *expected += warp.density(point);
        }
        *expected *= chart.measure * SAMPLES as f64 / (CELLS * CELLS * FINE * FINE) as f64;
    }
    let total: f64 = expected.iter().sum::<f64>() / SAMPLES as f64;
    assert!(
        (total - 1.0).abs() < 5e-3,
        "{name}: the density integrates to {total}"
    );
    chi_square(name, &counts, &expected);
    edges(name, warp);
}

fn edges<const D: usize, P: Copy + core::fmt::Debug>(name: &str, warp: &impl Warp<D, Point = P>) {
    for first in EDGES {
        for second in EDGES {
            let u = core::array::from_fn(|d| if d == 0 { first } else { second });
            let point = warp.sample(u);
            let density = warp.density(point);
            assert!(
                density.is_finite() && density >= 0.0,
                "{name}: density {density} at {u:?}"
            );
            assert!(
                !format!("{point:?}").contains("NaN"),
                "{name}: {point:?} at {u:?}"
            );
            assert!(
                !format!("{point:?}").contains("inf"),
                "{name}: {point:?} at {u:?}"
            );
        }
    }
}

fn check_1d(name: &str, warp: &impl Warp<1, Point = f64>, low: f64, high: f64) {
    let mut counts = vec![0.0; 40];
    let mut outside = 0.0;
    for index in 0..SAMPLES {
        let [u] = uniform(index);
        let x = warp.sample([u]);
        assert!(warp.density(x) > 0.0, "{name}: no density at {x}");
        let t = (x - low) / (high - low);
        if (0.0..1.0).contains(&t) {
            counts[(t * 40.0) as usize] += 1.0;
        } else {
            outside += 1.0;
        }
        let [back] = warp.invert(x).unwrap();
        assert!((back - u).abs() < 1e-9, "{name}: {u} came back as {back}");
    }
    let expected: Vec<f64> = (0..40)
        .map(|cell| {
            let fine = 2000;
            let sum: f64 = (0..fine)
                .map(|i| {
                    let t = (f64::from(cell) + (f64::from(i) + 0.5) / f64::from(fine)) / 40.0;
                    warp.density(low + t * (high - low))
                })
                .sum();
            sum * (high - low) / 40.0 / f64::from(fine) * SAMPLES as f64
        })
        .collect();
    let inside: f64 = expected.iter().sum();
    assert!(
        (inside + outside - SAMPLES as f64).abs() < 6.0 * (outside + 1.0).sqrt(),
        "{name}"
    );
    chi_square(name, &counts, &expected);
    edges(name, warp);
}

/// Directions by height and angle: equal areas, as Archimedes knew.
fn sphere() -> Chart<[f64; 3]> {
    Chart {
        measure: 4.0 * PI,
        to: |[x, y, z]| [0.5 * (z + 1.0), (y.atan2(x) / TAU).rem_euclid(1.0)],
        from: |[a, b]| {
            let z = 2.0 * a - 1.0;
            let radius = (1.0 - z * z).sqrt();
            [radius * (TAU * b).cos(), radius * (TAU * b).sin(), z]
        },
    }
}

#[test]
fn directions() {
    check_2d("sphere", &Sphere, &sphere());
    check_2d("hemisphere", &Hemisphere, &sphere());
    check_2d("cosine hemisphere", &CosineHemisphere, &sphere());
    for angle in [1.0, 2.5, PI] {
        check_2d("cone", &Cone::new(angle).unwrap(), &sphere());
    }
}

#[test]
fn polygons_seen_from_a_point() {
    let octant = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let triangles = [
        (octant, [0.0; 3]),
        (
            [[3.0, -1.0, 0.5], [-1.0, 2.0, 1.0], [-1.0, -2.0, 3.0]],
            [0.0, 0.1, 0.2],
        ),
        // The other way round.
        (
            [[-1.0, 2.0, 1.0], [3.0, -1.0, 0.5], [-1.0, -2.0, 3.0]],
            [0.0, 0.1, 0.2],
        ),
    ];
    for (corners, from) in triangles {
        let triangle = SphericalTriangle::new(corners, from).unwrap();
        check_2d("spherical triangle", &triangle, &sphere());
    }
    for from in [[0.0, 0.0, 0.0], [0.3, -0.9, 1.5], [-2.0, 1.0, 0.2]] {
        let rectangle =
            SphericalRectangle::new([-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0], from)
                .unwrap();
        check_2d("spherical rectangle", &rectangle, &sphere());
    }
}

/// Close to its plane a triangle fills nearly half of all directions, and its corners are nearly in one plane with the point.
#[test]
fn triangles_are_sampled_evenly_from_close_to_their_plane() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for height in [1e-2, 1e-4, 1e-6] {
        let triangle = SphericalTriangle::new(corners, [0.33, 0.33, height]).unwrap();
        for index in 0..1000 {
            let u = uniform::<2>(index);
            let direction = triangle.sample(u);
            // The part of the triangle before it, whose solid angle is a sum of angles.
            let back = triangle.invert(direction).unwrap();
            let off = (back[0] - u[0]).abs().max((back[1] - u[1]).abs());
            assert!(off < 1e-7, "{u:?} became {back:?} from {height}");
        }
    }
}

#[test]
fn solid_angles() {
    // Van Oosterom and Strackee's formula (1983) for the triangle; two triangles make a rectangle.
    let oosterom = |[a, b, c]: [[f64; 3]; 3]| {
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cross = [
            b[1] * c[2] - b[2] * c[1],
            b[2] * c[0] - b[0] * c[2],
            b[0] * c[1] - b[1] * c[0],
        ];
        let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
        let below = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la;
        2.0 * dot(a, cross).abs().atan2(below)
    };
    let (a, b, c, d) = (
        [-1.0, -1.0, 0.7],
        [1.5, -1.0, 0.7],
        [1.5, 0.5, 0.7],
        [-1.0, 0.5, 0.7],
    );
    let triangle = SphericalTriangle::new([a, b, c], [0.0; 3]).unwrap();
    assert!((triangle.solid_angle() - oosterom([a, b, c])).abs() < 1e-13);
    let rectangle = SphericalRectangle::new(a, [2.5, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0; 3]).unwrap();
    let both = oosterom([a, b, c]) + oosterom([a, c, d]);
    assert!((rectangle.solid_angle() - both).abs() < 1e-13);
}

#[test]
fn plane_domains() {
    let disk = Chart {
        measure: PI,
        to: |[x, y]: [f64; 2]| [(x * x + y * y).min(1.0), (y.atan2(x) / TAU).rem_euclid(1.0)],
        from: |[a, b]| [a.sqrt() * (TAU * b).cos(), a.sqrt() * (TAU * b).sin()],
    };
    check_2d("disk", &Disk, &disk);

    let triangle = Triangle::new([[1.0, 0.0, 2.0], [3.0, 0.0, 2.0], [1.0, 1.0, 2.0]]).unwrap();
    let rectangle = Chart {
        measure: 2.0,
        to: |[x, y, _]: [f64; 3]| [0.5 * (x - 1.0), y],
        from: |[a, b]: [f64; 2]| [1.0 + 2.0 * a, b, 2.0],
    };
    check_2d("triangle", &triangle, &rectangle);

    let square = Chart {
        measure: 1.0,
        to: |point: [f64; 2]| point,
        from: |point| point,
    };
    // Twelve columns and rows divide the cells of the test.
    let weights: Vec<f64> = (0..12)
        .map(|i| [0.0, 0.0, 0.0, 1.0, 0.0, 2.0, 5.0, 0.1][i % 8])
        .collect();
    check_2d(
        "piecewise 2-d",
        &Piecewise2d::new(&weights, 4).unwrap(),
        &square,
    );
}

#[test]
fn numbers() {
    check_1d("tent", &Tent::new(2.0).unwrap(), -2.0, 2.0);
    check_1d("exponential", &Exponential::new(3.0).unwrap(), 0.0, 3.0);
    check_1d("normal", &Normal::new(1.0, 2.0).unwrap(), -7.0, 9.0);
    check_1d(
        "piecewise",
        &Piecewise::new(&[3.0, 0.0, 1.0, 0.5, 0.0]).unwrap(),
        0.0,
        1.0,
    );
    check_1d("one cell", &Piecewise::new(&[1e300]).unwrap(), 0.0, 1.0);
}

#[test]
fn a_mixture_has_the_density_it_says() {
    let warps = [
        Normal::new(-3.0, 0.5).unwrap(),
        Normal::new(2.0, 1.0).unwrap(),
    ];
    let mixture = Mixture::new(&[1.0, 3.0], warps).unwrap();
    let mut counts = [0.0; 40];
    for index in 0..SAMPLES {
        let x = mixture.sample(uniform(index));
        counts[((x + 6.0) / 12.0 * 40.0).clamp(0.0, 39.0) as usize] += 1.0;
    }
    let expected: Vec<f64> = (0..40)
        .map(|cell| {
            let sum: f64 = (0..1000)
                .map(|i| {
                    mixture.density(-6.0 + 0.3 * (f64::from(cell) + (f64::from(i) + 0.5) / 1000.0))
                })
                .sum();
            sum * 0.3 / 1000.0 * SAMPLES as f64
        })
        .collect();
    chi_square("mixture", &counts, &expected);
    edges("mixture", &mixture);
}

#[test]
fn weights_of_zero_are_never_chosen() {
    let weights = [0.0, 1.0, 0.0, 1e-300, 3.0, 0.0, 0.1, 0.1];
    let table = AliasTable::new(&weights).unwrap();
    let piecewise = Piecewise::new(&weights).unwrap();
    let mut counts = [0.0; 8];
    let (mut left, mut squares) = (0.0, 0.0);
    for index in 0..SAMPLES {
        let [u] = uniform(index);
        let choice = table.choose(u);
        assert!((0.0..1.0).contains(&choice.u));
        counts[choice.index] += 1.0;
        left += choice.u;
        squares += choice.u * choice.u;
        assert!(piecewise.density(piecewise.sample([u])) > 0.0);
    }
    for u in EDGES {
        assert!(weights[table.choose(u).index] > 0.0);
        assert!(piecewise.density(piecewise.sample([u])) > 0.0);
    }
    let total: f64 = weights.iter().sum();
    let expected: Vec<f64> = weights
        .iter()
        .map(|weight| weight / total * SAMPLES as f64)
        .collect();
    chi_square("alias table", &counts, &expected);
    // What is left of the coordinate is uniform again: mean 1/2, mean square 1/3, within six sigma.
    let count = SAMPLES as f64;
    assert!((left / count - 0.5).abs() < 6.0 / (12.0 * count).sqrt());
    assert!((squares / count - 1.0 / 3.0).abs() < 6.0 * (4.0 / 45.0 / count).sqrt());
}

#[test]
fn tails_and_narrow_cones_keep_their_digits() {
    // scipy 1.17: norm.ppf(2^-54).
    let normal = Normal::new(0.0, 1.0).unwrap();
    assert!((normal.sample([0.0]) + 8.292_361_075_813_597).abs() < 1e-12);
    let cone = Cone::new(1e-9).unwrap();
    let direction = cone.sample([0.25, 0.0]);
    assert!((direction[0] / 0.5e-9 - 1.0).abs() < 1e-12);
    assert!((cone.density(direction) * PI * 1e-18 - 1.0).abs() < 1e-12);
    assert_eq!(cone.density([1.1e-9, 0.0, 1.0]), 0.0);
}

#[test]
fn what_is_no_domain_is_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Cone::new(bad).is_err());
        assert!(Tent::new(bad).is_err());
        assert!(Exponential::new(bad).is_err());
        assert!(Normal::new(0.0, bad).is_err());
    }
    assert!(Cone::new(4.0).is_err());
    assert!(Normal::new(f64::NAN, 1.0).is_err());
    let line = [[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]];
    assert!(Triangle::new(line).is_err());
    assert!(SphericalTriangle::new(line, [5.0, 5.0, 5.0]).is_err());
    let skew = SphericalRectangle::new([0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    assert!(skew.is_err());
    let edge_on =
        SphericalRectangle::new([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]);
    assert!(edge_on.is_err());
    for weights in [
        vec![],
        vec![0.0; 3],
        vec![1.0, -1.0],
        vec![f64::NAN],
        vec![f64::INFINITY, 1.0],
    ] {
        assert!(Piecewise::new(&weights).is_err());
        assert!(AliasTable::new(&weights).is_err());
        assert!(Piecewise2d::new(&weights, 1).is_err());
    }
    assert!(Piecewise2d::new(&[1.0; 6], 4).is_err());
    assert!(Piecewise2d::new(&[1.0; 6], 0).is_err());
}

#[test]
fn the_density_of_a_picture_is_in_proportion_to_its_weights() {
    // Rows of different shapes: sums and maxima of rows are not in proportion.
    let weights = [1.0, 1.0, 1.0, 5.0, 0.0, 0.0, 0.0, 2.0, 6.0];
    let picture = Piecewise2d::new(&weights, 3).unwrap();
    for (cell, weight) in weights.into_iter().enumerate() {
        let middle = [cell % 3, cell / 3].map(|k| (k as f64 + 0.5) / 3.0);
        let expected = weight / 16.0 * 9.0;
        assert!((picture.density(middle) - expected).abs() < 1e-14, "{cell}");
    }
}
