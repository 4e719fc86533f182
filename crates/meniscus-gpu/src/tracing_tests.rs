use glam::DVec3;
use meniscus_scene::{Motion, Scene};

use super::*;
use crate::bvh::cost;
use crate::host_scene::tests::scene;

fn arrays() -> Tracing {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NEG_X],
        normals: vec![Vec3::Z, Vec3::X, Vec3::NEG_Y],
        triangles: [[0, 1, 2], [0, 2, 3]]
            .into_iter()
            .zip(5..)
            .map(|(corners, object)| meniscus_scene::Triangle { corners, object })
            .collect(),
    };
    Tracing::new(&mesh, &Moving::default())
}

/// A number in [0, 1) from another: fractions of multiples of the golden ratio.
fn scattered(i: usize) -> f32 {
    (i as f64 * 0.618_033_988_749_895).fract() as f32
}

fn point(i: usize) -> Vec3 {
    Vec3::new(scattered(i), scattered(7 * i + 3), scattered(31 * i + 11))
}

/// Clouds of triangles, one an object, of which the first stands still where there are several. A
/// cloud of one triangle is among them.
fn clouds(counts: &[usize]) -> Scene {
    let mut scene = scene();
    let mesh = &mut scene.mesh;
    for (object, &count) in counts.iter().enumerate() {
        let centre = 3.0 * point(1000 + object);
        for i in 0..count {
            let first = mesh.positions.len() as u32;
            let at = centre + point(17 * i + object);
            mesh.positions
                .extend([0, 1, 2].map(|k| at + 0.1 * point(3 * i + k)));
            mesh.normals.extend([Vec3::Z; 3]);
            mesh.triangles.push(meniscus_scene::Triangle {
                corners: [first, first + 1, first + 2],
                object: object as u32,
            });
        }
    }
    for object in 1.min(counts.len() - 1)..counts.len() {
        let motion = Motion {
            velocity: DVec3::new(0.1, -0.05, 0.02),
            turn: DVec3::new(0.3, 1.0, 0.5 * object as f64),
            heave: 0.2,
            period: 3.0,
        };
        assert!(scene.set_motion(object as u32, motion, DVec3::splat(1.5)));
    }
    scene
}

/// The distance at which a ray meets a triangle (Möller and Trumbore 1997).
fn meets(origin: Vec3, way: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (e, f) = (b - a, c - a);
    let p = way.cross(f);
    let inverse = 1.0 / e.dot(p);
    let s = origin - a;
    let u = s.dot(p) * inverse;
    let q = s.cross(e);
    let v = way.dot(q) * inverse;
    let t = f.dot(q) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

fn enters(origin: Vec3, way: Vec3, [low, high]: [Vec3; 2]) -> bool {
    let (a, b) = ((low - origin) / way, (high - origin) / way);
    let from = a.min(b).max_element();
    let to = a.max(b).min_element();
    from <= to * (1.0 + 1e-5) && to >= 0.0
}

/// The nearest hit and how many triangles were asked, by the binary and by the wide tree.
fn walk(tracing: &Tracing, origin: Vec3, way: Vec3) -> [(Option<f32>, usize); 2] {
    let mut found = [(None::<f32>, 0), (None, 0)];
    let mut ask = |tree: usize, first: u32, count: u32| {
        for triangle in &tracing.triangles[first as usize..(first + count) as usize] {
            let hit = meets(origin, way, triangle.corners);
            let (nearest, asked) = &mut found[tree];
            *asked += 1;
            *nearest = [*nearest, hit].into_iter().flatten().reduce(f32::min);
        }
    };
    let mut open = vec![0];
    while let Some(index) = open.pop() {
        let node = tracing.nodes[index as usize];
        if !enters(origin, way, [node.low, node.high]) {
            continue;
        }
        match node.count {
            0 => open.extend([node.first, node.first + 1]),
            count => ask(0, node.first, count),
        }
    }
    let mut open = vec![0];
    while let Some(index) = open.pop() {
        let node: &WideNode = &tracing.wide[index as usize];
        for (place, &child) in node.children.iter().enumerate() {
            if child == NO_CHILD || !enters(origin, way, node.box_of(place)) {
                continue;
            }
            match child & 7 {
                0 => open.push(child >> 3),
                count => ask(1, child >> 3, count),
            }
        }
    }
    found
}

#[test]
fn trees_that_followed_find_what_trees_made_anew_find() {
    for counts in [&[400, 300][..], &[200, 1, 90, 5], &[300], &[1, 1], &[4; 20]] {
        let mut scene = clouds(counts);
        let mut followed = Tracing::new(&scene.mesh, &scene.moving);
        let all: Vec<usize> = (0..scene.moving.bodies().len()).collect();
        for time in [0.4, 2.0, -31.0, 0.0] {
            scene.set_time(time);
            followed.follow(&scene.mesh, &all);
            let anew = Tracing::new(&scene.mesh, &scene.moving);
            let still = Tracing::new(&scene.mesh, &Moving::default());
            let mut hits = 0;
            for i in 0..300 {
                let [a, b, c] = scene.mesh.corners(37 * i % scene.mesh.triangles.len());
                let middle = ((a + b + c) / 3.0).as_vec3();
                let origin = middle + 6.0 * point(5 * i) - 3.0;
                // Some rays miss what they are aimed at.
                let way = (middle + 0.05 * (point(11 * i + 1) - 0.5) - origin).normalize();
                let straight = scene.mesh.triangles.iter().filter_map(|triangle| {
                    let corners = triangle.corners.map(|c| scene.mesh.positions[c as usize]);
                    meets(origin, way, corners)
                });
                let nearest = straight.reduce(f32::min);
                hits += usize::from(nearest.is_some());
                for tracing in [&followed, &anew, &still] {
                    for (found, _) in walk(tracing, origin, way) {
                        assert_eq!(found, nearest, "{counts:?} {time}");
                    }
                }
            }
            assert!(hits > 50, "{hits}");
        }
    }
}

#[test]
fn only_what_moved_changes() {
    let mut scene = clouds(&[200, 30, 40]);
    let mut tracing = Tracing::new(&scene.mesh, &scene.moving);
    let before = (
        tracing.nodes.clone(),
        tracing.wide.clone(),
        tracing.triangles.clone(),
    );
    scene.set_time(1.0);
    tracing.follow(&scene.mesh, &[1]);
    for array in ["bvh_nodes", "bvh_wide_nodes", "triangles"] {
        let changed = tracing.changed(array, &[1]);
        let differs = |i: usize| match array {
            "bvh_nodes" => before.0[i] != tracing.nodes[i],
            "bvh_wide_nodes" => before.1[i] != tracing.wide[i],
            _ => before.2[i] != tracing.triangles[i],
        };
        let length = tracing.length(array);
        let other = (0..length).filter(|&i| differs(i) && !changed.iter().any(|r| r.contains(&i)));
        assert_eq!(other.count(), 0, "{array}");
        let told: usize = changed.iter().map(Range::len).sum();
        assert!(told < length / 2, "{array}: {told} of {length}");
        assert!((0..length).any(differs), "{array}");
    }
}

/// A rigid motion keeps what lies together together: no angle is one to build the tree anew for.
#[test]
fn trees_that_followed_cost_rays_hardly_more() {
    let mut scene = clouds(&[3000, 3000]);
    let mut followed = Tracing::new(&scene.mesh, &scene.moving);
    for step in 1..12 {
        scene.set_time(0.35 * f64::from(step));
        followed.follow(&scene.mesh, &[0]);
        let anew = Tracing::new(&scene.mesh, &scene.moving);
        let ratio = cost(&followed.nodes) / cost(&anew.nodes);
        assert!((0.7..1.3).contains(&ratio), "{step}: {ratio}");
    }
}

#[test]
fn triangles_keep_their_corners_and_objects_in_any_order() {
    let tracing = arrays();
    for triangle in &tracing.triangles {
        let last = [Vec3::Y, Vec3::NEG_X][triangle.object as usize - 5];
        assert_eq!(triangle.corners[2], last);
    }
    assert_ne!(tracing.triangles[0].object, tracing.triangles[1].object);
}

#[test]
fn normals_are_found_again() {
    let unpacked = |bits: u32| {
        let part = |shift: u32| f32::from((bits >> shift) as u16 as i16) / 32767.0;
        let flat = glam::Vec2::new(part(0), part(16));
        let z = 1.0 - flat.x.abs() - flat.y.abs();
        let back = (-z).max(0.0);
        let sign = |x: f32| if x < 0.0 { -1.0 } else { 1.0 };
        let x = flat.x - sign(flat.x) * back;
        Vec3::new(x, flat.y - sign(flat.y) * back, z).normalize()
    };
    for i in 0..1000 {
        let (turn, z) = (2.4 * i as f32, i as f32 / 499.5 - 1.0);
        let v = ((1.0 - z * z).max(0.0).sqrt() * glam::Vec2::from_angle(turn)).extend(z);
        assert!(unpacked(packed(v)).distance(v) < 1e-4, "{v}");
    }
    for v in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert_eq!(unpacked(packed(v)), Vec3::Z);
    }
}
