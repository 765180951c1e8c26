//! Grazing light, extreme coordinates, extreme roughness, equal indices of refraction.

use super::*;

const COORDINATES: [f64; 5] = [0.0, f64::MIN_POSITIVE, 0.5, 0.75, 1.0 - f64::EPSILON / 2.0];
const COSINES: [f32; 8] = [1.0, 0.999_999_9, 0.8, 0.2, 0.01, 1e-4, 1e-7, 1e-30];

fn all_cases() -> Vec<Case> {
    let mut cases = smooth_cases();
    for alpha in [
        [1e-4, 1e-4],
        [0.01, 0.01],
        [0.3, 0.3],
        [1.0, 1.0],
        [1e-4, 1.0],
    ] {
        cases.extend(rough_cases(alpha));
    }
    for distribution in DISTRIBUTIONS {
        for alpha in [0.0, 1e-4, 0.1, 1.0] {
            for eta in [1.0, 1.000_001, 0.999_999, 1.000_277] {
                let roughness = rough(distribution, [alpha; 2]);
                let glass = RoughDielectric::new(eta, 1.0, roughness).unwrap();
                let name = format!("glass {eta} {distribution:?} {alpha}");
                cases.push(Case::new(name, glass));
                let plastic = RoughPlastic::new(0.5.into(), eta, 1.0, distribution, alpha).unwrap();
                let name = format!("plastic {eta} {distribution:?} {alpha}");
                cases.push(Case::new(name, plastic));
            }
        }
    }
    cases
}

#[test]
fn whatever_is_drawn_is_finite_and_as_evaluated() {
    for Case { name, law, .. } in all_cases() {
        for cosine in COSINES.iter().flat_map(|&cosine| [cosine, -cosine]) {
            let out = direction(cosine, 0.7);
            for a in COORDINATES {
                for b in COORDINATES {
                    for c in [0.0, 0.3, 1.0 - f64::EPSILON / 2.0] {
                        let u = [a, b, c];
                        let Some(drawn) = law.sample(&(), out, &mut Fixed::new(&u)) else {
                            continue;
                        };
                        let case = format!("{name} at {cosine} by {u:?}: {drawn:?}");
                        assert!((drawn.direction.length() - 1.0).abs() < 1e-5, "{case}");
                        assert!(drawn.weight.is_finite(), "{case}");
                        assert!(drawn.weight.cmpge(Vec3A::ZERO).all(), "{case}");
                        // Nothing shines brighter than what it reflects, but for the other medium and the
                        // choice of lobes.
                        let most = 6.0 / (drawn.eta * drawn.eta);
                        assert!(drawn.weight.max_element() <= most, "{case}");
                        assert!(drawn.density > 0.0 && drawn.eta > 0.0, "{case}");
                        let evaluated = law.evaluate(&(), out, drawn.direction);
                        assert!(evaluated.value.is_finite(), "{case}: {evaluated:?}");
                        assert!(evaluated.density.is_finite(), "{case}: {evaluated:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn weights_are_values_over_densities() {
    let mut cases = smooth_cases();
    for alpha in [[0.05, 0.05], [0.3, 0.3], [1.0, 1.0], [0.1, 0.6]] {
        cases.extend(rough_cases(alpha));
    }
    for Case { name, law, .. } in cases {
        for cosine in [0.95, 0.5, 0.1, -0.3, -0.9] {
            let out = direction(cosine, 2.0);
            for i in 0..200_u16 {
                let u = [0.618_034, 0.754_878, 0.569_840].map(|step| (f64::from(i) * step) % 1.0);
                let Some(drawn) = law.sample(&(), out, &mut Fixed::new(&u)) else {
                    continue;
                };
                if drawn.density == f32::INFINITY {
                    continue;
                }
                let evaluated = law.evaluate(&(), out, drawn.direction);
                let case = format!("{name} at {cosine} by {u:?}: {drawn:?} {evaluated:?}");
                // How far rounding a direction by 1e-7 moves the density of a narrow lobe.
                let close = (evaluated.density / drawn.density - 1.0).abs() < 5e-3;
                assert!(close, "{case}");
                let weight = evaluated.value / evaluated.density;
                let error = (weight - drawn.weight).abs().max_element();
                assert!(error < 2e-3 * drawn.weight.max_element() + 1e-5, "{case}");
            }
        }
    }
}

#[test]
fn single_directions_are_only_met() {
    for Case { name, law, .. } in all_cases() {
        if !Law::is_delta(&law) {
            continue;
        }
        for cell in sphere(8, 8) {
            let evaluated = law.evaluate(&(), direction(0.6, 0.0), cell.middle);
            assert_eq!(
                (evaluated.density, evaluated.value),
                (0.0, Vec3A::ZERO),
                "{name}"
            );
        }
    }
}

#[test]
fn the_inner_side_of_what_is_opaque_is_black() {
    let mut cases = rough_cases([0.2, 0.2]);
    cases.retain(|case| !case.name.starts_with("glass"));
    cases.push(Case::new("diffuse", Diffuse::new(white()).unwrap()));
    cases.push(Case::new("copper", copper()));
    cases.push(Case::new(
        "plastic",
        Plastic::new(white(), 1.49, 1.0).unwrap(),
    ));
    for Case { name, law, .. } in cases {
        let (above, below) = (direction(0.6, 1.0), direction(-0.6, 1.0));
        let u = [0.3, 0.4, 0.5];
        assert!(
            law.sample(&(), below, &mut Fixed::new(&u)).is_none(),
            "{name}"
        );
        for (out, into) in [(below, below), (above, below), (below, above)] {
            assert_eq!(law.evaluate(&(), out, into).value, Vec3A::ZERO, "{name}");
        }
    }
}

#[test]
fn what_is_outside_the_domain_is_refused() {
    let nan = Uniform::from(f32::NAN);
    assert!(Diffuse::new(Uniform::from(1.1)).is_err());
    assert!(Diffuse::new(nan).is_err());
    assert!(Diffuse::new(Uniform::from([0.5, -0.1, 0.5])).is_err());
    assert!(Conductor::new(nan, white()).is_err());
    assert!(Conductor::new(white(), (-1.0).into()).is_err());
    assert!(copper().tinted(2.0.into()).is_err());
    assert!(Roughness::new(Distribution::Ggx, Uniform::from(-0.1)).is_err());
    assert!(Roughness::new(Distribution::Ggx, nan).is_err());
    assert!(Plastic::new(white(), 0.0, 1.0).is_err());
    assert!(Plastic::new(Uniform::from(2.0), 1.5, 1.0).is_err());
    assert!(ThinDielectric::new(1.5, f32::NAN).is_err());
    let message = Diffuse::new(Uniform::from([0.5, 1.5, 0.5])).unwrap_err();
    assert!(message.to_string().contains("1.5"), "{message}");
}
