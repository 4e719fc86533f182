//! From a written shape to triangles.

use std::path::Path;

use glam::DVec3;
use meniscus_source::Diagnostic;
use meniscus_source::ron::Spanned;

use crate::description::{Normals, ObjectFile, Shape, Up};
use crate::lower::Reader;
use crate::mesh_file;
use crate::settings::located;
use crate::shapes::{self, Fineness, Growth, Patch};
use crate::soup::Soup;

/// Where an object's triangles come from.
pub(crate) enum Source {
    /// From a file.
    Given(Soup),
    /// From a generator: longest cell side and the water's z, both in the shape's own space.
    Made(Box<dyn Fn(f64, Option<f64>) -> Vec<Patch>>),
}

/// Parts that are drawn in one call are limited to this many.
const MOST_COPIES: f64 = 1e4;

/// Reads a shape; what is wrong goes to the reader's report.
pub(crate) fn source(
    reader: &mut Reader,
    object: &Spanned<ObjectFile>,
    base_dir: Option<&Path>,
) -> Source {
    match &object.shape.value {
        Shape::Box { size } => {
            let size = reader.size("size", size);
            made_by(move |fineness| shapes::cuboid(size, fineness))
        }
        Shape::Sphere { radius } => {
            let radius = reader.length("radius", radius);
            made_by(move |fineness| shapes::sphere(radius, fineness))
        }
        Shape::Cylinder { radius, height } => {
            let (radius, height) = (
                reader.length("radius", radius),
                reader.length("height", height),
            );
            made_by(move |fineness| shapes::cylinder(radius, height, fineness))
        }
        Shape::Torus { radius, tube } => {
            let radius = reader.length("radius", radius);
            let tube = reader.number("tube", tube, 1e-4, radius);
            made_by(move |fineness| shapes::torus(radius, tube, fineness))
        }
        Shape::Plane { size } => {
            let size = reader.lengths("size", size);
            made_by(move |fineness| shapes::rectangle(size, fineness))
        }
        Shape::Pool { size, depth, rise } => {
            let size = reader.lengths("size", size);
            let depth = reader.length("depth", depth);
            let rise = reader.number("rise", rise, 0.0, 1e5);
            made_by(move |fineness| shapes::basin(size, depth, rise, fineness))
        }
        Shape::Frame {
            inner,
            outer,
            height,
        } => {
            let inner = reader.lengths("inner", inner);
            let height = reader.length("height", height);
            let wider = |least: f64| least * (1.0 + 1e-6);
            let outer = glam::DVec2::new(
                reader.number("outer", &outer.0, wider(inner.x), 1e5),
                reader.number("outer", &outer.1, wider(inner.y), 1e5),
            );
            made_by(move |fineness| shapes::frame(inner, outer, height, fineness))
        }
        Shape::Bars {
            size,
            count,
            thickness,
        } => {
            let size = reader.lengths("size", size);
            let thickness = reader.number("thickness", thickness, 1e-4, size.min_element());
            let count = (
                copies(reader, object, count.0),
                copies(reader, object, count.1),
            );
            made_by(move |fineness| shapes::bars(size, count, thickness, fineness))
        }
        Shape::Reeds {
            count,
            area,
            height,
            radius,
            lean,
            seed,
        } => {
            let growth = Growth {
                count: copies(reader, object, *count),
                area: reader.lengths("area", area),
                height: reader.length("height", height),
                radius: reader.length("radius", radius),
                lean: reader.number("lean", lean, 0.0, 90.0).to_radians(),
                seed: *seed,
            };
            made_by(move |fineness| shapes::reeds(&growth, fineness))
        }
        Shape::Mesh { file, up, normals } => {
            Source::Given(mesh(reader, file, *up, *normals, base_dir))
        }
    }
}

fn made_by(make: impl Fn(Fineness) -> Vec<Patch> + 'static) -> Source {
    Source::Made(Box::new(move |edge, water| make(Fineness { edge, water })))
}

fn copies(reader: &mut Reader, object: &Spanned<ObjectFile>, count: u32) -> u32 {
    let number = Spanned {
        value: f64::from(count),
        place: object.shape.place.clone(),
    };
    reader.number("count", &number, 0.0, MOST_COPIES) as u32
}

fn mesh(
    reader: &mut Reader,
    file: &Spanned<String>,
    up: Up,
    normals: Normals,
    base_dir: Option<&Path>,
) -> Soup {
    let Some(base_dir) = base_dir else {
        let message = format!(
            "mesh file `{}` cannot be found: this scene is part of the program",
            file.value
        );
        reader.report.add(
            located(Diagnostic::error(message), &file.place)
                .with_help("put the scene file into a directory of your own, next to the mesh"),
        );
        return Soup::default();
    };
    let mut soup = match mesh_file::read(&base_dir.join(&file.value)) {
        Ok(soup) => soup,
        Err(diagnostic) => {
            let diagnostic = match &file.place {
                Some(place) => diagnostic.see(place, "asked for here"),
                None => diagnostic,
            };
            reader.report.add(diagnostic);
            return Soup::default();
        }
    };
    if up == Up::Y {
        let upright = |v: &mut DVec3| *v = DVec3::new(v.x, -v.z, v.y);
        soup.positions.iter_mut().for_each(upright);
        soup.normals.iter_mut().for_each(upright);
    }
    match normals {
        Normals::File => soup.smooth(),
        Normals::Smooth => {
            soup.normals.clear();
            soup.smooth();
        }
        Normals::Flat => soup.facet(),
    }
    soup
}
