//! Objects that move: what is drawn, read, uploaded and left out.

use std::sync::Arc;

use glam::{DVec3, UVec2};
use meniscus_gpu::{Frame, PipelineCache, SceneBuffers, Skipping};
use meniscus_pipeline::{Format, Geometry, PassKind, Plan, PlannedPass, Size};
use meniscus_scene::{Motion, Scene};

use crate::build::{COVER, DRAW, frame, gpu, pass, plan, scene, shader};

const FLOATS: Format = Format::Rgba32Float;
/// Bytes of a vertex: position, normal, geometric normal and object.
const VERTEX: u64 = 40;

/// A floor under water, a wall above it, and two triangles that move: one above the water, and one
/// through it.
fn moving() -> Scene {
    let side = |x: f32, z: f32| [[x, 2.0, z], [x + 0.6, 2.0, z], [x, 2.0, z + 0.5]];
    let mut scene = scene(&[
        [[-3.0, 0.5, -1.0], [3.0, 0.5, -1.0], [0.0, 8.0, -1.0]],
        [[-3.0, 6.0, 0.1], [3.0, 6.0, 0.1], [0.0, 6.0, 3.0]],
        side(-1.2, 0.6),
        side(0.3, -0.6),
    ]);
    let motions = [
        (2, DVec3::new(0.2, 0.0, 0.0), 0.0),
        (3, DVec3::new(0.0, 0.1, 0.0), 0.5),
    ];
    for (object, velocity, heave) in motions {
        let motion = Motion {
            velocity,
            turn: DVec3::new(0.0, 0.3, 0.0),
            heave,
            period: 4.0,
        };
        let pivot = scene.mesh.corners(object as usize)[0];
        assert!(scene.set_motion(object, motion, pivot));
    }
    scene
}

/// The same where only the triangle above the water moves.
fn dry() -> Scene {
    let mut scene = moving();
    assert!(scene.set_motion(3, Motion::default(), DVec3::ZERO));
    scene
}

fn drawn(name: &str, geometry: Geometry, target: &str, depth: &str) -> PlannedPass {
    let text = format!(
        "{DRAW} @fragment fn show(v: Varied) -> @location(0) vec4f {{
            return vec4f(v.world, f32(v.object) + dot(v.geometric_normal, vec3f(0.1, 0.2, 0.3)));
        }}"
    );
    let mut pass = pass(
        name,
        PassKind::Draw(geometry),
        &shader(&text, &["colour"]),
        &[target],
    );
    pass.depth = Some(depth.to_owned());
    pass
}

/// Shows where triangles begin that rays are traced through, one a column.
fn read() -> PlannedPass {
    let text = format!(
        "{COVER} struct T {{ first: vec3f, object: u32 }} var<storage, read> triangles: array<T>;
        struct N {{ low: vec3f, high: vec3f }} var<storage, read> bvh_nodes: array<N>;
        @fragment fn show(@builtin(position) at: vec4f) -> @location(0) vec4f {{
            let index = min(u32(at.x), arrayLength(&triangles) - 1u);
            if at.y > 4.0 {{ return vec4f(bvh_nodes[0].low, bvh_nodes[0].high.z); }}
            return vec4f(triangles[index].first, f32(triangles[index].object));
        }}"
    );
    pass(
        "read",
        PassKind::Screen,
        &shader(&text, &["colour"]),
        &["read"],
    )
}

fn passes() -> Plan {
    let textures = [
        ("near", FLOATS, Size::Frame),
        ("near_depth", Format::Depth32Float, Size::Frame),
        ("far", FLOATS, Size::Frame),
        ("far_depth", Format::Depth32Float, Size::Frame),
        ("read", FLOATS, Size::Frame),
    ];
    let passes = vec![
        drawn("near", Geometry::NearSide, "near", "near_depth"),
        drawn("far", Geometry::FarSide, "far", "far_depth"),
        read(),
    ];
    plan(&textures, &[], passes)
}

/// A frame whose textures can all be read, and are there until they are made anew.
fn shared(buffers: &Arc<SceneBuffers>) -> Frame {
    let cache = PipelineCache::default();
    let (size, buffers) = (UVec2::splat(8), buffers.clone());
    let skipping = Skipping {
        sharing: false,
        ..Skipping::ALL
    };
    Frame::with(gpu(), &passes(), buffers, size, &cache, skipping).unwrap()
}

fn apart(scene: &Scene) -> Frame {
    shared(&Arc::new(SceneBuffers::new(gpu(), scene).unwrap()))
}

/// All that the passes made.
fn pictures(frame: &Frame) -> Vec<Vec<f32>> {
    let read = |name| frame.read(name).unwrap().data;
    ["near", "far", "read"].map(read).to_vec()
}

fn fresh(scene: &Scene) -> Vec<Vec<f32>> {
    let mut frame = apart(scene);
    frame.render().unwrap();
    pictures(&frame)
}

#[test]
fn a_frame_that_followed_shows_what_one_made_then_shows() {
    let mut scene = moving();
    let mut kept = apart(&scene);
    kept.refresh().unwrap();
    let first = pictures(&kept);
    for time in [0.3, 1.0, 2.9, 40.0, 0.0] {
        scene.set_time(time);
        kept.update(&scene).unwrap();
        kept.refresh().unwrap();
        let shown = pictures(&kept);
        assert_eq!(shown, fresh(&scene), "{time}");
        assert_eq!(shown == first, time == 0.0, "{time}");
    }
}

#[test]
fn the_eye_may_move_too_and_go_under_water() {
    let mut scene = moving();
    let mut kept = apart(&scene);
    for (time, z) in [(0.4, 1.0), (1.3, 0.8), (1.3, -0.3), (2.0, -0.3)] {
        scene.set_time(time);
        scene.camera.eye.z = z;
        scene.camera.target.z = z;
        kept.update(&scene).unwrap();
        kept.refresh().unwrap();
        assert_eq!(pictures(&kept), fresh(&scene), "{time} {z}");
    }
}

#[test]
fn only_passes_run_that_draw_or_read_what_has_moved() {
    let mut scene = dry();
    let mut frame = apart(&scene);
    assert_eq!(frame.refresh().unwrap().passes, 3);
    frame.update(&scene).unwrap();
    assert_eq!(frame.refresh().unwrap().passes, 0);
    assert_eq!(frame.moved().objects, 0);
    // A dry object is nowhere behind the water.
    scene.set_time(0.5);
    frame.update(&scene).unwrap();
    assert_eq!(
        (frame.moved().objects, frame.refresh().unwrap().passes),
        (1, 2)
    );
    assert_eq!(frame.refreshed().collect::<Vec<_>>(), ["near", "read"]);
    frame.update(&scene).unwrap();
    assert_eq!(frame.refresh().unwrap().passes, 0);

    let mut through = moving();
    let mut frame = apart(&through);
    frame.refresh().unwrap();
    through.set_time(0.5);
    frame.update(&through).unwrap();
    assert_eq!(
        (frame.moved().objects, frame.refresh().unwrap().passes),
        (2, 3)
    );
}

#[test]
fn only_what_moved_is_uploaded() {
    let mut scene = dry();
    let textures = [
        ("near", FLOATS, Size::Frame),
        ("depth", Format::Depth32Float, Size::Frame),
    ];
    let near = plan(
        &textures,
        &[],
        vec![drawn("near", Geometry::NearSide, "near", "depth")],
    );
    let mut frame = frame(&near, &scene).unwrap();
    frame.update(&scene).unwrap();
    assert_eq!((frame.uploaded(), frame.moved().bytes), (0, 0));
    scene.set_time(0.5);
    frame.update(&scene).unwrap();
    assert_eq!(
        (frame.uploaded(), frame.moved().bytes),
        (3 * VERTEX, 3 * VERTEX)
    );
    // What reads triangles and trees is given those of the object, and the top of the trees.
    let mut reads = apart(&scene);
    scene.set_time(0.75);
    reads.update(&scene).unwrap();
    let (triangle, node, top) = (16, 32, 3);
    assert_eq!(
        reads.moved().bytes,
        3 * VERTEX + triangle + (top + 1) * node
    );
}

#[test]
fn frames_of_one_scene_may_be_at_different_moments() {
    let mut scene = moving();
    let buffers = Arc::new(SceneBuffers::new(gpu(), &scene).unwrap());
    let mut frames = [shared(&buffers), shared(&buffers)];
    let mut expected = [fresh(&scene), fresh(&scene)];
    for (step, time) in [0.5, 1.5, 1.5, 3.0].into_iter().enumerate() {
        scene.set_time(time);
        let one = step % 2;
        frames[one].update(&scene).unwrap();
        expected[one] = fresh(&scene);
        for (frame, expected) in frames.iter_mut().zip(&expected) {
            match step % 3 {
                0 => frame.refresh().map(drop).unwrap(),
                _ => frame.render().map(drop).unwrap(),
            }
            assert_eq!(pictures(frame), *expected, "{time}");
        }
    }
    // A frame that is made later begins at the moment at which the scene was uploaded.
    let mut late = shared(&buffers);
    late.render().unwrap();
    assert_eq!(pictures(&late), fresh(&moving()));
}

#[test]
fn water_and_objects_at_different_times_are_an_error() {
    let mut scene = moving();
    let mut kept = apart(&scene);
    scene.water.time = 2.0;
    let error = kept.update(&scene).unwrap_err().to_string();
    assert!(
        error.contains("2 s") && error.contains("set_time"),
        "{error}"
    );
    assert!(SceneBuffers::new(gpu(), &scene).is_err());
    scene.set_time(f64::NAN);
    assert!(kept.update(&scene).is_err());
    // Other things that move are another scene.
    let error = kept.update(&dry()).unwrap_err().to_string();
    assert!(error.contains("upload the scene anew"), "{error}");
    kept.update(&moving()).unwrap();
    kept.render().unwrap();
    assert_eq!(pictures(&kept), fresh(&moving()));
}
