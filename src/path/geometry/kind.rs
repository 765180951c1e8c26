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

/// Whether a flat shape can be in the way between two points of the scene: it cannot if all shapes lie on one side of
/// its plane, as the walls of a room do, up to the distance at which surfaces are told apart.
pub(super) fn divides(flat: &Flat, shapes: &[Primitive]) -> bool {
    let normal = flat.normal.as_dvec3();
    let corner = flat.corner.as_dvec3();
    let height = |point: DVec3| normal.dot(point - corner);
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for shape in shapes {
        let [least, most] = match shape {
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
            other => {
                // Of the box around it, which is not smaller.
                let [low, high] = other.bounds().map(Vec3A::as_dvec3);
                let (middle, half) = (height(0.5 * (low + high)), 0.5 * (high - low));
                let reach = normal.abs().dot(half);
                [middle - reach, middle + reach]
            }
        };
        (low, high) = (low.min(least), high.max(most));
    }
    let margin = f64::from(flat.margin);
    low < -margin && high > margin
}
