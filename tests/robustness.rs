//! Whatever the mesh, the camera, the water and the size: no complaint of the driver, and no number
//! that is none.

mod common;

use std::sync::Arc;

use common::{folder, json, meniscus, npy_f32, text, words, write};
use glam::UVec2;
use meniscus::gpu::{Frame, Gpu, PipelineCache, SceneBuffers, Skipping};
use meniscus::pipeline::Plan;
use meniscus::scene::Setting;
use meniscus::{Project, Sources, facts_of};

/// Pipelines of the folder that every method of refraction is in.
const ALL: &str = "refraction/*";

/// Compares all pipelines and looks at everything that they leave behind.
#[track_caller]
fn sound(arguments: &str) {
    let there = folder();
    let line = format!("ablate {ALL} --rounds 1 {arguments}");
    let mut line = words(&line);
    line.extend(["--out", text(there.path())]);
    let said = meniscus(&line);
    assert_eq!(said.code, Some(0), "{arguments}: {}", said.err);
    for line in said.err.lines() {
        // What is being done; a driver or a layer that objects says something else.
        assert!(line.ends_with(" …"), "{arguments}: {line}");
    }
    let results = json(&there.path().join("results.json"));
    let rows = results["rows"].as_array().expect("rows");
    assert!(rows.len() >= 6, "{arguments}: {} rows", rows.len());
    for row in rows {
        let name = row["pipeline"].as_str().expect("a name");
        // JSON knows no NaN; what could not be computed would be missing.
        assert!(row["error"].is_object(), "{arguments}: {name}");
        assert_eq!(row["not_finite_pixels"], 0, "{arguments}: {name}");
        let file = name.replace('/', "-");
        let (shape, shown) = npy_f32(&there.path().join(format!("{file}.shown.npy")));
        let size = results["size"].as_array().expect("a size");
        let expected = [size[1].as_u64(), size[0].as_u64(), Some(4)];
        let shape: Vec<_> = shape.iter().map(|n| Some(*n as u64)).collect();
        assert_eq!(shape, expected, "{arguments}: {name}");
        let wrong = shown.iter().filter(|n| !n.is_finite()).count();
        assert_eq!(wrong, 0, "{arguments}: {name}: not finite in `shown`");
    }
}

#[test]
fn numbers_that_are_none_are_found_and_shown() {
    let there = folder();
    let path = |name: &str| there.path().join(name);
    let module = "// The square root of a negative number, wherever the sun shines.\n//\n\
        // provides: shade\n// needs: shading/surface_point\n\n\
        fn shade(point: SurfacePoint) -> vec3f {\n    \
        return vec3f(sqrt(min(-1.0, point.position.z - 1e6)));\n}\n";
    write(&path("modules/shading/none.wgsl"), module);
    let (modules, out) = (path("modules"), path("out"));
    let line = "ablate refraction/none --with all.shade=shading/none --size 16x9 --rounds 1";
    let mut line = words(line);
    line.extend(["--modules", text(&modules), "--out", text(&out)]);
    meniscus(&line).done();
    let results = json(&out.join("results.json"));
    let found = results["rows"][0]["not_finite_pixels"].as_u64();
    assert!(found > Some(16 * 9 / 2), "{found:?}");
    let pictures = std::fs::read_dir(&out).expect("the directory").flatten();
    let picture = pictures
        .map(|entry| entry.path())
        .find(|path| text(path).ends_with("none.png") && !text(path).contains("error"))
        .expect("a picture");
    let picture = image::open(picture).expect("a picture").to_rgb8();
    let marks = picture.pixels().filter(|p| p.0 == [255, 0, 255]).count();
    assert_eq!(Some(marks as u64), found);
}

#[test]
fn coarse_and_fine_meshes_are_rendered_at_two_sizes() {
    for size in ["160x90", "97x61"] {
        sound(&format!("--size {size} --set pool.triangles=4k"));
        sound(&format!("--size {size} --scene pool"));
        sound(&format!("--size {size} --scene pool-128k"));
    }
}

#[test]
fn steep_low_and_close_cameras_are_rendered() {
    for camera in [
        // Nearly straight down.
        "--set camera.position.x=0 --set camera.position.y=-0.2 --set camera.height=6 \
         --set camera.target.x=0 --set camera.target.y=0 --set camera.target.z=-1",
        // Along the water.
        "--set camera.height=0.35 --set camera.target.z=0.2",
        // From the other end.
        "--set camera.position.x=3 --set camera.position.y=1.8 --set camera.height=1.2 \
         --set camera.target.x=-1 --set camera.target.y=0",
    ] {
        for (size, truth) in [("160x90", "displaced"), ("97x61", "flat")] {
            sound(&format!(
                "--size {size} --truth {truth} --set pool.triangles=4k {camera}"
            ));
        }
    }
}

#[test]
fn extreme_water_and_cameras_are_rendered() {
    for extreme in [
        "water.rms_slope=0.4",
        "water.rms_slope=0",
        "water.time=1e6",
        "water.refractive_index=1",
        "water.refractive_index=2.5",
        "water.refractive_index=0.4",
        "camera.height=1e-6",
        "camera.height=-1e-6",
        "camera.height=0",
        "camera.height=-0.5",
        "camera.field_of_view=1",
        "camera.field_of_view=170",
        "camera.near=0.00001",
    ] {
        sound(&format!(
            "--size 97x61 --set pool.triangles=4k --set {extreme}"
        ));
    }
}

#[test]
fn the_smallest_pictures_are_rendered() {
    // A frame of one pixel has no neighbours; one row has a border that is all of it.
    for size in ["1x1", "97x1", "1x61"] {
        let there = folder();
        let results = there.path().join("results.json");
        let line = format!("ablate {ALL} --rounds 1 --set pool.triangles=4k --size {size}");
        let mut line = words(&line);
        line.extend(["--json", text(&results)]);
        let said = meniscus(&line);
        assert_eq!(said.code, Some(0), "{size}: {}", said.err);
        assert!(
            json(&results)["rows"]
                .as_array()
                .is_some_and(|r| r.len() >= 6)
        );
    }
}

#[test]
fn every_scene_is_rendered() {
    let project = project();
    for scene in project.scenes.iter() {
        let scene = &scene.name;
        if scene == "pool-128k" || scene == "pool" {
            continue;
        }
        let there = folder();
        let line = format!("ablate {ALL} --rounds 1 --size 97x61 --scene {scene}");
        let mut line = words(&line);
        let results = there.path().join("results.json");
        line.extend(["--json", text(&results)]);
        let said = meniscus(&line);
        assert_eq!(said.code, Some(0), "{scene}: {}", said.err);
        assert!(json(&results)["water_pixels"].as_u64() > Some(0), "{scene}");
        let rows = json(&results)["rows"].clone();
        let mut judged = rows.as_array().expect("rows").iter();
        assert!(judged.all(|r| r["error"].is_object()), "{scene}");
    }
}

fn project() -> Project {
    Project::open(&Sources::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn no_texture_of_any_pass_holds_a_number_that_is_none() {
    let project = project();
    let gpu = Gpu::open(None).unwrap_or_else(|e| panic!("{e}"));
    let cache = PipelineCache::default();
    let names = project
        .pipeline_names(&[ALL.to_owned()])
        .unwrap_or_else(|e| panic!("{e}"));
    assert!(names.len() >= 6);
    for settings in [
        &["water.rms_slope=0.05"][..],
        &["water.rms_slope=0"],
        &["water.rms_slope=0.4", "water.geometry=flat"],
        &["camera.height=-1"],
        &["water.refractive_index=0.4"],
    ] {
        let parsed: Vec<Setting> = settings
            .iter()
            .chain(&["pool.triangles=4k"])
            .map(|s| Setting::parse("a test", s).unwrap_or_else(|e| panic!("{e:?}")))
            .collect();
        let scene = project
            .scene("pool", &parsed)
            .unwrap_or_else(|e| panic!("{e}"));
        let buffers = Arc::new(SceneBuffers::new(&gpu, &scene).unwrap_or_else(|e| panic!("{e}")));
        for name in &names {
            let pipeline = project.pipeline(name).unwrap_or_else(|e| panic!("{e}"));
            for shown in [false, true] {
                let facts = facts_of(&scene, [97, 61]);
                let plan = Plan::new(&pipeline, &project.composer, &facts, shown)
                    .unwrap_or_else(|e| panic!("{e}"));
                let size = UVec2::new(97, 61);
                // Nothing shares memory, so that every texture can be read.
                let mut frame =
                    Frame::with(&gpu, &plan, buffers.clone(), size, &cache, Skipping::NONE)
                        .unwrap_or_else(|e| panic!("{name}: {e}"));
                frame.render().unwrap_or_else(|e| panic!("{name}: {e}"));
                let floating = plan
                    .textures
                    .iter()
                    .filter(|(_, texture)| !format!("{:?}", texture.format).ends_with("Uint"));
                let mut read = 0;
                for (texture, _) in floating {
                    let pixels = frame
                        .read(texture)
                        .unwrap_or_else(|e| panic!("{name}: {e}"));
                    let wrong = pixels.data.iter().filter(|n| !n.is_finite()).count();
                    assert_eq!(wrong, 0, "{settings:?}: {name}: `{texture}`");
                    read += 1;
                }
                assert!(read >= 2, "{name}: {read} textures");
            }
        }
    }
}
