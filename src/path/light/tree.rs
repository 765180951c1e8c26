//! Many shapes that emit light, in a tree.

mod bound;
mod group;

use glam::Vec3A;

use super::{Emission, Emitter, Illumination, Light};
use crate::path::frame::singles;
use crate::path::shape::Shape;
use crate::path::{Segment, Surface};
use crate::{Error, Sampler};
use bound::{Bound, split};
use group::Group;

/// Many shapes that emit light from their outer sides, chosen by what they may do for the surface at hand.
///
/// A tree over the emitters bounds for each group where it is, which way it shines and how much; from the root
/// down, one of two branches is taken in proportion to the bound of its irradiance.[^conty] Where
/// [`AreaLights`](super::AreaLights) draw a bright light far away or one that faces elsewhere, this draws one that is seen.
/// It takes longer, and pays where lights are far from one another: small lamps of unequal radiance in a hall eight times as long as wide
/// and high had 1.2, 2.5 and 4.0 times the efficiency, one over mean squared error and time, with 5, 20 and 100 of them,
/// in a cube of a room 1.7, 2.2 and 2.1; a lamp of 128 triangles beside another 0.7. That is with paths one by one. In scenes of up to 128 shapes
/// whose lights are flat and have one colour each, paths by a tree take three times as long: there it was 0.6 to 1.5.
/// What reads scene files takes a look at the scene to decide.
///
/// Two coordinates draw a point, however many emitters there are.
///
/// [^conty]: Conty Estevez, Alejandro; Kulla, Christopher (2018). *Importance Sampling of Many Lights with Adaptive Tree
///     Splitting*. <https://doi.org/10.1145/3233305>
#[derive(Clone, Debug, PartialEq)]
pub struct LightTree {
    emitters: Vec<Emitter>,
    /// The root comes first, both branches of a node side by side.
    nodes: Vec<Node>,
    /// The node of each emitter.
    leaves: Vec<u32>,
}

/// A group of emitters.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    group: Group,
    /// The node above; the root's is itself.
    parent: u32,
    /// The first of its branches, or its emitter.
    content: Content,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Branches(u32),
    Emitter(u32),
}

impl LightTree {
    /// Adds the nodes of the emitters in `indices` to the node `at`.
    fn grow(&mut self, at: usize, indices: &mut [u32], bounds: &[Bound]) {
        let whole = indices[1..]
            .iter()
            .fold(bounds[indices[0] as usize], |sum, &index| {
                sum.with(bounds[index as usize])
            });
        self.nodes[at].group = Group::of(&whole);
        if let [index] = *indices {
            self.nodes[at].content = Content::Emitter(index);
            self.leaves[index as usize] = number(at);
            return;
        }
        let split = split(indices, bounds, &whole);
        let (left, right) = indices.split_at_mut(split);
        let first = self.nodes.len();
        self.nodes[at].content = Content::Branches(number(first));
        let branch = Node {
            parent: number(at),
            ..self.nodes[at]
        };
        self.nodes.extend([branch; 2]);
        self.grow(first, left, bounds);
        self.grow(first + 1, right, bounds);
    }

    /// The probability of the first of two branches, seen from a point; `None` if neither can light it.
    #[inline]
    fn first(&self, branches: u32, from: Vec3A) -> Option<f32> {
        let [a, b] = [0, 1].map(|i| self.nodes[branches as usize + i].group.worth(from));
        (a + b > 0.0).then(|| a / (a + b))
    }

    /// An emitter, the probability of its choice, and what is left of the coordinate.
    #[inline]
    fn choose(&self, from: Vec3A, mut u: f64) -> Option<Chosen> {
        let (mut node, mut probability) = (0, 1.0);
        loop {
            match self.nodes[node].content {
                Content::Emitter(emitter) => {
                    return Some(Chosen {
                        emitter,
                        probability,
                        left: u,
                    });
                }
                Content::Branches(branches) => {
                    let first = self.first(branches, from)?;
                    let share = f64::from(first);
                    if u < share {
                        node = branches as usize;
                        probability *= first;
                        u /= share;
                    } else {
                        node = branches as usize + 1;
                        probability *= 1.0 - first;
                        u = (u - share) / (1.0 - share);
                    }
                    u = u.min(1.0 - f64::EPSILON / 2.0);
                }
            }
        }
    }

    /// The probability with which an emitter is chosen.
    #[inline]
    fn probability(&self, emitter: u32, from: Vec3A) -> f32 {
        let mut node = self.leaves[emitter as usize];
        let mut probability = 1.0;
        while node != 0 {
            let parent = self.nodes[node as usize].parent;
            let Content::Branches(branches) = self.nodes[parent as usize].content else {
                break;
            };
            let Some(first) = self.first(branches, from) else {
                return 0.0;
            };
            probability *= if node == branches { first } else { 1.0 - first };
            node = parent;
        }
        probability
    }
}

/// An emitter chosen by a coordinate.
struct Chosen {
    emitter: u32,
    probability: f32,
    left: f64,
}

/// The number of a node: there are fewer than twice as many as emitters, whose numbers end below 2^31.
fn number(node: usize) -> u32 {
    u32::try_from(node).expect("fewer than 2^31 emitters")
}

impl Light for LightTree {
    fn new(emitters: Vec<Emitter>) -> Result<Self, Error> {
        if emitters.is_empty() || emitters.len() >= 1 << 31 {
            return Err(Error::refused(
                "number of emitters",
                "at least 1 and below 2^31 in a tree of lights",
                emitters.len(),
            ));
        }
        let bounds: Vec<_> = emitters.iter().map(Bound::of).collect();
        let total: f32 = bounds.iter().map(|bound| bound.power).sum();
        if !(total > 0.0 && total.is_finite()) {
            return Err(Error::refused(
                "power of all lights together",
                "positive and finite",
                total,
            ));
        }
        let count = number(emitters.len());
        let mut tree = Self {
            leaves: vec![0; emitters.len()],
            emitters,
            nodes: vec![Node {
                group: Group::of(&bounds[0]),
                parent: 0,
                content: Content::Emitter(0),
            }],
        };
        let mut indices: Vec<u32> = (0..count).collect();
        tree.grow(0, &mut indices, &bounds);
        Ok(tree)
    }

    #[inline]
    fn sample<D, S: Sampler>(&self, from: &Surface<D>, u: &mut S) -> Option<Illumination> {
        let [a, b] = u.next_2d();
        let chosen = self.choose(from.point, a)?;
        let emitter = &self.emitters[chosen.emitter as usize];
        let drawn = emitter
            .shape
            .sample_with_density(from.point, singles([chosen.left, b]));
        let (there, density) = (drawn.0, chosen.probability * drawn.1);
        let lit = there.normal.dot(from.point - there.point) > 0.0;
        if !(lit && density > 0.0 && density < f32::MAX) {
            return None;
        }
        Some(Illumination {
            way: Segment::between(from, &there)?,
            weight: emitter.radiance_at(&there) / density,
            density,
        })
    }

    #[inline]
    fn emitted(&self, emitter: u32, from: Vec3A, surface: &Surface) -> Emission {
        if surface.normal.dot(from - surface.point) <= 0.0 {
            return Emission::NONE;
        }
        let probability = self.probability(emitter, from);
        let emitter = &self.emitters[emitter as usize];
        Emission {
            radiance: emitter.radiance_at(surface),
            density: probability * emitter.shape.density(from, surface),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::shape::{Flat, Sphere};
    use crate::points::{HashedOwen, PointSet, Sobol};

    /// Small squares that shine in all directions, and a few balls.
    fn lights(count: u64) -> Vec<Emitter> {
        let points = Sobol::new(8).unwrap().scrambled(HashedOwen { seed: 3 });
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let numbers = |index| -> [f32; 8] {
            core::array::from_fn(|dimension| {
                points.coordinate(index, u32::try_from(dimension).unwrap()) as f32
            })
        };
        (0..count)
            .map(|index| {
                let [a, b, c, d, e, f, g, h] = numbers(index);
                let corner = [4.0 * a - 2.0, 4.0 * b - 2.0, 4.0 * c - 2.0];
                let shape = if index % 7 == 0 {
                    Sphere::new(corner, 0.05).unwrap().into()
                } else {
                    let first = [d - 0.5, e - 0.5, 0.3].map(|x| 0.2 * x);
                    let second = [0.3, f - 0.5, g - 0.5].map(|x| 0.2 * x);
                    Flat::parallelogram(corner, first, second).unwrap().into()
                };
                Emitter {
                    shape,
                    radiance: Vec3A::splat(0.1 + h * h * 5.0),
                    picture: None,
                }
            })
            .collect()
    }

    fn at(point: Vec3A) -> Surface {
        Surface {
            point,
            normal: Vec3A::Y,
            margin: 0.0,
            detail: (),
        }
    }

    #[test]
    fn emitters_are_chosen_with_their_probabilities() {
        for count in [1, 2, 3, 50] {
            let tree = LightTree::new(lights(count)).unwrap();
            for from in [Vec3A::ZERO, Vec3A::new(1.0, -2.0, 0.5), Vec3A::splat(30.0)] {
                let steps: u16 = 1 << 14;
                let mut shares = vec![0.0; tree.emitters.len()];
                for step in 0..steps {
                    let u = (f64::from(step) + 0.5) / f64::from(steps);
                    // A branch that cannot light the point after all gives no sample.
                    if let Some(chosen) = tree.choose(from, u) {
                        shares[chosen.emitter as usize] += 1.0 / f32::from(steps);
                        assert!((0.0..1.0).contains(&chosen.left));
                    }
                }
                for (emitter, share) in (0..).zip(shares) {
                    // One step at each end of an interval.
                    let probability = tree.probability(emitter, from);
                    assert!((share - probability).abs() < 2.0 / f32::from(steps));
                }
            }
        }
    }

    #[test]
    fn no_light_that_arrives_is_passed_over() {
        let tree = LightTree::new(lights(300)).unwrap();
        for emitter in 0..300 {
            for corner in [[0.0, 0.0], [0.99, 0.0], [0.0, 0.99], [0.5, 0.5]] {
                let there = tree.emitters[emitter as usize]
                    .shape
                    .sample(Vec3A::ZERO, corner);
                for from in [Vec3A::ZERO, Vec3A::new(1.0, -2.0, 0.5), Vec3A::splat(30.0)] {
                    if there.normal.dot(from - there.point) > 0.0 {
                        assert!(tree.probability(emitter, from) > 0.0);
                    }
                }
            }
        }
    }

    #[test]
    fn the_light_of_many_is_their_sum_with_less_noise_than_by_power() {
        // The mean weight is the integral of the radiance over all directions: of each emitter by itself.
        let from = at(Vec3A::new(0.3, -0.2, 0.1));
        let points = Sobol::new(2).unwrap().scrambled(HashedOwen { seed: 5 });
        let estimate = |light: &dyn Fn(u64) -> Option<Illumination>, count: u16| {
            let (mut sum, mut squares) = (0.0, 0.0);
            for index in 0..count {
                let weight = light(index.into()).map_or(0.0, |light| f64::from(light.weight.x));
                sum += weight;
                squares += weight * weight;
            }
            let mean = sum / f64::from(count);
            (mean, squares / f64::from(count) - mean * mean)
        };
        let emitters = lights(200);
        let expected: f64 = emitters
            .iter()
            .map(|emitter| {
                let one = LightTree::new(vec![emitter.clone()]).unwrap();
                estimate(
                    &|index| one.sample(&from, &mut points.point(index)),
                    1 << 10,
                )
                .0
            })
            .sum();
        let tree = LightTree::new(emitters.clone()).unwrap();
        let power = super::super::AreaLights::new(emitters).unwrap();
        let count = 1 << 15;
        let by_tree = estimate(&|index| tree.sample(&from, &mut points.point(index)), count);
        let by_power = estimate(
            &|index| power.sample(&from, &mut points.point(index)),
            count,
        );
        // Six standard errors of independent points, of which scrambled nets stay well below.
        let bound = 6.0 * (by_tree.1 / f64::from(count)).sqrt();
        assert!(
            (by_tree.0 - expected).abs() < bound,
            "{by_tree:?} {expected}"
        );
        assert!(by_tree.1 < 0.5 * by_power.1, "{by_tree:?} {by_power:?}");
    }

    #[test]
    fn no_lights_and_dark_ones_are_refused() {
        assert!(LightTree::new(Vec::new()).is_err());
        let mut dark = lights(3);
        for emitter in &mut dark {
            emitter.radiance = Vec3A::ZERO;
        }
        assert!(LightTree::new(dark).is_err());
    }
}
