//! Packets against single paths.

use glam::{Affine2, Affine3A, DMat3, Mat3A, Vec2, Vec3, Vec3A};

use crate::hash::{hash, unit_f32};
use crate::path::bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, Distribution, Lambertian, Mask, Material, Mirror, Null,
    Plastic, RoughConductor, Roughness, Tint, TwoSided,
};
use crate::path::frame::single;
use crate::path::geometry::FEW;
use crate::path::light::{
    AreaLights, Background, Constant, DirectionalLight, Emission, Emitter, Environment,
    Illumination, Light, LightTree, NoEnvironment, NoLight, PointLight, ProjectorLight, Sky,
    Source, SpotLight, Surroundings,
};
use crate::path::reuse::{self, Group, MOST, Part, Pixels, Traces, WIDTH};
use crate::path::roulette::Rule;
use crate::path::sensor::Pinhole;
use crate::path::shape::{Cylinder, Disk, Flat, Mesh, Primitive, Sphere, cuboid};
use crate::path::texture::{Checkerboard, Parameter, Texture, Uniform};
use crate::path::{
    Instances, Object, Paths, Pixel, Scene, Segment, Share, Surface, View, filter::BoxFilter,
    scenes,
};
use crate::points::{HashedOwen, PointSet, Rescrambled, Sobol};
use crate::{Error, Integrand, NonFinite, Sampler};

/// Every value of `evaluate_many` must be that of `evaluate`, to the bit.
fn agree<B: Bsdf, L: Light, E: Environment>(view: &View<B, L, E, Pinhole>) {
    assert!(view.scene.packet().is_some(), "the scene has packets");
    let size = [7, 5];
    for position in [[0, 0], [3, 4], [6, 2], [2, 1]] {
        let pixel = Pixel {
            scene: &view.scene,
            sensor: &view.sensor,
            filter: &view.filter,
            paths: view.paths,
            position,
            size,
        };
        let seed = hash(u64::from(position[0]), u64::from(position[1]));
        let points = Sobol::new(12).unwrap().scrambled(HashedOwen { seed });
        for count in [1, 15, 300] {
            let mut samplers: Vec<_> = (0..count).map(|index| points.point(index)).collect();
            let mut values = vec![Vec3::NAN; samplers.len()];
            pixel.evaluate_many(&mut samplers, &mut values);
            for (index, value) in (0..count).zip(values) {
                let expected = pixel.evaluate(&mut points.point(index));
                assert_eq!(value, expected, "{position:?}, point {index} of {count}");
            }
        }
    }
    agree_where_reused(view);
}

/// So must what pixels give whose paths are reused.
fn agree_where_reused<B: Bsdf, L: Light, E: Environment>(view: &View<B, L, E, Pinhole>) {
    let size = [7, 5];
    let singly = Pixels {
        reused_by: 4,
        rule: NonFinite::Reject,
        follow: &|runs, groups, traces| view.trace_singly(size, runs, groups, traces),
        coordinates: &|_, _| Vec::new(),
    };
    assert_eq!(parts_of_pixels(view, 4), parts(&singly));
}

/// What some pixels give whose paths are reused by so many.
fn parts_of_pixels<B: Bsdf, L: Light, E: Environment>(
    view: &View<B, L, E, Pinhole>,
    reused_by: u32,
) -> Vec<[Part; 2]> {
    let ahead = view.ahead([7, 5]);
    let pixels = Pixels {
        reused_by,
        rule: NonFinite::Reject,
        follow: &|runs, groups, traces| view.trace([7, 5], runs, groups, traces, &ahead),
        coordinates: &|_, _| Vec::new(),
    };
    parts(&pixels)
}

fn parts(pixels: &Pixels<'_>) -> Vec<[Part; 2]> {
    let shares: Vec<_> = (0..14)
        .zip([17, 0, 40, 150, 16, 33, 64].into_iter().cycle())
        .map(|(place, count)| Share {
            position: [place % 7, 1 + place / 7],
            points: Rescrambled::new(4, place.into()).unwrap(),
            count,
        })
        .collect();
    let given: Vec<_> = shares.iter().map(Share::given).collect();
    pixels.parts(&given, shares.iter().map(|share| share.count / 3))
}

#[test]
fn packets_give_the_bits_of_single_paths_in_the_cornell_box() {
    let mut view = scenes::cornell_box();
    agree(&view);
    let alone = parts_of_pixels(&view, 1);
    assert_ne!(parts_of_pixels(&view, 4), alone, "nothing is reused");
    for longest in [1, 2, 8] {
        view.paths = Paths::default().longest(longest).unwrap();
        agree(&view);
    }
    view.paths = Paths::default().roulette_from(1);
    agree(&view);
    view.paths = view.learn_roulette([16, 16], 4, 1).unwrap();
    assert!(view.paths != Paths::default());
    agree(&view);
}

/// Points anywhere, near and far, and two that are not told apart, in slots that kept others before.
#[test]
fn packets_share_light_as_single_paths_do() {
    let view = room::<AreaLights, _>(true, NoEnvironment).unwrap();
    let packet = view.scene.packet().unwrap();
    let mut state = 0;
    let mut random = || {
        state += 1;
        unit_f32(hash(12, state))
    };
    let group = Group {
        pixels: MOST,
        rounds: 2 * WIDTH,
        slot: WIDTH,
    };
    let slots = WIDTH + group.pixels * group.rounds;
    let roulette = Rule::of_throughput(1);
    let mut traces = Traces::default();
    for size in [1e-19, 1e-3, 1.0, 1e18_f32] {
        let mut vector = || Vec3A::from([0; 3].map(|_| 2.0 * random() - 1.0));
        let mut point = || reuse::Diffuse {
            surface: Surface {
                point: vector() * (0.6 * size),
                normal: vector().normalize(),
                margin: 1e-6 * size,
                detail: (),
            },
            shading: vector().normalize(),
            albedo: vector().abs(),
        };
        let mut near = [point(), point()];
        for (near, side) in near.iter_mut().zip([1.0, -1.0]) {
            near.surface.normal = Vec3A::Z * side;
            near.surface.point = near.surface.normal * -near.surface.margin;
            near.shading = near.surface.normal;
        }
        traces.clear(slots);
        for slot in WIDTH..slots {
            let kept = hash(u64::from(size.to_bits()), slot as u64) % 4;
            if kept > 0 {
                traces.set_first(slot, point(), &roulette);
            }
            if kept > 1 {
                traces.set_second(slot, point(), point().albedo);
            }
            let weight = point().albedo.x;
            traces.end(slot, point().albedo, weight);
        }
        let (giver, taker) = (group.slot(0, 3), group.slot(1, 3));
        traces.set_first(giver, point(), &roulette);
        traces.set_second(giver, near[1], Vec3A::ONE);
        traces.end(giver, Vec3A::ONE, 1.0);
        traces.set_first(taker, near[0], &roulette);
        let mut singly = Traces {
            slots: traces.slots.clone(),
        };
        singly.share(&group, &|way| view.scene.occluded(way));
        packet.share(view.scene.geometry(), &[group], &mut traces);
        let values = |traces: &Traces| -> Vec<_> { traces.values(0..slots).collect() };
        assert_eq!(values(&traces), values(&singly), "{size}");
    }
}

/// Lit walls around what is darker than all that shares its light.
#[test]
fn packets_give_the_bits_of_single_paths_of_what_is_dark() {
    let walls = cuboid([0.0; 3], Mat3A::IDENTITY.to_cols_array_2d()).unwrap();
    let dark = Flat::parallelogram([-0.5, -0.5, 0.2], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]).unwrap();
    let lamp = Flat::parallelogram([-0.1, 0.7, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2]).unwrap();
    let law = |albedo| Lambertian::new([albedo; 3]).unwrap();
    let objects: Vec<Object<Lambertian>> = vec![
        Object::new(walls.into_iter().map(Flat::turned), law(0.7)),
        Object::new([dark], law(5e-7)),
        Object::new([lamp], law(0.0)).emitting([9.0; 3]).unwrap(),
    ];
    let scene = Scene::new(objects, NoEnvironment).unwrap();
    agree::<_, AreaLights, _>(&seen_from([0.1, -0.1, -0.9], 70.0, scene).unwrap());
}

/// A scene, seen from `origin` towards the middle at an angle of so many degrees.
fn seen_from<B: Bsdf, L: Light, E: Environment>(
    origin: [f32; 3],
    degrees: f64,
    scene: Scene<B, L, E>,
) -> Result<View<B, L, E, Pinhole>, Error> {
    Ok(View {
        scene,
        sensor: Pinhole::look_at(origin, [0.0; 3], [0.0, 1.0, 0.0], degrees, 1.4)?,
        filter: BoxFilter,
        paths: Paths::default(),
    })
}

/// A room of triangles, turned, below a sky, with lights of both kinds.
fn room<L: Light, E: Environment>(
    lit: bool,
    environment: E,
) -> Result<View<Lambertian, L, E, Pinhole>, Error> {
    let mut state = 0;
    let mut random = || {
        state += 1;
        unit_f32(hash(11, state))
    };
    let mut objects = vec![Object::new(
        cuboid(
            [0.0; 3],
            [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]],
        )?
        .into_iter()
        .skip(1)
        .map(Flat::turned),
        Lambertian::new([0.7, 0.5, 0.9])?,
    )];
    for k in 0..12 {
        let corners = [0; 3].map(|_| [0; 3].map(|_| 1.2 * random() - 0.6));
        let object = Object::new(
            [Flat::triangle(corners)?],
            Lambertian::new([0.5; 3])?.outside(),
        );
        let light = lit && k < 4;
        objects.push(if light {
            object.emitting([1.0, k as f32, 2.0])?
        } else {
            object
        });
    }
    if lit {
        let lamp = Flat::parallelogram([-0.1, 0.7, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2])?;
        objects.push(Object::new([lamp], Lambertian::new([0.0; 3])?).emitting([9.0; 3])?);
    }
    seen_from([0.1, -0.1, -0.9], 70.0, Scene::new(objects, environment)?)
}

#[test]
fn packets_give_the_bits_of_single_paths_among_triangles_and_many_lights() {
    agree::<_, AreaLights, _>(&room(true, NoEnvironment).unwrap());
    let sky = Constant::new([0.2, 0.3, 0.4]).unwrap();
    agree::<_, AreaLights, _>(&room(true, sky).unwrap());
    agree::<_, NoLight, _>(&room(false, sky).unwrap());
}

/// A ground and a lamp; disks, cylinders and a sphere; and copies, larger, smaller, turned and sheared, of a group of all
/// of them and of a mesh.
fn copies<B: Bsdf + Clone + From<Lambertian>, E: Environment>(
    law: &B,
    environment: E,
) -> Result<View<B, AreaLights, E, Pinhole>, Error> {
    let white = B::from(Lambertian::new([0.7, 0.5, 0.9])?);
    let ground = Flat::parallelogram([-4.0, -0.8, 4.0], [8.0, 0.0, 0.0], [0.0, 0.0, -8.0])?;
    let lamp = Flat::parallelogram([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.2])?;
    let round = || -> Result<Vec<Primitive>, Error> {
        Ok(vec![
            Cylinder::new([-0.6, -0.6, 0.0], [0.1, 0.8, 0.2], 0.3)?.into(),
            Disk::new([0.0, 0.4, 0.1], [0.5, 0.0, 0.1], [0.0, 0.1, -0.5])?.into(),
            Cylinder::new([0.7, -0.7, 0.3], [0.6, 0.3, 0.2], 0.2)?
                .turned()
                .into(),
            Sphere::new([0.2, -0.3, -0.6], 0.3)?.into(),
        ])
    };
    let mut random = (0..).map(|state| unit_f32(hash(15, state)));
    let mut vectors = |size: f32| -> Vec<[f32; 3]> {
        let mut vector = || [0; 3].map(|_| size * random.next().unwrap() - 0.5 * size);
        (0..60).map(|_| vector()).collect()
    };
    let triangles = (0..58).map(|first| [first, first + 1, first + 2]).collect();
    let mesh = Mesh::new(vectors(1.2), triangles)?.with_normals(vectors(2.0))?;
    let beside = Mesh::new(
        vectors(2.0),
        (0..20).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
    )?;
    let places = (0_u8..5).map(|k| {
        let k = f32::from(k);
        let turned = Mat3A::from_rotation_y(k) * (0.15 + 0.1 * k);
        let sheared = Mat3A::from_cols(
            turned.x_axis,
            turned.y_axis + 0.2 * turned.x_axis,
            turned.z_axis,
        );
        Affine3A::from_mat3_translation(sheared.into(), Vec3::new(0.9 * k - 2.0, 0.1 * k, k.sin()))
    });
    let group = vec![
        Object::new(round()?, law.clone()),
        Object::mesh(mesh, law.clone()),
    ];
    let objects = vec![
        Object::new([ground], white.clone()),
        Object::new([lamp], white).emitting([6.0, 5.0, 4.0])?,
        Object::new(round()?, law.clone()),
        Object::mesh(beside, law.clone()),
    ];
    let copies = Instances {
        objects: group,
        places: places.collect(),
    };
    seen_from(
        [0.1, 1.0, 3.0],
        60.0,
        Scene::with_instances(objects, vec![copies], environment)?,
    )
}

#[test]
fn packets_give_the_bits_of_single_paths_among_other_shapes_and_copies() {
    let sky = Constant::new([0.2, 0.3, 0.4]).unwrap();
    let diffuse = Lambertian::new([0.3, 0.9, 0.5]).unwrap();
    agree(&copies(&diffuse, NoEnvironment).unwrap());
    agree(&copies(&diffuse.outside(), sky).unwrap());
    agree(
        &copies(
            &Material::<Uniform>::from(Mirror::new([0.9; 3]).unwrap()),
            sky,
        )
        .unwrap(),
    );
    let rough = Roughness::new(Distribution::Ggx, Texture::from(Uniform::from(0.3))).unwrap();
    let [eta, k] = [2.0, 1.5].map(|value| Uniform::from(value).into());
    let metal = RoughConductor::new(Conductor::new(eta, k).unwrap(), rough);
    agree(&copies(&Material::<Texture>::from(metal), NoEnvironment).unwrap());
}

/// A box with a lamp, and in it meshes with and without normals, one of them black inside and turned.
fn meshes<B: Bsdf + From<Lambertian>, E: Environment>(
    smooth: bool,
    height: f32,
    environment: E,
) -> Result<View<B, AreaLights, E, Pinhole>, Error> {
    let edges = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let law = |albedo, one_sided| -> Result<B, Error> {
        let law = Lambertian::new(albedo)?;
        Ok(B::from(if one_sided { law.outside() } else { law }))
    };
    let walls = cuboid([0.0; 3], edges)?.into_iter().map(Flat::turned);
    let lamp = Flat::parallelogram([-0.4, height, -0.4], [0.8, 0.0, 0.0], [0.0, 0.0, 0.8])?;
    let mut objects = vec![
        Object::new(walls, law([0.7, 0.5, 0.9], false)?),
        Object::new([lamp], law([0.3; 3], true)?).emitting([5.0, 4.0, 3.0])?,
    ];
    let mut state = 0;
    let mut random = || {
        state += 1;
        unit_f32(hash(12, state))
    };
    for (k, one_sided) in [false, true, true].into_iter().enumerate() {
        // More triangles than are taken apart.
        let mut vector = |size: f32, shift: f32| [0; 3].map(|_| size * random() - shift);
        let positions: Vec<_> = (0..24).map(|_| vector(1.4, 0.7)).collect();
        let normals = (0..24).map(|_| vector(2.0, 1.0)).collect();
        let corners = (0..22).map(|first| [first, first + 1, first + 2]).collect();
        let mut mesh = Mesh::new(positions, corners)?;
        if smooth {
            mesh = mesh.with_normals(normals)?;
        }
        let mesh = if k == 2 { mesh.turned() } else { mesh };
        objects.push(Object::mesh(mesh, law([0.2, 0.6, 0.8], one_sided)?));
    }
    seen_from([0.1, -0.1, -0.9], 70.0, Scene::new(objects, environment)?)
}

#[test]
fn packets_give_the_bits_of_single_paths_among_meshes() {
    let sky = Constant::new([0.2, 0.3, 0.4]).unwrap();
    for height in [0.9, -0.6] {
        agree(&meshes::<Lambertian, _>(false, height, NoEnvironment).unwrap());
        agree(&meshes::<Material<Texture>, _>(true, height, NoEnvironment).unwrap());
        // Laws that do not heed interpolated normals.
        agree(&meshes::<Lambertian, _>(true, height, NoEnvironment).unwrap());
        agree(&meshes::<Material<Uniform>, _>(true, height, sky).unwrap());
        agree(&meshes::<Material<Texture>, _>(true, height, sky).unwrap());
    }
}

#[test]
fn packets_give_the_bits_of_single_paths_near_a_lamp() {
    let mut view = scenes::cornell_box();
    let room = |size: f32| -> Result<Vec<Object<Lambertian>>, Error> {
        let white = Lambertian::new([0.6; 3])?;
        let floor = Flat::parallelogram([-4.0, 0.0, 4.0], [8.0, 0.0, 0.0], [0.0, 0.0, -8.0])?;
        let half = 0.5 * size;
        let corner = [-half, 0.8, -half];
        let tile = [[0.9 * size, 0.0, 0.0], [0.0, 0.0, size]];
        let corners = [corner, [half, 0.8, -half], [-half, 0.8, half]];
        Ok(vec![
            Object::new([floor], white),
            Object::new([Flat::parallelogram(corner, tile[0], tile[1])?], white)
                .emitting([2.0; 3])?,
            Object::new([Flat::triangle(corners)?], white).emitting([1.0; 3])?,
        ])
    };
    for (size, near) in [(2.0, true), (0.1, false)] {
        view.scene = Scene::new(room(size).unwrap(), NoEnvironment).unwrap();
        let lights = view.scene.lights().shapes();
        let drawn = |shape: &Primitive| match shape {
            Primitive::Flat(flat) => flat.longest_by_solid_angle().is_some(),
            _ => false,
        };
        assert_eq!(lights.map(drawn).collect::<Vec<_>>(), [near; 2], "{size}");
        agree(&view);
    }
}

/// A ground, a lamp that may shine, spheres and a mesh of several laws, one of which has the given reflectance.
fn balls<P: Parameter + From<Uniform>, L: Light, E: Environment>(
    lit: bool,
    tiles: P,
    environment: E,
) -> Result<View<Material<P>, L, E, Pinhole>, Error> {
    let color = |albedo: f32| P::from(Uniform::from(albedo));
    let rough = Roughness::new(Distribution::Ggx, color(0.3))?;
    let white: Material<P> = Lambertian::new([0.8, 0.7, 0.6])?.into();
    let laws: Vec<Material<P>> = vec![
        white.clone(),
        Lambertian::new([0.2, 0.9, 0.5])?.outside().into(),
        Mirror::new([0.9; 3])?.into(),
        Dielectric::new(1.5, 1.0)?.tinted(Tint::default()).into(),
        Plastic::new(color(0.4), 1.49, 1.0)?.into(),
        RoughConductor::new(Conductor::new(color(2.0), color(1.5))?, rough).into(),
        Mask::new(color(0.5), white.clone()).into(),
        Diffuse::new(tiles.clone())?.into(),
        Null.into(),
        TwoSided::new(Diffuse::new(tiles.clone())?.into()).into(),
        TwoSided::different(Diffuse::new(tiles)?.into(), white.clone()).into(),
    ];
    let ground = Flat::parallelogram([-4.0, 0.0, 4.0], [8.0, 0.0, 0.0], [0.0, 0.0, -8.0])?;
    let lamp = Flat::parallelogram([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.2])?;
    let lamp = Object::new([lamp], white.clone());
    let mut objects = vec![
        Object::new([ground], white),
        if lit { lamp.emitting([6.0; 3])? } else { lamp },
    ];
    let mut random = (0..).map(|state| unit_f32(hash(13, state)));
    for law in &laws {
        let [x, z] = [0; 2].map(|_| 2.4 * random.next().unwrap() - 1.2);
        let ball = Sphere::new([x, 0.5, z], 0.4)?;
        let ball = if x > 0.9 { ball.turned() } else { ball };
        objects.push(Object::new([ball], law.clone()));
    }
    let mut vectors = |shift: f32| -> Vec<[f32; 3]> {
        let mut vector = || [0; 3].map(|_| 1.4 * random.next().unwrap() - shift);
        (0..60).map(|_| vector()).collect()
    };
    for law in [&laws[4], &laws[7]] {
        let corners = (0..58).map(|first| [first, first + 1, first + 2]).collect();
        let mesh = Mesh::new(vectors(0.5), corners)?.with_normals(vectors(0.7))?;
        objects.push(Object::mesh(mesh, law.clone()));
    }
    seen_from([0.1, 1.5, 3.0], 60.0, Scene::new(objects, environment)?)
}

#[test]
fn packets_give_the_bits_of_single_paths_among_spheres_of_any_law() {
    let sky = || {
        let pixel = |i: u64| [0, 1, 2].map(|k| unit_f32(hash(14, 3 * i + k)).powi(8));
        let pixels: Vec<_> = (0..512).map(pixel).collect();
        Sky::new(32, &pixels, DMat3::from_rotation_x(0.4)).unwrap()
    };
    let constant = Constant::new([0.2, 0.3, 0.4]).unwrap();
    let tiles = || {
        let colors = [0.9, 0.1].map(|color| Uniform::from(color).into());
        Texture::from(Checkerboard::new(
            colors,
            Affine2::from_scale(Vec2::splat(8.0)),
        ))
    };
    let grey = Uniform::from(0.4);
    agree(&balls::<_, AreaLights, _>(true, grey, NoEnvironment).unwrap());
    agree(&balls::<_, AreaLights, _>(true, grey, constant).unwrap());
    agree(&balls::<_, AreaLights, _>(true, grey, sky()).unwrap());
    agree(&balls::<_, NoLight, _>(false, grey, sky()).unwrap());
    let around = |background| Surroundings::new(Vec::new(), background).unwrap();
    let surroundings = around(Background::Sky(Box::new(sky())));
    agree(&balls::<_, NoLight, _>(false, grey, surroundings).unwrap());
    agree(&balls::<_, AreaLights, _>(true, tiles(), sky()).unwrap());
    agree(&balls::<_, NoLight, _>(false, tiles(), constant).unwrap());
}

#[test]
fn packets_give_the_bits_of_single_paths_where_only_albedos_vary() {
    let tiles = |scale: f32| {
        let colors = [0.9, 0.1].map(|color| Uniform::from(color).into());
        let tiles = Checkerboard::new(colors, Affine2::from_scale(Vec2::splat(scale)));
        Diffuse::new(Texture::from(tiles)).unwrap()
    };
    let view = |environment| {
        let ground = Flat::parallelogram([-4.0, 0.0, 4.0], [8.0, 0.0, 0.0], [0.0, 0.0, -8.0])?;
        let lamp = Flat::parallelogram([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.2])?;
        let wall = Flat::parallelogram([-1.0, 0.0, -1.0], [2.0, 0.0, 0.2], [0.0, 1.5, 0.0])?;
        let both = TwoSided::new(Material::from(tiles(3.0)));
        let grey: Material<Texture> = Lambertian::new([0.3; 3])?.into();
        let objects: Vec<Object<Material<Texture>>> = vec![
            Object::new([ground], tiles(8.0)),
            Object::new([wall], both),
            Object::new([lamp], grey).emitting([6.0; 3])?,
        ];
        let scene = Scene::<_, AreaLights, _>::new(objects, environment)?;
        seen_from([0.1, 1.5, 3.0], 60.0, scene)
    };
    agree(&view(Constant::new([0.2, 0.3, 0.4]).unwrap()).unwrap());
}

#[test]
fn packets_give_the_bits_of_single_paths_among_spheres_or_meshes_alone() {
    let sky = Constant::new([0.2, 0.3, 0.4]).unwrap();
    let mut view = scenes::environment();
    let law = || Lambertian::new([0.5; 3]).unwrap();
    let ball = Sphere::new([0.0, 0.5, 0.0], 1.0).unwrap();
    view.scene = Scene::new(vec![Object::new([ball], law())], sky).unwrap();
    agree(&view);
    let corners = |k: u16| [0.0, 1.0, 2.5].map(|shift| (f32::from(k) + shift).sin());
    let triangles = (0..58).map(|first| [first, first + 1, first + 2]).collect();
    let mesh = Mesh::new((0..60).map(corners).collect(), triangles).unwrap();
    view.scene = Scene::new(vec![Object::mesh(mesh, law())], sky).unwrap();
    agree(&view);
}

#[test]
fn lights_that_are_asked_for_are_drawn_by_solid_angle() {
    let law = || Lambertian::new([0.5; 3]).unwrap();
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let triangles = (0..60).map(|k| [k % 4, (k + 1) % 4, (k + 2) % 4]).collect();
    let mesh = Mesh::new(corners, triangles).unwrap();
    let shining = Object::<Lambertian>::mesh(mesh, law())
        .emitting([1.0; 3])
        .unwrap();
    let scene: Scene<_, AreaLights, _> = Scene::new(vec![shining], NoEnvironment).unwrap();
    assert!(scene.lights().shapes().all(|shape| match shape {
        Primitive::Flat(flat) => flat.longest_by_solid_angle().is_some(),
        _ => false,
    }));
}

/// Spheres, a disk, a mesh and a picture that shine, next to a lamp.
fn lights<L: Light, E: Environment>(
    environment: E,
) -> Result<View<Material<Uniform>, L, E, Pinhole>, Error> {
    let white = Lambertian::new([0.7, 0.5, 0.9])?;
    let mirror = Mirror::new([0.9; 3])?;
    let ground = Flat::parallelogram([-4.0, -0.8, 4.0], [8.0, 0.0, 0.0], [0.0, 0.0, -8.0])?;
    let lamp = Flat::parallelogram([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.2])?;
    let screen = Flat::parallelogram([-2.0, -0.5, -1.0], [1.5, 0.0, -1.0], [0.0, 1.5, 0.0])?;
    let mut random = (0..).map(|state| unit_f32(hash(16, state)));
    let mut vector = || [0; 3].map(|_| 1.4 * random.next().unwrap() - 0.7);
    let corners: Vec<_> = (0..58).map(|first| [first, first + 1, first + 2]).collect();
    let mut mesh = || Mesh::new((0..60).map(|_| vector()).collect(), corners.clone());
    let disk = Disk::new([1.5, 0.4, 0.1], [0.5, 0.0, 0.1], [0.0, 0.1, -0.5])?;
    let sphere = |x| Sphere::new([x, -0.3, 0.6], 0.3);
    let picture = Checkerboard::new(
        [0.9, 0.1].map(|color| Uniform::from(color).into()),
        Affine2::from_scale(Vec2::splat(8.0)),
    );
    let objects = vec![
        Object::new([ground], white),
        Object::new([lamp], white).emitting([6.0, 5.0, 4.0])?,
        Object::new([sphere(0.4)?], white).emitting([1.0, 2.0, 3.0])?,
        Object::new([sphere(1.3)?.turned()], mirror).emitting([0.5; 3])?,
        Object::new([sphere(-0.5)?], mirror),
        Object::new([disk], white.outside()).emitting([2.0; 3])?,
        Object::new([screen], white).emitting_picture(picture.into())?,
        Object::mesh(mesh()?, white),
        Object::mesh(mesh()?, white).emitting([0.2, 0.1, 0.3])?,
        Object::mesh(mesh()?, white).emitting([0.3, 0.2, 0.1])?,
    ];
    seen_from([0.1, 1.0, 3.0], 60.0, Scene::new(objects, environment)?)
}

#[test]
fn packets_give_the_bits_of_single_paths_among_lights_of_any_kind() {
    let sky = Constant::new([0.2, 0.3, 0.4]).unwrap();
    agree::<_, AreaLights, _>(&lights(NoEnvironment).unwrap());
    agree::<_, AreaLights, _>(&lights(sky).unwrap());
    agree::<_, LightTree, _>(&lights(sky).unwrap());
    // Coordinates are drawn for lights that are not there.
    agree::<_, AreaLights, _>(&room(false, NoEnvironment).unwrap());
    agree::<_, LightTree, _>(&room(true, NoEnvironment).unwrap());
}

#[test]
fn packets_give_the_bits_of_single_paths_among_sources_without_size() {
    let some_around = |count, background| {
        let bulb = PointLight::new([0.6, 0.9, 0.7], [3.0, 2.0, 1.0]).unwrap();
        let sun = DirectionalLight::new([0.3, -1.0, 0.2], [1.0, 0.9, 0.8]).unwrap();
        let spot = SpotLight::new([-0.4, 1.9, 0.9], [0.1, -1.0, -0.3], [4.0; 3], 15.0, 50.0);
        let sources = [
            Source::Point(bulb),
            Source::Directional(sun),
            Source::Spot(Box::new(spot.unwrap())),
        ];
        let sources = sources.iter().cycle().take(count).cloned();
        Surroundings::new(sources.collect(), background).unwrap()
    };
    let around = |background| some_around(3, background);
    let grey = Uniform::from(0.4);
    let sky = Constant::new([0.2, 0.3, 0.4]).unwrap();
    agree(&balls::<_, AreaLights, _>(true, grey, around(Background::None)).unwrap());
    agree(&balls::<_, NoLight, _>(false, grey, around(Background::Constant(sky))).unwrap());
    agree::<_, AreaLights, _>(&room(true, around(Background::Constant(sky))).unwrap());
    agree::<_, AreaLights, _>(&lights(around(Background::None)).unwrap());
    // As many as are seen at once, and one more.
    for count in [1, 16, 17] {
        agree::<_, AreaLights, _>(&lights(some_around(count, Background::None)).unwrap());
    }
    let picture = || {
        let colors = [0.9, 0.1].map(|color| Uniform::from(color).into());
        Texture::from(Checkerboard::new(
            colors,
            Affine2::from_scale(Vec2::splat(4.0)),
        ))
    };
    let (place, down) = ([-0.4, 1.9, 0.9], [0.1, -1.0, -0.3]);
    let (across, below) = ([1.0, 0.1, 0.0], [0.0, -0.3, 1.0]);
    let slide = SpotLight::new(place, down, [4.0; 3], 15.0, 50.0);
    let slide = slide.unwrap().projecting(picture(), across, below).unwrap();
    let projector =
        ProjectorLight::new(place, down, [across, below], [0.5, 0.6], picture(), 2.0).unwrap();
    for source in [
        Source::Spot(Box::new(slide)),
        Source::Projector(Box::new(projector)),
    ] {
        let around = Surroundings::new(vec![source], Background::None).unwrap();
        agree::<_, AreaLights, _>(&lights(around).unwrap());
    }
    agree::<_, LightTree, _>(&lights(around(Background::None)).unwrap());
    let diffuse = Lambertian::new([0.3, 0.9, 0.5]).unwrap();
    agree(&copies(&diffuse, around(Background::None)).unwrap());
    let pixels = [[0.1, 0.2, 0.3], [0.5, 3.0, 0.2]].repeat(16);
    let sky = Sky::new(8, &pixels, DMat3::IDENTITY).unwrap();
    agree(&balls::<_, AreaLights, _>(true, grey, around(Background::Sky(Box::new(sky)))).unwrap());
}

/// A light at a point, which no ray meets: of a kind that the crate does not know.
#[derive(Debug)]
struct Bulb;

impl Light for Bulb {
    fn new(_: Vec<Emitter>) -> Result<Self, Error> {
        Ok(Self)
    }

    fn sample<D, S: Sampler>(&self, from: &Surface<D>, u: &mut S) -> Option<Illumination> {
        let [x, y] = u.next_2d().map(single);
        Some(Illumination {
            // Beyond the walls, some of the time.
            way: Segment::to_point(from, Vec3A::new(2.0 * x - 1.0, 2.0 * y - 1.0, 0.3))?,
            weight: Vec3A::new(3.0, 2.0, 1.0),
            density: f32::INFINITY,
        })
    }

    fn emitted(&self, _: u32, _: Vec3A, _: &Surface) -> Emission {
        Emission::NONE
    }
}

/// Ways to lights end at surfaces or do not, whatever the kind of light.
#[test]
fn packets_give_the_bits_of_single_paths_among_lights_of_other_kinds() {
    agree::<_, Bulb, _>(&room(false, NoEnvironment).unwrap());
    agree::<_, Bulb, _>(&room(true, Constant::new([0.2; 3]).unwrap()).unwrap());
}

#[test]
fn scenes_of_many_shapes_have_no_packets() {
    for count in [FEW, FEW + 1] {
        let balls = (0..count).map(|k| Sphere::new([k as f32, 0.0, 0.0], 0.4).unwrap());
        let object = Object::<Lambertian>::new(balls, Lambertian::new([0.5; 3]).unwrap());
        let scene: Scene<_, NoLight, _> = Scene::new(vec![object], NoEnvironment).unwrap();
        assert_eq!(scene.packet().is_some(), count == FEW);
    }
}

/// Lamps, and a mesh that shines beside them.
#[test]
fn packets_give_the_bits_of_single_paths_where_lamps_leave_no_room_for_others() {
    let white = Lambertian::new([0.7; 3]).unwrap();
    let corners = vec![[-0.5, 0.1, 0.4], [0.5, 0.2, 0.3], [0.0, 0.9, 0.1]];
    for count in [FEW - 1, FEW] {
        let tile = |k: usize| {
            let x = 4.0 * k as f32 / count as f32 - 2.0;
            Flat::parallelogram([x, -0.7, 2.0], [0.03, 0.0, 0.0], [0.0, 0.0, -4.0]).unwrap()
        };
        let mesh = Mesh::new(corners.clone(), vec![[0, 1, 2], [2, 1, 0]]).unwrap();
        let lamps = Object::<Lambertian>::new((0..count).map(tile), white);
        let objects = vec![
            lamps.emitting([0.3; 3]).unwrap(),
            Object::mesh(mesh, white).emitting([2.0, 1.0, 3.0]).unwrap(),
        ];
        let scene: Scene<_, AreaLights, _> = Scene::new(objects, NoEnvironment).unwrap();
        agree(&seen_from([0.1, 1.0, 3.0], 60.0, scene).unwrap());
    }
}
