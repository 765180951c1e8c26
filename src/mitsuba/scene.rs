//! A whole scene.

use super::document::{Document, Kind};
use super::emitter::{self, Emitter, Source};
use super::error::{Place, SceneError};
use super::integrator::{self, Integrator};
use super::query::{Context, Query};
use super::sensor::{self, Sensor};
use super::shape::{self, Shape};

/// What a scene file says, with the defaults of Mitsuba filled in.
///
/// Meshes and images are named and not yet loaded; objects that nothing refers to are not in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Which paths of light count.
    pub integrator: Integrator,
    /// From where pictures are taken; at least one.
    pub sensors: Vec<Sensor>,
    /// Where surfaces are.
    pub shapes: Vec<Shape>,
    /// Light that does not come from shapes; at most one of these is around the scene.
    pub emitters: Vec<Emitter>,
    /// Objects of the file that nothing refers to.
    pub unused: Vec<Place>,
    /// Where the scene stands.
    pub place: Place,
}

/// The scene that a document describes.
pub(super) fn describe(document: &Document) -> Result<Description, SceneError> {
    let context = Context::new(document);
    let mut query = Query::new(&context, 0, 0)?;
    // They are about how Mitsuba finds intersections.
    query.ignore(&[
        "allow_thread_reordering",
        "compact_acceleration_structures",
        "embree_use_robust_intersections",
    ]);
    let children = query.children();
    let of = |kind| children.iter().filter(move |child| child.kind == kind);
    let mut integrators = of(Kind::Integrator);
    let integrator = match (integrators.next(), integrators.next()) {
        (None, _) => Integrator::default(),
        (Some(&one), None) => integrator::describe(query.enter(one)?)?,
        (_, Some(second)) => {
            return Err(second
                .property
                .place
                .error("a scene has at most one integrator"));
        }
    };
    let sensors = of(Kind::Sensor)
        .map(|&child| sensor::describe(query.enter(child)?))
        .collect::<Result<Vec<_>, _>>()?;
    if sensors.is_empty() {
        return Err(query.error("a scene needs a sensor"));
    }
    let mut shapes = Vec::new();
    for &child in of(Kind::Shape) {
        if document.objects[child.index].plugin != "shapegroup" {
            shapes.extend(shape::describe(query.enter(child)?)?);
        }
    }
    // Area lights and groups of shapes appear only where shapes refer to them.
    let mut emitters = Vec::new();
    let mut around = false;
    let is_area = |index: usize| document.objects[index].plugin == "area";
    for &child in of(Kind::Emitter).filter(|child| !is_area(child.index)) {
        let emitter = emitter::describe(query.enter(child)?)?;
        let is_around = matches!(
            emitter.source,
            Source::Constant { .. } | Source::EnvironmentMap { .. }
        );
        if is_around && around {
            return Err(child
                .property
                .place
                .error("a scene has at most one constant or envmap around it"));
        }
        around |= is_around;
        emitters.push(emitter);
    }
    if let Some(&stray) = of(Kind::Film)
        .chain(of(Kind::Sampler))
        .chain(of(Kind::Filter))
        .next()
    {
        return Err(query.stray(stray));
    }
    if let Some(child) = of(Kind::Integrator).next() {
        integrator.check(&document.objects[child.index].place, &shapes, &emitters)?;
    }
    let place = query.place().clone();
    query.finish()?;
    let reached = context.reached.borrow();
    let unused = children
        .iter()
        .filter(|child| !reached[child.index])
        .map(|child| child.property.place.clone())
        .collect();
    Ok(Description {
        integrator,
        sensors,
        shapes,
        emitters,
        unused,
        place,
    })
}
