//! Scenes whose pictures have a closed form, for every point set and estimator, at every scale and place; and the
//! number of coordinates that paths draw.
//!
//! Statistical tests have fixed seeds; the false-positive rate is stated with each.

use estimand::hash::hash;
use estimand::path::bsdf::{Bsdf, Dielectric, Lambertian, Material, Mirror};
use estimand::path::light::{AreaLights, Constant, Environment, Light, NoEnvironment, NoLight};
use estimand::path::sensor::Pinhole;
use estimand::path::shape::{Flat, Sphere, cuboid};
use estimand::path::{Image, Object, Paths, Pixel, Scene, View, scenes};
use estimand::points::{
    DigitPermutation, DigitalShift, Halton, Hammersley, HashedOwen, Independent, LinearMatrix,
    NRooks, Owen, PointSet, Shifted, Sobol, Stratified, VanDerCorput,
};
use estimand::{Average, Estimator, Integrand, Moments, MonteCarlo, Replicated, Sampler};
use glam::{Mat3A, Vec3A};

const SPP: u64 = 64;

/// How many standard errors the mean over all pixels of the furnace, which are independent, is from 1.
fn furnace_z<T: Estimator>(estimator: impl Fn(u64) -> T + Sync) -> f64 {
    let picture = scenes::furnace().render([16; 2], 1, estimator).unwrap();
    let moments: Moments<f64> = picture.pixels().iter().map(|pixel| pixel.x).collect();
    (moments.mean() - 1.0) / moments.std_error().unwrap()
}

/// All randomised sets, by name.
fn sets(seed: u64) -> Vec<(&'static str, Box<dyn PointSet>)> {
    let (halton, sobol) = (Halton::new(16).unwrap(), Sobol::new(16).unwrap());
    let hammersley = || {
        let offset = estimand::hash::unit(hash(seed, 1));
        Hammersley::new(SPP, 16).unwrap().offset(offset).unwrap()
    };
    vec![
        ("independent", Box::new(Independent::new(seed))),
        (
            "stratified",
            Box::new(Stratified::new(SPP, 2, seed).unwrap()),
        ),
        (
            "stratified in four",
            Box::new(Stratified::new(SPP, 4, seed).unwrap()),
        ),
        ("n-rooks", Box::new(NRooks::new(SPP, seed).unwrap())),
        (
            "van der Corput shifted",
            Box::new(Shifted::new(VanDerCorput::new(2).unwrap(), seed)),
        ),
        (
            "Halton shifted",
            Box::new(Shifted::new(halton.clone(), seed)),
        ),
        (
            "Halton, digital shift",
            Box::new(halton.clone().scrambled(DigitalShift { seed })),
        ),
        (
            "Halton permuted",
            Box::new(halton.clone().scrambled(DigitPermutation { seed })),
        ),
        ("Halton, Owen", Box::new(halton.scrambled(Owen { seed }))),
        (
            "Hammersley permuted",
            Box::new(hammersley().scrambled(DigitPermutation { seed })),
        ),
        (
            "Hammersley, Owen",
            Box::new(hammersley().scrambled(Owen { seed })),
        ),
        ("Sobol shifted", Box::new(Shifted::new(sobol.clone(), seed))),
        (
            "Sobol, digital shift",
            Box::new(sobol.clone().scrambled(DigitalShift { seed })),
        ),
        (
            "Sobol, linear matrix",
            Box::new(sobol.clone().scrambled(LinearMatrix { seed })),
        ),
        (
            "Sobol, Owen",
            Box::new(sobol.clone().scrambled(Owen { seed })),
        ),
        (
            "Sobol, hashed Owen",
            Box::new(sobol.scrambled(HashedOwen { seed })),
        ),
    ]
}

/// 34 tests at 4.6 standard errors, the two-sided 4e-6: false-positive rate 1.5e-4 over all.
#[test]
fn a_furnace_is_uniform_with_every_set_and_estimator() {
    const LIMIT: f64 = 4.6;
    let z = furnace_z(|seed| MonteCarlo::new(SPP, seed));
    assert!(z.abs() < LIMIT, "Monte Carlo: {z}");
    for which in 0..sets(0).len() {
        let (name, _) = sets(0)[which];
        let set = |seed| sets(seed).swap_remove(which).1;
        let z = furnace_z(|seed| Average::new(Dynamic(set(seed)), SPP));
        assert!(z.abs() < LIMIT, "the average over {name}: {z}");
        let z = furnace_z(|key| Replicated::new(4, SPP, |seed| Dynamic(set(seed))).seed(key));
        assert!(z.abs() < LIMIT, "replicates of {name}: {z}");
    }
}

/// A boxed set as a set.
struct Dynamic(Box<dyn PointSet>);

impl PointSet for Dynamic {
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        self.0.coordinate(index, dimension)
    }
    fn size(&self) -> Option<u64> {
        self.0.size()
    }
    fn dimensions(&self) -> u32 {
        self.0.dimensions()
    }
    fn fill(&self, first: u64, dimensions: std::ops::Range<u32>, out: &mut [f64]) {
        self.0.fill(first, dimensions, out);
    }
}

fn camera(origin: [f32; 3], target: [f32; 3]) -> Pinhole {
    Pinhole::look_at(origin, target, [0.0, 1.0, 0.0], 30.0, 1.0).unwrap()
}

fn under_a_sky<B: Bsdf>(
    objects: Vec<Object<B>>,
    scale: f32,
) -> View<B, NoLight, Constant, Pinhole> {
    View {
        scene: Scene::new(objects, Constant::new([1.0, 0.5, 0.25]).unwrap()).unwrap(),
        sensor: camera([0.0, 0.0, -6.0 * scale], [0.0; 3]),
        paths: Paths::default(),
    }
}

/// A convex body under a constant sky is lit by the sky alone: its radiance is its albedo times the sky's, at every
/// point, and every single path finds that exactly.
#[test]
fn a_convex_body_reflects_the_sky() {
    for scale in [1e-4, 1.0, 1e4] {
        let ball = Sphere::new([0.0; 3], 2.5 * scale).unwrap();
        let view = under_a_sky(
            vec![Object::<Lambertian>::new(
                [ball],
                Lambertian::new([0.25; 3]).unwrap(),
            )],
            scale,
        );
        let picture = view
            .render([8; 2], 1, |seed| MonteCarlo::new(64, seed))
            .unwrap();
        for pixel in picture.pixels() {
            assert!((pixel.x - 0.25).abs() < 1e-7, "{pixel} at scale {scale}");
        }
        assert!(picture.std_error().unwrap().mean().x < 1e-7);
    }
}

/// A perfect mirror and a ball of glass that absorbs nothing show the sky wherever one looks, whatever way light takes
/// inside. The mirror is exact; for the glass, whose paths Russian roulette ends, 4.6 standard errors: 4e-6.
#[test]
fn mirror_and_glass_keep_all_light() {
    let ball = Sphere::new([0.0; 3], 2.5).unwrap();
    let mirror = Object::<Material>::new([ball], Mirror::new([1.0; 3]).unwrap());
    let picture = under_a_sky(vec![mirror], 1.0)
        .render([8; 2], 1, |seed| MonteCarlo::new(16, seed))
        .unwrap();
    assert!(
        picture
            .pixels()
            .iter()
            .all(|pixel| pixel.to_array() == [1.0, 0.5, 0.25])
    );

    for (inside, outside) in [(1.5, 1.0), (1.0, 1.5), (1.0 + 1e-6, 1.0), (1.0, 1.0)] {
        let glass = Dielectric::new(inside, outside).unwrap();
        let view = under_a_sky(vec![Object::<Material>::new([ball], glass)], 1.0);
        let picture = view
            .render([16; 2], 1, |seed| MonteCarlo::new(256, seed))
            .unwrap();
        let moments: Moments<f64> = picture.pixels().iter().map(|pixel| pixel.x).collect();
        let error = (moments.mean() - 1.0).abs();
        // Rounding of refracted directions and weights stays below 1e-6.
        let limit = 4.6 * moments.std_error().unwrap() + 1e-6;
        assert!(error < limit, "{inside} in {outside}: {error} >= {limit}");
    }
}

/// A scene is the same picture, whether it is of the size of an atom or of a planet, and wherever it is: as far as
/// `f32` tells its points apart.
fn moved(
    scale: f32,
    turn: Mat3A,
    shift: Vec3A,
) -> View<Lambertian, AreaLights, NoEnvironment, Pinhole> {
    let at = |point: [f32; 3]| (turn * (Vec3A::from(point) * scale) + shift).to_array();
    let along = |edge: [f32; 3]| (turn * (Vec3A::from(edge) * scale)).to_array();
    let halves = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(along);
    let room = cuboid(at([0.0; 3]), halves).unwrap().map(Flat::turned);
    let ball = Sphere::new(at([0.2, -0.3, 0.4]), 0.45 * scale).unwrap();
    let grey = Lambertian::new([0.5; 3]).unwrap();
    let objects = vec![
        Object::new(room, grey).emitting([0.5; 3]).unwrap(),
        Object::new([ball], grey).emitting([0.5; 3]).unwrap(),
    ];
    View {
        scene: Scene::new(objects, NoEnvironment).unwrap(),
        sensor: Pinhole::look_at(
            at([-0.6, 0.5, -0.9]),
            at([0.2, -0.2, 0.4]),
            along([0.0, 1.0, 0.0]),
            60.0,
            1.0,
        )
        .unwrap(),
        paths: Paths::default(),
    }
}

/// Scales, turns and places to try.
fn placements() -> Vec<(f32, Mat3A, Vec3A)> {
    let turned = Mat3A::from_rotation_y(0.7) * Mat3A::from_rotation_x(0.4);
    let mut placements = Vec::new();
    for turn in [Mat3A::IDENTITY, turned] {
        for scale in [1e-10, 1e-4, 1.0, 1e4, 1e10] {
            placements.push((scale, turn, Vec3A::ZERO));
        }
        for shift in [10.0, 1000.0, 1e4] {
            placements.push((1.0, turn, Vec3A::new(shift, -shift, 0.5 * shift)));
        }
    }
    placements
}

/// 16 tests at 4.4 standard errors, the two-sided 1.1e-5: false-positive rate 1.8e-4 over all.
#[test]
fn a_furnace_is_uniform_at_every_scale_and_place() {
    for (scale, turn, shift) in placements() {
        let view = moved(scale, turn, shift);
        let picture = view
            .render([32; 2], 1, |seed| MonteCarlo::new(64, seed))
            .unwrap();
        let moments: Moments<f64> = picture.pixels().iter().map(|pixel| pixel.x).collect();
        let z = (moments.mean() - 1.0) / moments.std_error().unwrap();
        assert!(z.abs() < 4.4, "scale {scale}, shift {shift}: {z}");
    }
}

/// The walls of the cube `[-1, 1]^3`, each of `cells` by `cells` squares of two triangles, so that every edge is a seam.
fn triangles(cells: u8, at: impl Fn([f32; 3]) -> [f32; 3]) -> Vec<Flat> {
    let mut triangles = Vec::new();
    let line = |cell| 2.0 * f32::from(cell) / f32::from(cells) - 1.0;
    for side in 0..6 {
        for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
            let corner = |i, j| {
                let mut point = [0.0; 3];
                point[side % 3] = if side < 3 { -1.0 } else { 1.0 };
                point[(side + 1) % 3] = line(i);
                point[(side + 2) % 3] = line(j);
                at(point)
            };
            let [a, b] = [corner(i, j), corner(i + 1, j)];
            let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
            triangles.push(Flat::triangle([a, b, c]).unwrap());
            triangles.push(Flat::triangle([a, c, d]).unwrap());
        }
    }
    triangles
}

/// Nothing of a bright sky comes into a closed room, through no edge and no corner: with walls of twelve triangles,
/// which are swept, and of 300, which are in a tree.
#[test]
fn a_closed_room_stays_dark() {
    for cells in [1, 5] {
        for (scale, turn, shift) in placements() {
            let at = |point: [f32; 3]| (turn * (Vec3A::from(point) * scale) + shift).to_array();
            let walls = Lambertian::new([0.9; 3]).unwrap();
            let room = Object::<Lambertian>::new(triangles(cells, at), walls);
            let sensor = Pinhole::look_at(
                at([0.1, 0.2, 0.3]),
                at([0.5, 0.4, 0.9]),
                [0.0, 1.0, 0.0],
                120.0,
                1.0,
            );
            let view = View::<_, NoLight, _, _> {
                scene: Scene::new(vec![room], Constant::new([1e6; 3]).unwrap()).unwrap(),
                sensor: sensor.unwrap(),
                paths: Paths::default(),
            };
            let picture = view
                .render([32; 2], 1, |seed| MonteCarlo::new(128, seed))
                .unwrap();
            let light = picture.mean().x;
            assert_eq!(
                light, 0.0,
                "{cells} cells, scale {scale}, turn {turn}, shift {shift}"
            );
        }
    }
}

/// The light that a point of a floor gets from a parallel square above it: the form factor of a rectangle over one of its
/// corners (Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, C-12), four times. 4.6
/// standard errors: 4e-6.
#[test]
fn a_square_light_has_its_form_factor() {
    let floor = Flat::parallelogram([-9.0, 0.0, -9.0], [0.0, 0.0, 18.0], [18.0, 0.0, 0.0]).unwrap();
    for triangles in [false, true] {
        let light = if triangles {
            let [a, b, c, d] = [
                [-1.0, 2.0, -1.0],
                [1.0, 2.0, -1.0],
                [1.0, 2.0, 1.0],
                [-1.0, 2.0, 1.0],
            ];
            vec![
                Flat::triangle([a, b, c]).unwrap(),
                Flat::triangle([a, c, d]).unwrap(),
            ]
        } else {
            vec![Flat::parallelogram([-1.0, 2.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]).unwrap()]
        };
        let objects = vec![
            Object::<Lambertian>::new([floor], Lambertian::new([0.5; 3]).unwrap()),
            Object::new(light, Lambertian::new([0.0; 3]).unwrap())
                .emitting([3.0; 3])
                .unwrap(),
        ];
        let view = View::<_, AreaLights, _, _> {
            scene: Scene::new(objects, NoEnvironment).unwrap(),
            sensor: Pinhole::look_at([5.0, 1.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0], 1e-4, 1.0)
                .unwrap(),
            paths: Paths::default(),
        };
        let pixel = Pixel {
            scene: &view.scene,
            sensor: &view.sensor,
            paths: view.paths,
            position: [0, 0],
            size: [1, 1],
        };
        let estimate = MonteCarlo::new(100_000, 1).estimate(&pixel).unwrap();
        let x = 0.5_f64; // Half the edge over the height.
        let root = (1.0 + x * x).sqrt();
        let corner = 2.0 * (x / root * (x / root).atan()) / std::f64::consts::TAU;
        let expected = 0.5 * 3.0 * 4.0 * corner;
        let z = (estimate.mean.x - expected) / estimate.std_error.unwrap().x;
        assert!(z.abs() < 4.6, "{} against {expected}: {z}", estimate.mean.x);
    }
}

/// Counts what is read from a stream of independent coordinates.
struct Counting(u64, u64);

impl Sampler for Counting {
    fn next_1d(&mut self) -> f64 {
        self.1 += 1;
        estimand::hash::unit(hash(self.0, self.1))
    }
}

/// How many coordinates each of a thousand paths of at most `segments` segments draws.
fn counts<B: Bsdf, L: Light, E: Environment>(
    view: &View<B, L, E, Pinhole>,
    segments: u32,
) -> Vec<u64> {
    let pixel = Pixel {
        scene: &view.scene,
        sensor: &view.sensor,
        paths: view.paths.longest(segments).unwrap(),
        position: [0, 0],
        size: [1, 1],
    };
    (0..1000)
        .map(|path| {
            let mut u = Counting(path, 0);
            pixel.evaluate(&mut u);
            u.1
        })
        .collect()
}

#[test]
fn absent_parts_draw_no_coordinates() {
    let grey = Lambertian::new([0.5; 3]).unwrap();
    let room = || {
        cuboid(
            [0.0; 3],
            [[9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]],
        )
        .unwrap()
    };
    let ball = Sphere::new([0.0; 3], 2.5).unwrap();
    let closed = || {
        vec![
            Object::<Lambertian>::new(room(), grey),
            Object::new([ball], grey),
        ]
    };
    // In a closed room every path has all its segments. Film: 2. With lights: 2 and 2 for every surface but the last;
    // without: 2.
    let lit = {
        let mut objects = closed();
        objects[0] = Object::new(room().map(Flat::turned), grey)
            .emitting([1.0; 3])
            .unwrap();
        View::<_, AreaLights, _, _> {
            scene: Scene::new(objects, NoEnvironment).unwrap(),
            sensor: camera([0.0, 0.0, -6.0], [0.0; 3]),
            paths: Paths::default(),
        }
    };
    let dark = under_a_sky(closed(), 1.0);
    for segments in 1..=5 {
        let surfaces = u64::from(segments) - 1;
        assert!(
            counts(&lit, segments)
                .iter()
                .all(|&count| count == 2 + 4 * surfaces)
        );
        assert!(
            counts(&dark, segments)
                .iter()
                .all(|&count| count == 2 + 2 * surfaces)
        );
    }
    // One for Russian roulette after the fifth segment.
    assert!(counts(&dark, 6).iter().all(|&count| count == 2 + 2 * 5 + 1));
    // A mirror draws none, glass one at every surface; neither asks for lights.
    let mirror = Object::<Material>::new([ball], Mirror::new([1.0; 3]).unwrap());
    assert!(
        counts(&under_a_sky(vec![mirror], 1.0), 4)
            .iter()
            .all(|&count| count == 2)
    );
    let glass = Object::<Material>::new([ball], Dielectric::new(1.5, 1.0).unwrap());
    let glass = counts(&under_a_sky(vec![glass], 1.0), 4);
    assert!(
        glass.iter().all(|count| (3..=5).contains(count)),
        "{glass:?}"
    );
}

#[test]
fn parts_must_fit_their_types() {
    let ball = || {
        Object::<Lambertian>::new(
            [Sphere::new([0.0; 3], 1.0).unwrap()],
            Lambertian::new([0.5; 3]).unwrap(),
        )
    };
    let lamp = || ball().emitting([1.0; 3]).unwrap();
    let refused = |result: Result<(), estimand::Error>| result.unwrap_err().to_string();
    let dark = Scene::<_, AreaLights, _>::new(vec![ball()], NoEnvironment).map(drop);
    assert!(refused(dark).contains("power of all lights"));
    let bright = Scene::<_, NoLight, _>::new(vec![lamp()], NoEnvironment).map(drop);
    assert!(refused(bright).contains("number of emitters must be 0"));
    assert!(refused(Lambertian::new([0.5, f32::NAN, 0.5]).map(drop)).contains("NaN"));
    assert!(Sphere::new([0.0; 3], -1.0).is_err());
    assert!(Sphere::new([f32::INFINITY, 0.0, 0.0], 1.0).is_err());
    assert!(Flat::triangle([[0.0; 3], [1.0; 3], [2.0; 3]]).is_err());
    assert!(Flat::parallelogram([0.0; 3], [f32::NAN; 3], [1.0; 3]).is_err());
    assert!(Dielectric::new(0.0, 1.0).is_err());
    assert!(ball().emitting([-1.0; 3]).is_err());
    assert!(Pinhole::look_at([0.0; 3], [0.0; 3], [0.0, 1.0, 0.0], 40.0, 1.0).is_err());
    assert!(Paths::default().longest(0).is_err());
    let nothing = Scene::<Lambertian, NoLight, _>::new(Vec::new(), NoEnvironment);
    let view = View {
        scene: nothing.unwrap(),
        sensor: camera([1.0; 3], [0.0; 3]),
        paths: Paths::default(),
    };
    let picture: Image = view
        .render([2, 3], 1, |seed| MonteCarlo::new(2, seed))
        .unwrap();
    assert_eq!((picture.height(), picture.mean().x), (3, 0.0));
}

/// Also without the feature `parallel`: the bits are those of one thread there.
#[cfg(feature = "parallel")]
#[test]
fn a_picture_has_the_same_bits_with_any_number_of_threads() {
    let picture = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            scenes::cornell_box()
                .render([16; 2], seed, |seed| MonteCarlo::new(32, seed))
                .unwrap()
        })
    };
    let one = picture(1, 7);
    assert_eq!(one, picture(2, 7));
    assert_eq!(one, picture(5, 7));
    assert_ne!(one, picture(1, 8));
}

#[test]
fn a_picture_that_is_stopped_keeps_its_rows() {
    let view = scenes::cornell_box();
    let plain = |seed| MonteCarlo::new(4, seed);
    let whole = view.render([8; 2], 1, plain).unwrap();
    let part = view.render_while([8; 2], 1, plain, |row| row < 5).unwrap();
    let (kept, left_out) = part.pixels().split_at(5 * 8);
    assert_eq!(kept, &whole.pixels()[..5 * 8]);
    assert!(left_out.iter().all(|pixel| *pixel == glam::DVec3::ZERO));
}
