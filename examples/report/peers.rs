//! Other programs, measured in the same run: scipy, vegas and Mitsuba, by a script under `reference/`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use estimand::convergence::{Curve, Run, Trial};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::Failure;
use crate::boxes::Room;
use crate::effort::Effort;
use crate::scalars::Kind;
use crate::setup::threads;

/// The other programs that are there.
pub(crate) struct Peers {
    python: Option<PathBuf>,
    /// What there is, with versions; or why there is nothing.
    description: String,
    names: Vec<String>,
}

/// One run as the script reports it.
#[derive(Deserialize)]
struct Reported {
    method: String,
    count: u64,
    evaluations: u64,
    seconds: f64,
    squared_error: f64,
    squared_claim: Option<f64>,
    covered: Option<f64>,
}

impl Peers {
    /// No other program, and why.
    pub(crate) fn none(why: &str) -> Self {
        Self {
            python: None,
            description: format!("left out: {why}"),
            names: Vec::new(),
        }
    }

    /// Those that the given Python has, or `python3` if none is given.
    ///
    /// # Errors
    ///
    /// If the given one has none of them.
    pub(crate) fn find(given: Option<&Path>) -> Result<Self, Failure> {
        let python = given.unwrap_or(Path::new("python3"));
        match ask(python, &json!({ "task": "versions" })) {
            Ok(answer) => {
                let names: Vec<String> = serde_json::from_value(answer)?;
                if !names.is_empty() {
                    return Ok(Self {
                        python: Some(python.to_owned()),
                        description: names.join(", "),
                        names,
                    });
                }
                if given.is_some() {
                    let python = python.display();
                    return Err(format!("{python} has neither scipy, vegas nor Mitsuba").into());
                }
            }
            Err(error) if given.is_some() => return Err(error),
            Err(_) => {}
        }
        Ok(Self::none(
            "no Python with scipy, vegas or Mitsuba was found; `--python PATH` names one",
        ))
    }

    pub(crate) fn description(&self) -> String {
        self.description.clone()
    }

    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// The curves of scipy and vegas for an integrand.
    pub(crate) fn scalars(
        &self,
        kind: &Kind,
        effort: &Effort,
        seed: u64,
    ) -> Result<Vec<Curve>, Failure> {
        let problem = &kind.problem;
        let task = json!({
            "task": "integral", "family": problem.family.to_string(), "dims": problem.dims, "a": problem.a, "u": problem.u,
            "width": problem.width, "truth": problem.integral(), "powers": effort.powers,
            "seeds": effort.seeds.min(8), "seed": seed, "shortest": effort.shortest,
        });
        self.curves(&task, 0.0)
    }

    /// The curves of Mitsuba for a picture, whose reference is in `file`.
    pub(crate) fn pictures(
        &self,
        of: &Room,
        file: &Path,
        effort: &Effort,
        seed: u64,
        noise: f64,
    ) -> Result<Vec<Curve>, Failure> {
        let spp: Vec<u64> = effort.spp().collect();
        let task = json!({
            "task": "picture", "scene": of.scene, "depth": of.depth, "reference": file, "size": effort.small, "spp": spp,
            "seeds": effort.picture_seeds, "seed": seed, "threads": threads(),
        });
        self.curves(&task, noise)
    }

    fn curves(&self, task: &Value, noise: f64) -> Result<Vec<Curve>, Failure> {
        let Some(python) = &self.python else {
            return Ok(Vec::new());
        };
        let reported: Vec<Reported> = serde_json::from_value(ask(python, task)?)?;
        let mut methods: Vec<&str> = Vec::new();
        for run in &reported {
            if !methods.contains(&run.method.as_str()) {
                methods.push(&run.method);
            }
        }
        let curve = |method: &&str| {
            let runs = reported.iter().filter(|run| run.method == *method);
            Curve::of_runs(*method, runs.map(Reported::run), noise)
        };
        Ok(methods.iter().map(curve).collect::<Result<_, _>>()?)
    }
}

impl Reported {
    fn run(&self) -> Run {
        Run {
            count: self.count,
            trial: Trial {
                evaluations: self.evaluations,
                squared_error: self.squared_error,
                squared_claim: self.squared_claim,
                covered: self.covered,
            },
            seconds: self.seconds,
        }
    }
}

/// Gives the script a task and reads its answer, both as JSON.
fn ask(python: &Path, task: &Value) -> Result<Value, Failure> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/peers.py");
    let mut child = Command::new(python)
        .arg(&script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("{}: {error}", python.display()))?;
    if let Some(mut input) = child.stdin.take() {
        input.write_all(task.to_string().as_bytes())?;
    }
    let output = child.wait_with_output()?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.lines().last().unwrap_or("no message");
        return Err(format!("{}: {}: {last}", python.display(), script.display()).into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}
