//! The distances at the voxels of one grid: exact about the triangles, then propagated.

use glam::Vec3;
use rayon::prelude::*;

use super::face::Face;
use super::{BAND, Grid};

/// Rounds of propagation along each axis, there and back.
const ROUNDS: usize = 2;
/// Squared distances that differ by less than this part are equal.
const TIE: f32 = 1e-4;

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
pub(super) fn measured(grid: &Grid, faces: &[Face]) -> Vec<(f32, u32)> {
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
