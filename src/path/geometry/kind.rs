//! What makes a flat shape easy to intersect, and which shapes can cast a shadow inside a scene.

use glam::{DVec3, Vec3A};

use crate::path::shape::{Flat, Primitive, Shape};

/// How simple the equations of a flat shape are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::path) enum Kind {
    /// A rectangle whose normal and edges run along the axes; that of the normal is named.
    Aligned(usize),
    /// Any other parallelogram.
    Parallelogram,
    /// A triangle.
    Triangle,
}

impl Kind {
    pub(in crate::path) fn of(flat: &Flat) -> Self {
        if flat.slant != 0.0 {
            return Self::Triangle;
        }
        let [normal, first, second] = [flat.normal, flat.first_dual, flat.second_dual].map(axis);
        match (normal, first, second) {
            (Some(normal), Some(_), Some(_)) => Self::Aligned(normal),
            _ => Self::Parallelogram,
        }
    }
}

/// The axis that a vector runs along, if it does.
pub(in crate::path) fn axis(vector: Vec3A) -> Option<usize> {
    let parts = vector.to_array();
    let [axis] = (0..3)
        .filter(|&axis| parts[axis] != 0.0)
        .collect::<Vec<_>>()[..]
    else {
        return None;
    };
    Some(axis)
}

/// Whether a flat shape can be in the way between two points of the scene: it cannot if all shapes, and the boxes around all else,
/// lie on one side of its plane, as the walls of a room do, up to the distance at which surfaces are told apart.
pub(super) fn divides(flat: &Flat, shapes: &[Primitive], others: &[[Vec3A; 2]]) -> bool {
    let normal = flat.normal.as_dvec3();
    let corner = flat.corner.as_dvec3();
    let height = |point: DVec3| normal.dot(point - corner);
    // Of a box.
    let span = |corners: [Vec3A; 2]| {
        let [low, high] = corners.map(Vec3A::as_dvec3);
        let (middle, half) = (height(0.5 * (low + high)), 0.5 * (high - low));
        let reach = normal.abs().dot(half);
        [middle - reach, middle + reach]
    };
    let spans = shapes.iter().map(|shape| {
        match shape {
            Primitive::Flat(other) => {
                let [first, second] = [other.first_edge, other.second_edge].map(Vec3A::as_dvec3);
                let start = other.corner.as_dvec3();
                let last = if other.slant == 0.0 {
                    first + second
                } else {
                    first
                };
                let heights = [start, start + first, start + second, start + last].map(height);
                let least = heights.iter().fold(f64::INFINITY, |a, &b| a.min(b));
                [
                    least,
                    heights.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b)),
                ]
            }
            // Of the box around it, which is not smaller.
            other => span(other.bounds()),
        }
    });
    let all = spans.chain(others.iter().map(|&corners| span(corners)));
    let [low, high] = all.fold([0.0_f64; 2], |[low, high], [least, most]| {
        [low.min(least), high.max(most)]
    });
    let margin = f64::from(flat.margin);
    low < -margin && high > margin
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_on_both_sides_of_a_wall_is_divided_by_it() {
        let wall =
            Flat::parallelogram([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]).unwrap();
        let cube = |height: f32| {
            let middle = Vec3A::new(0.3, height, 0.1);
            [middle - Vec3A::splat(0.5), middle + Vec3A::splat(0.5)]
        };
        let triangle = |height: f32| {
            let corners = [
                [0.0, height, 0.0],
                [1.0, height, 0.0],
                [0.0, height + 0.5, 1.0],
            ];
            Primitive::from(Flat::triangle(corners).unwrap())
        };
        let both = [cube(0.6), cube(-0.6)];
        for (shapes, boxes, expected) in [
            (vec![], &both[..0], false),
            (vec![], &both[..1], false),
            (vec![], &both[..], true),
            (vec![], &[cube(0.4)], true),
            (vec![triangle(1.0)], &both[..1], false),
            (vec![triangle(1.0)], &both[1..], true),
            (vec![triangle(1.0), triangle(-1.0)], &[], true),
        ] {
            assert_eq!(divides(&wall, &shapes, boxes), expected, "{boxes:?}");
        }
    }
}
