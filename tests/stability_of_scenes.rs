//! Scenes that strain the numbers: every size and place, needles, tiny and bright lights, nearly smooth surfaces, nearly
//! equal indices of refraction, nothing absorbed, grazing views, faces in one plane, and where `f32` gives out.
//!
//! Two closed forms serve throughout. In a *furnace*, a closed room whose surfaces each emit what they do not reflect, the
//! radiance is 1 everywhere. In a *dark room*, closed, black outside its walls a bright sky, it is exactly 0: whatever comes in
//! leaks. Statistical tests have fixed seeds; the false-positive rate is stated with each.

#[path = "stability_of_scenes/lights.rs"]
mod lights;
#[path = "stability_of_scenes/limits.rs"]
mod limits;
#[path = "stability_of_scenes/placement.rs"]
mod placement;
#[path = "stability_of_scenes/surfaces.rs"]
mod surfaces;
#[path = "stability_of_scenes/walls.rs"]
mod walls;

use estimand::MonteCarlo;
use estimand::path::bsdf::{Bsdf, Lambertian};
use estimand::path::filter::BoxFilter;
use estimand::path::light::{AreaLights, Constant, Environment, Light, NoEnvironment, NoLight};
use estimand::path::sensor::{Pinhole, Sensor};
use estimand::path::shape::{Flat, cuboid};
use estimand::path::{Image, Object, Paths, Scene, View};

/// The two-sided probability of 4.4 standard errors is 1.1e-5.
const LIMIT: f64 = 4.4;

/// The mean over a picture and its standard error: pixels are independent of one another.
#[derive(Clone, Copy, Debug)]
struct Mean {
    mean: f64,
    std_error: f64,
}

impl Mean {
    fn of(picture: &Image) -> Self {
        assert!(
            picture.pixels().iter().all(|pixel| pixel.is_finite()),
            "a pixel is not finite"
        );
        let errors = picture.std_error().expect("Monte Carlo has an error");
        let variance: f64 = errors.pixels().iter().map(|error| error.x * error.x).sum();
        Self {
            mean: picture.mean().x,
            std_error: variance.sqrt() / picture.pixels().len() as f64,
        }
    }

    /// How many standard errors the mean is from what is expected, of which rounding takes 2e-5.
    fn off(self, expected: f64) -> f64 {
        (self.mean - expected) / self.std_error.hypot(2e-5 * expected)
    }
}

fn camera(origin: [f32; 3], target: [f32; 3]) -> Pinhole {
    Pinhole::look_at(origin, target, [0.0, 1.0, 0.0], 60.0, 1.0).unwrap()
}

fn view<B: Bsdf, L: Light, E: Environment, C: Sensor>(
    objects: Vec<Object<B>>,
    environment: E,
    sensor: C,
) -> View<B, L, E, C> {
    View {
        scene: Scene::new(objects, environment).unwrap(),
        sensor,
        filter: BoxFilter,
        paths: Paths::default(),
    }
}

fn picture<B: Bsdf, L: Light, E: Environment, C: Sensor>(
    view: &View<B, L, E, C>,
    count: u64,
) -> Image {
    view.render([16; 2], 1, |seed| MonteCarlo::new(count, seed))
        .unwrap()
}

/// What is seen of objects that emit, with nothing around them.
fn lit<B: Bsdf, C: Sensor>(objects: Vec<Object<B>>, sensor: C, count: u64) -> Mean {
    Mean::of(&picture(
        &view::<_, AreaLights, _, _>(objects, NoEnvironment, sensor),
        count,
    ))
}

/// What comes in of a sky with a radiance of a million.
fn leak<B: Bsdf>(objects: Vec<Object<B>>, sensor: Pinhole) -> f64 {
    let sky = Constant::new([1e6; 3]).unwrap();
    picture(&view::<_, NoLight, _, _>(objects, sky, sensor), 256)
        .mean()
        .x
}

fn grey(albedo: f32) -> Lambertian {
    Lambertian::new([albedo; 3]).unwrap()
}

/// The walls of the cube `[-1, 1]^3`, seen from inside.
fn room() -> [Flat; 6] {
    let edges = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    cuboid([0.0; 3], edges).unwrap().map(Flat::turned)
}

/// The same, half of whose radiance of 1 is emitted.
fn furnace_walls<B: From<Lambertian>>() -> Object<B> {
    Object::new(room(), grey(0.5)).emitting([0.5; 3]).unwrap()
}
