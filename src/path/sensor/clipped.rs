//! The camera that sees no farther than a plane.

use glam::{DVec3, Vec3A};

use super::{Projection, Sensor};
use crate::path::Ray;
use crate::{Error, Sampler};

/// A camera that sees no shape beyond a plane; what is around the scene is seen in their place. They shine all the same, and are seen in mirrors.
///
/// The first ray of a path is followed twice.
///
/// ```
/// use estimand::path::sensor::{Clipped, FarPlane, Pinhole, Projection};
///
/// let projection = Projection { near: 0.1, ..Projection::default() };
/// let far = FarPlane::new(&projection, 99.9)?;
/// let camera = Clipped::new(Pinhole::new(&projection)?, Some(far));
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clipped<C> {
    camera: C,
    far: Option<FarPlane>,
}

/// A plane, and that nothing is seen beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarPlane {
    axis: Vec3A,
    end: f32,
}

impl FarPlane {
    /// The plane `depth` units of the scene behind the near one of a projection, which rays begin at.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a depth that is not positive, and for a matrix that has no axis.
    pub fn new(projection: &Projection, depth: f64) -> Result<Self, Error> {
        let axis = projection.to_world.transform_vector3(DVec3::Z);
        let near = projection.origin() + axis * projection.near;
        let axis = axis.normalize();
        if !(depth > 0.0 && axis.is_finite()) {
            let what = "distance of the far plane from the near one";
            return Err(Error::refused(what, "positive, along an axis", depth));
        }
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let end = (axis.dot(near) + depth) as f32;
        Ok(Self {
            axis: axis.as_vec3a(),
            end,
        })
    }

    /// Whether a point is beyond it.
    #[inline]
    pub fn hides(&self, point: Vec3A) -> bool {
        self.axis.dot(point) > self.end
    }

    /// Whether any point of a box is beyond it.
    #[cfg(feature = "mitsuba")]
    pub(crate) fn cuts(&self, [low, high]: [Vec3A; 2]) -> bool {
        self.hides(Vec3A::select(self.axis.cmpgt(Vec3A::ZERO), high, low))
    }
}

impl<C> Clipped<C> {
    /// What `camera` sees before the plane; everything without one, for programs that do not know before they read a file.
    pub fn new(camera: C, far: Option<FarPlane>) -> Self {
        Self { camera, far }
    }
}

impl<C: Sensor> Sensor for Clipped<C> {
    #[inline]
    fn ray<S: Sampler>(&self, film: [f64; 2], u: &mut S) -> Ray {
        self.camera.ray(film, u)
    }

    #[inline]
    fn far_plane(&self) -> Option<&FarPlane> {
        self.far.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use glam::DMat4;

    use super::super::{Orthographic, Pinhole};
    use super::*;
    use crate::Integrand;
    use crate::path::bsdf::Lambertian;
    use crate::path::filter::BoxFilter;
    use crate::path::light::{AreaLights, Constant};
    use crate::path::shape::Sphere;
    use crate::path::{Object, Paths, Scene, View};

    struct Centre;

    impl Sampler for Centre {
        fn next_1d(&mut self) -> f64 {
            0.5
        }
    }

    /// Two balls that shine in front of one another, from z = 4 and 8 on, in light from all around.
    fn seen<C: Sensor>(sensor: C, paths: Paths) -> f32 {
        let ball = |z: f32, radiance: f32| {
            let sphere = Sphere::new([0.0, 0.0, z + 1.0], 1.0).unwrap();
            let black = Lambertian::new([0.0; 3]).unwrap();
            Object::new([sphere], black)
                .emitting([radiance; 3])
                .unwrap()
        };
        let around = Constant::new([1.0; 3]).unwrap();
        let scene = Scene::new(vec![ball(4.0, 4.0), ball(8.0, 8.0)], around).unwrap();
        let view: View<Lambertian, AreaLights, _, _> = View {
            scene,
            sensor,
            filter: BoxFilter,
            paths,
        };
        view.pixel([0, 0], [1, 1]).evaluate(&mut Centre).x
    }

    fn clipped<C: Sensor>(camera: C, projection: &Projection, depth: f64) -> Clipped<C> {
        Clipped::new(camera, Some(FarPlane::new(projection, depth).unwrap()))
    }

    #[test]
    fn what_is_beyond_is_not_seen_but_what_is_around() {
        let projection = Projection {
            near: 1.0,
            ..Projection::default()
        };
        let pinhole = Pinhole::new(&projection).unwrap();
        // The near ball ends at 6.
        for (near, depth, radiance) in [
            (0.0, 3.9, 1.0),
            (0.0, 4.1, 4.0),
            (6.5, 1.4, 1.0),
            (6.5, 1.6, 8.0),
        ] {
            let projection = Projection { near, ..projection };
            let pinhole = Pinhole::new(&projection).unwrap();
            let camera = clipped(pinhole, &projection, depth);
            assert_eq!(seen(camera, Paths::default()), radiance, "{near} {depth}");
        }
        assert_eq!(seen(Clipped::new(pinhole, None), Paths::default()), 4.0);
        let hiding = Paths::default().hiding_lights();
        let camera = clipped(pinhole, &projection, 2.9);
        assert_eq!(seen(camera, hiding), 0.0);
    }

    #[test]
    fn the_plane_is_in_units_of_the_scene_however_the_film_is_scaled() {
        let projection = Projection {
            to_world: DMat4::from_scale(DVec3::splat(2.0)),
            near: 1.0,
            ..Projection::default()
        };
        // Rays begin at 2.
        let camera = Orthographic::new(&projection).unwrap();
        for (depth, radiance) in [(1.9, 1.0), (2.1, 4.0)] {
            let camera = clipped(camera, &projection, depth);
            assert_eq!(seen(camera, Paths::default()), radiance, "{depth}");
        }
    }

    #[test]
    fn a_box_is_cut_by_its_farthest_corner() {
        let far = FarPlane::new(&Projection::default(), 3.0).unwrap();
        let within = |z| [Vec3A::splat(-1.0), Vec3A::new(1.0, 1.0, z)];
        assert!(!far.cuts(within(2.9)) && far.cuts(within(3.1)));
    }

    #[test]
    fn depths_that_are_none_are_refused() {
        for depth in [0.0, -1.0, f64::NAN] {
            assert!(FarPlane::new(&Projection::default(), depth).is_err());
        }
        let flat = Projection {
            to_world: DMat4::from_scale(DVec3::new(1.0, 1.0, 0.0)),
            ..Projection::default()
        };
        assert!(FarPlane::new(&flat, 1.0).is_err());
        assert!(FarPlane::new(&Projection::default(), f64::INFINITY).is_ok());
    }
}
