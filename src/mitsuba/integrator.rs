//! Integrators: which paths of light count.

use super::document::Kind;
use super::error::SceneError;
use super::query::Query;

/// Which paths of light count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Integrator {
    /// The most segments of a path, the one from the camera included; `None` for no limit. Of `direct` it is 2.
    pub max_depth: Option<u32>,
    /// From which segment on Russian roulette may end a path.
    pub rr_depth: u32,
    /// Whether the camera sees through what emits light.
    pub hide_emitters: bool,
    /// How light is found.
    pub techniques: Techniques,
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
            techniques: Techniques::Both,
        }
    }
}

pub(super) fn describe(mut query: Query<'_>) -> Result<Integrator, SceneError> {
    // They are about how Mitsuba runs.
    query.ignore(&["timeout", "block_size", "samples_per_pass"]);
    let hide_emitters = query.flag("hide_emitters", false)?;
    let integrator = match query.plugin() {
        "path" => path(&mut query, hide_emitters)?,
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
        _ => return Err(query.unsupported("there are path, direct and moment")),
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
        techniques: Techniques::Both,
    })
}
