//! glTF 2.0 and its binary form. Positions, normals and indices of all triangles that the scene
//! places are read; materials, skins and morphs are not.

use std::borrow::Cow;
use std::collections::HashSet;
use std::path::Path;

use base64::Engine as _;
use glam::{DAffine3, DMat4, DVec3};
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use meniscus_source::Diagnostic;

use crate::mesh_file::{bytes, not_too_many};
use crate::soup::Soup;

struct Reader<'a> {
    name: &'a str,
    buffers: Vec<Cow<'a, [u8]>>,
    soup: Soup,
    /// Nodes that have been placed: each may stand in the tree once.
    placed: HashSet<usize>,
}

/// Reads a file's bytes; other files are searched in `folder`.
pub(crate) fn read(name: &str, data: &[u8], folder: Option<&Path>) -> Result<Soup, Diagnostic> {
    let malformed = |what: &dyn std::fmt::Display| {
        Diagnostic::error(format!("mesh `{name}` is not a sound glTF file: {what}"))
            .with_help("export it again, or run it through a glTF validator")
    };
    // The binary form's reader subtracts the header from the length it finds there.
    if data.starts_with(b"glTF") {
        let length = data
            .get(8..12)
            .and_then(|b| b.try_into().ok())
            .map_or(0, u32::from_le_bytes);
        if length < 20 || length as usize > data.len() {
            return Err(malformed(&format!(
                "it says that it has {length} bytes and has {}",
                data.len()
            )));
        }
    }
    let gltf::Gltf { document, blob } =
        gltf::Gltf::from_slice_without_validation(data).map_err(|error| malformed(&error))?;
    let json = document.into_json();
    // The validation below looks up positions before it has checked that they are there.
    let accessors = json.accessors.len();
    let named = json.meshes.iter().flat_map(|mesh| &mesh.primitives);
    if let Some(index) = named
        .flat_map(|primitive| primitive.attributes.values())
        .find(|index| index.value() >= accessors)
    {
        let what = format!(
            "a mesh names accessor {}, and there are {accessors}",
            index.value()
        );
        return Err(malformed(&what));
    }
    let document = gltf::Document::from_json(json).map_err(|error| match &error {
        gltf::Error::Validation(faults) => {
            let faults: Vec<String> = faults
                .iter()
                .take(4)
                .map(|(path, fault)| format!("{path}: {fault}"))
                .collect();
            malformed(&faults.join(", "))
        }
        other => malformed(other),
    })?;
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        buffers.push(match buffer.source() {
            gltf::buffer::Source::Bin => blob
                .as_deref()
                .map(|blob| Cow::Owned(blob.to_vec()))
                .ok_or_else(|| malformed(&"it has no binary part"))?,
            gltf::buffer::Source::Uri(uri) => Cow::Owned(fetch(name, uri, folder)?),
        });
    }
    let mut reader = Reader {
        name,
        buffers,
        soup: Soup::default(),
        placed: HashSet::new(),
    };
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next());
    match scene {
        Some(scene) => {
            for node in scene.nodes() {
                reader.node(&node, DMat4::IDENTITY, 0)?;
            }
        }
        None => {
            for mesh in document.meshes() {
                reader.mesh(&mesh, DMat4::IDENTITY)?;
            }
        }
    }
    Ok(reader.soup)
}

fn fetch(name: &str, uri: &str, folder: Option<&Path>) -> Result<Vec<u8>, Diagnostic> {
    let unreadable = |what: String| Diagnostic::error(format!("mesh `{name}`: {what}"));
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
        let encoded =
            encoded.ok_or_else(|| unreadable("an embedded buffer is not in base64".into()))?;
        return base64::engine::general_purpose::STANDARD
            .decode(encoded)
            .map_err(|error| unreadable(format!("an embedded buffer is not in base64: {error}")));
    }
    let path = percent_encoding::percent_decode_str(uri)
        .decode_utf8()
        .map_err(|error| unreadable(format!("the buffer's address is not UTF-8: {error}")))?;
    bytes(&folder.unwrap_or(Path::new("")).join(&*path)).map_err(|diagnostic| {
        unreadable(diagnostic.message).with_help("a glTF file's buffers are named relative to it")
    })
}

impl Reader<'_> {
    fn fault(&self, what: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::error(format!("mesh `{}`: {what}", self.name))
    }

    fn node(
        &mut self,
        node: &gltf::Node<'_>,
        parent: DMat4,
        depth: usize,
    ) -> Result<(), Diagnostic> {
        if depth > 128 || !self.placed.insert(node.index()) {
            return Err(self.fault(format!(
                "node {} stands in the tree twice, or too deep",
                node.index()
            )));
        }
        let own = node
            .transform()
            .matrix()
            .map(|column| column.map(f64::from));
        let place = parent * DMat4::from_cols_array_2d(&own);
        if let Some(mesh) = node.mesh() {
            self.mesh(&mesh, place)?;
        }
        for child in node.children() {
            self.node(&child, place, depth + 1)?;
        }
        Ok(())
    }

    fn mesh(&mut self, mesh: &gltf::Mesh<'_>, place: DMat4) -> Result<(), Diagnostic> {
        let place = DAffine3::from_mat4(place);
        let mirrored = place.matrix3.determinant() < 0.0;
        let normals_place = place.matrix3.inverse().transpose();
        for primitive in mesh.primitives() {
            let what = format!("mesh {} primitive {}", mesh.index(), primitive.index());
            let Some(positions) = primitive.get(&gltf::Semantic::Positions) else {
                return Err(self.fault(format!("{what} has no positions")));
            };
            let positions = self.vectors(&positions, &what)?;
            let normals = match primitive.get(&gltf::Semantic::Normals) {
                Some(normals) => self.vectors(&normals, &what)?,
                None => vec![DVec3::ZERO; positions.len()],
            };
            if normals.len() != positions.len() {
                return Err(self.fault(format!(
                    "{what} has {} normals for {} positions",
                    normals.len(),
                    positions.len()
                )));
            }
            let indices = match primitive.indices() {
                Some(indices) => self.indices(&indices, &what)?,
                None => (0..positions.len() as u32).collect(),
            };
            if let Some(index) = indices
                .iter()
                .find(|&&index| index as usize >= positions.len())
            {
                return Err(self.fault(format!(
                    "{what}: index {index} is out of range; there are {} positions",
                    positions.len()
                )));
            }
            let first = self.soup.positions.len() as u32;
            for mut triangle in triangles(primitive.mode(), &indices) {
                if mirrored {
                    triangle.swap(1, 2);
                }
                self.soup
                    .triangles
                    .push(triangle.map(|index| first + index));
            }
            self.soup
                .positions
                .extend(positions.into_iter().map(|p| place.transform_point3(p)));
            self.soup.normals.extend(
                normals
                    .into_iter()
                    .map(|n| (normals_place * n).normalize_or_zero()),
            );
            if self.soup.positions.iter().any(|p| !p.is_finite()) {
                return Err(self.fault(format!("{what} is placed at no finite point")));
            }
            not_too_many(self.name, self.soup.triangles.len())?;
        }
        Ok(())
    }

    fn vectors(&self, accessor: &gltf::Accessor<'_>, what: &str) -> Result<Vec<DVec3>, Diagnostic> {
        if (accessor.dimensions(), accessor.data_type()) != (Dimensions::Vec3, DataType::F32) {
            return Err(self.fault(format!(
                "{what}: positions and normals are three 32-bit floats each"
            )));
        }
        let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let vectors: Vec<DVec3> = self
            .elements(accessor, 12, what)?
            .map(|b| DVec3::new(number(b), number(&b[4..]), number(&b[8..])))
            .collect();
        match vectors.iter().position(|v| !v.is_finite()) {
            Some(index) => Err(self.fault(format!(
                "{what}: vertex {index} has a number that is not finite"
            ))),
            None => Ok(vectors),
        }
    }

    fn indices(&self, accessor: &gltf::Accessor<'_>, what: &str) -> Result<Vec<u32>, Diagnostic> {
        let size = match (accessor.dimensions(), accessor.data_type()) {
            (Dimensions::Scalar, DataType::U8) => 1,
            (Dimensions::Scalar, DataType::U16) => 2,
            (Dimensions::Scalar, DataType::U32) => 4,
            _ => return Err(self.fault(format!("{what}: indices are unsigned whole numbers"))),
        };
        let elements = self.elements(accessor, size, what)?;
        Ok(elements
            .map(|b| {
                b.iter()
                    .rev()
                    .fold(0, |index, &byte| (index << 8) | u32::from(byte))
            })
            .collect())
    }

    /// The bytes of each element. (The format library's own reader trusts counts and strides.)
    fn elements(
        &self,
        accessor: &gltf::Accessor<'_>,
        size: usize,
        what: &str,
    ) -> Result<impl Iterator<Item = &[u8]>, Diagnostic> {
        if accessor.sparse().is_some() {
            return Err(self.fault(format!("{what}: sparse accessors are not read")));
        }
        let (count, offset) = (accessor.count(), accessor.offset());
        let view = accessor
            .view()
            .ok_or_else(|| self.fault(format!("{what}: an accessor has no data")))?;
        let stride = view.stride().unwrap_or(size);
        let beyond = || {
            self.fault(format!(
                "{what}: accessor {} reaches beyond its buffer",
                accessor.index()
            ))
        };
        let buffer = self.buffers.get(view.buffer().index()).ok_or_else(beyond)?;
        let end = view
            .offset()
            .checked_add(view.length())
            .ok_or_else(beyond)?;
        let data = buffer.get(view.offset()..end).ok_or_else(beyond)?;
        let data = data.get(offset..).ok_or_else(beyond)?;
        let needed = match count {
            0 => Some(0),
            _ => stride
                .checked_mul(count - 1)
                .and_then(|start| start.checked_add(size)),
        };
        if stride < size || needed.is_none_or(|needed| needed > data.len()) {
            return Err(beyond());
        }
        Ok((0..count).map(move |index| &data[index * stride..index * stride + size]))
    }
}

/// Triangles of a list, a strip or a fan; none of points and lines.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => indices
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect(),
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(i, t)| {
                if i % 2 == 0 {
                    [t[0], t[1], t[2]]
                } else {
                    [t[1], t[0], t[2]]
                }
            })
            .collect(),
        Mode::TriangleFan => {
            let around = indices.get(1..).unwrap_or_default();
            around
                .windows(2)
                .map(|t| [indices[0], t[0], t[1]])
                .collect()
        }
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    }
}
