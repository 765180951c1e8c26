//! Whether lights are near what they light.

use crate::hash::{hash, unit_f32};
use crate::path::Ray;
use crate::path::frame::{Frame, cosine_hemisphere};
use crate::path::geometry::Geometry;
use crate::path::light::Emitter;
use crate::path::shape::Primitive;

/// Whether some of the light of flat emitters falls on what is so near that it pays to draw it by solid angle where
/// that takes time: more than this [`SHARE`] of what falls on anything, on points from which the emitter would
/// fill [`NEAR`], were it small.
///
/// Found by following [`RAYS`] rays from each of a few emitters, the same ones every time.
pub(super) fn are_lit(geometry: &Geometry, emitters: &[Emitter]) -> bool {
    let (mut near, mut all) = (0.0, 0.0);
    for (number, emitter) in (0_u64..).zip(emitters) {
        let Primitive::Flat(flat) = &emitter.shape else {
            continue;
        };
        for ray in 0..RAYS {
            let key = hash(number, ray);
            let [a, b, c, d] = [0, 1, 2, 3].map(|word| unit_f32(hash(key, word)));
            let from = flat.at_area([a, b]);
            let direction = Frame::around(from.normal).out(cosine_hemisphere([c, d]));
            let origin = from.leave(direction);
            let Some(hit) = geometry.nearest(&Ray { origin, direction }) else {
                continue;
            };
            all += emitter.power();
            if flat.apparent(hit.surface.point) > NEAR {
                near += emitter.power();
            }
        }
    }
    near > SHARE * all
}

const RAYS: u64 = 128;

/// In steradians.
const NEAR: f32 = 1.0;
const SHARE: f64 = 0.125;
