//! Independent solutions that headers may name: written from the physics or the geometry, in `f64`,
//! and sharing no formula with modules.
//!
//! A truth gets all numbers of a function's arguments and gives all numbers of its result, both in the
//! order of [`Shape::leaves`](crate::Shape::leaves). NaN stands for "no opinion".

mod geometry;
mod optics;
mod vector;
mod waves;

use super::Host;

/// An independent solution that headers name after `against`.
struct Known {
    name: &'static str,
    /// Arguments and result, for people.
    about: &'static str,
    of: MakeTruth,
}

/// Makes the solution for what the host says of water and view.
type MakeTruth = fn(&Host) -> Option<Box<crate::Truth<'static>>>;

const fn known(name: &'static str, about: &'static str, of: MakeTruth) -> Known {
    Known { name, about, of }
}

static KNOWN: &[Known] = &[
    known("circle", "(angle) → cosine, sine; radians", |_| {
        Some(Box::new(|x| vec![x[0].cos(), x[0].sin()]))
    }),
    known(
        "crossing",
        "(height on the side of the lower index, depth on the other, distance along the plane) → \
         tangent of the angle on the side of the lower index, ratio of both tangents; of the host's water",
        |host| {
            let index = host.number("water.larger_index")?;
            Some(Box::new(move |x| optics::crossing(x[0], x[1], x[2], index)))
        },
    ),
    known(
        "refraction",
        "(incident direction, normal, relative index) → transmitted direction; 0 where all is reflected",
        |_| Some(Box::new(optics::refraction)),
    ),
    known(
        "fresnel",
        "(cosine of the angle of incidence, relative index) → reflectance of unpolarised light",
        |_| Some(Box::new(|x| vec![optics::fresnel(x[0], x[1])])),
    ),
    known(
        "plane",
        "(ray's origin, direction, plane's normal, distance of the plane from the origin along it) → \
         distance along the ray, in lengths of its direction",
        |_| Some(Box::new(geometry::plane)),
    ),
    known(
        "sphere",
        "(ray's origin, direction, centre, radius) → distance along the ray at which it first meets the \
         sphere, in lengths of its direction; no opinion where it does not",
        |_| Some(Box::new(geometry::sphere)),
    ),
    known(
        "triangle",
        "(ray's origin, direction, three corners) → distance along the ray, in lengths of its \
         direction, and barycentric weights of where it meets the triangle's plane",
        |_| Some(Box::new(|x| geometry::triangle(&x[..6], &x[6..15]))),
    ),
    known(
        "sheared triangle",
        "(ray's origin, turn of the axes, shear, three corners) → as `triangle`, for a ray made ready \
         as Woop, Benthin and Wald 2013 do",
        |_| Some(Box::new(geometry::sheared_triangle)),
    ),
    known(
        "camera ray",
        "(camera: eye, right, up, forward, focal length, size, near plane, size of what was seen; \
         pixel) → origin and direction of the ray",
        |_| Some(Box::new(geometry::camera_ray)),
    ),
    known(
        "camera pixel",
        "(camera as for `camera ray`; point) → pixel whose ray passes the point, depth; no opinion \
         behind the eye",
        |_| Some(Box::new(geometry::camera_pixel)),
    ),
    known(
        "waves",
        "(ray's origin, direction) → point at which it first meets the host's waves from the eye's side, \
         their normal there, 1; no opinion where it does not fall through all of them",
        |host| {
            let waves = waves::Waves::of(host)?;
            Some(Box::new(move |x| waves.meeting(x)))
        },
    ),
];

/// Names of the truths.
pub fn truth_names() -> impl Iterator<Item = &'static str> {
    KNOWN.iter().map(|known| known.name)
}

/// What a truth takes and gives, in words; none where there is none of that name.
pub fn truth_about(name: &str) -> Option<&'static str> {
    let known = KNOWN.iter().find(|known| known.name == name)?;
    Some(known.about)
}

/// The solution of a name, for what the host says of water and view; none where there is none of
/// that name.
pub fn truth(name: &str, host: &Host) -> Option<Box<crate::Truth<'static>>> {
    let known = KNOWN.iter().find(|known| known.name == name)?;
    (known.of)(host)
}
