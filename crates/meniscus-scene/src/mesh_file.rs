//! Meshes from files.

use std::path::Path;

use glam::DVec3;
use meniscus_source::{Diagnostic, Place, SourceFile};

use crate::gltf_file;
use crate::polygon::{MOST_CORNERS, triangulate};
use crate::soup::{MOST_TRIANGLES, Soup};

/// Larger files are refused, bytes.
const MOST_BYTES: u64 = 1 << 31;

/// Reads a mesh; the extension says what it is.
pub(crate) fn read(path: &Path) -> Result<Soup, Diagnostic> {
    let name = path.display().to_string();
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    let soup = match extension.as_deref() {
        Some("obj") => obj(&name, &bytes(path)?)?,
        Some("gltf" | "glb") => gltf_file::read(&name, &bytes(path)?, path.parent())?,
        _ => {
            return Err(
                Diagnostic::error(format!("`{name}` is no mesh file that can be read"))
                    .with_help("meshes are read from .obj, .gltf and .glb files"),
            );
        }
    };
    // A fourth coordinate near 0 or a placement may have made what was finite infinite.
    if let Some(index) = soup
        .positions
        .iter()
        .chain(&soup.normals)
        .position(|v| !v.is_finite())
    {
        return Err(Diagnostic::error(format!(
            "mesh `{name}`: number {index} of its positions and normals is not finite"
        )));
    }
    if soup.triangles.is_empty() {
        return Err(Diagnostic::error(format!("`{name}` has no faces"))
            .with_help("points and lines are not drawn; export triangles or polygons"));
    }
    Ok(soup)
}

/// A file's bytes, if there are not too many.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>, Diagnostic> {
    let name = path.display().to_string();
    let cannot = |error: std::io::Error| {
        Diagnostic::error(format!("cannot read mesh `{name}`: {error}"))
            .with_help("mesh files are named relative to the scene file")
    };
    let size = std::fs::metadata(path).map_err(cannot)?.len();
    if size > MOST_BYTES {
        return Err(Diagnostic::error(format!(
            "mesh `{name}` has {size} bytes; at most {MOST_BYTES} are read"
        )));
    }
    std::fs::read(path).map_err(cannot)
}

/// Checks that many triangles can be drawn.
pub(crate) fn not_too_many(name: &str, triangles: usize) -> Result<(), Diagnostic> {
    if triangles as u64 > MOST_TRIANGLES {
        return Err(Diagnostic::error(format!(
            "mesh `{name}` has {triangles} triangles; at most {MOST_TRIANGLES} are read"
        )));
    }
    Ok(())
}

fn obj(name: &str, bytes: &[u8]) -> Result<Soup, Diagnostic> {
    let text = std::str::from_utf8(bytes)
        .map_err(|error| Diagnostic::error(format!("mesh `{name}` is not UTF-8: {error}")))?;
    check_obj(name, text)?;
    // Materials and pictures belong to the scene file.
    let no_materials = |_: &Path| Ok((Vec::new(), Default::default()));
    let options = tobj::LoadOptions {
        triangulate: false,
        single_index: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let (models, _) = tobj::load_obj_buf(&mut &bytes[..], &options, no_materials)
        .map_err(|error| Diagnostic::error(format!("cannot read mesh `{name}`: {error}")))?;
    let mut soup = Soup::default();
    for tobj::Model { mesh, .. } in models {
        let first = soup.positions.len() as u32;
        let mut arities = mesh.face_arities.iter();
        let vectors = |numbers: &[f32]| -> Vec<DVec3> {
            numbers
                .chunks_exact(3)
                .map(|v| DVec3::new(v[0].into(), v[1].into(), v[2].into()))
                .collect()
        };
        let positions = vectors(&mesh.positions);
        let mut normals = vectors(&mesh.normals);
        if normals.len() != positions.len() {
            // Some faces have them, some don't, and nothing says which: compute all.
            normals.clear();
        }
        normals.resize(positions.len(), DVec3::ZERO);
        soup.positions.extend(positions);
        soup.normals.extend(normals);
        let mut rest = &mesh.indices[..];
        while !rest.is_empty() {
            // No arities: triangles throughout.
            let arity = arities
                .next()
                .map_or(3, |&arity| arity as usize)
                .min(rest.len());
            let (face, others) = rest.split_at(arity);
            rest = others;
            let corners: Vec<DVec3> = face
                .iter()
                .map(|&c| soup.positions[(first + c) as usize])
                .collect();
            let Some(triangles) = triangulate(&corners) else {
                return Err(Diagnostic::error(format!(
                    "mesh `{name}` has a face with {arity} corners that is not convex; at most {MOST_CORNERS} are cut into triangles"
                ))
                .with_help("triangulate it in the modelling program"));
            };
            soup.triangles
                .extend(triangles.into_iter().map(|t| t.map(|k| first + face[k])));
        }
        not_too_many(name, soup.triangles.len())?;
    }
    Ok(soup)
}

/// Finds what is wrong with an OBJ file and in which line, which its reader does not say.
fn check_obj(name: &str, text: &str) -> Result<(), Diagnostic> {
    let at = |word: &str| {
        // Only now is the text worth copying.
        let start = word.as_ptr() as usize - text.as_ptr() as usize;
        Place::new(&SourceFile::new(name, text), start..start + word.len())
    };
    // Faces may name vertices that come later, so these are counted first.
    let mut totals = [0_i64; 3];
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let Some(kind) = kind_of(words.next()) else {
            continue;
        };
        totals[kind] += 1;
        let wanted = if kind == 1 { 2 } else { 3 };
        let mut count = 0;
        for word in words {
            // f32, because what overflows it is not finite for the mesh either.
            match word.parse::<f32>() {
                Ok(number) if number.is_finite() => count += 1,
                Ok(_) => {
                    return Err(Diagnostic::error(format!(
                        "mesh `{name}` has a number that is not finite: {word}"
                    ))
                    .at(&at(word), "NaN and infinity are no places"));
                }
                Err(_) => {
                    return Err(Diagnostic::error("a number is expected here").at(&at(word), ""));
                }
            }
        }
        if count < wanted {
            return Err(Diagnostic::error(format!(
                "{wanted} numbers are expected here, not {count}"
            ))
            .at(&at(line), ""));
        }
    }
    let mut so_far = [0_i64; 3];
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let first = words.next();
        if let Some(kind) = kind_of(first) {
            so_far[kind] += 1;
        }
        if first != Some("f") {
            continue;
        }
        let mut corners = 0;
        for word in words {
            corners += 1;
            for (kind, index) in word.split('/').enumerate() {
                if kind > 2 {
                    return Err(
                        Diagnostic::error("a corner is written v, v/vt, v//vn or v/vt/vn")
                            .at(&at(word), ""),
                    );
                }
                if index.is_empty() && kind > 0 {
                    continue;
                }
                let what = ["vertices", "texture coordinates", "normals"][kind];
                let Ok(index) = index.parse::<i64>() else {
                    return Err(Diagnostic::error("an index is expected here")
                        .at(&at(word), "a whole number"));
                };
                let known = if index < 0 {
                    so_far[kind]
                } else {
                    totals[kind]
                };
                if index == 0 || index.unsigned_abs() > known.unsigned_abs() {
                    return Err(Diagnostic::error(format!(
                        "mesh `{name}`: index {index} is out of range"
                    ))
                    .at(&at(word), format!("there are {known} {what}"))
                    .with_help(
                        "indices count from 1; negative ones count back from the last one above",
                    ));
                }
            }
        }
        if corners < 3 {
            return Err(Diagnostic::error("a face has at least three corners").at(&at(line), ""));
        }
    }
    Ok(())
}

/// Which of positions, texture coordinates and normals a line holds.
fn kind_of(word: Option<&str>) -> Option<usize> {
    ["v", "vt", "vn"]
        .iter()
        .position(|kind| Some(*kind) == word)
}
