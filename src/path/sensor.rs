//! Where pictures are taken from: one camera a file.
//!
//! | camera | coordinates |
//! |---|---|
//! | [`Pinhole`], [`Orthographic`] | 0 |
//! | [`ThinLens`] | 2 |
//! | [`Camera`], [`Clipped`] | as the one it is |

mod camera;
mod clipped;
mod orthographic;
mod pinhole;
mod projection;
mod thin_lens;

use super::Ray;
use crate::Sampler;

pub use camera::Camera;
pub use clipped::{Clipped, FarPlane};
pub use orthographic::Orthographic;
pub use pinhole::Pinhole;
pub use projection::Projection;
pub use thin_lens::ThinLens;

/// A camera: from a point of the film to a ray into the scene.
pub trait Sensor: Sync {
    /// The ray through a point of the film: `[0, 0]` is the upper left corner of the picture, `[1, 1]` the lower right
    /// one. Coordinates of a lens, where there is one, are drawn from `u`.
    fn ray<S: Sampler>(&self, film: [f64; 2], u: &mut S) -> Ray;

    /// The plane beyond which shapes are not seen, if there is one: it is [`Pixel`](super::Pixel), and all that goes by pixels, that
    /// begins paths by it, not whoever follows [rays](Self::ray) of his own. Sensors made of others pass theirs on. None unless implemented.
    fn far_plane(&self) -> Option<&FarPlane> {
        None
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3, Vec3A};

    use super::*;

    struct Fixed(f64);

    impl Sampler for Fixed {
        fn next_1d(&mut self) -> f64 {
            self.0
        }
    }

    fn close(a: Vec3A, b: [f32; 3]) -> bool {
        (a - Vec3A::from(b)).length() < 1e-5
    }

    #[test]
    fn looking_at_a_target_is_a_matrix() {
        // From z = -4 to the origin: x of the scene runs to the left of the picture.
        let camera = Pinhole::look_at([0.0, 0.0, -4.0], [0.0; 3], [0.0, 1.0, 0.0], 90.0, 2.0);
        let ray = camera.unwrap().ray([0.0, 0.0], &mut Fixed(0.0));
        let corner = Vec3A::new(1.0, 0.5, 1.0).normalize();
        assert!(close(ray.direction, corner.to_array()));
        assert!(close(ray.origin, [0.0, 0.0, -4.0]));
    }

    #[test]
    fn a_window_is_a_part_of_the_picture() {
        let whole = Projection {
            to_world: DMat4::from_rotation_y(0.7),
            width_degrees: 70.0,
            aspect: 1.5,
            ..Projection::default()
        };
        let part = Projection {
            window: [[0.25, 0.5], [0.75, 1.0]],
            ..whole
        };
        let (whole, part) = (Pinhole::new(&whole).unwrap(), Pinhole::new(&part).unwrap());
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [0.3, 0.9]] {
            let here = part.ray([x, y], &mut Fixed(0.0));
            let there = whole.ray([0.25 + 0.5 * x, 0.5 + 0.5 * y], &mut Fixed(0.0));
            assert!(close(here.direction, there.direction.to_array()));
        }
    }

    #[test]
    fn all_rays_of_a_lens_meet_in_the_plane_of_focus() {
        let projection = Projection {
            to_world: DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0)),
            near: 0.5,
            ..Projection::default()
        };
        let lens = ThinLens::new(&projection, 0.3, 5.0).unwrap();
        let pinhole = Pinhole::new(&projection).unwrap();
        for film in [[0.0, 0.0], [0.5, 0.5], [0.9, 0.2]] {
            let way = pinhole.ray(film, &mut Fixed(0.0)).direction;
            let focus = Vec3A::new(1.0, 2.0, 3.0) + way * (5.0 / way.z);
            for u in [0.0, 0.1, 0.5, 0.8] {
                let ray = lens.ray(film, &mut Fixed(u));
                assert!((ray.origin.z - 3.5).abs() < 1e-5);
                let distance = (8.0 - ray.origin.z) / ray.direction.z;
                assert!(close(ray.at(distance), focus.to_array()));
            }
        }
    }

    #[test]
    fn an_orthographic_film_spans_two_units_times_the_scale() {
        let projection = Projection {
            to_world: DMat4::from_scale(DVec3::new(3.0, 3.0, 1.0)),
            aspect: 2.0,
            near: 0.25,
            ..Projection::default()
        };
        let camera = Orthographic::new(&projection).unwrap();
        let corner = camera.ray([0.0, 0.0], &mut Fixed(0.0));
        assert!(close(corner.origin, [3.0, 1.5, 0.25]));
        assert!(close(corner.direction, [0.0, 0.0, 1.0]));
        assert!(close(
            camera.ray([1.0, 1.0], &mut Fixed(0.0)).origin,
            [-3.0, -1.5, 0.25]
        ));
    }

    #[test]
    fn bad_cameras_are_refused() {
        let good = Projection::default();
        for bad in [
            Projection {
                width_degrees: 180.0,
                ..good
            },
            Projection {
                width_degrees: f64::NAN,
                ..good
            },
            Projection {
                aspect: 0.0,
                ..good
            },
            Projection { near: -1.0, ..good },
            Projection {
                window: [[0.5, 0.0], [0.5, 1.0]],
                ..good
            },
            Projection {
                to_world: DMat4::ZERO,
                ..good
            },
            Projection {
                to_world: DMat4::from_scale(DVec3::splat(2.0)),
                ..good
            },
            Projection {
                to_world: DMat4::NAN,
                ..good
            },
        ] {
            assert!(Pinhole::new(&bad).is_err(), "{bad:?}");
            assert!(ThinLens::new(&bad, 1.0, 1.0).is_err(), "{bad:?}");
        }
        assert!(ThinLens::new(&good, 0.0, 1.0).is_err());
        assert!(ThinLens::new(&good, 1.0, f64::INFINITY).is_err());
        assert!(Pinhole::look_at([0.0; 3], [0.0; 3], [0.0, 1.0, 0.0], 45.0, 1.0).is_err());
    }
}
