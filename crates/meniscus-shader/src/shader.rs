//! What composition turns out: a validated shader and its interface.

use std::collections::BTreeMap;

/// The composed, validated shader of one pass.
///
/// `module` holds only what its entry points use, with group 0 and a binding number assigned to
/// every resource. Numbers (`override`s) are still open, so that variants that differ only in
/// numbers share a shader.
#[derive(Debug)]
pub struct Shader {
    /// The IR that runs.
    pub module: naga::Module,
    /// naga's analysis of it.
    pub info: naga::valid::ModuleInfo,
    /// Its entry points' names.
    pub entry: Entry,
    /// The resources it reads and writes, in the order of their binding numbers.
    pub bindings: Vec<Binding>,
    /// Names of the vertex attributes, in the order of their locations.
    pub attributes: Vec<Attribute>,
    /// Vertex attributes (`vertex.NAME`) and varyings (`fragment.NAME`) that the skeleton has and
    /// that nothing in this shader reads, so that they are left out.
    pub unread: Vec<String>,
    /// Names of the outputs, in the order of their locations (fragment) or as bound (compute).
    pub outputs: Vec<String>,
    /// The composed WGSL, with the modules' comments.
    pub text: String,
    /// blake3 of `text`, hexadecimal.
    pub hash: String,
    /// For every number of every filling, by its path (`intersect.step.taps`), the name of the
    /// `override` in the IR. Numbers that no entry point uses are absent.
    pub overrides: BTreeMap<String, String>,
    /// The numbers that may change while a plan runs: members of the read-only storage buffer
    /// [`LIVE_NUMBERS`](crate::LIVE_NUMBERS), in their order.
    pub live: Vec<LiveNumber>,
}

impl Shader {
    /// What a number of a path is called: the name of its `override`, or that of a live number.
    /// None where nothing uses it, and for constants, whose values are in the text.
    pub fn number(&self, path: &str) -> Option<&str> {
        let live = || self.live.iter().find(|number| number.path == path);
        let found = self.overrides.get(path).map(String::as_str);
        found.or_else(|| live().map(|number| number.name.as_str()))
    }

    /// Those of a pass's numbers that are `override`s: all but the live ones, by their names.
    pub fn constants<'n>(
        &'n self,
        numbers: &'n BTreeMap<String, f64>,
    ) -> impl Iterator<Item = (&'n str, f64)> {
        let is_live = |name: &str| self.live.iter().any(|number| number.name == name);
        let numbers = numbers.iter().map(|(name, value)| (name.as_str(), *value));
        numbers.filter(move |(name, _)| !is_live(name))
    }

    /// The content of the buffer of live numbers, little-endian; empty where there are none. Numbers
    /// have their defaults unless `value` knows them, by their [`LiveNumber::name`].
    pub fn live_bytes(&self, value: impl Fn(&str) -> Option<f64>) -> Vec<u8> {
        let length = self.live.iter().map(|number| number.offset as usize + 4);
        let mut bytes = vec![0; length.max().unwrap_or(0)];
        for number in &self.live {
            let at = number.offset as usize;
            let value = value(&number.name).unwrap_or(number.default);
            bytes[at..at + 4].copy_from_slice(&number.bytes(value));
        }
        bytes
    }
}

/// A number that changes while a plan runs.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveNumber {
    /// Its path: `intersect.bound_px`.
    pub path: String,
    /// What the composed text calls it: `live_numbers.intersect_bound_px`.
    pub name: String,
    /// Bytes before it in the buffer.
    pub offset: u32,
    /// Its type: `f32`, `i32` or `u32`.
    pub scalar: naga::Scalar,
    /// The value that its module gives it.
    pub default: f64,
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub most: f64,
}

impl LiveNumber {
    /// The name of its member in the buffer.
    pub fn member(&self) -> &str {
        self.name.rsplit('.').next().unwrap_or(&self.name)
    }

    /// Its value in the buffer, little-endian. What lies outside its range becomes the nearest value
    /// in it, what is no number the default, and a fraction is cut off where it is a whole number.
    pub fn bytes(&self, value: f64) -> [u8; 4] {
        let value = if value.is_nan() { self.default } else { value };
        let value = value.max(self.least).min(self.most);
        match self.scalar.kind {
            naga::ScalarKind::Sint => (value as i32).to_le_bytes(),
            naga::ScalarKind::Uint => (value as u32).to_le_bytes(),
            _ => (value as f32).to_le_bytes(),
        }
    }
}

/// The entry points of a shader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Entry {
    /// A vertex and a fragment stage.
    Render {
        /// Name of the vertex entry point.
        vertex: String,
        /// Name of the fragment entry point.
        fragment: String,
    },
    /// A compute stage.
    Compute {
        /// Its name.
        name: String,
        /// Threads a workgroup.
        workgroup: [u32; 3],
    },
}

/// A vertex attribute that the shader reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attribute {
    /// The host's name of it (`position`, `normal`, …).
    pub name: String,
    /// `@location` number.
    pub location: u32,
}

/// A resource of a shader, in group 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Binding {
    /// `@binding` number.
    pub index: u32,
    /// The variable's name in the composed shader.
    pub variable: String,
    /// The name of what it is connected to: a texture or buffer of the pipeline, or a resource of
    /// the host.
    pub resource: String,
    /// What it is.
    pub kind: BindingKind,
    /// Whether the vertex stage uses it.
    pub in_vertex: bool,
    /// Whether the fragment stage uses it.
    pub in_fragment: bool,
    /// Whether the compute stage uses it.
    pub in_compute: bool,
}

/// What kind of resource a binding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BindingKind {
    /// A uniform buffer; the type is in the shader's module.
    Uniform(naga::Handle<naga::Type>),
    /// A storage buffer.
    Storage {
        /// The type in the shader's module.
        ty: naga::Handle<naga::Type>,
        /// Whether the shader only reads it.
        read_only: bool,
    },
    /// A sampled texture.
    Texture {
        /// Number of dimensions.
        dimension: naga::ImageDimension,
        /// What a texel is.
        sample: Sample,
        /// Whether a sampler reads it, so that its format must be filterable.
        filtered: bool,
    },
    /// A texture that is written.
    StorageTexture {
        /// Texel format.
        format: naga::StorageFormat,
        /// Number of dimensions.
        dimension: naga::ImageDimension,
        /// Whether texels are also read.
        reads: bool,
    },
    /// A sampler: bilinear, clamped to the edge.
    Sampler,
}

/// What a texel of a sampled texture is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sample {
    /// Floating point, normalised included.
    Float,
    /// Depth.
    Depth,
    /// Signed integers.
    Sint,
    /// Unsigned integers.
    Uint,
}
