//! The camera that sees no farther than a plane.

use glam::{DVec3, Vec3A};

use super::{Projection, Sensor};
use crate::path::Ray;
use crate::{Error, Sampler};

/// A camera that meets no shape beyond a plane; what is around the scene is seen in their place. They shine all the same, and are seen in mirrors,
/// through holes and glass, and where [lights are hidden](crate::path::Paths::hiding_lights) behind these: only what the first ray of a path meets is heeded,
/// as in Mitsuba.
///
/// That ray is followed twice.
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
    normal: Vec3A,
    end: f32,
}

impl FarPlane {
    /// The plane that a projection has `depth` units of the scene, along its axis, behind its near one, which rays begin at and it is parallel to.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a depth that is not positive, for a near distance that is negative or not finite, and for a matrix that is not finite or cannot be
    /// inverted.
    pub fn new(projection: &Projection, depth: f64) -> Result<Self, Error> {
        projection.check_near()?;
        projection.check_placing()?;
        if !(depth > 0.0) {
            let what = "distance of the far plane from the near one";
            return Err(Error::refused(what, "positive", depth));
        }
        let vector = |axis| projection.to_world.transform_vector3(axis);
        let axis = vector(DVec3::Z);
        let near = projection.origin() + axis * projection.near;
        let axis = axis.normalize();
        let normal = vector(DVec3::X).normalize().cross(vector(DVec3::Y));
        let normal = normal.normalize() * normal.dot(axis).signum();
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let end = (normal.dot(near) + normal.dot(axis) * depth) as f32;
        Ok(Self {
            normal: normal.as_vec3a(),
            end,
        })
    }

    /// Whether a point is beyond it.
    #[inline]
    pub fn hides(&self, point: Vec3A) -> bool {
        self.normal.dot(point) > self.end
    }

    /// Whether any point of a box is beyond it.
    #[cfg(any(test, feature = "mitsuba"))]
    pub(crate) fn cuts(&self, [low, high]: [Vec3A; 2]) -> bool {
        self.hides(Vec3A::select(self.normal.cmpgt(Vec3A::ZERO), high, low))
    }
}

impl<C> Clipped<C> {
    /// What `camera` sees before the plane; everything without one, for programs that do not know before they read a file. Camera and plane must be of one
    /// [`Projection`], or no ray come back through the plane: what a ray meets before it, after something beyond it, is not seen either.
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

    use super::super::{Orthographic, Pinhole, ThinLens};
    use super::*;
    use crate::Integrand;
    use crate::path::bsdf::Lambertian;
    use crate::path::filter::BoxFilter;
    use crate::path::light::{AreaLights, Constant};
    use crate::path::shape::Sphere;
    use crate::path::{Direct, Ending, Object, Paths, Recursive, Scene, View};

    struct Centre;

    impl Sampler for Centre {
        fn next_1d(&mut self) -> f64 {
            0.5
        }
    }

    fn ball(z: f32, albedo: f32) -> Object<Lambertian> {
        let sphere = Sphere::new([0.0, 0.0, z + 1.0], 1.0).unwrap();
        Object::new([sphere], Lambertian::new([albedo; 3]).unwrap())
    }

    fn view<C: Sensor>(
        balls: Vec<Object<Lambertian>>,
        sensor: C,
        paths: Paths,
    ) -> View<Lambertian, AreaLights, Constant, C> {
        let around = Constant::new([1.0; 3]).unwrap();
        View {
            scene: Scene::new(balls, around).unwrap(),
            sensor,
            filter: BoxFilter,
            paths,
        }
    }

    /// Two balls that shine in front of one another, from z = 4 and 8 on, in light from all around.
    fn seen<C: Sensor>(sensor: C) -> f32 {
        let lamp = |z: f32| ball(z, 0.0).emitting([z; 3]).unwrap();
        let view = view(vec![lamp(4.0), lamp(8.0)], sensor, Paths::default());
        let pixel = view.pixel([0, 0], [1, 1]);
        let radiance = pixel.evaluate(&mut Centre).x;
        let recursion = Recursive::new(1, Ending::Depth(1), Direct::Chance).unwrap();
        let recursive = recursion.pixel(pixel).evaluate(&mut Centre).x;
        assert_eq!(recursive, radiance);
        radiance
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
            assert_eq!(seen(camera), radiance, "{near} {depth}");
            let lens = ThinLens::new(&projection, 1e-3, 5.0).unwrap();
            let lens = clipped(lens, &projection, depth);
            assert_eq!(seen(lens), radiance, "{near} {depth}");
        }
        assert_eq!(seen(Clipped::new(pinhole, None)), 4.0);
    }

    #[test]
    fn what_is_around_is_hidden_behind_the_plane_too() {
        let projection = Projection::default();
        let pinhole = Pinhole::new(&projection).unwrap();
        let far = |depth| FarPlane::new(&projection, depth).ok();
        let seen = |far: Option<FarPlane>, paths| {
            let view = view(vec![ball(4.0, 0.5)], Clipped::new(pinhole, far), paths);
            view.pixel([0, 0], [1, 1]).evaluate(&mut Centre).x
        };
        let (all, hiding) = (Paths::default(), Paths::default().hiding_lights());
        assert_eq!(seen(far(3.9), all), 1.0);
        assert_eq!(seen(far(3.9), hiding), 0.0);
        assert!(seen(far(4.1), hiding) > 0.1);
        assert_eq!(seen(far(4.1), hiding), seen(None, all));
    }

    #[test]
    fn however_many_shapes_are_beyond_none_is_seen() {
        let pinhole = Pinhole::new(&Projection::default()).unwrap();
        let balls = (4_u8..40)
            .map(|z| ball(f32::from(z) * 1e3, 0.5).emitting([2.0; 3]).unwrap())
            .collect();
        let camera = clipped(pinhole, &Projection::default(), 100.0);
        let view = view(balls, camera, Paths::default());
        assert_eq!(view.pixel([0, 0], [1, 1]).evaluate(&mut Centre).x, 1.0);
    }

    #[test]
    fn the_plane_is_parallel_to_the_film() {
        // Upwards the film comes nearer; rays go along z.
        let sheared = Projection {
            to_world: DMat4::from_cols_array_2d(&[
                [-2.0, 0.0, 0.0, 0.0],
                [0.0, 1.0, -1.0, 0.0],
                [0.0, 0.0, 3.0, 0.0],
                [0.0, 0.0, 0.0, 1.0],
            ]),
            near: 2.0,
            ..Projection::default()
        };
        let far = FarPlane::new(&sheared, 4.0).unwrap();
        for (x, y, end) in [(0.0, 0.0, 10.0), (7.0, 0.0, 10.0), (-3.0, 2.0, 8.0)] {
            let [before, beyond] = [-0.01, 0.01].map(|d| Vec3A::new(x, y, end + d));
            assert!(!far.hides(before) && far.hides(beyond), "{x} {y}");
        }
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
            assert_eq!(seen(camera), radiance, "{depth}");
        }
    }

    #[test]
    fn a_box_is_cut_by_its_farthest_corner() {
        let far = FarPlane::new(&Projection::default(), 3.0).unwrap();
        let within = |z| [Vec3A::splat(-1.0), Vec3A::new(1.0, 1.0, z)];
        assert!(!far.cuts(within(2.9)) && far.cuts(within(3.1)));
    }

    #[test]
    fn planes_that_are_none_are_refused() {
        for depth in [0.0, -1.0, f64::NAN] {
            assert!(FarPlane::new(&Projection::default(), depth).is_err());
        }
        for scale in [DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, f64::NAN, 1.0)] {
            let projection = Projection {
                to_world: DMat4::from_scale(scale),
                ..Projection::default()
            };
            let error = FarPlane::new(&projection, 1.0).unwrap_err();
            assert!(error.to_string().contains("camera"), "{error}");
        }
        for near in [-1.0, f64::NAN, f64::INFINITY] {
            let projection = Projection {
                near,
                ..Projection::default()
            };
            let error = FarPlane::new(&projection, 1.0).unwrap_err();
            assert!(error.to_string().contains("near"), "{error}");
        }
        assert!(FarPlane::new(&Projection::default(), f64::INFINITY).is_ok());
    }
}
