//! What is drawn, counted in cells of the sphere or of a small part of it, against the density.

use super::*;

use estimand::hash::{hash, unit};

const SAMPLES: u32 = 40_000;
const CELLS: usize = 16;
/// Per cell and axis, for a rule with one point anywhere in each part: the edge of a lobe, where facets end, may run
/// along a row of midpoints.
const FINE: usize = 24;

/// The coordinates of one sample.
struct Hashed {
    index: u64,
    dimension: u64,
}

impl Sampler for Hashed {
    fn next_1d(&mut self) -> f64 {
        self.dimension += 1;
        unit(hash(hash(5, self.index), self.dimension))
    }
}

/// A part of the sphere as the unit square.
#[derive(Clone, Copy)]
enum Chart {
    /// All of it, by the angle from the normal and the azimuth.
    Whole,
    /// What lies around a direction, by the coordinates across it over a half width.
    Around(Vec3A, f32),
}

impl Chart {
    fn square(self, direction: Vec3A) -> Option<[f32; 2]> {
        match self {
            Self::Whole => {
                let turns = direction.y.atan2(direction.x) / (2.0 * PI);
                let polar = direction.z.clamp(-1.0, 1.0).acos();
                Some([polar / PI, turns.rem_euclid(1.0)])
            }
            Self::Around(center, width) => {
                let (s, t) = center.any_orthonormal_pair();
                let place = [s, t].map(|axis| 0.5 + 0.5 * axis.dot(direction) / width);
                let inside = place.iter().all(|place| (0.0..1.0).contains(place));
                (inside && center.dot(direction) > 0.0).then_some(place)
            }
        }
    }

    /// The direction of a point of the square, and the solid angle per area of the square.
    fn sphere(self, [a, b]: [f32; 2]) -> Option<(Vec3A, f32)> {
        match self {
            Self::Whole => {
                let polar = PI * a;
                let angle = 2.0 * PI * PI * polar.sin();
                Some((direction(polar.cos(), 2.0 * PI * b), angle))
            }
            Self::Around(center, width) => {
                let (s, t) = center.any_orthonormal_pair();
                let (x, y) = ((2.0 * a - 1.0) * width, (2.0 * b - 1.0) * width);
                let height = 1.0 - x * x - y * y;
                (height > 1e-6).then(|| {
                    let height = height.sqrt();
                    let direction = s * x + t * y + center * height;
                    (direction, 4.0 * width * width / height)
                })
            }
        }
    }
}

/// The quantile that chi-square passes once in 10^6 cases, by Wilson's and Hilferty's formula.
fn limit(freedom: f64) -> f64 {
    let part = 2.0 / (9.0 * freedom);
    freedom * (1.0 - part + 4.7534 * part.sqrt()).powi(3)
}

fn check(name: &str, law: &Material, out: Vec3A, chart: Chart) {
    let samples = f64::from(SAMPLES);
    // The last one counts what is not drawn, goes to single directions, or out of the chart.
    let mut counts = vec![0.0; CELLS * CELLS + 1];
    for index in 0..SAMPLES {
        let mut u = Hashed {
            index: index.into(),
            dimension: 0,
        };
        let drawn = law.sample(&(), out, &mut u);
        let place = drawn
            .filter(|drawn| drawn.density < f32::INFINITY)
            .and_then(|drawn| chart.square(drawn.direction));
        let cell = place.map_or(CELLS * CELLS, |place| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a small whole number"
            )]
            let [a, b] = place.map(|t| ((t * CELLS as f32) as usize).min(CELLS - 1));
            a * CELLS + b
        });
        counts[cell] += 1.0;
    }
    let mut expected = vec![0.0; CELLS * CELLS + 1];
    let grid = CELLS * FINE;
    let mut within = Hashed {
        index: SAMPLES.into(),
        dimension: 0,
    };
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    let mut place = |i: usize| ((i as f64 + within.next_1d()) / grid as f64) as f32;
    for i in 0..grid {
        for j in 0..grid {
            if let Some((into, angle)) = chart.sphere([place(i), place(j)]) {
                let density = law.evaluate(&(), out, into).density * angle;
                expected[i / FINE * CELLS + j / FINE] +=
                    f64::from(density) * samples / (grid * grid) as f64;
            }
        }
    }
    let total: f64 = expected.iter().sum();
    assert!(total < samples * 1.004, "{name}: {}", total / samples);
    expected[CELLS * CELLS] = (samples - total).max(0.0);
    let (mut sum, mut cells) = (0.0, 0.0);
    let (mut pooled, mut pooled_expected) = (0.0, 0.0);
    for (count, expected) in counts.into_iter().zip(expected) {
        if expected < 10.0 {
            pooled += count;
            pooled_expected += expected;
            continue;
        }
        // With the error of the rule.
        sum += f64::powi(count - expected, 2) / (expected + f64::powi(4e-3 * expected, 2));
        cells += 1.0;
    }
    sum += f64::powi(pooled - pooled_expected, 2) / (pooled_expected + 10.0);
    let limit = limit(cells);
    assert!(
        sum < limit,
        "{name}: {sum} for {cells} cells, limit {limit}"
    );
}

#[test]
fn wide_lobes_have_their_density() {
    let mut cases = smooth_cases();
    for alpha in [[0.3, 0.3], [1.0, 1.0], [0.3, 0.8]] {
        cases.extend(rough_cases(alpha));
    }
    for Case { name, law, eta } in cases {
        // Copper is drawn as any metal is; a lobe of refraction by nearly equal indices is a narrow one.
        if Law::is_delta(&law) || eta == 1.05 || name.starts_with("copper") {
            continue;
        }
        for cosine in [0.98, 0.5, 0.1, -0.4] {
            let name = format!("{name} at {cosine}");
            check(&name, &law, direction(cosine, 0.6), Chart::Whole);
        }
    }
}

#[test]
fn narrow_lobes_have_their_density() {
    for alpha in [[0.01, 0.01], [0.05, 0.05], [0.02, 0.1]] {
        for Case { name, law, eta } in rough_cases(alpha) {
            if name.starts_with("copper") {
                continue;
            }
            for cosine in [0.98_f32, 0.5, -0.7] {
                let out = direction(cosine, 0.6);
                let mirrored = Vec3A::new(-out.x, -out.y, out.z);
                let width = 3.0 * alpha[0].max(alpha[1]);
                let name = format!("{name} at {cosine}");
                check(&name, &law, out, Chart::Around(mirrored, width));
                if eta == 1.0 {
                    continue;
                }
                let eta = if cosine > 0.0 { eta } else { 1.0 / eta };
                let squared = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
                if squared > 0.1 {
                    let down = -squared.sqrt().copysign(cosine);
                    let refracted = Vec3A::new(-out.x / eta, -out.y / eta, down);
                    let width = (1.0 / eta - 1.0).abs().max(0.04) * width;
                    check(
                        &name,
                        &law,
                        out,
                        Chart::Around(refracted.normalize(), width),
                    );
                }
            }
        }
    }
}
