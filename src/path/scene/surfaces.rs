//! What a scene is made of before it is known how its lights are drawn and what is around it.

use std::sync::Arc;

use super::Scene;
use super::nearby;
use super::parts::{Owner, Parts, are_few};
use crate::Error;
use crate::path::Detail;
use crate::path::bsdf::Bsdf;
use crate::path::geometry::{Copied, FEW, Geometry};
use crate::path::light::{Emitter, Environment, Light};
use crate::path::object::{Instances, Object, Radiance};
use crate::path::resolution::{check_object, check_scene};

/// The surfaces of a scene.
pub(crate) struct Surfaces<B> {
    pub(super) geometry: Geometry,
    /// Of each shape.
    pub(super) owners: Vec<Owner>,
    pub(super) bsdfs: Vec<B>,
    pub(super) emitters: Vec<Emitter>,
    /// Whether paths go many at once, and all lights are drawn in lanes then, unless their type is another: no emitter is drawn one lane after the
    /// other.
    pub(super) lights_in_lanes: bool,
}

impl<B: Bsdf> Surfaces<B> {
    /// Those of objects, and of objects that stand in many places.
    pub(crate) fn new(
        mut objects: Vec<Object<B>>,
        instances: Vec<Instances<B>>,
    ) -> Result<Self, Error> {
        let mut parts = Parts::default();
        if B::Detail::is_nothing() && are_few(&objects) && instances.is_empty() {
            objects.iter_mut().for_each(Object::take_apart);
        }
        let shines = |object: &Object<B>| object.radiance != Radiance::Nothing;
        let meshes_shine = objects
            .iter()
            .any(|one| shines(one) && !one.meshes.is_empty());
        let (shapes, meshes) = parts.add(objects)?;
        let mut copies = Vec::new();
        for Instances { objects, places } in instances {
            if objects.iter().any(shines) {
                let given = "one that does";
                return Err(Error::refused("instance", "one that emits no light", given));
            }
            let start = parts.owners.len();
            let (shapes, meshes) = parts.add(objects)?;
            let group = Arc::new(Geometry::new(shapes, meshes, Vec::new()));
            check_scene(group.bounds())?;
            for place in places {
                let copy = Copied::new(Arc::clone(&group), start, place)?;
                check_object(copy.extent())?;
                copies.push(copy);
            }
        }
        let lights_in_lanes = shapes.len() <= FEW && parts.lights_are_flat() && !meshes_shine;
        let geometry = Geometry::new(shapes, meshes, copies);
        check_scene(geometry.bounds())?;
        Ok(Self {
            geometry,
            owners: parts.owners,
            bsdfs: parts.bsdfs,
            emitters: parts.emitters,
            lights_in_lanes,
        })
    }

    /// Whether any of them may be beyond a plane.
    #[cfg(feature = "mitsuba")]
    pub(crate) fn are_cut_by(&self, far: &crate::path::sensor::FarPlane) -> bool {
        far.cuts(self.geometry.bounds())
    }

    /// The scene of them in an environment.
    pub(crate) fn scene<L: Light, E: Environment>(
        self,
        environment: E,
    ) -> Result<Scene<B, L, E>, Error> {
        let mut emitters = self.emitters;
        // Where all lights go in lanes, drawing from the area is a little faster, and few scenes gain by more.
        let in_lanes = self.lights_in_lanes && L::new(emitters.clone())?.as_area_lights().is_some();
        let from_area = in_lanes && !nearby::are_lit(&self.geometry, &emitters);
        if !from_area {
            emitters.iter_mut().for_each(Emitter::by_solid_angle);
        }
        #[cfg_attr(
            not(feature = "simd"),
            expect(unused_mut, reason = "there are no packets")
        )]
        let mut scene = Scene {
            geometry: self.geometry,
            owners: self.owners,
            bsdfs: self.bsdfs,
            lights: L::new(emitters)?,
            environment,
            #[cfg(feature = "simd")]
            packet: None,
        };
        #[cfg(feature = "simd")]
        if scene.geometry.sweep().is_some() {
            scene.packet = scene.packed().map(Box::new);
        }
        Ok(scene)
    }
}
