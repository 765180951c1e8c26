//! Integrators: which paths of light count.

use super::bsdf::Bsdf;
use super::document::Kind;
use super::emitter::{Emitter, Source};
use super::error::{Place, SceneError};
use super::query::Query;
use super::shape::Shape;

/// Which paths of light count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Integrator {
    /// The most segments of a path, the one from the camera included; `None` for no limit. Of `direct` it is 2.
    pub max_depth: Option<u32>,
    /// From which segment on Russian roulette may end a path.
    pub rr_depth: u32,
    /// Whether the camera sees through what emits light.
    pub hide_emitters: bool,
    /// Whether it then sees what is around through surfaces that light passes straight through, as in `direct`.
    pub hides_in_front_alone: bool,
    /// How light is found.
    pub techniques: Techniques,
    /// Whether surfaces count that light passes straight through, and lights that are drawn behind them are hidden: not in `volpath`, which is the same as `path` otherwise where
    /// there are no media.
    pub counts_passages: bool,
}

/// How light is found. One technique alone misses what the other alone can find.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Techniques {
    /// Both by its sources and by what surfaces reflect.
    #[default]
    Both,
    /// By its sources alone: `direct` without `bsdf_samples`.
    Emitters,
    /// By what surfaces reflect alone: `direct` without `emitter_samples`.
    Bsdfs,
}

impl Default for Integrator {
    fn default() -> Self {
        Self {
            max_depth: None,
            rr_depth: 5,
            hide_emitters: false,
            hides_in_front_alone: false,
            techniques: Techniques::Both,
            counts_passages: true,
        }
    }
}

impl Integrator {
    /// That its techniques find the light of a scene. `place` is where it stands.
    pub(super) fn check(
        &self,
        place: &Place,
        shapes: &[Shape],
        emitters: &[Emitter],
    ) -> Result<(), SceneError> {
        let is_point = |emitter: &Emitter| {
            !matches!(
                emitter.source,
                Source::Constant { .. } | Source::EnvironmentMap { .. }
            )
        };
        let passes = |shape: &Shape| {
            let is = |bsdf: &Bsdf| {
                matches!(
                    bsdf,
                    Bsdf::Null | Bsdf::Mask { .. } | Bsdf::ThinDielectric(_)
                )
            };
            shape.bsdf.any(&is)
        };
        let heeded =
            self.max_depth.is_some() || self.hide_emitters || emitters.iter().any(is_point);
        if !self.counts_passages && heeded && shapes.iter().any(passes) {
            return Err(place.error(
                "without media volpath is path, but for passages through null, mask and thindielectric: it does not count them, draws \
                 lights through them, and hides emitters behind them; use path",
            ));
        }
        match self.techniques {
            Techniques::Bsdfs if emitters.iter().any(is_point) => Err(place.error(
                "without `emitter_samples` lights without size would be missed; leave them at 1",
            )),
            Techniques::Emitters if shapes.iter().any(|shape| is_delta(&shape.bsdf)) => Err(place
                .error("without `bsdf_samples` mirrors and glass would be black; leave them at 1")),
            _ => Ok(()),
        }
    }
}

/// Whether some of the light goes to single directions.
fn is_delta(bsdf: &Bsdf) -> bool {
    bsdf.any(&|bsdf| {
        matches!(
            bsdf,
            Bsdf::Conductor(_)
                | Bsdf::Dielectric(_)
                | Bsdf::ThinDielectric(_)
                | Bsdf::Plastic(_)
                | Bsdf::Mask { .. }
                | Bsdf::Null
        )
    })
}

pub(super) fn describe(mut query: Query<'_>) -> Result<Integrator, SceneError> {
    // They are about how Mitsuba runs.
    query.ignore(&["timeout", "block_size", "samples_per_pass"]);
    let hide_emitters = query.flag("hide_emitters", false)?;
    let integrator = match query.plugin() {
        // What a particle tracer finds from the other end are the same paths.
        "path" | "ptracer" => path(&mut query, hide_emitters)?,
        "volpath" | "volpathmis" => Integrator {
            counts_passages: false,
            ..path(&mut query, hide_emitters)?
        },
        "direct" => {
            let both: u32 = query.count("shading_samples", 1)?;
            let emitter = query.count("emitter_samples", both)?;
            let bsdf = query.count("bsdf_samples", both)?;
            let techniques = match (emitter, bsdf) {
                (0, 0) => return Err(query.error("without samples nothing is seen")),
                (0, _) => Techniques::Bsdfs,
                (_, 0) => Techniques::Emitters,
                _ => Techniques::Both,
            };
            Integrator {
                max_depth: Some(2),
                hide_emitters,
                hides_in_front_alone: true,
                techniques,
                ..Integrator::default()
            }
        }
        "moment" => {
            let [nested] = query.children_of(Kind::Integrator)?[..] else {
                return Err(query.error("it has exactly one integrator"));
            };
            describe(query.enter(nested)?)?
        }
        _ => return Err(query.unsupported("there are path, direct and moment; ptracer, volpath and volpathmis are rendered as path")),
    };
    query.finish()?;
    Ok(integrator)
}

fn path(query: &mut Query<'_>, hide_emitters: bool) -> Result<Integrator, SceneError> {
    let max_depth = match query.optional_integer("max_depth")? {
        None | Some(-1) => None,
        Some(depth) => Some(u32::try_from(depth).map_err(|_| {
            query.error(format_args!(
                "`max_depth` must be -1, for no limit, or more; it is {depth}"
            ))
        })?),
    };
    let rr_depth = query.count("rr_depth", 5)?;
    if rr_depth == 0 {
        return Err(query.error("`rr_depth` must be at least 1; it is 0"));
    }
    Ok(Integrator {
        max_depth,
        rr_depth,
        hide_emitters,
        ..Integrator::default()
    })
}
