//! What is said about mistakes: where they are, what they are, how to mend them.

mod common;

use common::{built_in, load, load_mesh, text_with};
use meniscus_scene::{Library, SceneSource, Setting};

const BOX: &str = "Box(size: (1, 1, 1))";

/// The message for a text and settings, which must be refused.
fn refused(text: &str, settings: &[&str]) -> String {
    match load(text, settings) {
        Ok(_) => panic!("accepted: {text} {settings:?}"),
        Err(report) => report.to_string(),
    }
}

fn says(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "`{word}` is missing in\n{message}");
    }
}

#[test]
fn mistakes_in_scene_files_are_placed_and_explained() {
    let good = text_with(BOX, "");
    load(&good, &[]).unwrap();
    for (from, to, words) in [
        ("camera: (", "camera (", &["test.ron:2:"][..]),
        (
            "height: 2",
            "hieght: 2",
            &["test.ron:2:", "hieght", "height"],
        ),
        ("height: 2", "height: \"high\"", &["test.ron:2:", "number"]),
        (
            "height: 2",
            "height: NaN",
            &["test.ron:2:", "camera.height", "not a finite number"],
        ),
        (
            "height: 2",
            "height: 1e999",
            &["test.ron:2:", "camera.height", "-100000 to 100000"],
        ),
        (
            "height: 2, target: (0, 0, 0)",
            "height: 0, target: (0, -9, 0)",
            &["test.ron:2:", "stands where it looks at"],
        ),
        (
            "wavelength: 1",
            "wavelength: -1",
            &["test.ron:3:", "wavelength", "0.001 to 10000"],
        ),
        (
            "material: \"m\"",
            "material: \"n\"",
            &["test.ron:5:", "unknown material `n`", "`m`"],
        ),
        (
            "0.5, 0.5, 0.5",
            "0.5, 0.5, 1.5",
            &["test.ron:4:", "colour", "0 to 1"],
        ),
        (
            "Box(size: (1, 1, 1))",
            "Box(size: (1, inf, 1))",
            &["test.ron:5:", "size", "finite"],
        ),
        (
            "Box(size: (1, 1, 1))",
            "Bax(size: (1, 1, 1))",
            &["test.ron:5:", "Bax", "Box"],
        ),
        (
            "Box(size: (1, 1, 1))",
            "Torus(radius: 1, tube: 2)",
            &["test.ron:5:", "tube", "0.0001 to 1"],
        ),
        (
            "Box(size: (1, 1, 1)), ",
            "Box(size: (1e4, 1e4, 1e4)), edge: 0.001",
            &["test.ron:5:", "triangles", "edge"],
        ),
        (
            "Box(size: (1, 1, 1)), ",
            "Box(size: (1, 1, 1)), translate: (1e6, 0, 0), ",
            &["test.ron:5:", "further"],
        ),
        (
            "objects: [",
            "objects: [(name: \"thing\", material: \"m\", shape: Sphere(radius: 1)), ",
            &["test.ron:5:", "two objects"],
        ),
        (
            "materials: {",
            "materials: {\"m\": (colour: (1, 1, 1)), ",
            &["test.ron:4:", "twice"],
        ),
        (
            "materials: {",
            "pool: (triangles: \"many\"), materials: {",
            &["test.ron:4:", "many", "16k"],
        ),
    ] {
        assert!(good.contains(from), "{from}");
        says(&refused(&good.replacen(from, to, 1), &[]), words);
    }
    says(&refused("", &[]), &["test.ron:1:1"]);
    says(
        &refused(
            "Scene(about: \"x\", camera: (position: (0, 0), height: 1, target: (1, 0, 0)), objects: [])",
            &[],
        ),
        &["no triangles"],
    );
}

#[test]
fn mistakes_in_settings_show_the_setting_and_what_would_do() {
    let good = text_with(BOX, "");
    for (setting, words) in [
        (
            "water.rms_slop=0.1",
            &[
                "unknown setting",
                "did you mean `water.rms_slope`?",
                "camera.height",
            ][..],
        ),
        ("banana=1", &["unknown setting `banana`", "water.time"]),
        (
            "water.rms_slope=NaN",
            &["--set:1:17", "not a finite number", "0 to 4"],
        ),
        ("water.time=inf", &["--set:1:12", "not a finite number"]),
        (
            "water.time=1e999",
            &["--set:1:12", "not a finite number", "-1000000 to 1000000"],
        ),
        ("water.rms_slope=-0.1", &["out of range", "0 to 4"]),
        ("camera.height=tall", &["must be a number, not `tall`"]),
        ("camera.height=", &["must be a number"]),
        ("water.geometry=wavy", &["flat or displaced"]),
        ("pool.triangles=16q", &["must be a count", "16k"]),
        ("pool.triangles=NaN", &["not a finite number"]),
        ("pool.triangles=99M", &["out of range"]),
        ("camera.near=0", &["out of range"]),
    ] {
        says(&refused(&good, &[setting]), words);
    }
    says(
        &refused(&good, &["water.time=NaN", "camera.near=0"]),
        &["water.time", "camera.near"],
    );
    let no_waves = good.replace("(direction: 10, wavelength: 1)", "");
    says(&refused(&no_waves, &["water.rms_slope=0.1"]), &["no waves"]);
    for wrong in ["water.time", "=3", ""] {
        says(
            &Setting::parse("--set", wrong).unwrap_err().render(),
            &["KEY=VALUE"],
        );
    }
}

#[test]
fn mistakes_in_obj_files_name_file_and_line() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    for (rest, words) in [
        (
            "f 1 2 9\n",
            &["thing.obj:5:7", "out of range", "there are 4 vertices"][..],
        ),
        ("f 1 2 0\n", &["thing.obj:5:7", "out of range", "from 1"]),
        ("f 1 2 -5\n", &["thing.obj:5:7", "out of range"]),
        ("f 1/7 2/1 3/1\n", &["thing.obj:5:3", "texture coordinates"]),
        (
            "f 1//-9223372036854775808 2//1 3//1\n",
            &["thing.obj:5:3", "there are 0 normals"],
        ),
        (
            "vn 0 0 1\nf 1//1 2//1 3//2\n",
            &["thing.obj:6:", "there are 1 normals"],
        ),
        ("f 1 2\n", &["thing.obj:5:1", "three corners"]),
        ("f 1 2 x\n", &["thing.obj:5:7", "index"]),
        ("f 1/1/1/1 2 3\n", &["thing.obj:5:3"]),
        ("v 1 nan 2\nf 1 2 3\n", &["thing.obj:5:5", "not finite"]),
        ("v 1 1e999 2\nf 1 2 3\n", &["thing.obj:5:5", "not finite"]),
        ("v 1 2\nf 1 2 3\n", &["thing.obj:5:1", "3 numbers"]),
        (
            "v 1 2 three\nf 1 2 3\n",
            &["thing.obj:5:7", "number is expected"],
        ),
        ("vn 0 NaN 0\nf 1 2 3\n", &["thing.obj:5:6", "not finite"]),
        ("v 1 1 1 0\nf 1 2 5\n", &["thing.obj"]),
        ("v 3e38 1 1 1e-9\nf 1 2 5\n", &["thing.obj", "finite"]),
        ("", &["thing.obj", "no faces"]),
        ("l 1 2\n", &["thing.obj", "no faces"]),
        (
            "f 1 1 1\nf 1 2 2\n",
            &["test.ron:5:", "no triangle with an area"],
        ),
    ] {
        let Err(report) = load_mesh("thing.obj", format!("{square}{rest}").as_bytes()) else {
            panic!("accepted: {rest}");
        };
        says(&report.to_string(), words);
    }
    let report = load_mesh("thing.obj", b"v 0 0 \xff\n").unwrap_err();
    says(&report.to_string(), &["thing.obj", "UTF-8"]);
    let report = load_mesh("thing.stl", b"solid").unwrap_err();
    says(
        &report.to_string(),
        &["thing.stl", ".obj, .gltf and .glb", "test.ron:5:"],
    );
}

#[test]
fn a_missing_mesh_is_named_with_the_line_that_asks_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let text = text_with("Mesh(file: \"gone.obj\")", "");
    let report = common::load_in(Some(folder.path()), &text, &[])
        .unwrap_err()
        .to_string();
    says(
        &report,
        &[
            "gone.obj",
            "cannot read",
            "test.ron:5:",
            "relative to the scene file",
        ],
    );
    says(
        &refused(&text, &[]),
        &["part of the program", "test.ron:5:"],
    );
}

#[test]
fn all_mistakes_are_told_at_once() {
    let text = text_with("Torus(radius: 1, tube: 2)", "")
        .replace("wavelength: 1", "wavelength: 0")
        .replace("material: \"m\"", "material: \"n\"");
    says(&refused(&text, &[]), &["tube", "wavelength", "material"]);
}

#[test]
fn a_library_suggests_names_and_follows_variants() {
    let library = built_in();
    says(
        &library.find("pol").unwrap_err().render(),
        &["unknown scene `pol`", "did you mean `pool`?"],
    );
    says(
        &library.find("no/such.ron").unwrap_err().render(),
        &["no/such.ron"],
    );

    let variant =
        |of: &str, set: &str| format!("// v\nVariant(of: \"{of}\", about: \"\", set: {{{set}}})");
    let mut library = Library::new([
        SceneSource::embedded("scenes/base.ron", &text_with(BOX, "")),
        SceneSource::embedded("scenes/tall.ron", &variant("base", "\"camera.height\": 30")),
        SceneSource::embedded(
            "scenes/late.ron",
            &variant("tall", "\"water.time\": 4.5, \"water.geometry\": \"flat\""),
        ),
        SceneSource::embedded("scenes/odd.ron", &variant("base", "\"camera.hieght\": 30")),
        SceneSource::embedded("scenes/lost.ron", &variant("bsae", "")),
        SceneSource::embedded("scenes/round.ron", &variant("about", "")),
        SceneSource::embedded("scenes/about.ron", &variant("round", "")),
    ]);
    let late = library
        .load("late", &[Setting::new("water.time", "5")])
        .unwrap();
    assert_eq!(
        (late.name.as_str(), late.camera.eye.z, late.water.time),
        ("late", 30.0, 5.0)
    );
    let message = |name: &str| library.load(name, &[]).unwrap_err().to_string();
    says(&message("odd"), &["scenes/odd.ron:2:", "camera.height"]);
    says(
        &message("lost"),
        &["scenes/lost.ron:2:", "did you mean `base`?"],
    );
    says(&message("round"), &["variant of itself", "round → about"]);

    // What comes later replaces what has its name.
    library.add(SceneSource::embedded(
        "elsewhere/base.ron",
        &text_with("Sphere(radius: 1)", ""),
    ));
    assert!(library.load("base", &[]).unwrap().mesh.triangles.len() > 12);
}
