//! Filters that are a product of one profile across and the same down.

use super::{Filter, Filtered};
use crate::Error;

/// A filter of one dimension.
///
/// # Writing your own
///
/// ```
/// use estimand::path::filter::{Profile, Separable};
///
/// /// The cosine between its first zeros.
/// struct Cosine;
///
/// impl Profile for Cosine {
///     fn radius(&self) -> f64 { 1.0 }
///     fn value(&self, x: f64) -> f64 { (0.5 * std::f64::consts::PI * x).cos() }
/// }
///
/// let filter = Separable::new(&Cosine)?;
/// # Ok::<(), estimand::Error>(())
/// ```
pub trait Profile {
    /// How far it reaches, in pixels: it is zero from there on. In `(0, 64]`.
    fn radius(&self) -> f64;

    /// The value at a distance of `x` pixels from the centre, `x` in `[-radius, radius]`. It must be finite. Where it
    /// changes its sign at a multiple of 1/64, no sample is wasted.
    fn value(&self, x: f64) -> f64;
}

/// Nodes of the table for each pixel. Centres and borders of pixels are among the nodes.
const NODES: usize = 64;
const NODES_F64: f64 = NODES as f64;

/// A filter that is the product of one [`Profile`] across and the same down.
///
/// A table of the profile, linear between nodes a 64th of a pixel apart, is drawn from exactly; what is left of
/// the profile is in the weight. A constant picture has no noise but that, below 1e-3 of it for the filters of
/// this module.
///
/// At the border of the picture the filter is cut off, and what is inside counts the more: no ray is shot past
/// the border. That is how Mitsuba has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Separable<P> {
    profile: P,
    /// Where the first node is; the others follow at steps of a 64th.
    first: f64,
    nodes: Vec<Node>,
}

/// A point of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    /// The absolute value of the profile.
    height: f64,
    /// The integral of the table up to here.
    table: f64,
    /// The integral of the profile up to here.
    profile: f64,
}

impl<P: Profile> Separable<P> {
    /// The filter with the given profile.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a radius outside `(0, 64]`, for a profile that is not finite somewhere, and for one whose
    /// integral over some picture's part of it is not positive.
    pub fn new(profile: P) -> Result<Self, Error> {
        let radius = profile.radius();
        if !(radius > 0.0 && radius <= 64.0) {
            return Err(Error::refused(
                "radius of a filter",
                "in (0, 64] pixels",
                radius,
            ));
        }
        let value = |x: f64| {
            if x.abs() < radius {
                profile.value(x)
            } else {
                0.0
            }
        };
        // Half a pixel at least, so that every picture has a pixel's own square.
        let reach = radius.max(0.5);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "64 pixels at most"
        )]
        let half = (reach * NODES_F64).ceil() as usize;
        let first = -(half as f64) / NODES_F64;
        let mut nodes = Vec::with_capacity(2 * half + 1);
        let (mut table, mut integral) = (0.0, 0.0);
        for index in 0..=2 * half {
            let x = first + index as f64 / NODES_F64;
            let height = value(x).abs();
            if let Some(&Node { height: before, .. }) = nodes.last() {
                table += 0.5 * (before + height) / NODES_F64;
                integral += simpson(value, x - 1.0 / NODES_F64, x);
            }
            if !(height.is_finite() && integral.is_finite()) {
                return Err(Error::refused("value of a filter", "finite", height));
            }
            nodes.push(Node {
                height,
                table,
                profile: integral,
            });
        }
        let filter = Self {
            profile,
            first,
            nodes,
        };
        filter.check()?;
        Ok(filter)
    }

    /// Refuses a profile that has no positive integral on some part that a border leaves.
    fn check(&self) -> Result<(), Error> {
        let reach = self.nodes.len() / NODES;
        for below in 0..=reach {
            for above in 0..=reach {
                let [low, high] = self.part(below as f64, above as f64);
                let integral = self.nodes[high].profile - self.nodes[low].profile;
                if !(integral > 0.0) {
                    return Err(Error::refused(
                        "integral of a filter over the picture",
                        "positive",
                        integral,
                    ));
                }
            }
        }
        Ok(())
    }

    /// The first and the last node of what is inside a picture with `below` pixels before this one and `above` after
    /// it.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the nodes"
    )]
    fn part(&self, below: f64, above: f64) -> [usize; 2] {
        let node = |x: f64| {
            let place = ((x - self.first) * NODES_F64).round();
            place.clamp(0.0, (self.nodes.len() - 1) as f64) as usize
        };
        [node(-(below + 0.5)), node(above + 0.5)]
    }

    /// A distance from the centre of the pixel in column or row `position` of `size`, and its weight.
    fn along(&self, position: u32, size: u32, u: f64) -> [f64; 2] {
        let above = size.saturating_sub(position).saturating_sub(1);
        let [low, high] = self.part(position.into(), above.into());
        let nodes = &self.nodes[low..=high];
        let (start, end) = (nodes[0], nodes[nodes.len() - 1]);
        let target = start.table + u * (end.table - start.table);
        let cell = nodes
            .partition_point(|node| node.table <= target)
            .clamp(1, nodes.len() - 1)
            - 1;
        let (left, right) = (nodes[cell], nodes[cell + 1]);
        let area = right.table - left.table;
        let within = if area > 0.0 {
            slanted(
                left.height,
                right.height,
                ((target - left.table) / area).clamp(0.0, 1.0),
            )
        } else {
            0.5
        };
        let x = self.first + ((low + cell) as f64 + within) / NODES_F64;
        let height = left.height + within * (right.height - left.height);
        let value = if x.abs() < self.profile.radius() {
            self.profile.value(x)
        } else {
            0.0
        };
        let drawn = end.table - start.table;
        let whole = end.profile - start.profile;
        let weight = if height > 0.0 {
            value / height * (drawn / whole)
        } else {
            0.0
        };
        [x, weight]
    }
}

impl<P: Profile + Sync> Filter for Separable<P> {
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn sample(&self, position: [u32; 2], size: [u32; 2], u: [f64; 2]) -> Filtered {
        let [x, across] = self.along(position[0], size[0], u[0]);
        let [y, down] = self.along(position[1], size[1], u[1]);
        Filtered {
            point: [
                f64::from(position[0]) + 0.5 + x,
                f64::from(position[1]) + 0.5 + y,
            ],
            weight: (across * down) as f32,
        }
    }
}

impl<P: Profile + ?Sized> Profile for &P {
    fn radius(&self) -> f64 {
        (**self).radius()
    }

    fn value(&self, x: f64) -> f64 {
        (**self).value(x)
    }
}

/// Simpson's rule between two neighbouring nodes.
fn simpson(value: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    (b - a) / 6.0 * (value(a) + 4.0 * value(0.5 * (a + b)) + value(b))
}

/// The place in `[0, 1]` below which the share `u` of a trapezium lies whose height goes from `a` to `b`.
fn slanted(a: f64, b: f64, u: f64) -> f64 {
    let root = (a * a + u * (b * b - a * a)).max(0.0).sqrt();
    let place = u * (a + b) / (a + root);
    if place.is_finite() {
        place.clamp(0.0, 1.0)
    } else {
        0.5
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Gaussian, Lanczos, Mitchell, Tent};
    use super::*;

    /// The mean of weight times `f` of the distance from the centre, by the midpoint rule in `u`.
    fn mean<P: Profile>(filter: &Separable<P>, position: u32, f: impl Fn(f64) -> f64) -> f64 {
        let count = 1 << 16;
        (0..count)
            .map(|i| {
                let u = (f64::from(i) + 0.5) / f64::from(count);
                let [x, weight] = filter.along(position, 100, u);
                weight * f(x)
            })
            .sum::<f64>()
            / f64::from(count)
    }

    /// The same by Simpson's rule over the part inside the picture.
    fn expected<P: Profile>(profile: &P, position: u32, f: impl Fn(f64) -> f64) -> f64 {
        let radius = profile.radius();
        let low = (-radius).max(-f64::from(position) - 0.5);
        let steps = 20_000;
        let step = (radius - low) / f64::from(steps);
        let integral = |g: &dyn Fn(f64) -> f64| {
            (0..steps)
                .map(|i| simpson(g, low + step * f64::from(i), low + step * f64::from(i + 1)))
                .sum::<f64>()
        };
        integral(&|x| profile.value(x) * f(x)) / integral(&|x| profile.value(x))
    }

    fn agrees<P: Profile + Clone>(profile: &P) {
        let filter = Separable::new(profile.clone()).unwrap();
        for position in [0, 1, 2, 50] {
            for f in [
                |_| 1.0,
                |x: f64| x,
                |x: f64| x * x,
                |x: f64| (3.0 * x).cos(),
            ] {
                let (ours, theirs) = (mean(&filter, position, f), expected(profile, position, f));
                assert!((ours - theirs).abs() < 2e-4, "{ours} {theirs}");
            }
        }
    }

    #[test]
    fn samples_have_the_moments_of_the_profile() {
        agrees(&Tent::new(1.0).unwrap());
        agrees(&Tent::new(1.3).unwrap());
        agrees(&Gaussian::new(0.5).unwrap());
        agrees(&Mitchell::new(1.0 / 3.0, 1.0 / 3.0).unwrap());
        agrees(&Mitchell::catmull_rom());
        agrees(&Lanczos::new(3).unwrap());
    }

    #[test]
    fn a_positive_filter_adds_hardly_any_noise() {
        let filter = Separable::new(Gaussian::new(0.5).unwrap()).unwrap();
        let count = 1 << 16;
        let variance = (0..count)
            .map(|i| filter.along(50, 100, (f64::from(i) + 0.5) / f64::from(count))[1])
            .map(|weight| (weight - 1.0).powi(2))
            .sum::<f64>()
            / f64::from(count);
        assert!(variance.sqrt() < 1e-3, "{variance}");
    }

    #[test]
    fn samples_stay_inside_the_picture() {
        let filter = Separable::new(Gaussian::new(0.5).unwrap()).unwrap();
        for u in [0.0, f64::MIN_POSITIVE, 0.5, 1.0 - f64::EPSILON / 2.0] {
            for size in [1, 2, 5] {
                for position in 0..size {
                    let seen = filter.sample([position; 2], [size; 2], [u; 2]);
                    for x in seen.point {
                        assert!((0.0..=f64::from(size)).contains(&x), "{x} of {size}");
                    }
                    assert!(seen.weight.is_finite());
                }
            }
        }
    }

    #[test]
    fn bad_profiles_are_refused() {
        struct Bad(f64, f64);
        impl Profile for Bad {
            fn radius(&self) -> f64 {
                self.0
            }
            fn value(&self, _: f64) -> f64 {
                self.1
            }
        }
        for (radius, value) in [
            (0.0, 1.0),
            (f64::NAN, 1.0),
            (65.0, 1.0),
            (1.0, f64::NAN),
            (1.0, -1.0),
            (1.0, 0.0),
        ] {
            assert!(Separable::new(Bad(radius, value)).is_err());
        }
        assert!(Separable::new(Bad(0.25, 1.0)).is_ok());
    }
}
