//! The path of a ray through air and water to what it sees.

use glam::{DVec2, DVec3};
use meniscus_scene::{Scene, View};

use crate::bvh::Bvh;
use crate::refraction::{Deflected, deflect};
use crate::surface::{Medium, Surface};
use crate::triangle::Ray;

/// A ray meets the water at most this often; after that it passes through unhindered.
pub const MAX_EVENTS: usize = 4;

/// A meeting with the water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// World space, metres.
    pub point: DVec3,
    /// Unit normal of the waves, upwards.
    pub normal: DVec3,
    /// Unit direction of the ray that arrives.
    pub incident: DVec3,
    /// Unit direction of the ray that goes on: transmitted, or reflected where `total`.
    pub deflected: DVec3,
    /// What the arriving ray ran through.
    pub medium: Medium,
    /// Whether the ray was totally reflected.
    pub total: bool,
}

/// A meeting with a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// World space, metres.
    pub point: DVec3,
    /// Index of the triangle in the scene's mesh.
    pub triangle: u32,
    /// Id of its object.
    pub object: u32,
    /// Unit normal of the triangle, towards the side that sees it counter-clockwise.
    pub geometric_normal: DVec3,
    /// Unit normal interpolated between the corners', as they point.
    pub shading_normal: DVec3,
}

/// All that happened to a ray.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Where the ray began; world space, metres.
    pub origin: DVec3,
    /// What surrounds the origin.
    pub medium: Medium,
    /// Its meetings with the water, in order.
    pub events: Vec<Event>,
    /// The solid that it ended on, if any.
    pub hit: Option<Hit>,
    /// Unit direction in which it arrived there, or left the scene.
    pub direction: DVec3,
    /// On flat geometry with wave normals: the normal faced away from the ray, or the deflected
    /// ray left to the side of the plane where it cannot be. There is no physical answer; the path
    /// ends at that event, which is not among `events`.
    pub undefined: Option<DVec3>,
}

impl Path {
    /// Whether the ray met the water before any solid.
    pub fn water_first(&self) -> bool {
        !self.events.is_empty() || self.undefined.is_some()
    }

    /// Whether the first meeting with the water was a total reflection.
    pub fn total(&self) -> bool {
        self.events.first().is_some_and(|event| event.total)
    }
}

/// A scene made ready for rays.
///
/// The scene keeps its promises (indices in range, positions finite); its loaders check them.
#[derive(Debug)]
pub struct Tracer<'a> {
    pub(crate) scene: &'a Scene,
    bvh: Bvh,
    surface: Surface,
}

impl<'a> Tracer<'a> {
    /// Sorts the scene's triangles, on all cores.
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            bvh: Bvh::new(&scene.mesh),
            surface: Surface::new(&scene.water),
        }
    }

    /// Follows the ray through a place of the picture (pixels, centres at half integers).
    ///
    /// Like a rasteriser, it sees no solid before the view's near plane unless through water. The
    /// water itself has no near plane.
    pub fn trace_pixel(&self, view: &View, pixel: DVec2) -> Path {
        let direction = view.direction(pixel);
        let cosine = direction.dot(view.forward);
        let near = if cosine > 0.0 {
            view.near / cosine
        } else {
            0.0
        };
        self.follow(view.eye, direction, near)
    }

    /// Follows a ray of unit direction. Solids nearer than `near` (metres along the ray, until it
    /// meets water) are not seen.
    pub fn follow(&self, origin: DVec3, direction: DVec3, near: f64) -> Path {
        let mut medium = self.surface.medium(origin);
        let mut path = Path {
            origin,
            medium,
            events: Vec::new(),
            hit: None,
            direction,
            undefined: None,
        };
        let (mut origin, mut near) = (origin, near);
        loop {
            let direction = path.direction;
            let ray = Ray::new(origin, direction);
            let solid = self.bvh.nearest(&ray, near, f64::INFINITY);
            let limit = solid.map_or(f64::INFINITY, |(_, meeting)| meeting.t);
            let water = if path.events.len() < MAX_EVENTS {
                self.surface.meet(origin, direction, medium, limit)
            } else {
                None
            };
            let Some(t) = water else {
                path.hit = solid.map(|(triangle, meeting)| self.hit(triangle, meeting.weights));
                return path;
            };
            let mut point = origin + t * direction;
            if !self.surface.displaced() {
                point.z = self.scene.water.level;
            }
            let Some(event) = self.event(point, direction, medium) else {
                path.undefined = Some(point);
                return path;
            };
            path.events.push(event);
            path.direction = event.deflected;
            if !event.total {
                medium = medium.other();
            }
            (origin, near) = (point, 0.0);
        }
    }

    /// What the water does to a ray that leaves `medium` at `point`; none where it has no answer.
    fn event(&self, point: DVec3, incident: DVec3, medium: Medium) -> Option<Event> {
        let normal = self.surface.normal(point.truncate());
        let facing = medium.sign() * normal;
        if incident.dot(facing) >= 0.0 {
            return None;
        }
        let deflected = deflect(
            incident,
            facing,
            self.surface.index(medium),
            self.surface.index(medium.other()),
        );
        let (deflected, total) = match deflected {
            Deflected::Transmitted(direction) => (direction, false),
            Deflected::Reflected(direction) => (direction, true),
        };
        // On the rest plane the ray must also go on to the side of the plane that it is now on.
        let ahead = if total { medium } else { medium.other() };
        if !self.surface.displaced() && ahead.sign() * deflected.z <= 0.0 {
            return None;
        }
        Some(Event {
            point,
            normal,
            incident,
            deflected,
            medium,
            total,
        })
    }

    fn hit(&self, index: u32, weights: DVec3) -> Hit {
        let mesh = &self.scene.mesh;
        let triangle = &mesh.triangles[index as usize];
        let [a, b, c] = triangle
            .corners
            .map(|i| mesh.positions[i as usize].as_dvec3());
        let [na, nb, nc] = triangle
            .corners
            .map(|i| mesh.normals[i as usize].as_dvec3());
        let geometric_normal = (b - a).cross(c - a).normalize_or(DVec3::Z);
        let shading_normal = na * weights.x + nb * weights.y + nc * weights.z;
        Hit {
            point: a * weights.x + b * weights.y + c * weights.z,
            triangle: index,
            object: triangle.object,
            geometric_normal,
            // Normals that cancel each other have no direction to give.
            shading_normal: shading_normal.normalize_or(geometric_normal),
        }
    }
}
