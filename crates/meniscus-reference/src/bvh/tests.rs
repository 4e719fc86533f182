//! The tree against brute force, and closed meshes against leaks.

use super::*;
use meniscus_scene::Triangle;

/// A number in [0, 1) for each index, spread evenly (Roberts's sequence in four dimensions).
fn spread(index: usize) -> [f64; 4] {
    let g = 1.1673039782614187_f64;
    [1, 2, 3, 4].map(|i| (0.5 + index as f64 * g.powi(-i)).fract())
}

fn triangle_soup(count: usize) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count {
        let [x, y, z, size] = spread(i);
        for corner in 0..3 {
            let [a, b, c, _] = spread(7919 * i + 31 * corner + 5);
            let at = DVec3::new(x, y, z) + 0.1 * size * (DVec3::new(a, b, c) - 0.5);
            mesh.positions.push(at.as_vec3());
            mesh.normals.push(Vec3::Z);
        }
        let first = 3 * i as u32;
        mesh.triangles.push(Triangle {
            corners: [first, first + 1, first + 2],
            object: 0,
        });
    }
    mesh
}

fn brute_force(mesh: &Mesh, ray: &Ray, nearest: f64) -> Option<(u32, Meeting)> {
    let mut best: Option<(u32, Meeting)> = None;
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        let corners = triangle
            .corners
            .map(|c| mesh.positions[c as usize].as_dvec3());
        if let Some(meeting) = ray.meet(corners)
            && meeting.t >= nearest
            && best.is_none_or(|(_, best)| meeting.t < best.t)
        {
            best = Some((i as u32, meeting));
        }
    }
    best
}

#[test]
fn the_tree_finds_what_testing_every_triangle_finds() {
    // The last is large enough to be built in parallel.
    for (count, rays) in [(0, 10), (1, 100), (9, 1000), (700, 3000), (20_000, 60)] {
        let mesh = triangle_soup(count);
        let bvh = Bvh::new(&mesh);
        let mut hits = 0;
        for i in 0..rays {
            let [a, b, c, d] = spread(104_729 + i);
            let origin = DVec3::new(2.0 * a - 0.5, 2.0 * b - 0.5, -1.0 + c);
            let target = DVec3::new(b, d, a);
            let ray = Ray::new(origin, (target - origin).normalize());
            let found = bvh.nearest(&ray, 0.3, f64::INFINITY);
            assert_eq!(found, brute_force(&mesh, &ray, 0.3));
            hits += usize::from(found.is_some());
        }
        assert!(count < 700 || hits > rays / 8, "{hits} hits");
    }
}

#[test]
fn triangles_at_one_place_do_not_defeat_the_tree() {
    let mut mesh = triangle_soup(1);
    mesh.triangles = vec![mesh.triangles[0]; 5000];
    let bvh = Bvh::new(&mesh);
    let centre = mesh.positions.iter().sum::<Vec3>().as_dvec3() / 3.0;
    let ray = Ray::new(centre + DVec3::Z, DVec3::NEG_Z);
    assert!(bvh.nearest(&ray, 0.0, f64::INFINITY).is_some());
}

/// A closed, bumpy sphere about the origin, with vertices that are not round numbers.
fn closed_mesh(rings: u32, sectors: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        for sector in 0..sectors {
            let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            let around = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            // The poles are one point each, or the mesh would not be closed.
            let pole = ring == 0 || ring == rings;
            let radius = if pole {
                1.0
            } else {
                1.0 + 0.1 * (7.0 * around).sin()
            };
            let side = if pole { 0.0 } else { polar.sin() };
            let at = radius * DVec3::new(side * around.cos(), side * around.sin(), polar.cos());
            mesh.positions.push(at.as_vec3());
            mesh.normals.push(at.as_vec3());
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let at = |r: u32, s: u32| r * sectors + s % sectors;
            let corners = [
                at(ring, sector),
                at(ring + 1, sector),
                at(ring + 1, sector + 1),
                at(ring, sector + 1),
            ];
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                mesh.triangles.push(Triangle {
                    corners: [corners[a], corners[b], corners[c]],
                    object: 0,
                });
            }
        }
    }
    mesh
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let mesh = closed_mesh(12, 19);
    let bvh = Bvh::new(&mesh);
    let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
    for i in 0..40 {
        let [a, b, c, _] = spread(i);
        let mut origin = 0.8 * (DVec3::new(a, b, c) - 0.5);
        if i % 4 == 0 {
            // From round places, axes and edges of boxes line up with rays.
            origin = (origin * 4.0).round() / 4.0;
        }
        for (k, triangle) in mesh.triangles.iter().enumerate() {
            let [p, q, r] = triangle.corners.map(corner);
            let [s, t, ..] = spread(i + 40 * k);
            for target in [
                p,
                (p + q) * 0.5,
                p.lerp(q, s),
                q.lerp(r, t),
                (p + q + r) / 3.0,
            ] {
                let ray = Ray::new(origin, target - origin);
                let found = bvh.nearest(&ray, 0.0, f64::INFINITY);
                assert!(found.is_some(), "leak from {origin} towards {target}");
            }
        }
    }
}
