//! A function of a module as a compute shader, for whoever has a GPU: words in, words out.

use std::collections::BTreeMap;
use std::fmt::Write;

use meniscus_source::{Diagnostic, Report};
use naga::{AddressSpace, ImageClass, ScalarKind, TypeInner};

use super::{Host, Specimen};
use crate::{Column, Function, Kind, Lanes, Shape};

/// Threads of a workgroup.
const GROUP: u32 = 64;
/// Names that no module has.
const INPUTS: &str = "meniscus_inputs";
const OUTPUTS: &str = "meniscus_outputs";

/// A compute shader that calls a function once in each thread.
///
/// Storage buffers of words stand at group 0: binding 0 holds the arguments of all calls, binding 1
/// gets their results, each call's numbers side by side in the order of
/// [`Shape::leaves`](crate::Shape::leaves); truth values are 0 and 1. What the module reads follows.
#[derive(Debug)]
pub struct Kernel {
    /// The shader.
    pub module: naga::Module,
    /// Words of a call's arguments.
    pub input_words: usize,
    /// Words of a call's result.
    pub output_words: usize,
    /// Values of its `override`s by their names.
    pub constants: BTreeMap<String, f64>,
    /// What the module reads, and at which binding of group 0.
    pub reads: Vec<(u32, Read)>,
    arguments: Vec<Kind>,
    results: Vec<Kind>,
}

/// Something that a module reads, as bytes that a GPU takes.
#[derive(Debug, Clone, PartialEq)]
pub enum Read {
    /// A uniform block.
    Uniform(Vec<u32>),
    /// A storage buffer that is only read.
    Storage(Vec<u32>),
    /// A texture of one layer and level: four words a texel, row by row.
    Texture {
        /// Width and height.
        size: [u32; 2],
        /// What its texels are.
        texels: Texels,
        /// Four words for each, of depths the first counts.
        words: Vec<[u32; 4]>,
        /// Whether a sampler mixes its texels.
        filtered: bool,
    },
    /// A sampler that mixes texels and keeps to the edge.
    Sampler,
}

/// Kinds of texels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Texels {
    /// `f32`
    Float,
    /// `i32`
    Sint,
    /// `u32`
    Uint,
    /// A depth that is not compared.
    Depth,
}

impl Kernel {
    /// The name of the entry point.
    pub const ENTRY: &str = "meniscus_call";

    /// The shader for a function, which reads what the host says.
    ///
    /// # Errors
    /// Where the function takes nothing and returns nothing, or something that cannot be handed
    /// over; where the host does not know what it reads; where it writes to what it is given.
    pub fn new(specimen: &Specimen, function: &Function, host: &Host) -> Result<Self, Report> {
        let leaves = |shape: &Shape| shape.leaves().into_iter().map(|(_, kind)| kind);
        let arguments: Vec<Kind> = function.arguments().flat_map(|(_, s)| leaves(s)).collect();
        let Some(result) = function.result() else {
            return Err(unfit(function, "it returns nothing"));
        };
        let results: Vec<Kind> = leaves(result).collect();
        let module = specimen.alone.with_entries(&entry(function, result))?;
        let connected = specimen.connect(function, host)?;
        let mut reads = Vec::new();
        for (_, variable) in module.global_variables.iter() {
            let (Some(binding), Some(name)) = (&variable.binding, &variable.name) else {
                continue;
            };
            if [INPUTS, OUTPUTS].contains(&name.as_str()) {
                continue;
            }
            let words = || {
                let found = connected.buffers.iter().find(|(n, _)| n == name);
                found.map(|(_, buffer)| buffer.words()).unwrap_or_default()
            };
            let read = match (variable.space, &module.types[variable.ty].inner) {
                (AddressSpace::Uniform, _) => Read::Uniform(words()),
                (AddressSpace::Storage { access }, _)
                    if !access.contains(naga::StorageAccess::STORE) =>
                {
                    Read::Storage(words())
                }
                (
                    _,
                    TypeInner::Image {
                        dim,
                        class,
                        arrayed,
                    },
                ) => {
                    let texels = match class {
                        _ if *dim != naga::ImageDimension::D2 || *arrayed => None,
                        ImageClass::Sampled { kind, multi: false } => match kind {
                            ScalarKind::Sint => Some(Texels::Sint),
                            ScalarKind::Uint => Some(Texels::Uint),
                            _ => Some(Texels::Float),
                        },
                        ImageClass::Depth { multi: false } => Some(Texels::Depth),
                        _ => None,
                    };
                    let texture = connected.textures.iter().find(|(n, _)| n == name);
                    let (Some(texels), Some((_, texture))) = (texels, texture) else {
                        return Err(unfit(function, "it reads a texture of an unusual kind"));
                    };
                    let [width, height, _] = texture.size(0);
                    Read::Texture {
                        size: [width, height],
                        texels,
                        words: texture.words(),
                        filtered: false,
                    }
                }
                (_, TypeInner::Sampler { comparison: false }) => Read::Sampler,
                _ => return Err(unfit(function, "it writes to what it is given")),
            };
            reads.push((binding.binding, read));
        }
        let samples = reads.iter().any(|(_, read)| *read == Read::Sampler);
        for (_, read) in &mut reads {
            if let Read::Texture {
                texels: Texels::Float,
                filtered,
                ..
            } = read
            {
                *filtered = samples;
            }
        }
        let known = |name: &String| {
            let mut overrides = module.overrides.iter();
            overrides.any(|(_, o)| o.name.as_ref() == Some(name))
        };
        let numbers = specimen.numbers.iter();
        let constants = numbers
            .filter(|(name, _)| known(name))
            .map(|(name, value)| (name.clone(), *value))
            .collect();
        Ok(Self {
            constants,
            module,
            input_words: arguments.len().max(1),
            output_words: results.len().max(1),
            reads,
            arguments,
            results,
        })
    }

    /// Arguments as the shader reads them.
    pub fn pack(&self, arguments: &[Lanes<f32>], lanes: usize) -> Vec<u32> {
        let columns: Vec<&Column<f32>> = arguments.iter().flat_map(|a| &a.columns).collect();
        let mut words = Vec::with_capacity(self.input_words * lanes);
        for lane in 0..lanes {
            words.extend(columns.iter().map(|column| word(column, lane)));
            words.resize((lane + 1) * self.input_words, 0);
        }
        words
    }

    /// Results as the shader wrote them; what is missing is 0.
    pub fn unpack(&self, words: &[u32], lanes: usize) -> Lanes<f32> {
        let column = |(index, kind): (usize, &Kind)| {
            let word = |lane| words.get(lane * self.output_words + index);
            let words = (0..lanes).map(|lane| word(lane).copied().unwrap_or(0));
            match kind {
                Kind::Float => Column::Float(words.map(f32::from_bits).collect()),
                Kind::Sint => Column::Sint(words.map(|w| w as i32).collect()),
                Kind::Uint => Column::Uint(words.collect()),
                Kind::Bool => Column::Bool(words.map(|w| w != 0).collect()),
            }
        };
        Lanes {
            columns: self.results.iter().enumerate().map(column).collect(),
        }
    }

    /// How many numbers its arguments have.
    pub fn numbers(&self) -> usize {
        self.arguments.len()
    }
}

fn word(column: &Column<f32>, lane: usize) -> u32 {
    match column {
        Column::Float(c) => c.get(lane).map(|x| x.to_bits()),
        Column::Sint(c) => c.get(lane).map(|&n| n as u32),
        Column::Uint(c) => c.get(lane).copied(),
        Column::Bool(c) => c.get(lane).map(|&b| u32::from(b)),
    }
    .unwrap_or(0)
}

fn unfit(function: &Function, why: &str) -> Report {
    let message = format!("`{}` cannot be called on a GPU by itself", function.name());
    Diagnostic::error(message).with_help(why).into()
}

/// The entry point in WGSL.
fn entry(function: &Function, result: &Shape) -> String {
    let mut next = 0;
    let arguments: Vec<String> = function
        .arguments()
        .map(|(_, shape)| read(shape, &mut next))
        .collect();
    let (inputs, outputs) = (next.max(1), result.leaf_count().max(1));
    let mut text = format!(
        "@group(0) @binding(0) var<storage, read> {INPUTS}: array<u32>;\n\
         @group(0) @binding(1) var<storage, read_write> {OUTPUTS}: array<u32>;\n\
         @compute @workgroup_size({GROUP})\n\
         fn {}(@builtin(global_invocation_id) thread: vec3u) {{\n\
         \x20   if thread.x >= arrayLength(&{OUTPUTS}) / {outputs}u {{\n        return;\n    }}\n\
         \x20   let given = thread.x * {inputs}u;\n\
         \x20   let first = thread.x * {outputs}u;\n\
         \x20   let found = {}({});\n",
        Kernel::ENTRY,
        function.name(),
        arguments.join(", ")
    );
    for (index, (path, kind)) in result.leaves().iter().enumerate() {
        let value = match kind {
            Kind::Bool => format!("select(0u, 1u, found{path})"),
            _ => format!("bitcast<u32>(found{path})"),
        };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "    {OUTPUTS}[first + {index}u] = {value};");
    }
    text + "}\n"
}

/// A value of a shape, made from the next words.
fn read(shape: &Shape, next: &mut usize) -> String {
    let number = |kind: &Kind, next: &mut usize| {
        let word = format!("{INPUTS}[given + {next}u]");
        *next += 1;
        match kind {
            Kind::Bool => format!("({word} != 0u)"),
            kind => format!("bitcast<{}>({word})", kind.name()),
        }
    };
    let parts: Vec<String> = match shape {
        Shape::Scalar(kind) => return number(kind, next),
        Shape::Vector { size, kind } => (0..*size).map(|_| number(kind, next)).collect(),
        Shape::Matrix { .. } => (0..shape.leaf_count())
            .map(|_| number(&Kind::Float, next))
            .collect(),
        Shape::Array { of, length } => (0..*length).map(|_| read(of, next)).collect(),
        Shape::Struct { members, .. } => members.iter().map(|(_, m)| read(m, next)).collect(),
    };
    format!("{shape}({})", parts.join(", "))
}

/// Something that calls functions in `f32` of its own: a GPU.
pub trait Device: Sync {
    /// What it is called in tables.
    fn name(&self) -> String;

    /// Makes a function ready.
    ///
    /// # Errors
    /// Where the device cannot run it.
    fn launcher(&self, kernel: &Kernel) -> Result<Box<Launcher<'_>>, Report>;
}

/// Runs a kernel: words in, number of calls; words out, or what went wrong.
pub type Launcher<'a> = dyn Fn(&[u32], usize) -> Result<Vec<u32>, String> + Sync + 'a;
