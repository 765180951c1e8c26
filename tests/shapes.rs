//! Shapes by themselves, meshes and instances beside the same shapes put together by hand.
//!
//! Rays are those of fixed point sets; nothing here is statistical.

#[path = "shapes/near.rs"]
mod near;

use approx::assert_relative_eq;
use core::f32::consts::{PI, TAU};
use estimand::path::bsdf::{Dielectric, Lambertian, Mask, Material, Mirror, Null, ThinDielectric};
use estimand::path::filter::BoxFilter;
use estimand::path::light::{AreaLights, Constant, NoEnvironment, NoLight};
use estimand::path::sensor::Pinhole;
use estimand::path::shape::{Cylinder, Disk, Flat, Mesh, Primitive, Shape, Sphere, cuboid};
use estimand::path::texture::{Bitmap, Filter, Texture, Uniform};
use estimand::path::{Instances, Object, Paths, Ray, Scene, Segment, Surface, View};
use estimand::points::{HashedOwen, PointSet, Sobol};
use estimand::{Average, Estimator, Sampler};
use glam::{Affine3A, Mat3A, Quat, Vec2, Vec3, Vec3A};

#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn singles<const N: usize>(index: u64) -> [f32; N] {
    let points = Sobol::new(8).unwrap().scrambled(HashedOwen { seed: 7 });
    let mut u = points.point(index);
    core::array::from_fn(|_| (u.next_1d() as f32).min(1.0 - f32::EPSILON / 2.0))
}

fn shapes() -> Vec<Primitive> {
    let cylinder = Cylinder::new([0.1, -0.4, 0.2], [0.5, 0.7, -0.3], 0.3).unwrap();
    let sphere = Sphere::new([0.2, -0.1, 0.3], 0.5).unwrap();
    let turned = sphere
        .with_axes(Vec3A::new(1.0, 2.0, 0.0), Vec3A::new(0.3, -0.4, 0.8))
        .unwrap();
    let triangle = Flat::triangle([[0.0, 0.1, 0.2], [0.9, 0.3, 0.0], [0.2, 0.8, -0.4]]).unwrap();
    let disk = Disk::new([0.1, 0.2, 0.3], [0.4, 0.1, 0.0], [0.0, 0.3, 0.5]).unwrap();
    vec![
        triangle.into(),
        triangle.turned().into(),
        Flat::parallelogram([0.0; 3], [0.7, 0.2, 0.1], [-0.2, 0.6, 0.3])
            .unwrap()
            .into(),
        sphere.into(),
        turned.into(),
        turned.turned().into(),
        disk.into(),
        disk.turned().into(),
        cylinder.into(),
        cylinder.turned().into(),
    ]
}

#[test]
fn drawn_points_are_hit_from_outside() {
    for shape in shapes() {
        let [low, high] = shape.bounds();
        for index in 0..2000 {
            let [a, b, c, d] = singles(index);
            let from = Vec3A::new(a - 0.5, b - 0.5, c - 0.5) * 6.0;
            let surface = shape.sample(from, [c, d]);
            assert!(
                surface.point.cmpge(low - 1e-5).all() && surface.point.cmple(high + 1e-5).all()
            );
            assert_relative_eq!(surface.normal.length(), 1.0, epsilon = 1e-5);
            let way = surface.point - from;
            let ray = Ray {
                origin: from,
                direction: way.normalize(),
            };
            let Some(distance) = shape.intersect(&ray, f32::INFINITY) else {
                // Edge on, or at the very edge.
                assert!(
                    ray.direction.dot(surface.normal).abs() < 2e-2,
                    "{shape:?} {index}"
                );
                continue;
            };
            assert!(
                distance <= way.length() * (1.0 + 1e-3) + 1e-3,
                "{shape:?} {index}"
            );
            let hit = shape.surface(&ray, distance);
            assert!(
                (hit.point - ray.at(distance)).length() < 1e-3,
                "{shape:?} {index}"
            );
            // Of a convex body the drawn point may lie behind the one that is hit.
            if (hit.point - surface.point).length() < 1e-3 {
                assert!(hit.normal.dot(surface.normal) > 0.99);
            }
        }
    }
}

#[test]
fn drawing_by_area_has_the_density_of_area() {
    // Mean of the area over what the density says of it, at a point where all of the surface is in view: exactly 1.
    for shape in shapes() {
        if matches!(shape, Primitive::Sphere(_)) {
            continue;
        }
        let from = Vec3A::new(3.0, -2.0, 4.0);
        for index in 0..100 {
            let [a, b] = singles(index);
            let surface = shape.sample(from, [a, b]);
            let offset = surface.point - from;
            let cosine = (surface.normal.dot(offset) / offset.length()).abs();
            let density = shape.density(from, &surface);
            let area = offset.length_squared() / (cosine * density);
            assert_relative_eq!(area, shape.area(), max_relative = 1e-3);
        }
    }
    let disk = Disk::new([0.0; 3], [2.0, 0.0, 0.0], [0.0, 0.5, 0.0]).unwrap();
    assert_relative_eq!(disk.area(), PI, max_relative = 1e-6);
    let cylinder = Cylinder::new([0.0; 3], [0.0, 0.0, 3.0], 0.5).unwrap();
    assert_relative_eq!(cylinder.area(), TAU * 1.5, max_relative = 1e-6);
}

#[test]
fn the_tangents_are_the_derivatives_of_the_point() {
    let step = 3e-3;
    for shape in shapes() {
        for index in 0..200 {
            let [a, b] = singles(index);
            let from = Vec3A::new(3.0, -2.0, 4.0);
            let here = shape.sample(from, [a, b]);
            let shading = shape.shading(&here);
            assert!(
                shading.uv.cmpge(Vec2::splat(-1e-4)).all(),
                "{shape:?} {}",
                shading.uv
            );
            assert!(
                shading.uv.cmple(Vec2::splat(1.0001)).all(),
                "{shape:?} {}",
                shading.uv
            );
            assert_eq!(shading.normal, here.normal);
            for (tangent, expected) in [(shading.du, Vec2::X), (shading.dv, Vec2::Y)] {
                if tangent.length() < 0.3 || (shading.uv - 0.5).abs().max_element() > 0.45 {
                    continue; // near a pole or a seam
                }
                let moved = Surface {
                    point: here.point + tangent * step,
                    ..here
                };
                // Curved shapes read the coordinates of the nearest point of theirs.
                let moved = nearest(&shape, &moved);
                let change = (shape.shading(&moved).uv - shading.uv) / step;
                assert!(
                    (change - expected).length() < 0.08,
                    "{shape:?} {change} {expected}"
                );
            }
        }
    }
}

/// A sphere reads its coordinates off the normal.
fn nearest(shape: &Primitive, surface: &Surface) -> Surface {
    let Primitive::Sphere(sphere) = shape else {
        return *surface;
    };
    let outward = (surface.point - sphere.center()).normalize();
    Surface {
        normal: outward * outward.dot(surface.normal).signum(),
        ..*surface
    }
}

/// A closed can of albedo 1/2 that emits 1/2 inside is of radiance 1 wherever one looks; outside is a blinding sky.
#[test]
fn a_can_has_no_leaks() {
    let (start, end) = ([0.2, -0.6, 0.1], [-0.3, 0.9, 0.4]);
    let along = (Vec3::from(end) - Vec3::from(start)).normalize();
    let (first, second) = along.any_orthonormal_pair();
    let lid = |center, second: Vec3| {
        Disk::new(center, (first * 0.5).to_array(), (second * 0.5).to_array()).unwrap()
    };
    // The outer sides face inwards.
    let facing = |disk: Disk, inward: Vec3| {
        let normal = disk.sample(Vec3A::ZERO, [0.5, 0.5]).normal;
        if normal.dot(inward.into()) > 0.0 {
            disk
        } else {
            disk.turned()
        }
    };
    let can: Vec<Primitive> = vec![
        Cylinder::new(start, end, 0.5).unwrap().turned().into(),
        facing(lid(start, second), along).into(),
        facing(lid(end, second), -along).into(),
    ];
    let object = Object::new(can, Lambertian::new([0.5; 3]).unwrap());
    let object = object.emitting([0.5; 3]).unwrap();
    let view = View::<Lambertian, AreaLights, _, _> {
        scene: Scene::new(vec![object], Constant::new([1e9; 3]).unwrap()).unwrap(),
        sensor: Pinhole::look_at([0.0, 0.1, 0.2], end, [0.3, 0.1, 1.0], 120.0, 1.0).unwrap(),
        filter: BoxFilter,
        paths: Paths::default(),
    };
    let image = view
        .render([16, 16], 1, |seed| {
            Average::new(Sobol::new(32).unwrap().scrambled(HashedOwen { seed }), 256)
        })
        .unwrap();
    assert_relative_eq!(image.mean().x, 1.0, epsilon = 5e-3);
}

fn pyramid() -> Mesh {
    let positions = vec![
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.1, 0.2, 1.5],
    ];
    let triangles = vec![
        [0, 1, 4],
        [1, 2, 4],
        [2, 3, 4],
        [3, 0, 4],
        [0, 2, 1],
        [0, 3, 2],
    ];
    Mesh::new(positions, triangles).unwrap()
}

fn rays(count: u64) -> impl Iterator<Item = Ray> {
    (0..count).map(|index| {
        let [a, b, c, d, e, f] = singles(index);
        let origin = Vec3A::new(a - 0.5, b - 0.5, c - 0.5) * 8.0;
        let target = Vec3A::new(d - 0.5, e - 0.5, f - 0.5) * 2.0;
        Ray {
            origin,
            direction: (target - origin).normalize(),
        }
    })
}

type Bare = Scene<Lambertian, NoLight, NoEnvironment>;

fn white() -> Lambertian {
    Lambertian::new([0.5; 3]).unwrap()
}

#[test]
fn a_mesh_is_hit_where_its_triangles_are() {
    let corners = [
        [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.1, 0.2, 1.5]],
        [[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [0.1, 0.2, 1.5]],
        [[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.1, 0.2, 1.5]],
        [[-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [0.1, 0.2, 1.5]],
        [[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]],
        [[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
    ];
    let flats = corners.map(|corners| Flat::triangle(corners).unwrap());
    let flats: Bare = Scene::new(vec![Object::new(flats, white())], NoEnvironment).unwrap();
    let ball = Sphere::new([0.0, 0.0, 2.0], 0.4).unwrap();
    let mesh: Bare = Scene::new(vec![Object::mesh(pyramid(), white())], NoEnvironment).unwrap();
    let both: Bare = Scene::new(
        vec![
            Object::mesh(pyramid(), white()),
            Object::new([ball], white()),
        ],
        NoEnvironment,
    )
    .unwrap();
    let mut hits = 0;
    for ray in rays(5000) {
        let (flat, mesh) = (flats.meet(&ray), mesh.meet(&ray));
        let ball = ball.intersect(&ray, f32::INFINITY);
        assert_eq!(flat.is_some(), mesh.is_some());
        assert_eq!(both.meet(&ray).is_some(), mesh.is_some() || ball.is_some());
        let (Some(flat), Some(mesh)) = (flat, mesh) else {
            continue;
        };
        hits += 1;
        assert_eq!(flat.surface, mesh.surface);
        assert_eq!(flat.shading(), mesh.shading());
        let nearer = ball.is_some_and(|ball| {
            ray.at(ball).distance(ray.origin) < mesh.surface.point.distance(ray.origin)
        });
        if !nearer {
            assert_eq!(both.meet(&ray).unwrap().surface, mesh.surface);
        }
    }
    assert!(hits > 1000);
}

#[test]
fn normals_and_texture_coordinates_are_interpolated() {
    let uvs = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 4.0], [0.0, 4.0], [1.0, 2.0]];
    let normals = [
        [-1.0, -1.0, 0.2],
        [1.0, -1.0, 0.2],
        [1.0, 1.0, 0.2],
        [-1.0, 1.0, 0.2],
        [0.0, 0.0, 3.0],
    ];
    let mesh = pyramid()
        .with_normals(normals.to_vec())
        .unwrap()
        .with_uvs(uvs)
        .unwrap();
    let base = Ray {
        origin: Vec3A::new(0.5, -0.3, -2.0),
        direction: Vec3A::Z,
    };
    for (mesh, side) in [(mesh.clone(), 1.0), (mesh.turned(), -1.0)] {
        let scene: Bare = Scene::new(vec![Object::mesh(mesh, white())], NoEnvironment).unwrap();
        let vertex = scene.meet(&base).unwrap();
        assert!((vertex.surface.normal - Vec3A::new(0.0, 0.0, -side)).length() < 1e-6);
        let shading = vertex.shading();
        // On the bottom u is 1 + x, v is 2 (1 + y).
        assert!((shading.uv - Vec2::new(1.5, 1.4)).length() < 1e-5);
        assert!((shading.du - Vec3A::X).length() < 1e-5);
        assert!((shading.dv - Vec3A::Y * 0.5).length() < 1e-5);
        // There (0.5, -0.3) is 0.25 of the corner (-1, -1), 0.35 of (1, 1), 0.4 of (1, -1).
        let expected = Vec3A::new(-0.25 + 0.35 + 0.4, -0.25 + 0.35 - 0.4, 0.2).normalize();
        assert!(
            (shading.normal - expected * side).length() < 1e-5,
            "{}",
            shading.normal
        );
    }
}

#[test]
fn bad_meshes_are_refused() {
    let triangle = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert!(Mesh::new(triangle.clone(), vec![[0, 1, 3]]).is_err());
    let mut nan = triangle.clone();
    nan[1][2] = f32::NAN;
    let error = Mesh::new(nan, vec![[0, 1, 2]]).unwrap_err().to_string();
    assert!(error.contains("NaN"), "{error}");
    let mesh = Mesh::new(triangle, vec![[0, 1, 2], [0, 1, 1]]).unwrap();
    assert_eq!(mesh.dropped(), 1);
    assert!(mesh.clone().with_normals(vec![[0.0, 0.0, 1.0]; 2]).is_err());
    assert!(
        mesh.clone()
            .with_uvs(vec![[f32::INFINITY, 0.0]; 3])
            .is_err()
    );
    assert!(Cylinder::new([0.0; 3], [0.0; 3], 1.0).is_err());
    assert!(Cylinder::new([0.0; 3], [1.0; 3], 0.0).is_err());
    assert!(Cylinder::new([0.0; 3], [f32::NAN; 3], 1.0).is_err());
    assert!(Disk::new([0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]).is_err());
    assert!(
        Sphere::new([0.0; 3], 1.0)
            .unwrap()
            .with_axes(Vec3A::X, Vec3A::X)
            .is_err()
    );
}

#[test]
fn an_instance_is_hit_where_the_same_shapes_in_its_place_are() {
    let places = [
        Affine3A::from_scale_rotation_translation(
            Vec3::new(0.5, 1.5, 0.8),
            Quat::from_rotation_y(0.7),
            Vec3::new(0.5, 0.0, -1.0),
        ),
        // Mirrored.
        Affine3A::from_mat3_translation(
            glam::Mat3::from_diagonal(Vec3::new(-0.3, 0.3, 0.3)),
            Vec3::new(-1.0, 0.5, 0.2),
        ),
    ];
    let boxes = cuboid(
        [0.0; 3],
        [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]],
    )
    .unwrap();
    let objects = || {
        vec![
            Object::new(boxes, white()),
            Object::mesh(pyramid(), white()),
        ]
    };
    let instances = Instances {
        objects: objects(),
        places: places.to_vec(),
    };
    let floor =
        Flat::parallelogram([-5.0, -2.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0]).unwrap();
    let scene: Bare = Scene::with_instances(
        vec![Object::new([floor], white())],
        vec![instances],
        NoEnvironment,
    )
    .unwrap();
    let one: Bare = Scene::new(objects(), NoEnvironment).unwrap();
    let mut hits = 0;
    for ray in rays(5000) {
        let mut expected: Option<(f32, Vec3A, Vec2)> =
            floor.intersect(&ray, f32::INFINITY).map(|distance| {
                let surface = floor.surface(&ray, distance);
                (distance, surface.normal, floor.shading(&surface).uv)
            });
        for place in places {
            let inward = place.inverse();
            let origin = inward.transform_point3a(ray.origin);
            let direction = inward.transform_vector3a(ray.direction).normalize();
            let Some(vertex) = one.meet(&Ray { origin, direction }) else {
                continue;
            };
            let point = place.transform_point3a(vertex.surface.point);
            let normals: Mat3A = inward.matrix3.transpose();
            let normal = (normals * vertex.surface.normal).normalize();
            let distance = point.distance(ray.origin);
            if expected.is_none_or(|(nearest, ..)| distance < nearest) {
                expected = Some((distance, normal, vertex.shading().uv));
            }
        }
        let vertex = scene.meet(&ray);
        assert_eq!(vertex.is_some(), expected.is_some());
        let (Some(vertex), Some((distance, normal, uv))) = (vertex, expected) else {
            continue;
        };
        hits += 1;
        assert!((vertex.surface.point.distance(ray.origin) - distance).abs() < 1e-4);
        assert!((vertex.surface.normal - normal).length() < 1e-4);
        assert!((vertex.shading().uv - uv).length() < 1e-3);
        // A ray on into the open from the outer side meets nothing at once.
        let outward = vertex.surface.normal;
        let on = Ray {
            origin: vertex.surface.leave(outward),
            direction: outward,
        };
        if let Some(next) = scene.meet(&on) {
            assert!(next.surface.point.distance(vertex.surface.point) > 1e-4);
        }
    }
    assert!(hits > 1000);
}

#[test]
fn instances_that_emit_or_cannot_be_inverted_are_refused() {
    let instances = |object: Object<Lambertian>, place| Instances {
        objects: vec![object],
        places: vec![place],
    };
    let ball = || Object::new([Sphere::new([0.0; 3], 1.0).unwrap()], white());
    let with = |instances| Bare::with_instances(Vec::new(), vec![instances], NoEnvironment);
    let shining = ball().emitting([1.0; 3]).unwrap();
    assert!(with(instances(shining, Affine3A::IDENTITY)).is_err());
    assert!(
        with(instances(
            ball(),
            Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))
        ))
        .is_err()
    );
    assert!(with(instances(ball(), Affine3A::IDENTITY)).is_ok());
}

/// A floor under a light whose left half is dark, by a picture and by two shapes.
#[test]
fn a_picture_shines_where_it_is_bright() {
    let floor = || {
        let floor = Flat::parallelogram([-2.0, 0.0, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]);
        Object::new([floor.unwrap()], white())
    };
    let texels = vec![0.2, 0.4, 0.6, 4.0, 3.0, 2.0];
    let picture = || -> Texture {
        Bitmap::new(2, 3, texels.clone())
            .unwrap()
            .filtered(Filter::Nearest)
            .into()
    };
    let half = |x: f32, radiance: [f32; 3]| {
        let flat = Flat::parallelogram([x, 1.5, -0.5], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0]);
        Object::new([flat.unwrap()], white())
            .emitting(radiance)
            .unwrap()
    };
    let corner = [-0.5, 1.5, -0.5];
    let flat = Flat::parallelogram(corner, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]).unwrap();
    let vertices = vec![corner, [0.5, 1.5, -0.5], [0.5, 1.5, 0.5], [-0.5, 1.5, 0.5]];
    let uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mesh = Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]])
        .unwrap()
        .with_uvs(uvs)
        .unwrap();
    let render = |lights: Vec<Object<Lambertian>>| {
        let objects = lights.into_iter().chain([floor()]).collect();
        let view = View::<Lambertian, AreaLights, _, _> {
            scene: Scene::new(objects, NoEnvironment).unwrap(),
            sensor: Pinhole::look_at([0.0, 1.2, 3.0], [0.0, 0.5, 0.0], [0.0, 1.0, 0.0], 60.0, 1.0)
                .unwrap(),
            filter: BoxFilter,
            paths: Paths::default(),
        };
        view.render([12, 12], 1, |seed| {
            Average::new(
                Sobol::new(16).unwrap().scrambled(HashedOwen { seed }),
                1 << 12,
            )
        })
        .unwrap()
    };
    let expected = render(vec![
        half(-0.5, [0.2, 0.4, 0.6]),
        half(0.0, [4.0, 3.0, 2.0]),
    ]);
    for shape in [Object::new([flat], white()), Object::mesh(mesh, white())] {
        let ours = render(vec![shape.emitting_picture(picture()).unwrap()]);
        let off = (ours.mean() / expected.mean() - 1.0).abs().max_element();
        assert!(off < 2e-3, "{off}");
        for (ours, expected) in ours.pixels().iter().zip(expected.pixels()) {
            let off = (*ours - *expected).abs().max_element();
            assert!(
                off < 0.03 * expected.max_element() + 1e-3,
                "{ours} {expected}"
            );
        }
    }
    let negative = Bitmap::new(1, 1, vec![-1.0]).unwrap();
    assert!(floor().emitting_picture(negative.into()).is_err());
}

#[test]
fn hidden_lights_light_but_are_not_seen() {
    let floor = Flat::parallelogram([-2.0, 0.0, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]).unwrap();
    let lamp = Sphere::new([0.0, 1.0, 0.0], 0.3).unwrap();
    let black = Lambertian::new([0.0; 3]).unwrap();
    let render = |paths, from, to| {
        let view = View::<Lambertian, AreaLights, _, _> {
            scene: Scene::new(
                vec![
                    Object::new([floor], white()),
                    Object::new([lamp], black).emitting([5.0; 3]).unwrap(),
                ],
                Constant::new([0.25; 3]).unwrap(),
            )
            .unwrap(),
            sensor: Pinhole::look_at(from, to, [0.0, 1.0, 0.0], 0.1, 1.0).unwrap(),
            filter: BoxFilter,
            paths,
        };
        view.render([1, 1], 1, |seed| {
            Average::new(
                Sobol::new(16).unwrap().scrambled(HashedOwen { seed }),
                1 << 12,
            )
        })
        .unwrap()
        .mean()
        .x
    };
    let (all, hiding) = (Paths::default(), Paths::default().hiding_lights());
    // Through the lamp at the floor: what is seen from below the lamp.
    let (above, below, target) = ([0.0, 2.0, 0.1], [0.0, 0.6, 0.03], [0.0; 3]);
    assert_eq!(render(all, above, target), 5.0);
    let (through, beyond) = (render(hiding, above, target), render(all, below, target));
    assert!((through / beyond - 1.0).abs() < 1e-3, "{through} {beyond}");
    assert!(through > 0.1);
    // Through the lamp, or past it, at the sky.
    for target in [[0.0, 1.1, 0.0], [0.0, 1.9, 0.0]] {
        assert_eq!(render(hiding, [0.0, 1.0, 2.0], target), 0.0);
    }
    assert_eq!(render(all, [0.0, 1.0, 2.0], [0.0, 1.9, 0.0]), 0.25);
}

/// Through holes and thin glass, straight on, nothing is seen of what is around; by a mirror, through real glass and scattered it is.
#[test]
fn what_is_around_is_hidden_behind_holes_and_thin_glass_too() {
    fn seen_from(eye: [f32; 3], law: impl Into<Material>, paths: Paths) -> f64 {
        let pane =
            Flat::parallelogram([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]).unwrap();
        let around = Constant::new([0.25; 3]).unwrap();
        let pane = Object::new([pane], law);
        let view: View<Material, NoLight, _, _> = View {
            scene: Scene::new(vec![pane], around).unwrap(),
            sensor: Pinhole::look_at(eye, [0.0; 3], [0.0, 1.0, 0.0], 0.01, 1.0).unwrap(),
            filter: BoxFilter,
            paths,
        };
        let points = Sobol::new(16).unwrap().scrambled(HashedOwen { seed: 1 });
        let estimator = Average::new(points, 1 << 12);
        let estimate = estimator.estimate(&view.pixel([0, 0], [1, 1]));
        estimate.unwrap().mean.x / 0.25
    }
    fn seen(law: impl Into<Material>, paths: Paths) -> f64 {
        seen_from([1.0, 0.5, 2.0], law, paths)
    }
    let (all, hiding) = (Paths::default(), Paths::default().hiding_lights());
    let grey = || Lambertian::new([0.5; 3]).unwrap().into();
    let hole = || Mask::new(Uniform::from(0.25), grey());
    let pane = || ThinDielectric::new(1.5, 1.0).unwrap();
    // At one boundary, and by both sides of a pane with what goes to and fro between them.
    let once = {
        let cosine = 2.0 / 5.25_f64.sqrt();
        let inner = (1.0 - (1.0 - cosine * cosine) / 2.25).sqrt();
        let across = ((cosine - 1.5 * inner) / (cosine + 1.5 * inner)).powi(2);
        let along = ((1.5 * cosine - inner) / (1.5 * cosine + inner)).powi(2);
        0.5 * (across + along)
    };
    let reflected = 2.0 * once / (1.0 + once);
    for (what, found, expected) in [
        ("hole", seen(hole(), hiding), 0.25 * 0.5),
        ("hole", seen(hole(), all), 0.25 * 0.5 + 0.75),
        ("thin glass", seen(pane(), hiding), reflected),
        ("thin glass", seen(pane(), all), 1.0),
        // It is mirrored nearly straight on.
        (
            "mirror along which one looks",
            seen_from([0.9, 0.0, 3e-4], Mirror::new([1.0; 3]).unwrap(), hiding),
            1.0,
        ),
        ("nothing", seen(Null, hiding), 0.0),
        ("nothing", seen(Null, all), 1.0),
        (
            "into glass",
            seen(Dielectric::new(1.5, 1.0).unwrap(), hiding),
            once + (1.0 - once) / 2.25,
        ),
    ] {
        assert!(
            (found - expected).abs() < 2e-3,
            "{what}: {found} for {expected}"
        );
    }
}

#[test]
fn rays_along_the_axes_meet_a_mesh_whatever_the_sign_of_their_zeros() {
    let scene: Bare = Scene::new(vec![Object::mesh(pyramid(), white())], NoEnvironment).unwrap();
    for zero in [0.0, -0.0] {
        for (origin, direction) in [
            ([0.1, 0.2, -2.0], [zero, zero, 1.0]),
            ([0.1, 0.2, 4.0], [zero, zero, -1.0]),
            ([-3.0, 0.1, 0.2], [1.0, zero, zero]),
            ([0.1, 3.0, 0.2], [zero, -1.0, zero]),
        ] {
            let ray = Ray {
                origin: Vec3A::from(origin),
                direction: Vec3A::from(direction),
            };
            let here = Surface {
                point: ray.origin,
                normal: ray.direction,
                margin: 0.0,
                detail: (),
            };
            assert!(scene.meet(&ray).is_some(), "{ray:?}");
            let way = Segment::along(&here, ray.direction);
            assert!(scene.occluded(&way), "{ray:?}");
        }
    }
}
