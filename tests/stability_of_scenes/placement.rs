//! The same room in every size and place.

use glam::{Mat3A, Vec3A};

use super::*;
use estimand::path::bsdf::{
    Conductor, Dielectric, Distribution, Material, RoughConductor, Roughness,
};
use estimand::path::shape::{Cylinder, Disk, Mesh, Sphere};
use estimand::path::texture::Uniform;

/// Where a scene is.
#[derive(Clone, Copy, Debug)]
struct Placement {
    scale: f32,
    turn: Mat3A,
    shift: Vec3A,
}

impl Placement {
    const ORIGINAL: Self = Self {
        scale: 1.0,
        turn: Mat3A::IDENTITY,
        shift: Vec3A::ZERO,
    };

    fn at(&self, point: [f32; 3]) -> [f32; 3] {
        (self.turn * (Vec3A::from(point) * self.scale) + self.shift).to_array()
    }

    fn along(&self, edge: [f32; 3]) -> [f32; 3] {
        (self.turn * (Vec3A::from(edge) * self.scale)).to_array()
    }

    fn flat(&self, corner: [f32; 3], first: [f32; 3], second: [f32; 3]) -> Flat {
        Flat::parallelogram(self.at(corner), self.along(first), self.along(second)).unwrap()
    }
}

/// A room with something of everything: coloured walls, a lamp below the ceiling and a ball that shines, a mesh, a disk, a
/// cylinder, glass, and a rough metal.
fn uneven(place: Placement) -> View<Material<Uniform>, AreaLights, NoEnvironment, Pinhole> {
    let [x, y, z] = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    let law = |color: [f32; 3]| Lambertian::new(color).unwrap();
    let low = [-1.0; 3];
    let white = [
        place.flat(low, z, x),
        place.flat([-1.0, 1.0, -1.0], x, z),
        place.flat([-1.0, -1.0, 1.0], y, x),
        place.flat(low, x, y),
    ];
    let lamp = place.flat([-0.3, 0.9, -0.2], [0.6, 0.0, 0.0], [0.0, 0.0, 0.5]);
    let corners = [
        [-0.8, -1.0, 0.2],
        [-0.2, -1.0, 0.4],
        [-0.6, -1.0, 0.8],
        [-0.5, -0.1, 0.5],
    ];
    let tent = Mesh::new(
        corners.map(|corner| place.at(corner)).to_vec(),
        vec![[0, 3, 1], [1, 3, 2], [2, 3, 0]],
    );
    let ball = |center, radius: f32| Sphere::new(place.at(center), radius * place.scale).unwrap();
    let post = Cylinder::new(
        place.at([0.7, -1.0, 0.6]),
        place.at([0.7, 0.4, 0.6]),
        0.12 * place.scale,
    );
    let table = Disk::new(
        place.at([0.3, -0.4, 0.2]),
        place.along([0.0, 0.0, 0.3]),
        place.along([0.3, 0.0, 0.0]),
    );
    let metal = Conductor::new(Uniform::from(0.2), Uniform::from(3.0)).unwrap();
    let brushed = Roughness::new(Distribution::Ggx, Uniform::from(0.2)).unwrap();
    let objects = vec![
        Object::new(white, law([0.7; 3])),
        Object::new([place.flat(low, y, z)], law([0.6, 0.1, 0.1])),
        Object::new([place.flat([1.0, -1.0, -1.0], z, y)], law([0.1, 0.5, 0.1])),
        Object::new([lamp], law([0.2; 3]))
            .emitting([4.0; 3])
            .unwrap(),
        Object::new([ball([-0.7, -0.8, -0.2], 0.15)], law([0.5; 3]))
            .emitting([2.0; 3])
            .unwrap(),
        Object::mesh(tent.unwrap(), law([0.3, 0.4, 0.8])),
        Object::new([post.unwrap()], law([0.6; 3])),
        Object::new([table.unwrap()], law([0.8, 0.6, 0.2])),
        Object::new(
            [ball([0.4, -0.7, -0.3], 0.28)],
            Dielectric::new(1.5, 1.0).unwrap(),
        ),
        Object::new(
            [ball([-0.2, -0.75, -0.1], 0.22)],
            RoughConductor::new(metal, brushed),
        ),
    ];
    let sensor = Pinhole::look_at(
        place.at([0.1, 0.1, -0.95]),
        place.at([0.0, -0.3, 0.5]),
        place.along([0.0, 1.0, 0.0]),
        80.0,
        1.0,
    );
    view(objects, NoEnvironment, sensor.unwrap())
}

/// Powers of two change no digit: every pixel has the same bits, at a ten-thousandth and at ten thousand times the
/// size.
#[test]
fn powers_of_two_in_size_change_no_bit() {
    let original = picture(&uneven(Placement::ORIGINAL), 16);
    for scale in [2.0_f32.powi(-14), 2.0_f32.powi(14)] {
        let place = Placement {
            scale,
            ..Placement::ORIGINAL
        };
        assert_eq!(picture(&uneven(place), 16).pixels(), original.pixels());
    }
}

/// The whole picture and each of 16 parts of it, in 9 placements: 153 tests at the two-sided probability 1.1e-5 of
/// 4.4 standard errors, false-positive rate 1.7e-3.
#[test]
fn an_uneven_room_is_the_same_in_every_size_and_place() {
    const COUNT: u64 = 1024;
    let original = picture(&uneven(Placement::ORIGINAL), COUNT);
    let turned = Mat3A::from_rotation_y(0.7) * Mat3A::from_rotation_x(0.4);
    let mut places = Vec::new();
    for scale in [1e-4, 1.0, 1e4] {
        places.push(Placement {
            scale,
            turn: turned,
            shift: Vec3A::ZERO,
        });
    }
    for turn in [Mat3A::IDENTITY, turned] {
        for shift in [
            Vec3A::new(1e4, 0.0, 0.0),
            Vec3A::new(0.0, -1e4, 0.0),
            Vec3A::new(1e4, -1e4, 1e4),
        ] {
            places.push(Placement {
                scale: 1.0,
                turn,
                shift,
            });
        }
    }
    for place in places {
        let moved = uneven(place)
            .render([16; 2], 2, |seed| MonteCarlo::new(COUNT, seed))
            .unwrap();
        assert!(moved.pixels().iter().all(|pixel| pixel.is_finite()));
        let [old, new] = [&original, &moved].map(parts);
        for (part, (old, new)) in old.iter().zip(&new).enumerate() {
            let z = (old.mean - new.mean) / old.std_error.hypot(new.std_error);
            assert!(z.abs() < LIMIT, "{place:?}, part {part}: {old:?} {new:?}");
        }
    }
}

/// The whole picture and its 4 x 4 parts.
fn parts(picture: &Image) -> Vec<Mean> {
    let errors = picture.std_error().unwrap();
    let mut parts = vec![Mean::of(picture)];
    for part in 0..16 {
        let (mut sum, mut variance) = (0.0, 0.0);
        for pixel in 0..256 {
            let (x, y) = (pixel % 16, pixel / 16);
            if x / 4 + y / 4 * 4 == part {
                sum += picture.pixels()[pixel].x;
                variance += errors.pixels()[pixel].x.powi(2);
            }
        }
        parts.push(Mean {
            mean: sum / 16.0,
            std_error: variance.sqrt() / 16.0,
        });
    }
    parts
}
