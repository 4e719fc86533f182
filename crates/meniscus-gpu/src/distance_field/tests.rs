use super::*;
use meniscus_scene::Triangle;

/// A mesh of quadrilaterals, counter-clockwise as seen from outside; object = number.
fn quads(quads: &[[[f32; 3]; 4]]) -> Mesh {
    let mut mesh = Mesh::default();
    for (object, corners) in (0..).zip(quads) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(Vec3::from_array));
        mesh.normals.extend([Vec3::Z; 4]);
        for corners in [[0, 1, 2], [0, 2, 3]] {
            let corners = corners.map(|c| first + c);
            mesh.triangles.push(Triangle { corners, object });
        }
    }
    mesh
}

/// The cube from −1 to 1.
fn cube() -> Mesh {
    let mut faces = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let corner = |u: f32, v: f32| {
                let mut corner = [0.0; 3];
                corner[axis] = side;
                corner[(axis + 1) % 3] = u * side;
                corner[(axis + 2) % 3] = v;
                corner
            };
            faces.push([
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ]);
        }
    }
    quads(&faces)
}

fn each(field: &DistanceField, mut look: impl FnMut(&Grid, Vec3, usize)) {
    for grid in &field.grids {
        for index in 0..grid.slice() * grid.size.z as usize {
            let at = grid.at(index % grid.slice(), index / grid.slice());
            look(grid, at, grid.first as usize + index);
        }
    }
}

#[test]
fn the_distance_to_a_cube_is_exact_near_it_and_negative_behind_its_faces() {
    let mut cube = cube();
    for triangle in &mut cube.triangles {
        triangle.object = 7;
    }
    let field = DistanceField::with_voxels(&cube, [1.0, 0.0], [20_000, 10_000]);
    let mut inside = 0;
    each(&field, |grid, at, index| {
        let q = at.abs() - 1.0;
        let exact = q.max(Vec3::ZERO).length() + q.max_element().min(0.0);
        let found = field.distances[index];
        if exact.abs() < (BAND - 0.01) * grid.voxel {
            assert!((found - exact).abs() < 1e-4, "{at}: {found} for {exact}");
            inside += usize::from(found < 0.0);
        } else {
            // Another triangle may have been taken for the nearest.
            let more = found.abs() - exact.abs();
            assert!(more > -1e-4 && more < 0.5 * grid.voxel, "{at}: {found}");
        }
        assert_eq!(field.objects[index], 7);
    });
    assert!(inside > 1000);
}

const SHEET: [[f32; 3]; 4] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

#[test]
fn a_sheet_has_a_back_only_behind_itself() {
    let above = SHEET.map(|[x, y, _]| [x, y, 3.0]);
    let mesh = quads(&[SHEET, above]);
    let field = DistanceField::with_voxels(&mesh, [3.0, 0.0], [30_000, 8_000]);
    let mut negative = 0;
    each(&field, |grid, at, index| {
        let sideways = at.truncate().abs().max_element();
        let under = [0.0, 3.0].map(|z| z - at.z);
        let band = BAND * grid.voxel;
        let behind = sideways < 1.0 && under.iter().any(|d| (1e-3..band - 1e-3).contains(d));
        let clear = (sideways - 1.0).abs() > 1e-3
            && (at.z - 1.5).abs() > 1e-3
            && under
                .iter()
                .all(|d| d.abs() > 1e-3 && (d - band).abs() > 1e-3);
        if clear {
            assert_eq!(field.distances[index] < 0.0, behind, "{at}");
            assert_eq!(field.objects[index], u32::from(at.z > 1.5), "{at}");
            negative += usize::from(behind);
        }
    });
    assert!(negative > 100);
}

#[test]
fn what_stands_in_another_opens_no_way_into_it() {
    // A floor through the middle of the cube: behind it there is no outside.
    let mut mesh = cube();
    let floor = SHEET.map(|[x, y, _]| [3.0 * x, 3.0 * y, 0.0]);
    let first = mesh.positions.len() as u32;
    let floor = quads(&[floor]);
    mesh.positions.extend(floor.positions);
    mesh.normals.extend(floor.normals);
    mesh.triangles
        .extend(floor.triangles.iter().map(|t| Triangle {
            corners: t.corners.map(|c| first + c),
            object: 6,
        }));
    let field = DistanceField::with_voxels(&mesh, [0.3, 0.1], [40_000, 20_000]);
    each(&field, |grid, at, index| {
        let under = -at.z;
        if at.truncate().abs().max_element() < 3.0
            && (1e-3..(BAND - 0.01) * grid.voxel).contains(&under)
        {
            assert!(field.distances[index] < 0.0, "{at}");
        }
    });
}

#[test]
fn grids_hold_what_the_water_covers_and_everything_within_their_budget() {
    let field = DistanceField::with_voxels(&cube(), [-0.6, 0.1], [20_000, 10_000]);
    let [below, all] = field.grids[..] else {
        panic!("{:?}", field.grids)
    };
    let high = |g: &Grid| g.low + g.voxel * (g.size - UVec3::ONE).as_vec3();
    assert!(below.low.cmple(Vec3::splat(-1.0)).all());
    assert!(high(&below).z >= -0.5 && high(&below).z < 0.0);
    assert!(all.low.cmple(Vec3::splat(-1.0)).all() && high(&all).cmpge(Vec3::ONE).all());
    assert!(below.size.element_product() <= 20_000 && all.size.element_product() <= 10_000);
    assert_eq!(field.distances.len(), field.objects.len());
    assert_eq!(all.first, below.size.element_product());
}

#[test]
fn meshes_of_nothing_and_of_no_area_are_far_away() {
    let mut flat = cube();
    flat.positions.fill(Vec3::ONE);
    for mesh in [Mesh::default(), flat] {
        let field = DistanceField::with_voxels(&mesh, [f32::MAX, 1.0], [1000, 1000]);
        assert!(field.distances.iter().all(|d| d.is_finite() && *d > 0.0));
    }
}

#[test]
fn more_voxels_are_smaller_ones() {
    let sizes: Vec<f32> = [1 << 12, 1 << 15, 1 << 18]
        .map(|voxels| DistanceField::new(&cube(), [0.5, 0.0], voxels).grids[0].voxel)
        .into();
    assert!(sizes.is_sorted_by(|a, b| *a > 1.8 * b), "{sizes:?}");
}
