//! Signed distances to a scene's triangles at the voxels of two grids, for sphere tracing.
//!
//! Within a band about the triangles distances are exact, and negative behind the nearest triangle
//! of an object; where several are equally near, the one that is faced most decides, as Bærentzen &
//! Aanæs (2005) ask for at edges and corners. The least of all objects' distances is kept, so that
//! objects may stand in each other. Meshes need not be closed: what is nearest to a rim, an edge of
//! one triangle alone, counts as outside, so that a sheet has a back only within its own outline.
//! Outside of the band voxels take over the nearest triangle of their neighbours (Danielsson 1980):
//! a distance may be a little too large where the nearest triangle is none of theirs. It is positive
//! there on either side, for rays that come from outside end in the band. A grid knows only of what
//! reaches into it: a distance says nothing beyond the grid.

use std::collections::HashMap;
use std::time::Instant;

use glam::{UVec3, Vec3};
use meniscus_scene::Mesh;
use rayon::prelude::*;

/// Voxels of the grid about what the water covers, and of the one about everything.
const VOXELS: [usize; 2] = [1 << 21, 1 << 20];
/// The most voxels along an axis.
const MAX_SIDE: f32 = 1024.0;
/// Voxels around what a grid holds.
const MARGIN: f32 = 2.0;
/// How far from a triangle distances are computed for it, in voxels.
const BAND: f32 = 2.0;
/// Rounds of propagation along each axis, there and back.
const ROUNDS: usize = 2;
/// Squared distances that differ by less than this part are equal.
const TIE: f32 = 1e-4;

/// Where the voxels of a grid are: their corners stand at `low + voxel · (x, y, z)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    /// Of the first voxel, world space, metres.
    pub low: Vec3,
    /// Metres.
    pub voxel: f32,
    /// Voxels along the axes; at least 2.
    pub size: UVec3,
    /// Index of the first voxel in the arrays; x runs fastest, then y.
    pub first: u32,
}

/// The grids and their voxels.
#[derive(Debug)]
pub(crate) struct DistanceField {
    /// The finer one first.
    pub grids: Vec<Grid>,
    /// Metres; negative at most two voxels behind what is nearest.
    pub distances: Vec<f32>,
    /// Id of the object that is nearest.
    pub objects: Vec<u32>,
    /// How long it took to build, milliseconds.
    pub build_ms: f64,
}

impl DistanceField {
    /// Of a mesh whose corners are finite and their indices in range, under water of this level
    /// that stands nowhere higher above it than `waves`.
    pub fn new(mesh: &Mesh, level: f32, waves: f32) -> Self {
        Self::with_voxels(mesh, [level, waves], VOXELS)
    }

    fn with_voxels(mesh: &Mesh, [level, waves]: [f32; 2], voxels: [usize; 2]) -> Self {
        let start = Instant::now();
        let faces = Face::all(mesh);
        let mut field = Self {
            grids: Vec::new(),
            distances: Vec::new(),
            objects: Vec::new(),
            build_ms: 0.0,
        };
        for (top, voxels) in [level, f32::INFINITY].into_iter().zip(voxels) {
            let (low, mut high) = bounds(&faces, top);
            if top == high.z {
                // Rays begin at the waves.
                high.z += waves;
            }
            let mut grid = Grid::new(low, high, voxels);
            grid.first = field.distances.len() as u32;
            for (distance, object) in measured(&grid, &faces) {
                field.distances.push(distance);
                field.objects.push(object);
            }
            field.grids.push(grid);
        }
        field.build_ms = start.elapsed().as_secs_f64() * 1e3;
        field
    }
}

impl Grid {
    fn new(low: Vec3, high: Vec3, voxels: usize) -> Self {
        let extent = (high - low).max(Vec3::ZERO);
        let longest = extent.max_element().max(1e-3);
        let size = |voxel: f32| (extent / voxel).ceil() + 1.0 + 2.0 * MARGIN;
        // The smallest voxels of which there are not too many; the count falls with their size.
        let mut voxel = longest / (MAX_SIDE - 2.0 - 2.0 * MARGIN);
        while size(voxel).element_product() > voxels as f32 {
            voxel *= 1.01;
        }
        Self {
            low: low - MARGIN * voxel,
            voxel,
            size: size(voxel).as_uvec3(),
            first: 0,
        }
    }

    fn slice(&self) -> usize {
        (self.size.x * self.size.y) as usize
    }

    /// Where a voxel of a slice stands.
    fn at(&self, index: usize, z: usize) -> Vec3 {
        let x = index % self.size.x as usize;
        let y = index / self.size.x as usize;
        self.low + self.voxel * Vec3::new(x as f32, y as f32, z as f32)
    }

    /// The range of voxels along an axis between two coordinates.
    fn range(&self, axis: usize, low: f32, high: f32) -> std::ops::Range<usize> {
        let count = self.size[axis] as f32;
        let index = |x: f32| ((x - self.low[axis]) / self.voxel).clamp(0.0, count);
        index(low).ceil() as usize..(index(high).floor() as usize + 1).min(count as usize)
    }
}

/// The box about what of the triangles lies no higher than `top`.
fn bounds(faces: &[Face], top: f32) -> (Vec3, Vec3) {
    let mut low = Vec3::INFINITY;
    let mut high = Vec3::NEG_INFINITY;
    let mut add = |point: Vec3| {
        low = low.min(point);
        high = high.max(point);
    };
    for face in faces {
        for i in 0..3 {
            let (a, b) = (face.corners[i], face.corners[(i + 1) % 3]);
            if a.z <= top {
                add(a);
            }
            if (a.z > top) != (b.z > top) {
                add(a + (b - a) * ((top - a.z) / (b.z - a.z)));
            }
        }
    }
    if low.is_finite() {
        (low, high)
    } else {
        (Vec3::ZERO, Vec3::ZERO)
    }
}

/// A triangle of some area.
#[derive(Debug, Clone, Copy)]
struct Face {
    corners: [Vec3; 3],
    /// Unit.
    normal: Vec3,
    object: u32,
    /// Whether the edge from this corner to the next belongs to no other triangle.
    rim: [bool; 3],
}

/// A position that equal ones share; −0 is 0.
fn key(corner: Vec3) -> [u32; 3] {
    (corner + 0.0).to_array().map(f32::to_bits)
}

/// Where a face is nearest to a point.
struct Nearest {
    squared: f32,
    offset: Vec3,
    /// On an edge that no other triangle shares.
    on_rim: bool,
}

impl Face {
    fn all(mesh: &Mesh) -> Vec<Self> {
        let mut faces = Vec::with_capacity(mesh.triangles.len());
        for triangle in &mesh.triangles {
            let corners = triangle.corners.map(|c| mesh.positions[c as usize]);
            let [a, b, c] = corners.map(|corner| corner.as_dvec3());
            let normal = (b - a).cross(c - a).as_vec3().try_normalize();
            faces.extend(normal.map(|normal| Self {
                corners,
                normal,
                object: triangle.object,
                rim: [false; 3],
            }));
        }
        let mut edges = HashMap::<_, u32>::new();
        let edge = |face: &Self, i: usize| {
            let (a, b) = (key(face.corners[i]), key(face.corners[(i + 1) % 3]));
            (a.min(b), a.max(b))
        };
        for face in &faces {
            for i in 0..3 {
                *edges.entry(edge(face, i)).or_default() += 1;
            }
        }
        for face in &mut faces {
            face.rim = std::array::from_fn(|i| edges[&edge(face, i)] == 1);
        }
        faces
    }

    fn nearest(&self, point: Vec3) -> Nearest {
        let height = self.normal.dot(point - self.corners[0]);
        let foot = point - height * self.normal;
        let mut inside = true;
        let mut best = Nearest {
            squared: f32::INFINITY,
            offset: Vec3::ZERO,
            on_rim: false,
        };
        for i in 0..3 {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % 3]);
            let along = b - a;
            inside &= self.normal.dot(along.cross(foot - a)) >= 0.0;
            let part = (point - a).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
            let offset = point - (a + part.clamp(0.0, 1.0) * along);
            let squared = offset.length_squared();
            if squared < best.squared {
                best = Nearest {
                    squared,
                    offset,
                    on_rim: self.rim[i],
                };
            }
        }
        if inside {
            best = Nearest {
                squared: height * height,
                offset: height * self.normal,
                on_rim: false,
            };
        }
        best
    }
}

/// What a voxel knows: the nearest face, and how much that faces it.
#[derive(Debug, Clone, Copy)]
struct Voxel {
    squared: f32,
    facing: f32,
    face: u32,
    /// The least signed distance to an object, and the object, of those within the band.
    signed: f32,
    object: u32,
}

const UNKNOWN: Voxel = Voxel {
    squared: f32::INFINITY,
    facing: 0.0,
    face: u32::MAX,
    signed: f32::INFINITY,
    object: 0,
};

impl Voxel {
    fn meet(&mut self, index: u32, faces: &[Face], point: Vec3) {
        if index == self.face || index == UNKNOWN.face {
            return;
        }
        let face = &faces[index as usize];
        let nearest = face.nearest(point);
        let distance = nearest.squared.sqrt().max(f32::MIN_POSITIVE);
        let facing = face.normal.dot(nearest.offset).abs() / distance;
        let nearer = nearest.squared < self.squared * (1.0 - TIE);
        let as_near = nearest.squared <= self.squared * (1.0 + TIE);
        if nearer || (as_near && facing > self.facing) {
            *self = Self {
                squared: nearest.squared.min(self.squared),
                facing,
                face: index,
                ..*self
            };
        }
    }
}

impl Voxel {
    /// Takes what was found of one object; what is no nearer than the band is for propagation only.
    fn join(&mut self, found: &Self, faces: &[Face], grid: &Grid, point: Vec3) {
        let Some(face) = faces.get(found.face as usize) else {
            return;
        };
        self.meet(found.face, faces, point);
        let distance = found.squared.sqrt();
        if distance > BAND * grid.voxel {
            return;
        }
        let nearest = face.nearest(point);
        let behind = face.normal.dot(nearest.offset) < 0.0 && !nearest.on_rim;
        let signed = if behind { -distance } else { distance };
        if signed < self.signed {
            self.signed = signed;
            self.object = face.object;
        }
    }
}

/// Distance and object at every voxel of a grid.
fn measured(grid: &Grid, faces: &[Face]) -> Vec<(f32, u32)> {
    let mut voxels = vec![UNKNOWN; grid.slice() * grid.size.z as usize];
    near_faces(grid, faces, &mut voxels);
    for _ in 0..ROUNDS {
        propagate_in_slices(grid, faces, &mut voxels);
        propagate_between_slices(grid, faces, &mut voxels);
    }
    let far = grid.voxel * grid.size.as_vec3().length();
    voxels
        .par_iter()
        .map(|voxel| match faces.get(voxel.face as usize) {
            _ if voxel.signed.is_finite() => (voxel.signed, voxel.object),
            Some(face) => (voxel.squared.sqrt(), face.object),
            None => (far, 0),
        })
        .collect()
}

/// The voxels in the band about each face.
fn near_faces(grid: &Grid, faces: &[Face], voxels: &mut [Voxel]) {
    let reach = Vec3::splat(BAND * grid.voxel);
    let boxed = |face: &Face| {
        let [a, b, c] = face.corners;
        (a.min(b).min(c) - reach, a.max(b).max(c) + reach)
    };
    let mut slices = vec![Vec::new(); grid.size.z as usize];
    for (index, face) in (0..).zip(faces) {
        let (low, high) = boxed(face);
        for slice in &mut slices[grid.range(2, low.z, high.z)] {
            slice.push(index);
        }
    }
    let object = |index: &u32| faces[*index as usize].object;
    for slice in &mut slices {
        slice.sort_by_key(object);
    }
    voxels
        .par_chunks_mut(grid.slice())
        .zip(&slices)
        .enumerate()
        .for_each_init(
            || vec![UNKNOWN; grid.slice()],
            |own, (z, (voxels, slice))| {
                let mut touched = Vec::new();
                for part in slice.chunk_by(|a, b| object(a) == object(b)) {
                    for &index in part {
                        let (low, high) = boxed(&faces[index as usize]);
                        for y in grid.range(1, low.y, high.y) {
                            for x in grid.range(0, low.x, high.x) {
                                let at = y * grid.size.x as usize + x;
                                own[at].meet(index, faces, grid.at(at, z));
                                touched.push(at);
                            }
                        }
                    }
                    for at in touched.drain(..) {
                        let found = std::mem::replace(&mut own[at], UNKNOWN);
                        voxels[at].join(&found, faces, grid, grid.at(at, z));
                    }
                }
            },
        );
}

/// Along x and y, there and back.
fn propagate_in_slices(grid: &Grid, faces: &[Face], voxels: &mut [Voxel]) {
    let (width, count) = (grid.size.x as usize, grid.slice());
    voxels
        .par_chunks_mut(count)
        .enumerate()
        .for_each(|(z, voxels)| {
            let mut take = |to: usize, from: usize| {
                let face = voxels[from].face;
                voxels[to].meet(face, faces, grid.at(to, z));
            };
            for at in (0..count).filter(|at| at % width > 0) {
                take(at, at - 1);
            }
            for at in (0..count).rev().filter(|at| at % width > 0) {
                take(at - 1, at);
            }
            for at in width..count {
                take(at, at - width);
            }
            for at in (width..count).rev() {
                take(at - width, at);
            }
        });
}

/// Along z, there and back.
fn propagate_between_slices(grid: &Grid, faces: &[Face], voxels: &mut [Voxel]) {
    let count = grid.slice();
    let depth = grid.size.z as usize;
    let take = |to: &mut [Voxel], from: &[Voxel], z: usize| {
        let pairs = to.par_iter_mut().zip(from).enumerate();
        pairs.for_each(|(at, (to, from))| to.meet(from.face, faces, grid.at(at, z)));
    };
    for z in 1..depth {
        let (before, after) = voxels.split_at_mut(z * count);
        take(&mut after[..count], &before[(z - 1) * count..], z);
    }
    for z in (1..depth).rev() {
        let (before, after) = voxels.split_at_mut(z * count);
        take(&mut before[(z - 1) * count..], &after[..count], z - 1);
    }
}

#[cfg(test)]
mod tests {
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
}
