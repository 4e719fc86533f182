//! What users can get wrong in files, and what they are told: where it is, what it is, how to mend it.

mod common;

use common::{folder, meniscus, program, run, text, words, write};

/// A deflection that is right; the tests break it.
const DEFLECTION: &str = "\
// Straight on.
//
// provides: deflect
// needs: geometry/ray, optics/deflected

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    return Deflected(incident, false);
}
";

/// Breaks the deflection and has it rendered; the picture must not be there afterwards.
#[track_caller]
fn module_is_refused(from: &str, to: &str, expected: &[&str]) {
    assert!(DEFLECTION.contains(from), "{from}");
    let there = folder();
    write(
        &there.path().join("modules/optics/mine.wgsl"),
        DEFLECTION.replacen(from, to, 1),
    );
    let said = run(program().current_dir(&there).args(words(
        "--modules modules render refraction/combined --with narrow.deflect=optics/mine --size 16x9 -o x.png",
    )));
    said.refused(expected);
    assert!(!there.path().join("x.png").exists());
    // `check` finds it as well, though no pipeline uses the module.
    let place = expected[0];
    run(program()
        .current_dir(&there)
        .args(words("--modules modules check")))
    .refused(&[place]);
}

#[test]
fn the_module_that_is_broken_below_is_right() {
    let there = folder();
    write(&there.path().join("modules/optics/mine.wgsl"), DEFLECTION);
    let said = run(program().current_dir(&there).args(words(
        "--modules modules render refraction/combined --with narrow.deflect=optics/mine --size 16x9 -o x.png",
    )));
    said.done();
    assert!(there.path().join("x.png").exists());
}

#[test]
fn a_syntax_error_is_placed_in_the_module() {
    module_is_refused(
        "incident, false",
        "incident false",
        &["modules/optics/mine.wgsl:7:31", "expected `)`", "false"],
    );
}

#[test]
fn a_type_error_is_placed_in_the_module() {
    module_is_refused(
        "incident, false",
        "incident, 1.0",
        &["modules/optics/mine.wgsl:7:32", "bool", "Deflected"],
    );
}

#[test]
fn a_missing_need_is_named() {
    module_is_refused(
        ", optics/deflected",
        "",
        &[
            "modules/optics/mine.wgsl:6:",
            "Deflected",
            "optics/deflected",
            "needs",
        ],
    );
    module_is_refused(
        "// needs: geometry/ray, optics/deflected\n",
        "",
        &[
            "modules/optics/mine.wgsl:5:",
            "Ray",
            "geometry/ray",
            "needs",
        ],
    );
}

#[test]
fn a_wrong_signature_is_shown_beside_the_slots() {
    module_is_refused(
        "normal: vec3f",
        "normal: vec2f",
        &[
            "modules/optics/mine.wgsl:6:27",
            "signature",
            "slots/deflect.wgsl",
            "fn deflect(incident: Ray, normal: vec3f) -> Deflected",
        ],
    );
}

#[test]
fn a_module_for_an_unknown_slot_is_told_the_near_one() {
    module_is_refused(
        "provides: deflect",
        "provides: defect",
        &["modules/optics/mine.wgsl:3:14", "`defect`", "`deflect`"],
    );
}

#[test]
fn a_need_that_does_not_exist_is_placed_in_the_header() {
    module_is_refused(
        "geometry/ray,",
        "geometry/rey,",
        &[
            "modules/optics/mine.wgsl:4:",
            "geometry/rey",
            "geometry/ray",
        ],
    );
}

/// A pipeline whose parts the tests break.
const PIPELINE: &str = r#"Pipeline(
    about: "Looks through the water at what no pass has drawn.",
    textures: {
        "seen_colour":   (format: Rgba16Float, size: Guarded),
        "seen_position": (format: Rgba32Float, size: Guarded),
        "seen_normal":   (format: Rgba16Float, size: Guarded),
        "front_depth":   (format: Depth32Float, size: Frame),
        "frame":         (format: Rgba16Float, size: Frame),
    },
    sequence: [
        Screen(name: "narrow", skeleton: "passes/redirect", over: Water,
            slots: {
                "deflect": "optics/refracted_ray",
                "intersect": "geometry/tangent_plane",
                "reproject": "screen/through_flat_water",
                "colour": "screen/resampled",
            },
            writes: { "colour": "frame" }),
    ],
    output: (colour: "frame"),
)
"#;

/// A pipeline file by its path, and by its name in a directory.
#[track_caller]
fn pipeline_is_refused(pipeline: &str, expected: &[&str]) {
    let there = folder();
    write(&there.path().join("pipelines/mine.ron"), pipeline);
    for line in [
        "render pipelines/mine.ron --size 16x9 -o x.png",
        "ablate pipelines/mine.ron --size 16x9 --rounds 1",
        "--pipelines pipelines check mine",
        "--pipelines pipelines check",
    ] {
        let said = run(program().current_dir(&there).args(words(line)));
        said.refused(expected);
    }
    assert!(!there.path().join("x.png").exists());
}

#[test]
fn reading_before_writing_is_told_of_the_pass_and_the_texture() {
    pipeline_is_refused(
        PIPELINE,
        &[
            "pipelines/mine.ron:11:22",
            "`narrow` reads `seen_position` before any pass has written it",
            "put the pass that writes it before",
        ],
    );
}

#[test]
fn mistakes_in_ron_are_placed() {
    let variant = |of: &str, rest: &str| format!("Variant(\n    of: \"{of}\",\n    {rest}\n)\n");
    let combined = |rest: &str| variant("refraction/combined", rest);
    for (pipeline, expected) in [
        (
            "Variant(\n    of: \"refraction/combined\"\n    about: \"no comma\",\n)\n".to_owned(),
            &["pipelines/mine.ron:3:5", "comma"][..],
        ),
        (
            "Variant(of: \"refraction/combined\", about: \"open".to_owned(),
            &["pipelines/mine.ron:1:"],
        ),
        (String::new(), &["pipelines/mine.ron:1:1"]),
        (
            combined("about: \"x\", sets: {}"),
            &["pipelines/mine.ron:3:17", "`sets`", "did you mean `set`?"],
        ),
        (
            PIPELINE.replace("textures:", "texture:"),
            &[
                "pipelines/mine.ron:3:5",
                "`texture`",
                "did you mean `textures`?",
            ],
        ),
        (
            PIPELINE.replacen("Rgba16Float", "Rgba61Float", 1),
            &["pipelines/mine.ron:4:", "Rgba61Float", "Rgba16Float"],
        ),
        (
            variant("refraction/combind", "about: \"x\", set: {}"),
            &[
                "pipelines/mine.ron:2:9",
                "there is no pipeline `refraction/combind`",
                "`refraction/combined`",
            ],
        ),
        (
            combined("about: \"x\", set: { \"narrow.deflect\": \"optics/refracted_rey\" }"),
            &[
                "pipelines/mine.ron:3:42",
                "there is no module `optics/refracted_rey`",
                "did you mean `optics/refracted_ray`?",
            ],
        ),
        (
            combined("about: \"x\", set: { \"narrow.defect\": \"optics/refracted_ray\" }"),
            &[
                "pipelines/mine.ron:3:24",
                "there is no slot `defect`",
                "did you mean `deflect`?",
            ],
        ),
        (
            combined("about: \"x\", set: { \"narow.deflect\": \"optics/refracted_ray\" }"),
            &[
                "pipelines/mine.ron:3:24",
                "no pass `narow`",
                "did you mean `narrow`?",
            ],
        ),
        (
            combined("about: \"x\", set: { \"narrow.deflect\": \"geometry/tangent_plane\" }"),
            &[
                "pipelines/mine.ron:3:42",
                "fills the slot `intersect`, not `deflect`",
                "provides: deflect",
            ],
        ),
    ] {
        pipeline_is_refused(&pipeline, expected);
    }
}

#[test]
fn a_variant_of_itself_is_refused() {
    let there = folder();
    write(
        &there.path().join("mine.ron"),
        "Variant(of: \"mine\", about: \"x\", set: {})",
    );
    meniscus(["--pipelines", text(there.path()), "check", "mine"])
        .refused(&["mine.ron:1:", "mine"]);
}

/// A scene with one mesh file.
const SCENE: &str = r#"Scene(
    about: "One mesh.",
    camera: (position: (0, -3), height: 1.7, target: (0, 0, 0), field_of_view: 50),
    materials: {"red": (colour: (1, 0, 0))},
    objects: [(name: "thing", material: "red", shape: Mesh(file: "thing.obj"))],
)
"#;

#[track_caller]
fn mesh_is_refused(mesh: Option<&str>, expected: &[&str]) {
    let there = folder();
    write(&there.path().join("scenes/mine.ron"), SCENE);
    if let Some(mesh) = mesh {
        write(&there.path().join("scenes/thing.obj"), mesh);
    }
    for line in [
        "--scenes scenes render refraction/combined --scene mine --size 16x9 -o x.png",
        "render refraction/combined --scene scenes/mine.ron --size 16x9 -o x.png",
        "ablate refraction/combined --scene scenes/mine.ron --size 16x9 --rounds 1",
    ] {
        run(program().current_dir(&there).args(words(line))).refused(expected);
    }
}

#[test]
fn mistakes_in_meshes_are_placed() {
    mesh_is_refused(
        None,
        &[
            "scenes/mine.ron:5:",
            "thing.obj",
            "relative to the scene file",
        ],
    );
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (rest, expected) in [
        (
            "f 1 2 9\n",
            &["thing.obj:4:7", "out of range", "3 vertices"][..],
        ),
        ("f 1 2 0\n", &["thing.obj:4:7", "out of range"]),
        ("v nan 0 0\nf 1 2 4\n", &["thing.obj:4:3", "not finite"]),
        ("v 1e999 0 0\nf 1 2 4\n", &["thing.obj:4:3", "not finite"]),
        ("", &["thing.obj", "no faces"]),
    ] {
        mesh_is_refused(Some(&format!("{corners}{rest}")), expected);
    }
}

#[test]
fn mistakes_in_scene_files_are_placed() {
    for (from, to, expected) in [
        (
            "about: \"One mesh.\",",
            "about: \"One mesh.\"",
            &["mine.ron:3:5", "comma"][..],
        ),
        ("camera:", "camra:", &["mine.ron:3:5", "camra", "camera"]),
        (
            "height: 1.7",
            "height: NaN",
            &["mine.ron:3:", "camera.height", "not a finite number"],
        ),
        (
            "height: 1.7",
            "height: 1e999",
            &["mine.ron:3:", "camera.height", "not a finite number"],
        ),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let there = folder();
        let scene = there.path().join("mine.ron");
        write(&scene, SCENE.replacen(from, to, 1));
        meniscus([
            "render",
            "refraction/none",
            "--scene",
            text(&scene),
            "-o",
            "x.png",
        ])
        .refused(expected);
    }
}

#[test]
fn numbers_of_modules_are_refused_beyond_their_range() {
    let there = folder();
    let module = DEFLECTION
        .replace("// needs", "// number bend: 0 to 2, step 0.1\n// needs")
        .replace("fn deflect", "override bend: f32 = 1.0;\n\nfn deflect")
        .replace("(incident, false)", "(incident, bend > 3.0)");
    write(&there.path().join("modules/optics/mine.wgsl"), module);
    let with = |number: &str| {
        run(program().current_dir(&there).args(words(&format!(
            "--modules modules render refraction/combined --size 16x9 -o x.png \
             --with narrow.deflect=optics/mine --with narrow.deflect.bend={number}"
        ))))
    };
    with("1.5").done();
    for wrong in ["NaN", "1e999", "-inf"] {
        with(wrong).refused(&["--with narrow.deflect.bend:1:1", "finite"]);
    }
    for wrong in ["-0.5", "2.5", "1e30"] {
        with(wrong).refused(&["--with narrow.deflect.bend:1:1", "0 to 2"]);
    }
}
