use super::*;
use crate::sight::tests::sight;
use meniscus_pipeline::Geometry;
use meniscus_scene::{Mesh, Triangle};
use std::collections::BTreeMap;

type Bits = [u32; 3];

fn bits(p: [f32; 3]) -> Bits {
    // The same place, whatever the sign of zero.
    p.map(|x| (x + 0.0).to_bits())
}

fn band(margin: f64) -> WaterBand {
    WaterBand::about(0.0, margin)
}

/// A closed box, each side of two triangles and an object of its own, corners doubled.
fn box_of(low: Vec3, high: Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    let corner = |i: usize| {
        let pick = |axis: usize| {
            if i >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    for (object, side) in (0..).zip(sides) {
        let first = mesh.positions.len() as u32;
        let at = side.map(corner);
        let normal = (at[1] - at[0]).cross(at[2] - at[0]).normalize();
        mesh.positions.extend(at);
        mesh.normals.extend([normal; 4]);
        for corners in [[0, 1, 2], [0, 2, 3]] {
            let corners = corners.map(|c| first + c);
            mesh.triangles.push(Triangle { corners, object });
        }
    }
    mesh
}

/// Everything, drawn for an eye above: also what stands above the water.
fn all_of(mesh: &Mesh, sight: &Sight, bow_px: f64, budget: usize) -> (Triangles, Option<Divided>) {
    let made = Triangles::new(mesh, band(1e6)).unwrap();
    let all = 0..made.indices.len() as u32;
    let divided = divided(&made, all, band(1e6), sight, bow_px, budget);
    (made, divided)
}

fn corners(divided: &Divided) -> impl Iterator<Item = [Vertex; 3]> {
    let triangles = divided.indices.chunks_exact(3);
    triangles.map(|t| [0, 1, 2].map(|i| divided.vertices[t[i] as usize]))
}

fn area(t: &[Vertex; 3]) -> DVec3 {
    let [a, b, c] = t.map(|v| wide(v.position));
    0.5 * (b - a).cross(c - a)
}

fn volume(t: &[Vertex; 3]) -> f64 {
    let [a, b, c] = t.map(|v| wide(v.position));
    a.dot(b.cross(c)) / 6.0
}

/// Every edge is passed as often one way as the other: nothing is open, no corner lies on an edge.
/// Where it is `torn` along the plane, edges there are left out.
fn assert_closed(divided: &Divided, torn: bool) {
    let mut passes: BTreeMap<[Bits; 2], i32> = BTreeMap::new();
    for triangle in corners(divided) {
        let ends = [(0, 1), (1, 2), (2, 0)];
        let along = |i: usize| triangle[i].position[2].abs() <= LIFT;
        for (i, j) in ends
            .into_iter()
            .filter(|&(i, j)| !(torn && along(i) && along(j)))
        {
            let [a, b] = [i, j].map(|i| bits(triangle[i].position));
            *passes.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    assert!(passes.values().all(|&p| p == 0));
}

fn straddling() -> Mesh {
    box_of(Vec3::new(-1.3, 1.1, -2.0), Vec3::new(1.7, 4.3, 0.7))
}

#[test]
fn closed_meshes_stay_closed_and_keep_area_volume_and_attributes() {
    for (height, bow_px) in [(1.7, 0.1), (0.05, 0.3), (-1.5, 0.1), (1.7, f64::INFINITY)] {
        let mesh = straddling();
        let (made, divided) = all_of(&mesh, &sight(height, 1.333), bow_px, usize::MAX);
        let divided = divided.unwrap();
        assert_closed(&divided, height < 0.0);
        let mut areas = [DVec3::ZERO; 6];
        let mut whole = 0.0;
        for piece in corners(&divided) {
            areas[piece[0].object as usize] += area(&piece);
            whole += volume(&piece);
            let normal = Vec3::from(piece[0].geometric_normal);
            assert!(area(&piece).dot(normal.as_dvec3()) > 0.0, "turned over");
            for vertex in piece {
                assert!(normal.distance(vertex.normal.into()) < 1e-6);
            }
            let z = piece.map(|v| v.position[2]);
            assert!(
                !(z.iter().any(|&z| z < 0.0) && z.iter().any(|&z| z > 0.0)),
                "{z:?}"
            );
        }
        assert!((whole - 3.0 * 3.2 * 2.7).abs() < 1e-4, "{whole}");
        for (object, total) in areas.iter().enumerate() {
            let original = made.indices.chunks_exact(3).filter_map(|t| {
                let t = [0, 1, 2].map(|i| made.vertices[t[i] as usize]);
                (t[0].object as usize == object).then(|| area(&t))
            });
            assert!(original.sum::<DVec3>().distance(*total) < 1e-5);
        }
        assert_eq!(bow_px, divided.bow_px);
    }
}

#[test]
fn to_an_eye_below_nothing_above_the_water_is_drawn_outside_snells_window() {
    let (depth, index) = (1.5, 1.333);
    let sight = sight(-depth, index);
    let standing = box_of(Vec3::new(-1.3, 1.1, 0.0), Vec3::new(1.7, 4.3, 0.7));
    let mut outside_without_lifting = 0;
    for mesh in [straddling(), standing] {
        let (_, divided) = all_of(&mesh, &sight, 0.1, usize::MAX);
        for piece in corners(&divided.unwrap()) {
            if piece.iter().all(|v| v.position[2] <= 0.0) {
                continue;
            }
            for vertex in piece {
                let world = wide(vertex.position);
                let from_eye = |p: DVec3| {
                    let apart = (p - DVec3::new(0.0, -1.0, 0.0)).truncate().length();
                    apart * (index * index - 1.0).sqrt() / (depth + p.z)
                };
                assert!(
                    from_eye(sight.sighted(world).apparent) < 1.0 + 1e-6,
                    "{world}"
                );
                outside_without_lifting += usize::from(from_eye(world.with_z(0.0)) > 1.0);
            }
        }
    }
    assert!(outside_without_lifting > 100, "{outside_without_lifting}");
}

#[test]
fn no_edge_bows_beyond_the_bound() {
    for height in [1.7, 0.05, -1.5] {
        for bow_px in [0.1, 1.0] {
            let sight = sight(height, 1.333);
            let (_, divided) = all_of(&straddling(), &sight, bow_px, usize::MAX);
            let mut halved = 0;
            for piece in corners(&divided.unwrap()) {
                let seen = piece.map(|v| sight.sighted(wide(v.position)));
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    // From under water the lowest millimetre of what stands on it appears torn from
                    // it, beyond the critical distance: there halving ends by its depth alone.
                    if height < 0.0 && [a, b].iter().any(|&v| seen[v].world.z < 1e-3) {
                        continue;
                    }
                    let bow = sight.bow(&seen[a], &seen[b]);
                    assert!(
                        bow <= bow_px,
                        "{height}: {bow} px, {:?}",
                        [seen[a], seen[b]]
                    );
                    halved += 1;
                }
            }
            assert!(halved > 3 * 40, "{height} {bow_px}: only {halved}");
        }
    }
}

/// The picture that the pieces draw, found without any of the code that divides: points of the
/// mesh's faces against the piece of that face that covers them.
#[test]
fn points_are_drawn_where_they_appear() {
    let sight = sight(1.7, 1.333);
    let (_, divided) = all_of(&straddling(), &sight, 0.1, usize::MAX);
    let view = crate::sight::tests::view(DVec3::new(0.0, -1.0, 1.7));
    let pixel = |p: DVec3| view.project(p).unwrap();
    let mut worst = 0.0_f64;
    for piece in corners(&divided.unwrap()) {
        let at = piece.map(|v| wide(v.position));
        let drawn = at.map(|p| sight.sighted(p).apparent);
        if drawn.iter().any(|&p| {
            view.project(p)
                .is_none_or(|p| p.min_element() < 0.0 || p.cmpgt(view.size.as_dvec2()).any())
        }) {
            continue;
        }
        let mix = |c: [DVec3; 3]| (c[0] + c[1] + c[2]) / 3.0;
        let off = pixel(mix(drawn)) - pixel(sight.sighted(mix(at)).apparent);
        worst = worst.max(off.length());
    }
    assert!(worst > 0.0 && worst < 0.6, "{worst} px");
}

#[test]
fn what_flat_water_does_not_bend_is_only_cut() {
    let (made, divided) = all_of(&straddling(), &sight(1.7, 1.0), 0.1, usize::MAX);
    // Four sides cross the plane, of two triangles each, and each of these becomes three.
    assert_eq!(
        divided.unwrap().indices.len(),
        made.indices.len() + 4 * 2 * 2 * 3
    );
    let under = box_of(Vec3::new(-1.3, 1.1, -2.0), Vec3::new(1.7, 4.3, -0.7));
    assert!(
        all_of(&under, &sight(1.7, 1.0), 0.1, usize::MAX)
            .1
            .is_none()
    );
    let above = box_of(Vec3::new(-1.3, 1.1, 0.0), Vec3::new(1.7, 4.3, 0.7));
    assert!(
        all_of(&above, &sight(1.7, 1.333), 0.1, usize::MAX)
            .1
            .is_none()
    );
    let far = box_of(Vec3::new(-0.1, 900.0, -0.2), Vec3::new(0.1, 900.1, -0.1));
    assert!(
        all_of(&far, &sight(1.7, 1.333), 0.1, usize::MAX)
            .1
            .is_none()
    );
    assert!(
        all_of(&Mesh::default(), &sight(1.7, 1.333), 0.1, usize::MAX)
            .1
            .is_none()
    );
}

#[test]
fn what_stands_on_the_eyes_side_alone_is_left_out() {
    for (height, deeper) in [(1.7, true), (-1.5, false)] {
        for (margin, reach) in [(0.0, 0.0), (0.2, 0.7)] {
            let band = band(margin);
            let made = Triangles::new(&straddling(), band).unwrap();
            let range = made.range(Geometry::FarSide, deeper);
            let sight = sight(height, 1.333);
            let divided = divided(&made, range, band, &sight, 0.1, usize::MAX).unwrap();
            let z = corners(&divided).flatten().map(|v| {
                if deeper {
                    v.position[2]
                } else {
                    -v.position[2]
                }
            });
            let most = z.fold(f32::MIN, f32::max);
            let reach = if deeper { reach } else { reach * 2.0 / 0.7 };
            assert!((most - reach).abs() < 1e-6, "{height} {margin}: {most}");
        }
    }
}

#[test]
fn a_short_budget_relaxes_the_bound_and_is_kept() {
    let sight = sight(1.7, 1.333);
    let (_, free) = all_of(&straddling(), &sight, 0.02, usize::MAX);
    let free = free.unwrap();
    assert_eq!(free.bow_px, 0.02);
    let budget = free.indices.len() / 3 / 5;
    let (_, tight) = all_of(&straddling(), &sight, 0.02, budget);
    let tight = tight.unwrap();
    assert!(tight.indices.len() / 3 <= budget && tight.bow_px > 0.02);
    assert_closed(&tight, false);
    // What crosses the plane is cut at any price.
    let (_, none) = all_of(&straddling(), &sight, 0.02, 0);
    let none = none.unwrap();
    assert!(none.bow_px.is_infinite());
    assert_closed(&none, false);
    for odd in [0.0, -1.0, f64::NAN] {
        let (_, odd) = all_of(&straddling(), &sight, odd, 2000);
        assert!(odd.unwrap().indices.len() / 3 <= 2000);
    }
}

#[test]
fn the_budget_covers_what_is_cut_at_any_price() {
    for n in [0, 46, 16_000, 1 << 20, 1 << 23] {
        assert!(budget(n) >= 3 * n && budget(n) >= BUDGET_LEAST);
    }
}

#[test]
fn odd_triangles_and_eyes_end() {
    let eyes = [1.7, 1e-9, 0.0, -1e-9, 1e30];
    let huge = f32::MAX / 4.0;
    let shapes: [[[f32; 3]; 3]; 7] = [
        [[0.0, 3.0, -1.0]; 3],
        [[-5.0, 3.0, -1.0], [5.0, 3.0, -1.0], [5.0, 3.0, -1.0]],
        [[-5.0, 3.0, -1.0], [5.0, 3.0, -1.0], [0.0, 3.0, -1.0]],
        [[-huge, -huge, -1.0], [huge, -huge, -1.0], [0.0, huge, -1.0]],
        [[0.0, 3.0, -huge], [1.0, 3.0, huge], [-1.0, 3.0, huge]],
        [[0.0, -1.0, -1.0], [1e-42, 3.0, 1e-42], [-1.0, 3.0, 0.0]],
        [[-1e4, -1e4, -2.0], [1e4, -1e4, -2.0], [0.0, 1e4, -2.0]],
    ];
    for eye in eyes {
        for shape in shapes {
            let mesh = Mesh {
                positions: shape.map(Vec3::from).to_vec(),
                normals: vec![Vec3::Z; 3],
                triangles: vec![Triangle {
                    corners: [0, 1, 2],
                    object: 0,
                }],
            };
            let (_, divided) = all_of(&mesh, &sight(eye, 1.333), 0.1, 20_000);
            let Some(divided) = divided else { continue };
            assert!(divided.indices.len() / 3 <= 20_000, "{eye} {shape:?}");
            let every = divided
                .vertices
                .iter()
                .flat_map(|v| v.position.into_iter().chain(v.normal));
            assert!(every.into_iter().all(f32::is_finite), "{eye} {shape:?}");
        }
    }
}

#[test]
fn normals_between_the_corners_are_those_of_the_whole() {
    let mesh = Mesh {
        positions: [[-2.0, 2.0, -1.0], [2.0, 2.0, -1.0], [0.0, 5.0, 0.5]]
            .map(Vec3::from)
            .to_vec(),
        normals: vec![Vec3::X, Vec3::Y, Vec3::Z],
        triangles: vec![Triangle {
            corners: [0, 1, 2],
            object: 7,
        }],
    };
    let (_, divided) = all_of(&mesh, &sight(1.7, 1.333), 0.1, usize::MAX);
    let divided = divided.unwrap();
    assert!(divided.indices.len() > 60);
    for vertex in corners(&divided).flatten() {
        // The third weight by height, the second by x.
        let p = wide(vertex.position);
        let third = (p.z + 1.0) / 1.5;
        let second = (p.x + 2.0 * (1.0 - third)) / 4.0;
        let normal = DVec3::new(1.0 - second - third, second, third);
        assert!(wide(vertex.normal).distance(normal) < 1e-6);
    }
}
