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

mod face;
mod measured;

use std::time::Instant;

use glam::{UVec3, Vec3};
use meniscus_pipeline::PlannedPass;
use meniscus_scene::Mesh;

use crate::layout::Column;
use face::Face;
use measured::measured;

/// Voxels of the grid about what the water covers, where nothing else is asked for; the one about
/// everything has half as many.
pub(crate) const VOXELS: u32 = 1 << 21;
/// The fewest and the most that can be asked for.
const VOXELS_ALLOWED: [u32; 2] = [1 << 12, 1 << 25];
/// The `override` by which a shader asks for as many.
const VOXELS_NUMBER: &str = "field_voxels";
/// The most voxels along an axis.
const MAX_SIDE: f32 = 1024.0;
/// Voxels around what a grid holds.
const MARGIN: f32 = 2.0;
/// How far from a triangle distances are computed for it, in voxels.
const BAND: f32 = 2.0;

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
    /// that stands nowhere higher above it than `waves`, with so many voxels in the finer grid.
    pub fn new(mesh: &Mesh, [level, waves]: [f32; 2], voxels: u32) -> Self {
        let finer = voxels as usize;
        Self::with_voxels(mesh, [level, waves], [finer, finer / 2])
    }

    /// The length of one of the host's arrays.
    pub fn length(&self, array: &str) -> usize {
        match array {
            "distance_grids" => self.grids.len(),
            _ => self.distances.len(),
        }
    }

    /// A member of one of the host's arrays.
    pub fn column(&self, array: &str, member: &str) -> Option<Column<'_>> {
        let g = &self.grids;
        Some(match (array, member) {
            ("distance_grids", "low") => Column::vec3(|i| g[i].low),
            ("distance_grids", "size") => Column::vec3(|i| g[i].size.as_vec3()),
            ("distance_grids", "voxel") => Column::f32(|i| g[i].voxel),
            ("distance_grids", "first") => Column::u32(|i| g[i].first),
            ("distance_voxels", "distance") => Column::f32(|i| self.distances[i]),
            ("distance_objects", "object") => Column::u32(|i| self.objects[i]),
            _ => return None,
        })
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

/// How many voxels a pass asks for: the number of that name, the largest where several fillings
/// have one.
pub fn voxels_asked(pass: &PlannedPass) -> u32 {
    let overrides = pass.shader.overrides.iter();
    let asked = overrides.filter(|(path, _)| path.rsplit('.').next() == Some(VOXELS_NUMBER));
    let number = |name: &String| {
        let set = pass.numbers.get(name).copied();
        set.or_else(|| default_of(&pass.shader.module, name))
    };
    let most = asked
        .filter_map(|(_, name)| number(name))
        .fold(0.0, f64::max);
    match most > 0.0 {
        true => (most as u32).clamp(VOXELS_ALLOWED[0], VOXELS_ALLOWED[1]),
        false => VOXELS,
    }
}

/// What an `override` is where nothing is set.
fn default_of(module: &naga::Module, name: &str) -> Option<f64> {
    let named = |o: &&naga::Override| o.name.as_deref() == Some(name);
    let found = module.overrides.iter().map(|(_, o)| o).find(named)?;
    match module.global_expressions[found.init?] {
        naga::Expression::Literal(naga::Literal::I32(number)) => Some(f64::from(number)),
        naga::Expression::Literal(naga::Literal::U32(number)) => Some(f64::from(number)),
        naga::Expression::Literal(naga::Literal::F32(number)) => Some(f64::from(number)),
        _ => None,
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

#[cfg(test)]
mod tests;
