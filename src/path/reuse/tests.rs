//! What shared light weighs.

use super::*;

/// A point at `point`, seen from the side of its normal.
fn diffuse(point: [f32; 3], normal: Vec3A) -> Diffuse {
    Diffuse {
        surface: Surface {
            point: point.into(),
            normal,
            margin: 1e-6,
            detail: (),
        },
        shading: normal,
        albedo: Vec3A::ONE,
    }
}

const ALBEDOS: [[f32; 3]; 3] = [[0.5, 0.25, 0.0], [0.2, 0.4, 0.8], [1.0; 3]];
/// Paths go on from the first point.
const ALWAYS: Rule = Rule::of_throughput(5);
const LIGHT: Vec3A = Vec3A::new(1.0, 2.0, 3.0);

/// Three pixels with first points on the floor, below and beside the one second point, of the first of them, at the ceiling.
fn traces() -> (Traces, Group) {
    let group = Group {
        pixels: 3,
        rounds: WIDTH,
        slot: WIDTH,
    };
    let mut traces = Traces::default();
    traces.clear(4 * WIDTH);
    for (pixel, x) in [0.0, 1.0, 2.0].into_iter().enumerate() {
        let slot = group.slot(pixel, 5);
        let mut point = diffuse([x, 0.0, 0.0], Vec3A::Z);
        point.albedo = ALBEDOS[pixel].into();
        traces.set_first(slot, point, &ALWAYS);
        if pixel == 0 {
            traces.set_second(slot, diffuse([0.0, 0.0, 2.0], -Vec3A::Z), Vec3A::splat(7.0));
            traces.end(slot, LIGHT * 0.5, 2.0);
        } else {
            traces.end(slot, Vec3A::splat(x), 1.0);
        }
    }
    (traces, group)
}

fn value(traces: &Traces, group: &Group, pixel: usize) -> Vec3A {
    let slot = group.slot(pixel, 5);
    traces.values(slot..slot + 1).next().unwrap().into()
}

/// Cosines and distances by hand: 1 and 4, 2 over the root of 5 and 5, the root of 1/2 and 8.
const DENSITIES: [f32; 3] = [1.0 / 4.0, 4.0 / 5.0 / 5.0, 0.5 / 8.0];

fn close(found: Vec3A, expected: Vec3A) {
    assert!(
        (found - expected).length() < 1e-6 * expected.length(),
        "{found} {expected}"
    );
}

#[test]
fn light_goes_to_all_that_see_it_by_their_densities() {
    let (mut traces, group) = traces();
    traces.share(&group, &|_| false);
    let sum: f32 = DENSITIES.iter().sum();
    let given = |pixel: usize| LIGHT * Vec3A::from(ALBEDOS[pixel]) * (DENSITIES[pixel] / sum);
    close(
        value(&traces, &group, 0),
        (Vec3A::splat(7.0) + given(0)) * 2.0,
    );
    close(value(&traces, &group, 1), Vec3A::splat(1.0) + given(1));
    close(value(&traces, &group, 2), Vec3A::splat(2.0) + given(2));
}

/// Directions are drawn around the normal of shading, and meet areas that their own normals tell.
#[test]
fn shading_is_of_the_first_point_alone() {
    let tilted = Vec3A::new(0.6, 0.0, 0.8);
    let mut first = diffuse([0.0; 3], Vec3A::Z);
    let mut second = diffuse([0.0, 0.0, 2.0], -Vec3A::Z);
    (first.shading, second.shading) = (tilted, -tilted);
    assert!((density(&first, &second) / (0.8 / 4.0) - 1.0).abs() < 1e-6);
    second.surface.normal = -tilted;
    assert!((density(&first, &second) / (0.64 / 4.0) - 1.0).abs() < 1e-6);
}

#[test]
fn what_is_in_the_way_leaves_more_to_the_others() {
    let (mut traces, group) = traces();
    // Nobody looks at the way that was found already.
    traces.share(&group, &|way| {
        assert!(way.ray.origin.x > 0.5, "{way:?}");
        way.ray.origin.x > 1.5
    });
    let sum = DENSITIES[0] + DENSITIES[1];
    let given = |pixel: usize| LIGHT * Vec3A::from(ALBEDOS[pixel]) * (DENSITIES[pixel] / sum);
    close(
        value(&traces, &group, 0),
        (Vec3A::splat(7.0) + given(0)) * 2.0,
    );
    close(value(&traces, &group, 1), Vec3A::splat(1.0) + given(1));
    close(value(&traces, &group, 2), Vec3A::splat(2.0));
}

#[test]
fn light_without_end_stays_with_those_that_see_it() {
    let (mut traces, group) = traces();
    traces.end(group.slot(0, 5), Vec3A::INFINITY, 2.0);
    traces.share(&group, &|way| way.ray.origin.x > 1.5);
    assert_eq!(value(&traces, &group, 1), Vec3A::INFINITY);
    close(value(&traces, &group, 2), Vec3A::splat(2.0));
}

#[test]
fn what_was_known_of_other_paths_is_forgotten() {
    let (mut traces, group) = traces();
    traces.clear(4 * WIDTH);
    for pixel in 0..3 {
        let slot = group.slot(pixel, 5);
        assert!(!traces.has_first(slot));
        traces.end(slot, LIGHT, 1.0);
    }
    traces.share(&group, &|way| panic!("{way:?}"));
    for pixel in 0..3 {
        close(value(&traces, &group, pixel), LIGHT);
    }
}

#[test]
fn nothing_is_given_to_other_sides_and_other_rounds() {
    for away in [
        // Below the second point's surface, the first point's horizon, and in another round.
        Some(diffuse([1.0, 0.0, 3.0], -Vec3A::Z)),
        Some(diffuse([1.0, 0.0, 0.0], -Vec3A::Z)),
        None,
    ] {
        let (mut traces, group) = traces();
        for pixel in [1, 2] {
            let slot = group.slot(pixel, 5);
            traces.of_mut(slot).first.known[slot % WIDTH] = 0.0;
            match away {
                Some(point) => traces.set_first(slot, point, &ALWAYS),
                None => {
                    let point = diffuse([1.0, 0.0, 0.0], Vec3A::Z);
                    traces.set_first(slot + 1, point, &ALWAYS);
                }
            }
        }
        traces.share(&group, &|way| panic!("{way:?}"));
        let own = LIGHT * Vec3A::from(ALBEDOS[0]);
        close(value(&traces, &group, 0), (Vec3A::splat(7.0) + own) * 2.0);
        close(value(&traces, &group, 1), Vec3A::splat(1.0));
    }
}

/// A dark pixel, whose paths rarely go on and are bright then, and a bright one.
#[test]
fn what_the_roulette_lets_go_on_is_not_brighter_than_its_light() {
    let albedos = [[0.02, 0.05, 0.0], [0.7, 0.1, 0.3]].map(Vec3A::from);
    // What is carried to the second point is the largest albedo over the probability, which is that albedo, or one where the
    // roulette begins later.
    for (from, carried, survivals) in [(1, 1.0, 0.75), (2, 0.05, 2.0)] {
        let roulette = Rule::of_throughput(from);
        let group = Group {
            pixels: 2,
            rounds: WIDTH,
            slot: 0,
        };
        let mut traces = Traces::default();
        traces.clear(2 * WIDTH);
        for (pixel, albedo) in albedos.into_iter().enumerate() {
            let mut point = diffuse([0.0; 3], Vec3A::Z);
            point.albedo = albedo;
            traces.set_first(group.slot(pixel, 5), point, &roulette);
            traces.end(group.slot(pixel, 5), Vec3A::ZERO, 1.0);
        }
        let slot = group.slot(0, 5);
        traces.set_second(slot, diffuse([0.0, 0.0, 2.0], -Vec3A::Z), Vec3A::ZERO);
        traces.end(slot, LIGHT * carried, 1.0);
        traces.share(&group, &|_| false);
        // The densities are alike but for the survival.
        for (pixel, albedo) in albedos.into_iter().enumerate() {
            close(value(&traces, &group, pixel), LIGHT * albedo / survivals);
        }
    }
}

#[test]
fn what_is_dark_keeps_its_light() {
    for (albedo, first) in [(0.9 * DARKEST, false), (1.1 * DARKEST, true)] {
        let mut traces = Traces::default();
        traces.clear(WIDTH);
        let roulette = Rule::of_throughput(1);
        let mut tracer = Tracer {
            traces: &mut traces,
            roulette: &roulette,
            slot: 3,
        };
        let mut point = diffuse([0.0; 3], Vec3A::Z);
        point.albedo = Vec3A::splat(albedo);
        let (mut throughput, mut radiance) = (Vec3A::ONE, Vec3A::splat(5.0));
        tracer.scatters(1, &|| Some(point), &mut throughput, &mut radiance);
        assert_eq!((throughput, radiance), (Vec3A::ONE, Vec3A::splat(5.0)));
        // The next point is another's light only after one that is kept.
        let mut next = |segment, at: Option<Diffuse>| {
            tracer.scatters(segment, &|| at, &mut throughput, &mut radiance);
        };
        next(3, Some(diffuse([0.0; 3], Vec3A::Z)));
        next(2, None);
        next(2, Some(diffuse([0.0; 3], Vec3A::Z)));
        let expected = if first {
            Vec3A::ZERO
        } else {
            Vec3A::splat(5.0)
        };
        assert_eq!(radiance, expected);
        assert_eq!(traces.has_first(3), first);
    }
}

/// However near or far points are.
#[test]
fn no_distance_loses_light() {
    // The shares of two are halves; those of more are rounded.
    let cases = (-30..=37).flat_map(|exponent| [(exponent, 2, 0.0), (exponent, MOST, 1e-5)]);
    for (exponent, pixels, bound) in cases {
        let size = 10_f32.powi(exponent);
        let group = Group {
            pixels,
            rounds: WIDTH,
            slot: 0,
        };
        let mut traces = Traces::default();
        traces.clear(pixels * WIDTH);
        for pixel in 0..pixels {
            let mut point = diffuse([0.0; 3], Vec3A::Z);
            point.surface.margin = 0.0;
            traces.set_first(group.slot(pixel, 0), point, &ALWAYS);
            let mut other = diffuse([0.0, 0.0, size], -Vec3A::Z);
            other.surface.margin = 0.0;
            traces.set_second(group.slot(pixel, 0), other, Vec3A::ZERO);
            traces.end(group.slot(pixel, 0), Vec3A::splat(3.0), 1.0);
        }
        traces.share(&group, &|_| false);
        for pixel in 0..pixels {
            let slot = group.slot(pixel, 0);
            let value: Vec<_> = traces.values(slot..slot + 1).collect();
            let off = (value[0] - Vec3::splat(3.0)).length();
            assert!(off <= bound, "{size}: {value:?}");
        }
    }
}
