//! Objects that move with the scene's time, rigidly.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

use crate::{Mesh, Scene};

/// How an object moves. At time 0 it stands where it was placed.
///
/// A point p is at pivot + R (p − pivot) + velocity·t + heave·sin(2π t / period)·ẑ, where R turns by
/// |turn|·t about the axis `turn` (right-hand rule) and the pivot is the object's own origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// World space, metres per second.
    pub velocity: DVec3,
    /// World space; its length is in radians per second.
    pub turn: DVec3,
    /// How far it rises and falls, metres.
    pub heave: f64,
    /// How long it takes to be where it was, seconds; positive.
    pub period: f64,
}

impl Default for Motion {
    /// Standing still.
    fn default() -> Self {
        Self {
            velocity: DVec3::ZERO,
            turn: DVec3::ZERO,
            heave: 0.0,
            period: 1.0,
        }
    }
}

impl Motion {
    /// Whether nothing moves.
    pub fn is_still(&self) -> bool {
        self.velocity == DVec3::ZERO && self.turn == DVec3::ZERO && self.heave == 0.0
    }

    /// What carries the object's points from where they were placed to where they are, for an object
    /// about this pivot (world space, metres) at a time (seconds).
    pub fn pose(&self, pivot: DVec3, time: f64) -> DAffine3 {
        let speed = self.turn.length();
        let turn = match speed > 0.0 {
            // Full turns are left out first, which keeps late moments as exact as early ones.
            true => DQuat::from_axis_angle(
                self.turn / speed,
                TAU * (speed * time / TAU).rem_euclid(1.0),
            ),
            false => DQuat::IDENTITY,
        };
        let turn = DMat3::from_quat(turn);
        DAffine3 {
            matrix3: turn,
            translation: pivot - turn * pivot + self.shift(time),
        }
    }

    /// Where the pivot is beside where it was placed, metres.
    fn shift(&self, time: f64) -> DVec3 {
        let wave = (TAU * (time / self.period).rem_euclid(1.0)).sin();
        self.velocity * time + DVec3::Z * (self.heave * wave)
    }
}

/// An object that moves, with its points as they were placed.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    object: u32,
    motion: Motion,
    pivot: DVec3,
    /// Indices of its vertices in the mesh.
    vertices: Vec<u32>,
    /// World space at time 0, metres.
    positions: Vec<DVec3>,
    /// Unit vectors at time 0.
    normals: Vec<DVec3>,
}

impl Body {
    /// Of an object whose vertices are no other object's.
    pub(crate) fn new(
        object: u32,
        (motion, pivot): (Motion, DVec3),
        vertices: Vec<u32>,
        positions: Vec<DVec3>,
        normals: Vec<DVec3>,
    ) -> Self {
        Self {
            object,
            motion,
            pivot,
            vertices,
            positions,
            normals,
        }
    }

    /// The object's id.
    pub fn object(&self) -> u32 {
        self.object
    }

    /// How it moves.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// What it turns about at time 0: world space, metres.
    pub fn pivot(&self) -> DVec3 {
        self.pivot
    }

    /// Indices of its vertices in the scene's mesh, in ascending order.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Positions and unit normals of its vertices, in the order of [`Self::vertices`], at a time in
    /// seconds: made in f64 and rounded once. Points within rounding of `level` lie on it.
    pub fn points(&self, time: f64, level: f64) -> impl Iterator<Item = (Vec3, Vec3)> {
        let pose = self.motion.pose(self.pivot, time);
        let points = self.positions.iter().zip(&self.normals);
        points.map(move |(&position, &normal)| {
            let normal = pose.matrix3 * normal;
            (
                rounded(pose.transform_point3(position), level),
                normal.as_vec3().normalize_or(Vec3::Z),
            )
        })
    }

    /// Whether it stands elsewhere at one time than at another, seconds.
    pub fn moves_between(&self, from: f64, to: f64) -> bool {
        let pose = |time| self.motion.pose(self.pivot, time);
        from != to && pose(from) != pose(to)
    }

    /// The lowest and highest z that it may reach, metres: at a time, in seconds, if it sinks or rises
    /// for good; else at any time.
    pub fn heights(&self, time: f64) -> [f64; 2] {
        let tilts = self.motion.turn.truncate() != glam::DVec2::ZERO;
        let reach = |p: &DVec3| match tilts {
            true => [-1.0, 1.0].map(|side| side * p.distance(self.pivot)),
            false => [p.z - self.pivot.z; 2],
        };
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = self
            .positions
            .iter()
            .map(reach)
            .fold(none, |all, one| [all[0].min(one[0]), all[1].max(one[1])]);
        let middle = self.pivot.z + self.motion.velocity.z * time;
        let heave = self.motion.heave.abs();
        [middle + low - heave, middle + high + heave]
    }

    /// No point is farther from the origin along an axis at a time, metres.
    fn reach(&self, time: f64) -> f64 {
        let radius = self.positions.iter().map(|p| p.distance(self.pivot));
        let radius = radius.fold(0.0, f64::max);
        let centre = self.pivot + self.motion.velocity * time;
        centre.abs().max_element() + self.motion.heave.abs() + radius
    }
}

/// A scene's objects that move, and the time at which its mesh shows them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moving {
    bodies: Arc<Vec<Body>>,
    time: f64,
}

impl Moving {
    /// With the mesh as it is at time 0.
    pub(crate) fn new(bodies: Vec<Body>) -> Self {
        Self {
            bodies: Arc::new(bodies),
            time: 0.0,
        }
    }

    /// The objects that move, by ascending id; all others are static.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Whether nothing moves.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// The time at which the mesh shows the bodies, seconds.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Whether the same bodies move, at whatever time.
    pub fn is_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.bodies, &other.bodies) || self.bodies == other.bodies
    }

    /// Ids of the objects that stand elsewhere now than at another time, seconds.
    pub fn since(&self, time: f64) -> impl Iterator<Item = u32> {
        let moved = self
            .bodies
            .iter()
            .filter(move |b| b.moves_between(time, self.time));
        moved.map(Body::object)
    }

    /// Puts the vertices of bodies where they are at a time.
    pub(crate) fn set_time(&mut self, mesh: &mut Mesh, level: f64, time: f64) {
        let from = std::mem::replace(&mut self.time, time);
        for body in self.bodies.iter().filter(|b| b.moves_between(from, time)) {
            for (&vertex, (position, normal)) in body.vertices.iter().zip(body.points(time, level))
            {
                mesh.positions[vertex as usize] = position;
                mesh.normals[vertex as usize] = normal;
            }
        }
    }
}

/// A point of the mesh: on the water's level where it is within rounding of it.
pub(crate) fn rounded(mut at: DVec3, level: f64) -> Vec3 {
    if (at.z - level).abs() < 1e-9 * (1.0 + level.abs()) {
        at.z = level;
    }
    // −0 and 0 are one place; one of them keeps equal points equal bit for bit.
    (at + 0.0).as_vec3()
}

impl Scene {
    /// Puts the water and all that moves at a time, seconds.
    pub fn set_time(&mut self, time: f64) {
        self.water.time = time;
        if self.moving.time != time {
            self.moving.set_time(&mut self.mesh, self.water.level, time);
        }
    }

    /// The same scene at another time, seconds. The mesh is copied; where the scene is at hand,
    /// [`Scene::set_time`] does without.
    #[must_use]
    pub fn at_time(&self, time: f64) -> Self {
        let mut scene = self.clone();
        scene.set_time(time);
        scene
    }

    /// How an object moves; none where it is static.
    pub fn motion_of(&self, object: u32) -> Option<&Motion> {
        let bodies = &self.moving.bodies;
        let found = bodies.binary_search_by_key(&object, |body| body.object);
        found.ok().map(|index| bodies[index].motion())
    }

    /// The first object that is farther from the origin than coordinates serve (1000 km along an axis)
    /// at a time, seconds.
    pub fn lost_at(&self, time: f64) -> Option<u32> {
        let mut bodies = self.moving.bodies.iter();
        let lost = bodies.find(|body| body.reach(time).is_nan() || body.reach(time) > FARTHEST);
        lost.map(Body::object)
    }

    /// Has an object move from where it stands, which is where it will be at time 0, about a pivot in
    /// world space. False, and nothing changes, if it shares vertices with another object or has none,
    /// or if the mesh is not whole.
    pub fn set_motion(&mut self, object: u32, motion: Motion, pivot: DVec3) -> bool {
        let mesh = &self.mesh;
        let mut owned = vec![[false; 2]; mesh.positions.len()];
        for triangle in &mesh.triangles {
            for corner in triangle.corners {
                match owned.get_mut(corner as usize) {
                    Some(by) => by[usize::from(triangle.object == object)] = true,
                    None => return false,
                }
            }
        }
        let shared = owned.contains(&[true; 2]) || !owned.iter().any(|by| by[1]);
        if shared || mesh.normals.len() != mesh.positions.len() {
            return false;
        }
        let vertices: Vec<u32> = (0..)
            .zip(&owned)
            .filter(|(_, by)| by[1])
            .map(|(i, _)| i)
            .collect();
        let of = |all: &[Vec3]| {
            vertices
                .iter()
                .map(|&v| all[v as usize].as_dvec3())
                .collect()
        };
        let (positions, normals) = (of(&mesh.positions), of(&mesh.normals));
        let mut bodies = self.moving.bodies.to_vec();
        bodies.retain(|body| body.object != object);
        if !motion.is_still() {
            bodies.push(Body::new(
                object,
                (motion, pivot),
                vertices,
                positions,
                normals,
            ));
        }
        bodies.sort_by_key(|body| body.object);
        let time = self.water.time;
        self.moving.bodies = Arc::new(bodies);
        // The new body stands as at time 0.
        self.moving.time = 0.0;
        self.moving.set_time(&mut self.mesh, self.water.level, time);
        true
    }
}

/// Nothing stands farther from the origin, metres: f32 is too coarse beyond.
pub(crate) const FARTHEST: f64 = 1e6;
