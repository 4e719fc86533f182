//! Triangles: where they land, what they carry, which are drawn.

use std::sync::Arc;

use glam::{DVec3, UVec2, Vec3};
use meniscus_gpu::{BOW_PX, Frame, PipelineCache, SceneBuffers};
use meniscus_pipeline::{Format, Geometry, PassKind, Plan, Size, Texture};
use meniscus_scene::WaterGeometry;

use crate::build::{COVER, DRAW, frame, gpu, pass, plan, rendered, scene, shader, wave};

/// Object id + 1 where something is seen.
fn ids(geometry: Geometry) -> Plan {
    let text = format!(
        "{DRAW}
        @fragment fn show(in: Varied) -> @location(0) vec4f {{
            return vec4f(f32(in.object) + 1.0, in.geometric_normal);
        }}"
    );
    let mut draw = pass(
        "draw",
        PassKind::Draw(geometry),
        &shader(&text, &["colour"]),
        &["ids"],
    );
    draw.depth = Some("depth".to_owned());
    let textures = [
        ("ids", Format::Rgba32Float, Size::Frame),
        ("depth", Format::Depth32Float, Size::Frame),
    ];
    plan(&textures, &[], vec![draw])
}

/// A triangle at distance y that fills the lower left half of the view of 90°, but for the diagonal.
fn lower_left(y: f32) -> [[f32; 3]; 3] {
    [[-y, y, 1.0 + y], [-y, y, 1.0 - y], [y, y, 1.0 - y]]
}

/// A triangle at distance y that fills the view.
fn everywhere(y: f32) -> [[f32; 3]; 3] {
    [
        [-4.0 * y, y, -3.0 * y],
        [4.0 * y, y, -3.0 * y],
        [0.0, y, 9.0 * y],
    ]
}

/// The set of object ids + 1 seen on the diagonal that runs through the middle.
fn seen(plan: &Plan, scene: &meniscus_scene::Scene) -> Vec<u32> {
    let pixels = rendered(plan, scene).read("ids").unwrap();
    let mut all: Vec<u32> = pixels
        .data
        .chunks(4)
        .map(|p| p[0] as u32)
        .filter(|&id| id > 0)
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

#[test]
fn a_triangle_lands_on_its_pixels_and_leaves_the_others_clear() {
    let pixels = rendered(&ids(Geometry::All), &scene(&[lower_left(2.0)]))
        .read("ids")
        .unwrap();
    for y in 0..8 {
        for x in 0..8 {
            let pixel = pixels.at(x, y).unwrap();
            if x < y {
                assert_eq!(pixel, [1.0, 0.0, -1.0, 0.0], "({x}, {y}) inside");
            } else if x > y {
                assert_eq!(pixel, [0.0, 0.0, 0.0, -1.0], "({x}, {y}) outside");
            }
        }
    }
    assert_eq!(pixels.at(8, 0), None);
}

#[test]
fn the_nearer_triangle_is_seen_whatever_the_order() {
    let (near, far) = (everywhere(1.5), everywhere(3.0));
    for (triangles, expected) in [([near, far], 1), ([far, near], 2)] {
        assert_eq!(seen(&ids(Geometry::All), &scene(&triangles)), [expected]);
    }
    let frame = rendered(&ids(Geometry::All), &scene(&[far, near]));
    let depth = frame.read("depth").unwrap();
    assert!(
        depth.data.iter().all(|&d| (d - 0.125 / 1.5).abs() < 1e-6),
        "near over distance"
    );
}

#[test]
fn depth_is_sampled_and_then_drawn_against_again() {
    let (near, far) = (everywhere(1.5), everywhere(3.0));
    let mut plan = ids(Geometry::All);
    let copy = format!(
        "{COVER} var depth: texture_depth_2d;
        @fragment fn show(@builtin(position) p: vec4f) -> @location(0) f32 {{ return textureLoad(depth, vec2u(p.xy), 0); }}"
    );
    plan.passes.push(pass(
        "copy",
        PassKind::Screen,
        &shader(&copy, &["colour"]),
        &["copied"],
    ));
    let mut again = plan.passes[0].clone();
    again.name = "again".to_owned();
    again.targets = vec!["again".to_owned()];
    plan.passes.push(again);
    for (name, format) in [("copied", Format::R32Float), ("again", Format::Rgba32Float)] {
        plan.textures.insert(
            name.to_owned(),
            Texture {
                format,
                size: Size::Frame,
            },
        );
    }
    let frame = rendered(&plan, &scene(&[far, near]));
    let copied = frame.read("copied").unwrap();
    assert_eq!(copied.data, frame.read("depth").unwrap().data);
    // Nothing is nearer than what is there already, and depth was not cleared in between.
    let again = frame.read("again").unwrap();
    assert!(again.data.chunks(4).all(|p| p[0] == 0.0));
}

#[test]
fn triangles_that_share_all_vertices_keep_their_own_attributes() {
    // A fan about one vertex: none of its triangles lie in one plane.
    let mut fan = scene(&[]);
    let rim = (0..6).map(|i| {
        let angle = std::f32::consts::TAU * i as f32 / 6.0;
        Vec3::new(3.0 * angle.cos(), 2.0, 1.0 + 3.0 * angle.sin())
    });
    fan.mesh.positions = std::iter::once(Vec3::new(0.0, 1.0, 1.0))
        .chain(rim)
        .collect();
    fan.mesh.normals = vec![Vec3::Y; 7];
    fan.mesh.triangles = (0..6)
        .map(|i| meniscus_scene::Triangle {
            corners: [0, 1 + i, 1 + (i + 1) % 6],
            object: i,
        })
        .collect();
    let pixels = rendered(&ids(Geometry::All), &fan).read("ids").unwrap();
    let mut met = [false; 6];
    for pixel in pixels.data.chunks(4) {
        let object = pixel[0] as usize - 1;
        met[object] = true;
        let [a, b, c] = fan.mesh.triangles[object]
            .corners
            .map(|i| fan.mesh.positions[i as usize]);
        let normal = (b - a).cross(c - a).normalize();
        assert!(
            normal.distance(Vec3::from_slice(&pixel[1..])) < 1e-6,
            "{object}"
        );
    }
    assert_eq!(met, [true; 6]);
}

/// One triangle above the water, one below, one through it, side by side.
fn three_sides() -> meniscus_scene::Scene {
    let at = |x: f32, z: f32, high: f32| [[x, 2.0, z], [x + 1.0, 2.0, z], [x, 2.0, z + high]];
    // The last one is cut at the water, and shows on either side of it.
    scene(&[at(-1.5, 0.5, 0.8), at(-0.5, -0.9, 0.8), at(0.5, -1.5, 3.0)])
}

#[test]
fn near_and_far_side_are_the_cameras() {
    let mut scene = three_sides();
    let (near, far) = (ids(Geometry::NearSide), ids(Geometry::FarSide));
    assert_eq!(seen(&ids(Geometry::All), &scene), [1, 2, 3]);
    assert_eq!(seen(&near, &scene), [1, 3]);
    assert_eq!(seen(&far, &scene), [2, 3]);
    scene.camera.eye.z = -0.25;
    scene.camera.target.z = -0.25;
    assert_eq!(seen(&near, &scene), [2, 3]);
    assert_eq!(seen(&far, &scene), [1, 3]);
}

#[test]
fn a_frame_follows_the_camera_through_the_surface() {
    let mut scene = three_sides();
    let mut frame = frame(&ids(Geometry::NearSide), &scene).unwrap();
    let ids = |frame: &mut meniscus_gpu::Frame| -> Vec<u32> {
        frame.render().unwrap();
        let pixels = frame.read("ids").unwrap();
        let found = |id: u32| pixels.data.chunks(4).any(|p| p[0] == id as f32);
        (1..=3).filter(|&id| found(id)).collect()
    };
    assert_eq!(ids(&mut frame), [1, 3]);
    scene.camera.eye.z = -0.25;
    scene.camera.target.z = -0.25;
    frame.update(&scene).unwrap();
    assert_eq!(ids(&mut frame), [2, 3]);
}

#[test]
fn displaced_water_widens_both_sides() {
    let mut scene = three_sides();
    scene.water.waves = vec![wave(0.6)];
    assert_eq!(
        seen(&ids(Geometry::NearSide), &scene),
        [1, 3],
        "flat geometry"
    );
    scene.water.geometry = WaterGeometry::Displaced;
    assert_eq!(seen(&ids(Geometry::NearSide), &scene), [1, 2, 3]);
    assert_eq!(seen(&ids(Geometry::FarSide), &scene), [1, 2, 3]);
}

#[test]
fn a_scene_without_triangles_clears_its_targets() {
    let mut scene = scene(&[]);
    scene.camera.target = DVec3::new(0.0, 0.0, -1.0);
    let frame = rendered(&ids(Geometry::All), &scene);
    let pixels = frame.read("ids").unwrap();
    assert!(pixels.data.chunks(4).all(|p| p == [0.0, 0.0, 0.0, -1.0]));
    assert!(frame.read("depth").unwrap().data.iter().all(|&d| d == 0.0));
    assert_eq!(frame.counters().unwrap().draws, 0);
}

/// A floor of two triangles under water, before the camera.
fn floor() -> meniscus_scene::Scene {
    let corner = |x: f32, y: f32| [x, y, -1.0];
    let (a, b, c, d) = (
        corner(-3.0, 0.0),
        corner(3.0, 0.0),
        corner(3.0, 6.0),
        corner(-3.0, 6.0),
    );
    scene(&[[a, b, c], [a, c, d]])
}

#[test]
fn the_far_side_is_divided_for_each_camera_once() {
    let mut scene = floor();
    let buffers = Arc::new(SceneBuffers::new(gpu(), &scene).unwrap());
    let frame = |geometry: Geometry| {
        let size = UVec2::splat(64);
        Frame::new(
            gpu(),
            &ids(geometry),
            buffers.clone(),
            size,
            &PipelineCache::default(),
        )
        .unwrap()
    };
    let near = frame(Geometry::NearSide);
    assert_eq!(near.counters().unwrap().triangles, 0);
    assert_eq!(buffers.far_side(), None, "nobody has asked");
    let mut far = frame(Geometry::FarSide);
    let first = buffers.far_side().unwrap();
    assert_eq!((first.triangles, first.bow_px), (2, BOW_PX));
    assert!(first.drawn > 2);
    assert_eq!(far.counters().unwrap().triangles, first.drawn);
    let bytes = buffers.bytes();
    let _same = frame(Geometry::FarSide);
    assert_eq!(buffers.far_side(), Some(first), "the time it took included");
    scene.water.time = 3.0;
    far.update(&scene).unwrap();
    assert_eq!((buffers.far_side(), buffers.bytes()), (Some(first), bytes));
    scene.camera.eye.z += 0.5;
    far.update(&scene).unwrap();
    let second = buffers.far_side().unwrap();
    assert_ne!(second, first);
    assert_eq!(far.counters().unwrap().triangles, second.drawn);
    for step in 0..8 {
        scene.camera.eye.z += 0.1 * f64::from(step);
        far.update(&scene).unwrap();
    }
    assert!(buffers.bytes() < 4 * bytes, "old cameras' are dropped");
}

#[test]
fn what_is_drawn_is_the_same_surface_however_it_is_divided() {
    let scene = floor();
    let drawn = |bow_px: f64| {
        let buffers = SceneBuffers::new(gpu(), &scene)
            .unwrap()
            .with_bow_bound(bow_px);
        let buffers = Arc::new(buffers);
        let size = UVec2::splat(64);
        let plan = ids(Geometry::FarSide);
        let mut frame = Frame::new(
            gpu(),
            &plan,
            buffers.clone(),
            size,
            &PipelineCache::default(),
        )
        .unwrap();
        frame.render().unwrap();
        (
            frame.read("ids").unwrap().data,
            buffers.far_side().unwrap().drawn,
        )
    };
    let (whole, two) = drawn(f64::INFINITY);
    let (divided, many) = drawn(0.01);
    assert!(two == 2 && many > 100);
    // Vertices stay where they are in this plan: no gap, and nothing beyond the outline.
    let ids = |data: &[f32]| -> Vec<f32> { data.chunks(4).map(|p| p[0]).collect() };
    let differ = ids(&whole)
        .iter()
        .zip(ids(&divided))
        .filter(|(a, b)| **a != *b)
        .count();
    let covered = ids(&whole).iter().filter(|&&id| id > 0.0).count();
    assert!(
        covered > 500 && differ <= covered / 200,
        "{differ} of {covered}"
    );
}
