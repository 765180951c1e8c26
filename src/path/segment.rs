//! Ways along which light may pass.

use glam::Vec3A;

use super::ray::{Ray, Surface, gamma};

/// The way from one surface to another, or to what is no surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The ray from a margin off the one surface.
    pub ray: Ray,
    /// How far it is to a margin off the other, less the rounding error of a distance; infinite where there is no other
    /// end.
    pub length: f32,
    end: End,
}

/// What is at the end of a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// A surface of the scene. So the way is inside the scene, where fewer shapes can be in it.
    Surface,
    /// Anything else.
    Open,
}

impl Segment {
    /// The way between two surfaces; `None` where they are not told apart.
    #[inline]
    pub fn between<D>(here: &Surface<D>, there: &Surface) -> Option<Self> {
        let toward = there.point - here.point;
        Self::joining(here.leave(toward), there.leave(-toward), End::Surface)
    }

    /// The way from a surface to a point off all surfaces; `None` where they are not told apart.
    #[inline]
    pub fn to_point<D>(here: &Surface<D>, there: Vec3A) -> Option<Self> {
        Self::joining(here.leave(there - here.point), there, End::Open)
    }

    /// The way from a surface in a direction of length 1, without end.
    #[inline]
    pub fn along<D>(here: &Surface<D>, direction: Vec3A) -> Self {
        Self {
            ray: Ray {
                origin: here.leave(direction),
                direction,
            },
            length: f32::INFINITY,
            end: End::Open,
        }
    }

    #[inline]
    pub(super) fn end(&self) -> End {
        self.end
    }

    #[inline]
    fn joining(origin: Vec3A, to: Vec3A, end: End) -> Option<Self> {
        let way = to - origin;
        let length = way.length();
        (length > 0.0).then(|| Self {
            ray: Ray {
                origin,
                direction: way * length.recip(),
            },
            length: length * (1.0 - gamma(8)),
            end,
        })
    }
}
