//! Scenes that are loaded: as the smallest type that is enough, which gives the same picture as the general one.

use estimand::mitsuba::{Instance, Loaded, read};
use estimand::points::{Independent, pixel};
use glam::DVec3;

use crate::files::Folder;

/// The mean over the picture of a scene of 8 by 8 pixels, its standard error, and the mean number of coordinates of a path.
struct Seen {
    mean: DVec3,
    std_error: DVec3,
    coordinates: f64,
    left_out: Vec<String>,
    /// Whether its lights are chosen by a tree.
    by_tree: bool,
}

const COUNT: u64 = 256;

fn see(scene: &str, instance: Instance) -> Seen {
    let folder = Folder::new();
    let file = folder.scene(&format!(
        r#"<sensor type="perspective"><float name="fov" value="50"/>
        <transform name="to_world"><lookat origin="0 1 -5" target="0 0 0" up="0 1 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/>
        <rfilter type="box"/></film></sensor>{scene}"#
    ));
    let loaded = read(&file, &[])
        .and_then(|description| description.load(instance))
        .unwrap();
    let Loaded {
        picture,
        size,
        left_out,
    } = loaded;
    assert_eq!(size, [8, 8]);
    let (mut sum, mut squares, mut coordinates) = (DVec3::ZERO, DVec3::ZERO, 0);
    for y in 0..8 {
        for x in 0..8 {
            // Different points for the two instances: they are two estimates of the same.
            let seed = pixel::seed([x, y], instance as u64);
            let points = Independent::new(seed);
            // One value for each half of the points gives the error.
            let half = |seed: u64| {
                let estimate = picture.average([x, y], size, &Independent::new(seed), COUNT);
                estimate.unwrap().mean
            };
            let [a, b] = [half(seed), half(!seed)];
            sum += 0.5 * (a + b);
            squares += 0.25 * (a - b) * (a - b);
            coordinates += picture.coordinates([x, y], size, &points, 0);
        }
    }
    Seen {
        mean: sum / 64.0,
        std_error: squares.map(f64::sqrt) / 64.0,
        coordinates: coordinates as f64 / 64.0,
        by_tree: format!("{picture:?}").contains("LightTree"),
        left_out,
    }
}

const WHITE: &str = r#"<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>"#;

/// Five families of scenes; the means of three channels each differ by at most five standard errors of independent estimates.
/// The errors are those of 64 pixels with one degree of freedom each, about those of a normal distribution: a false
/// alarm has a probability of about 6e-7 a channel, 1e-5 in all.
#[test]
fn the_smallest_instance_gives_the_picture_of_the_general_one() {
    let ball = format!(r#"<shape type="sphere">{WHITE}</shape>"#);
    let lamp = r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><translate y="3"/></transform>
        <emitter type="area"><rgb name="radiance" value="8 4 2"/></emitter></shape>"#;
    let tiles = r#"<shape type="sphere"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"/></bsdf></shape>"#;
    let gold = r#"<shape type="sphere"><bsdf type="roughconductor"><string name="material" value="Au"/></bsdf></shape>"#;
    let spot = r#"<emitter type="point"><point name="position" value="0 3 -3"/><rgb name="intensity" value="20"/></emitter>"#;
    for (scene, expected) in [
        (
            format!("{ball}{lamp}"),
            vec![
                "textures",
                "laws",
                "lights without size",
                "environment",
                "lens",
                "instances",
            ],
        ),
        (
            format!(r#"{ball}<emitter type="constant"/>"#),
            vec![
                "textures",
                "laws",
                "shapes that emit",
                "lights without size",
                "lens",
                "instances",
            ],
        ),
        (
            format!("{gold}{lamp}"),
            vec![
                "textures",
                "lights without size",
                "environment",
                "lens",
                "instances",
            ],
        ),
        (
            format!("{tiles}{spot}"),
            vec!["shapes that emit", "lens", "instances"],
        ),
        (format!("{tiles}{spot}{lamp}"), vec!["lens", "instances"]),
    ] {
        let small = see(&scene, Instance::Smallest);
        let general = see(&scene, Instance::General);
        assert!(small.mean.min_element() > 0.0);
        let error = (small.std_error * small.std_error + general.std_error * general.std_error)
            .map(f64::sqrt);
        let off = (small.mean - general.mean).abs();
        assert!(
            off.cmple(5.0 * error).all(),
            "{scene}: {} {}",
            small.mean,
            general.mean
        );
        assert!(small.coordinates <= general.coordinates, "{scene}");
        assert!(general.left_out.is_empty(), "{:?}", general.left_out);
        assert_eq!(small.left_out.len(), expected.len(), "{:?}", small.left_out);
        for (part, expected) in small.left_out.iter().zip(expected) {
            assert!(part.contains(expected), "{part}");
        }
    }
}

/// Twenty-four balls that shine over a ground, so many units apart.
fn lamps(apart: f64) -> String {
    let lamp = |lamp: u32| {
        let (x, z) = (f64::from(lamp % 6) - 2.5, f64::from(lamp / 6) - 1.5);
        format!(
            r#"<shape type="sphere"><float name="radius" value="0.01"/><transform name="to_world"><translate x="{}" y="-0.5"
            z="{}"/></transform><emitter type="area"><rgb name="radiance" value="{} 400 200"/></emitter></shape>"#,
            x * apart,
            z * apart,
            100 + lamp % 5 * 1000
        )
    };
    (0..24).map(lamp).collect()
}

/// Lamps far from one another, without and with a sky: the smallest type draws them by a tree, the general one by
/// their power. The same test as above for 2 scenes of 3 channels: 4e-6. The tree has the smaller
/// errors. Lamps close together are drawn by their power in either.
#[test]
fn lights_far_apart_give_the_same_picture_by_a_tree_as_by_power() {
    let ground = format!(
        r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="20"/>
        <translate y="-1"/></transform>{WHITE}</shape>"#
    );
    // Lamps that are seen would be most of the noise.
    let hidden =
        r#"<integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>"#;
    let around = r#"<emitter type="constant"><rgb name="radiance" value="0.01"/></emitter>"#;
    for extra in ["", around] {
        let scene = format!("{hidden}{ground}{}{extra}", lamps(2.0));
        let [tree, power] = [Instance::Smallest, Instance::General].map(|it| see(&scene, it));
        assert!(tree.by_tree && !power.by_tree);
        let variance = tree.std_error * tree.std_error + power.std_error * power.std_error;
        let off = (tree.mean - power.mean).abs();
        assert!(
            off.cmple(5.0 * variance.map(f64::sqrt)).all(),
            "{} {}",
            tree.mean,
            power.mean
        );
        assert!(tree.std_error.y < power.std_error.y);
        let parts = tree.left_out.join(", ");
        assert!(!parts.contains("shapes that emit light"), "{parts}");
        assert_eq!(
            parts.contains("an environment"),
            extra.is_empty(),
            "{parts}"
        );
    }
    let together = format!("{ground}{}", lamps(0.05));
    assert!(!see(&together, Instance::Smallest).by_tree);
}

/// A diffuse ball in a constant environment: two coordinates for the film, and where a path hits the ball two for its next
/// direction, which leaves.
#[test]
fn absent_parts_draw_no_coordinates() {
    let ball = format!(
        r#"<integrator type="path"/><shape type="sphere"><float name="radius" value="50"/>{WHITE}</shape>
        <emitter type="constant"/>"#
    );
    // The camera is inside, and no path leaves: 4 vertices without roulette, 2 + 2 each, then 3 each.
    let inside = ball.replace(
        "<integrator type=\"path\"/>",
        r#"<integrator type="path"><integer name="max_depth" value="4"/></integrator>"#,
    );
    assert_eq!(
        see(&inside, Instance::Smallest).coordinates,
        2.0 + 2.0 * 3.0
    );
}

#[test]
fn what_contributes_nothing_is_left_out() {
    let scene = format!(
        r#"<shape type="sphere">{WHITE}</shape><emitter type="constant"/>
        <emitter type="point"><rgb name="intensity" value="0"/></emitter>
        <shape type="rectangle"><emitter type="area"><rgb name="radiance" value="0"/></emitter></shape>
        <bsdf type="conductor" id="spare"/>"#
    );
    let left_out = see(&scene, Instance::Smallest).left_out;
    for expected in [
        "<emitter type=\"point\">",
        "the light of <shape type=\"rectangle\">",
        "<bsdf type=\"conductor\">",
        "shapes that emit light",
        "lights without size",
    ] {
        assert!(
            left_out.iter().any(|part| part.contains(expected)),
            "{expected}: {left_out:?}"
        );
    }
}

#[test]
fn triangles_without_area_are_counted() {
    let folder = Folder::new();
    folder.write(
        "mesh.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 2 2 2\n",
    );
    let file = folder.scene(
        r#"<sensor type="perspective"/><shape type="obj"><string name="filename" value="mesh.obj"/></shape>"#,
    );
    let loaded = read(&file, &[]).unwrap().load(Instance::Smallest).unwrap();
    assert!(
        loaded
            .left_out
            .contains(&"2 triangles without area".to_owned())
    );
}

#[test]
fn what_the_tracer_lacks_is_told() {
    let folder = Folder::new();
    for (scene, expected) in [
        (
            r#"<integrator type="path"><integer name="max_depth" value="0"/></integrator>"#,
            "at least 1",
        ),
        (
            r#"<shape type="sphere"><transform name="to_world"><scale x="2"/></transform></shape>"#,
            "scaled alike in all directions",
        ),
    ] {
        let file = folder.scene(&format!(r#"<sensor type="perspective"/>{scene}"#));
        let error = read(file, &[])
            .unwrap()
            .load(Instance::Smallest)
            .unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}

/// A wall that fills the picture and a light that is the same all over it: the same value for every path.
fn even(scene: &str) -> DVec3 {
    let seen = see(scene, Instance::Smallest);
    assert!(seen.std_error.max_element() < 1e-6, "{}", seen.std_error);
    seen.mean
}

const TO_WALL: &str =
    r#"<transform name="to_world"><scale value="50"/><rotate y="1" angle="180"/></transform>"#;

/// Below a sky of radiance 1 a single plane has the radiance of its reflectance. The first of three triangles has no area: it
/// is dropped, and the values of the others stay theirs.
#[test]
fn attributes_of_meshes_are_textures() {
    let folder = Folder::new();
    let ply = folder.write(
        "wall.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         property float tone_0\nelement face 3\nproperty list uchar int vertex_indices\nproperty float r\n\
         property float g\nproperty float b\nend_header\n-1 -1 0 0.5\n1 -1 0 0.5\n1 1 0 0.5\n-1 1 0 0.5\n\
         3 0 0 1 0.9 0.9 0.9\n3 0 1 2 0.25 0.5 0.75\n3 0 2 3 0.25 0.5 0.75\n",
    );
    let wall = |name: &str, more: &str| {
        format!(
            r#"<shape type="ply"><string name="filename" value="{}"/>{TO_WALL}<bsdf type="diffuse">
            <texture name="reflectance" type="mesh_attribute"><string name="name" value="{name}"/>{more}</texture></bsdf></shape>
            <emitter type="constant"/>"#,
            ply.display()
        )
    };
    let half = r#"<float name="scale" value="0.5"/>"#;
    for (scene, expected) in [
        (wall("face_color", ""), [0.25, 0.5, 0.75]),
        (wall("face_color", half), [0.125, 0.25, 0.375]),
        (wall("vertex_tone", ""), [0.5; 3]),
    ] {
        let mean = even(&scene);
        assert!((mean - DVec3::from(expected)).length() < 1e-6, "{mean}");
    }
    let file = folder.scene(&format!(
        r#"<sensor type="perspective"/>{}"#,
        wall("face_heat", "")
    ));
    let error = read(file, &[]).unwrap().load(Instance::Smallest);
    let message = error.unwrap_err().to_string();
    assert!(
        message.contains("no attribute `face_heat`; it has `vertex_tone`, `face_color`"),
        "{message}"
    );
}

/// A projector of irradiance 3 at a distance of 2 gives a plane of reflectance 1/2 the radiance 3/2/4; a slide that halves the
/// light of a spot is one of half the intensity.
#[test]
fn slides_and_projectors_light_a_wall() {
    let wall = format!(r#"<shape type="rectangle">{TO_WALL}</shape>"#);
    let at = r#"<transform name="to_world"><translate z="-2"/></transform>"#;
    let projector = format!(
        r#"{wall}<emitter type="projector">{at}<float name="fov" value="170"/><float name="scale" value="1.5"/>
        <float name="irradiance" value="2"/></emitter>"#
    );
    let mean = even(&projector);
    assert!((mean - DVec3::splat(0.375)).length() < 1e-5, "{mean}");
    let spot = |intensity: f64, slide: &str| {
        let spot = format!(
            r#"{wall}<emitter type="spot">{at}<float name="cutoff_angle" value="80"/>{slide}
            <float name="intensity" value="{intensity}"/></emitter>"#
        );
        see(&spot, Instance::Smallest).mean
    };
    let slide = r#"<texture name="texture" type="checkerboard"><float name="color0" value="0.5"/>
        <float name="color1" value="0.5"/></texture>"#;
    assert_eq!(spot(2.0, slide), spot(1.0, ""));
}

/// What shines may reflect as a texture has it: on a mesh as on a rectangle. The same test as above for one scene of 3 channels:
/// 2e-6.
#[test]
fn meshes_that_shine_keep_their_texture_coordinates() {
    let folder = Folder::new();
    let obj = folder.write(
        "square.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n",
    );
    let lamp = |shape: String| {
        format!(
            r#"<shape {shape}{TO_WALL}<bsdf type="diffuse"><texture name="reflectance" type="checkerboard">
            <float name="color0" value="1"/><float name="color1" value="0"/>
            <transform name="to_uv"><scale x="9" y="0.6"/></transform></texture></bsdf>
            <emitter type="area"><rgb name="radiance" value="0.1 0.2 0.3"/></emitter></shape><emitter type="constant"/>"#
        )
    };
    let file = format!(
        r#"type="obj"><string name="filename" value="{}"/><boolean name="flip_tex_coords" value="false"/>"#,
        obj.display()
    );
    let [mesh, rectangle] = [file, r#"type="rectangle">"#.to_owned()]
        .map(|shape| see(&lamp(shape), Instance::Smallest));
    let variance = mesh.std_error * mesh.std_error + rectangle.std_error * rectangle.std_error;
    let off = (mesh.mean - rectangle.mean).abs();
    assert!(
        off.cmple(5.0 * variance.map(f64::sqrt) + 1e-6).all(),
        "{} {}",
        mesh.mean,
        rectangle.mean
    );
}

/// What is around a pane that light passes straight through: with lights hidden, Mitsuba's `path` has 0 there, its `direct` 1 (Mitsuba 3.9.1, `scalar_rgb`).
#[test]
fn direct_light_is_hidden_in_front_alone() {
    let scene = |integrator: &str, bsdf: &str| {
        format!(
            r#"<integrator type="{integrator}"><boolean name="hide_emitters" value="true"/></integrator>
            <shape type="rectangle">{TO_WALL}<bsdf type="{bsdf}"/></shape><emitter type="constant"/>"#
        )
    };
    assert_eq!(even(&scene("path", "null")), DVec3::ZERO);
    assert_eq!(even(&scene("direct", "null")), DVec3::ONE);
    assert_eq!(even(&scene("direct", "thindielectric")), DVec3::ONE);
    let nothing = r#"<integrator type="direct"><boolean name="hide_emitters" value="true"/></integrator><emitter type="constant"/>"#;
    assert_eq!(even(nothing), DVec3::ZERO);
}
