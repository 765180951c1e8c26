//! Scene files of Mitsuba 3: what they say, and what is wrong with them.
//!
//! Expected values are the defaults and conventions that Mitsuba documents and its sources have, named at each test.

#[path = "mitsuba/files.rs"]
mod files;
#[path = "mitsuba/loaded.rs"]
mod loaded;
#[path = "mitsuba/meshes.rs"]
mod meshes;
#[path = "mitsuba/mutated.rs"]
mod mutated;

use estimand::mitsuba::{
    BitmapFilter, Bsdf, Crop, Description, Distribution, Filter, Geometry, Integrator, Points,
    Projection, SceneError, Source, Texture, Wrap, read,
};
use files::Folder;
use glam::{DMat4, DVec2, DVec3};

/// The scene of a file with these elements.
fn scene(elements: &str) -> Result<Description, SceneError> {
    let folder = Folder::new();
    folder.write("mesh.ply", "");
    folder.write("image.png", "");
    read(folder.scene(elements), &[])
}

const SENSOR: &str = r#"<sensor type="perspective"><float name="fov" value="40"/></sensor>"#;

/// The scene of these elements and a sensor.
fn seen(elements: &str) -> Result<Description, SceneError> {
    scene(&format!("{SENSOR}{elements}"))
}

/// The BSDF of a sphere of this material.
fn material(bsdf: &str) -> Result<Bsdf, SceneError> {
    let scene = seen(&format!(r#"<shape type="sphere">{bsdf}</shape>"#))?;
    Ok((*scene.shapes[0].bsdf).clone())
}

fn grey(value: f64) -> Texture {
    Texture::Constant(DVec3::splat(value))
}

fn message<T: std::fmt::Debug>(result: Result<T, SceneError>) -> String {
    result.expect_err("an error").to_string()
}

#[test]
fn defaults_are_those_of_mitsuba() {
    let description = seen(r#"<shape type="sphere"/>"#).unwrap();
    assert_eq!(description.integrator, Integrator::default());
    let sensor = &description.sensors[0];
    assert_eq!((sensor.near_clip, sensor.far_clip), (1e-2, 1e4));
    assert_eq!((sensor.film.width, sensor.film.height), (768, 576));
    assert_eq!(sensor.film.filter, Filter::Gaussian { stddev: 0.5 });
    assert_eq!(sensor.sampler.points, Points::Independent);
    assert_eq!(sensor.sampler.sample_count, 4);
    let shape = &description.shapes[0];
    assert_eq!(
        shape.geometry,
        Geometry::Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
            flip_normals: false
        }
    );
    assert_eq!(
        *shape.bsdf,
        Bsdf::Diffuse {
            reflectance: grey(0.5)
        }
    );
}

#[test]
fn materials_have_their_defaults() {
    let Bsdf::Dielectric(glass) = material(r#"<bsdf type="dielectric"/>"#).unwrap() else {
        panic!("a dielectric");
    };
    assert_eq!((glass.int_ior, glass.ext_ior), (1.5046, 1.000_277));
    let Bsdf::RoughPlastic { plastic, roughness } =
        material(r#"<bsdf type="roughplastic"/>"#).unwrap()
    else {
        panic!("a plastic");
    };
    assert_eq!(plastic.int_ior, 1.49);
    assert_eq!(roughness.distribution, Distribution::Beckmann);
    assert_eq!(roughness.alpha_u, grey(0.1));
    let Bsdf::Conductor(mirror) = material(r#"<bsdf type="conductor"/>"#).unwrap() else {
        panic!("a conductor");
    };
    assert_eq!((mirror.eta, mirror.k), (grey(0.0), grey(1.0)));
}

/// Of Mitsuba 3.9.1: `mi.load_dict({"type": "conductor", "material": "Au"})`, variant `scalar_rgb`.
#[test]
fn metals_have_names() {
    let gold = material(r#"<bsdf type="conductor"><string name="material" value="Au"/></bsdf>"#);
    let Bsdf::Conductor(gold) = gold.unwrap() else {
        panic!("a conductor");
    };
    assert_eq!(
        gold.eta,
        Texture::Constant(DVec3::new(0.143_036, 0.375_307, 1.442_05))
    );
    let unknown = material(r#"<bsdf type="conductor"><string name="material" value="Xx"/></bsdf>"#);
    assert!(message(unknown).contains("Ag, Al, "));
}

#[test]
fn vectors_and_colours_have_several_spellings() {
    for position in [
        r#"<point name="position" x="1" y="2" z="3"/>"#,
        r#"<point name="position" value="1, 2, 3"/>"#,
        r#"<vector name="position" value="1 2 3"/>"#,
        r#"<transform name="to_world"><translate x="1" y="2" z="3"/></transform>"#,
        r#"<transform name="to_world"><matrix value="1 0 0 1  0 1 0 2  0 0 1 3  0 0 0 1"/></transform>"#,
    ] {
        for intensity in [
            r#"<rgb name="intensity" value="2"/>"#,
            r#"<rgb name="intensity" value="2, 2, 2"/>"#,
            r#"<float name="intensity" value="2"/>"#,
            r#"<integer name="intensity" value="2"/>"#,
            r#"<spectrum name="intensity" type="d65"><float name="scale" value="2"/></spectrum>"#,
        ] {
            let light = seen(&format!(
                r#"<emitter type="point">{position}{intensity}</emitter>"#
            ));
            let [emitter] = &light.unwrap().emitters[..] else {
                panic!("one emitter");
            };
            let expected = Source::Point {
                position: DVec3::new(1.0, 2.0, 3.0),
                intensity: DVec3::splat(2.0),
            };
            assert_eq!(emitter.source, expected, "{position} {intensity}");
        }
    }
}

/// `parse_transform_node` of Mitsuba's `src/core/parser.cpp`: each step is applied after those before it.
#[test]
fn transforms_are_chained_in_their_order() {
    let scene = seen(
        r#"<shape type="cube"><transform name="to_world">
            <scale value="2"/><rotate z="1" angle="90"/><translate value="1, 0, 0"/>
            <matrix value="1 0 0  0 1 0  0 0 3"/>
        </transform></shape>"#,
    );
    let to_world: DMat4 = scene.unwrap().shapes[0].to_world;
    let moved = to_world.transform_point3(DVec3::new(1.0, 0.0, 1.0));
    assert!(
        moved.abs_diff_eq(DVec3::new(1.0, 2.0, 6.0), 1e-15),
        "{moved}"
    );
}

#[test]
fn parameters_have_defaults_and_overrides() {
    let folder = Folder::new();
    let file = folder.scene(&format!(
        r#"<default name="depth" value="3"/><default name="kind" value="path"/>
        <integrator type="$kind"><integer name="max_depth" value="$depth"/></integrator>{SENSOR}"#
    ));
    let depth = |overrides| read(&file, overrides).map(|scene| scene.integrator.max_depth);
    assert_eq!(depth(&[]), Ok(Some(3)));
    assert_eq!(depth(&[("depth", "7")]), Ok(Some(7)));
    assert_eq!(depth(&[("depth", "-1")]), Ok(None));
    assert!(message(depth(&[("dept", "7")])).contains("`dept` was given"));
    assert!(message(seen(r#"<integrator type="$none"/>"#)).contains("$none has no value"));
}

#[test]
fn files_are_included() {
    let folder = Folder::new();
    folder.write(
        "parts/glass.xml",
        r#"<bsdf version="3.0.0" type="dielectric" id="glass"/>"#,
    );
    folder.write(
        "parts/more.xml",
        r#"<scene version="3.0.0"><include filename="glass.xml"/><alias id="glass" as="pane"/></scene>"#,
    );
    let file = folder.scene(&format!(
        r#"{SENSOR}<path value="parts"/><include filename="more.xml"/>
        <shape type="sphere"><ref id="pane"/></shape><shape type="cube"><ref id="glass"/></shape>"#
    ));
    let scene = read(file, &[]).unwrap();
    assert!(matches!(*scene.shapes[0].bsdf, Bsdf::Dielectric(_)));
    assert!(std::sync::Arc::ptr_eq(
        &scene.shapes[0].bsdf,
        &scene.shapes[1].bsdf
    ));
}

#[test]
fn what_nothing_refers_to_is_not_loaded() {
    let scene = seen(
        r#"<bsdf type="hair" id="fur"/><emitter type="area" id="lamp"/><shape type="sphere"><ref id="lamp"/></shape>
        <shape type="shapegroup" id="none"><shape type="ply"><string name="filename" value="no"/></shape></shape>"#,
    );
    let scene = scene.unwrap();
    assert_eq!(scene.shapes.len(), 1);
    let unused: Vec<_> = scene.unused.iter().map(|place| place.element()).collect();
    assert_eq!(
        unused,
        [r#"<bsdf type="hair">"#, r#"<shape type="shapegroup">"#]
    );
}

/// `upgrade_from_v1` of Mitsuba's `src/core/parser.cpp`.
#[test]
fn old_files_are_upgraded() {
    let folder = Folder::new();
    folder.write("image.png", "");
    folder.write(
        "scene.xml",
        format!(
            r#"<scene version="0.6.0">{SENSOR}<shape type="sphere">
            <transform name="toWorld"><scale value="2"/></transform>
            <bsdf type="diffuse"><texture type="bitmap" name="diffuseReflectance">
                <string name="filename" value="image.png"/><string name="wrapMode" value="clamp"/>
                <string name="filterType" value="nearest"/>
                <float name="uscale" value="3"/><float name="voffset" value="0.5"/>
            </texture></bsdf></shape></scene>"#
        ),
    );
    let scene = read(folder.path("scene.xml"), &[]).unwrap();
    assert_eq!(
        scene.shapes[0].to_world,
        DMat4::from_scale(DVec3::splat(2.0))
    );
    let Bsdf::Diffuse {
        reflectance: Texture::Bitmap(bitmap),
    } = &*scene.shapes[0].bsdf
    else {
        panic!("a bitmap");
    };
    assert_eq!(
        (bitmap.wrap, bitmap.filter),
        (Wrap::Clamp, BitmapFilter::Nearest)
    );
    assert_eq!(
        bitmap.to_uv.transform_point2(DVec2::ONE),
        DVec2::new(3.0, 1.5)
    );
}

/// `parse_fov` of Mitsuba's `src/render/sensor.cpp`, for a film twice as wide as high.
#[test]
fn fields_of_view_are_across() {
    let fov = |properties: &str| {
        let scene = scene(&format!(
            r#"<sensor type="perspective">{properties}<film type="hdrfilm">
            <integer name="width" value="200"/><integer name="height" value="100"/></film></sensor>"#
        ));
        match scene.unwrap().sensors[0].projection {
            Projection::Perspective { fov, .. } => fov,
            other => panic!("{other:?}"),
        }
    };
    let along = |axis: &str| {
        fov(&format!(
            r#"<float name="fov" value="90"/><string name="fov_axis" value="{axis}"/>"#
        ))
    };
    let across = 2.0 * 2.0_f64.atan().to_degrees();
    for (axis, expected) in [
        ("x", 90.0),
        ("larger", 90.0),
        ("y", across),
        ("smaller", across),
    ] {
        assert!((along(axis) - expected).abs() < 1e-12, "{axis}");
    }
    let diagonal = 2.0 * (1.0 / 1.25_f64.sqrt()).atan().to_degrees();
    assert!((along("diagonal") - diagonal).abs() < 1e-12);
    let by_length = fov(r#"<string name="focal_length" value="50mm"/>"#);
    let half = 1872.0_f64.sqrt() / 100.0 / 1.25_f64.sqrt();
    assert!((by_length - 2.0 * half.atan().to_degrees()).abs() < 1e-12);
}

#[test]
fn films_are_cropped() {
    let film = |properties: &str| {
        scene(&format!(
            r#"<sensor type="orthographic"><film type="hdrfilm"><integer name="width" value="20"/>
            <integer name="height" value="10"/>{properties}</film></sensor>"#
        ))
        .map(|scene| scene.sensors[0].film.clone())
    };
    let crop =
        r#"<integer name="crop_offset_x" value="4"/><integer name="crop_width" value="16"/>"#;
    assert_eq!(
        film(crop).unwrap().crop,
        Crop {
            x: 4,
            y: 0,
            width: 16,
            height: 10
        }
    );
    let outside =
        r#"<integer name="crop_offset_x" value="5"/><integer name="crop_width" value="16"/>"#;
    assert!(message(film(outside)).contains("16 x 10 at 5, 0 of 20 x 10"));
    assert!(message(film(r#"<integer name="crop_width" value="0"/>"#)).contains("not be empty"));
}

#[test]
fn errors_name_file_line_and_element() {
    let folder = Folder::new();
    let file = folder.scene(&format!(
        "{SENSOR}\n\n<shape type=\"sphere\">\n<bsdf type=\"hair\"/></shape>"
    ));
    let error = read(&file, &[]).unwrap_err();
    assert_eq!(error.file, file);
    assert_eq!(error.line, Some(4));
    assert_eq!(error.element.as_deref(), Some("<bsdf type=\"hair\">"));
    assert!(error.message.contains("there are diffuse, twosided"));
}

#[test]
fn what_is_wrong_is_told() {
    let sphere = |inside: &str| format!(r#"<shape type="sphere">{inside}</shape>"#);
    let cases = [
        (sphere(r#"<float name="radios" value="1"/>"#), "has no property `radios`; it has center"),
        (sphere(r#"<string name="radius" value="1"/>"#), "`radius` must be a float; it is a string"),
        (sphere(r#"<float name="radius" value="-1"/>"#), "`radius` must be above 0; it is -1"),
        (sphere(r#"<float name="radius" value="nan"/>"#), "`nan` is not a finite 32-bit number"),
        (sphere(r#"<float name="radius" value="1e39"/>"#), "`1e39` is not a finite 32-bit number"),
        (sphere(r#"<float name="radius"/>"#), "the attribute `value` is missing"),
        (sphere(r#"<float name="radius" value="1" unit="m"/>"#), "unexpected attribute `unit`"),
        (sphere(r#"<float name="radius" value="1"/><float name="radius" value="1"/>"#), "given twice"),
        (sphere(r#"<ref id="none"/>"#), "there is no object with the id `none`"),
        (sphere(r#"<sensor type="perspective"/>"#), "does not belong in <shape type=\"sphere\">"),
        (sphere(r#"<medium type="homogeneous"/>"#), "media are not supported"),
        (sphere("text"), "unexpected text"),
        (sphere("<bsdf type=\"diffuse\"/><bsdf type=\"diffuse\"/>"), "at most one BSDF"),
        (
            sphere(r#"<transform name="to_world"><scale value="0"/></transform>"#),
            "cannot be inverted; its determinant is 0",
        ),
        (
            sphere(r#"<transform name="to_world"><scale value="1e38"/><scale value="1e38"/><scale value="1e38"/></transform>"#),
            "cannot be inverted; its determinant is inf",
        ),
        (
            sphere(r#"<transform name="to_world"><lookat origin="0 0 0" target="0 0 0"/></transform>"#),
            "the target must differ from the origin",
        ),
        (sphere(r#"<transform name="to_world"><shear/></transform>"#), "no step of a transform"),
        (sphere(r#"<bsdf type="diffuse"><rgb name="reflectance" value="2"/></bsdf>"#), "must be in [0, 1]"),
        (sphere(r##"<bsdf type="diffuse"><rgb name="reflectance" value="#ffffff"/></bsdf>"##), "no hexadecimal colours"),
        (sphere(r#"<bsdf type="twosided"><bsdf type="dielectric"/></bsdf>"#), "only opaque materials"),
        (sphere(r#"<bsdf type="mask"/>"#), "exactly one BSDF"),
        (r#"<shape type="ply"><string name="filename" value="no.ply"/></shape>"#.to_owned(), "no such file: `no.ply`"),
        (r#"<shape type="serialized"/>"#.to_owned(), "convert other meshes to PLY"),
        (r#"<integrator type="aov"/>"#.to_owned(), "there are path, direct and moment"),
        (r#"<emitter type="constant"/><emitter type="constant"/>"#.to_owned(), "at most one constant or envmap"),
        (r#"<emitter type="sunsky"/>"#.to_owned(), "there are point, spot"),
        (r#"<include filename="scene.xml"/>"#.to_owned(), "includes itself"),
        (r#"<include filename="none.xml"/>"#.to_owned(), "no such file"),
        (r#"<path value="none"/>"#.to_owned(), "no such folder"),
        (r#"<bsdf type="diffuse" id="a"/><bsdf type="null" id="a"/>"#.to_owned(), "the id `a` is taken"),
        (r#"<bsdf type="mask" id="a"><ref id="a"/></bsdf><shape type="cube"><ref id="a"/></shape>"#.to_owned(), "within itself"),
        ("<colour/>".to_owned(), "no element of Mitsuba's scene files"),
        ("<shape type=\"sphere\">".to_owned(), "expected"),
    ];
    for (elements, expected) in cases {
        let error = message(seen(&elements));
        assert!(error.contains(expected), "{elements}\n{error}");
        assert!(error.contains("scene.xml"), "{error}");
    }
    assert!(message(scene("")).contains("needs a sensor"));
}

#[test]
fn no_file_is_too_deep() {
    let folder = Folder::new();
    let deep = "<bsdf type=\"twosided\">".repeat(20_000);
    let file = folder.scene(&deep);
    assert!(read(&file, &[]).is_err());
    let closed = format!("{deep}{}", "</bsdf>".repeat(20_000));
    assert!(message(read(folder.scene(&closed), &[])).contains("nested more than 64 deep"));
    for level in 0..20 {
        let next = format!(
            r#"<scene version="3.0.0"><include filename="{}.xml"/></scene>"#,
            level + 1
        );
        folder.write(&format!("{level}.xml"), &next);
    }
    assert!(message(read(folder.path("0.xml"), &[])).contains("included more than 15 deep"));
    // Each level refers twice to the next: 2^15 if they were not shared.
    let blend = |level| {
        format!(
            r#"<bsdf type="blendbsdf" id="b{level}"><float name="weight" value="1"/><ref id="b{0}"/><ref id="b{0}"/></bsdf>"#,
            level + 1
        )
    };
    let wide: String = (0..13).map(blend).collect();
    let wide = format!(
        r#"{SENSOR}{wide}<bsdf type="null" id="b13"/><shape type="cube"><ref id="b0"/></shape>"#
    );
    assert!(read(folder.scene(&wide), &[]).is_ok());
}

/// Errors name the element that they are about.
#[test]
fn techniques_must_find_the_light() {
    for (scene, expected) in [
        (
            r#"<integrator type="direct"><integer name="emitter_samples" value="0"/></integrator><emitter type="point"/>"#,
            "<integrator type=\"direct\">: without `emitter_samples`",
        ),
        (
            r#"<integrator type="direct"><integer name="bsdf_samples" value="0"/></integrator>
            <shape type="sphere"><bsdf type="conductor"/></shape>"#,
            "<integrator type=\"direct\">: without `bsdf_samples`",
        ),
        (
            r#"<integrator type="volpath"><integer name="max_depth" value="3"/></integrator>
            <shape type="sphere"><bsdf type="null"/></shape>"#,
            "<integrator type=\"volpath\">: without media",
        ),
        (
            r#"<integrator type="volpath"/><emitter type="point"/>
            <shape type="sphere"><bsdf type="mask"><bsdf type="diffuse"/></bsdf></shape>"#,
            "<integrator type=\"volpath\">: without media",
        ),
        (
            r#"<integrator type="volpath"><boolean name="hide_emitters" value="true"/></integrator>
            <shape type="sphere"><bsdf type="thindielectric"/></shape>"#,
            "<integrator type=\"volpath\">: without media",
        ),
    ] {
        let message = message(seen(scene));
        assert!(message.contains(expected), "{message}");
    }
}

/// Mitsuba 3.9.1: `ScalarTransform4f().rotate([0.4, 0.8, 0.3], 40)`.
#[test]
fn axes_of_rotations_are_taken_as_they_are() {
    let scene = seen(
        r#"<shape type="cube"><transform name="to_world">
            <rotate value="0.4 0.8 0.3" angle="40"/>
        </transform></shape>"#,
    );
    let to_world: DMat4 = scene.unwrap().shapes[0].to_world;
    #[rustfmt::skip]
    let rows = [
        0.803_477_35, -0.117_970_50, 0.542_304_75, 0.0,
        0.267_702_07, 0.915_776_01, -0.200_965_70, 0.0,
        -0.486_155_39, 0.313_264_37, 0.787_100_43, 0.0,
        0.0, 0.0, 0.0, 1.0,
    ];
    let expected = DMat4::from_cols_array(&rows).transpose();
    assert!(to_world.abs_diff_eq(expected, 1e-6), "{to_world}");
}
