//! What a host gives to shaders: uniform blocks and arrays by the names of their members, laid out
//! as naga says; textures; a sampler.

use std::collections::BTreeMap;

use meniscus_source::{Diagnostic, Report};
use naga::{ImageClass, Module, Scalar, ScalarKind, TypeInner};

use crate::{Buffer, Kind, Picture, Resources, Sampler, Texture};

/// The largest number of elements of an array that is set by hand.
const MOST_ELEMENTS: usize = 65_536;

/// Values of uniform blocks and arrays, by paths such as `water.level` and `waves[2].amplitude`,
/// and textures by the names of their variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Host {
    values: BTreeMap<String, Vec<f64>>,
    textures: BTreeMap<String, ([u32; 3], Vec<[u32; 4]>)>,
}

impl Default for Host {
    /// Water of index 1.333 at height 0 seen from the air, with three waves; a camera 1.7 m above
    /// it that looks down by 37°, 640 × 360 with a guard band; a sun; one grey material.
    fn default() -> Self {
        let mut host = Self {
            values: BTreeMap::new(),
            textures: BTreeMap::new(),
        };
        let fixed: &[(&str, &[f64])] = &[
            ("water.level", &[0.0]),
            ("water.height_bound", &[0.06]),
            ("water.slope_bound", &[0.2]),
            ("water.curvature_bound", &[1.2]),
            ("waves[0].wave_vector", &[3.0, 1.0]),
            ("waves[0].amplitude", &[0.02]),
            ("waves[0].phase", &[0.3]),
            ("waves[1].wave_vector", &[-1.0, 4.0]),
            ("waves[1].amplitude", &[0.015]),
            ("waves[1].phase", &[1.7]),
            ("waves[2].wave_vector", &[5.0, -2.0]),
            ("waves[2].amplitude", &[0.008]),
            ("waves[2].phase", &[4.1]),
            ("view_target.eye", &[0.3, -4.0, 1.7]),
            ("view_target.right", &[1.0, 0.0, 0.0]),
            ("view_target.up", &[0.0, 0.6, 0.8]),
            ("view_target.forward", &[0.0, 0.8, -0.6]),
            ("view_target.focal", &[500.0]),
            ("view_target.size", &[640.0, 360.0]),
            ("view_target.near", &[0.05]),
            ("view_target.seen_size", &[672.0, 392.0]),
            ("light.sun_direction", &[0.36, 0.48, 0.8]),
            ("light.sun_colour", &[0.8, 0.75, 0.6]),
            ("light.ambient", &[0.2, 0.25, 0.3]),
            ("light.horizon", &[0.7, 0.8, 0.9]),
            ("light.zenith", &[0.2, 0.4, 0.8]),
            ("light.deep", &[0.0, 0.02, 0.05]),
            ("objects[0].material", &[0.0]),
            ("objects[1].material", &[0.0]),
            ("materials[0].colour", &[0.5, 0.5, 0.5]),
            ("materials[0].line_colour", &[0.1, 0.1, 0.1]),
            ("materials[0].tile_size", &[0.3]),
            ("materials[0].line_width", &[0.02]),
        ];
        for (path, value) in fixed {
            host.values.insert((*path).to_owned(), value.to_vec());
        }
        host.water(1.333, true);
        host
    }
}

impl Host {
    /// The water's refractive index (relative to the air), and whether the eye is above it. What
    /// follows from these follows: `relative_index`, `camera_side`, `larger_index`, `root_high`,
    /// `root_low`.
    pub fn water(&mut self, index: f64, eye_above: bool) {
        let relative = if eye_above { index } else { 1.0 / index };
        // What shaders see of it is a float; what follows from it is of that very float.
        let larger = f64::from(index.max(1.0 / index) as f32);
        let root = ((larger - 1.0) * (larger + 1.0)).sqrt();
        let high = f64::from(root as f32);
        for (member, value) in [
            ("refractive_index", index),
            ("relative_index", relative),
            ("camera_side", if eye_above { 1.0 } else { -1.0 }),
            ("larger_index", larger),
            ("root_high", high),
            ("root_low", root - high),
        ] {
            self.values.insert(format!("water.{member}"), vec![value]);
        }
    }

    /// Sets a value by its path. The index and side of the water change what follows from them.
    ///
    /// # Errors
    /// Where a value is not finite, or the index is not positive.
    pub fn set(&mut self, path: &str, value: &[f64]) -> Result<(), Report> {
        if value.is_empty() || value.iter().any(|v| !v.is_finite()) {
            let wrong = Diagnostic::error(format!("`{path}` wants finite numbers"));
            return Err(wrong
                .with_help("separate components by commas: view_target.eye=0,-4,1.7")
                .into());
        }
        match path {
            "water.refractive_index" if value[0] <= 0.0 => {
                Err(Diagnostic::error("a refractive index is more than 0").into())
            }
            "water.refractive_index" => {
                let above = self.number("water.camera_side") != Some(-1.0);
                self.water(value[0], above);
                Ok(())
            }
            "water.camera_side" => {
                let index = self.number("water.refractive_index").unwrap_or(1.333);
                self.water(index, value[0] > 0.0);
                Ok(())
            }
            _ => {
                self.values.insert(path.to_owned(), value.to_vec());
                Ok(())
            }
        }
    }

    /// Replaces all elements of an array.
    pub fn clear(&mut self, array: &str) {
        let prefix = format!("{array}[");
        self.values.retain(|path, _| !path.starts_with(&prefix));
    }

    /// A value that is one number.
    pub fn number(&self, path: &str) -> Option<f64> {
        match self.values.get(path).map(Vec::as_slice) {
            Some([number]) => Some(*number),
            _ => None,
        }
    }

    /// All numbers of a value.
    pub fn numbers(&self, path: &str) -> Option<&[f64]> {
        self.values.get(path).map(Vec::as_slice)
    }

    /// What a camera of this name sees between two depths; none where it is not known.
    pub fn picture(&self, view: &str, depths: [f64; 2]) -> Option<Picture> {
        let values = |member: &str| self.values.get(&format!("{view}.{member}"));
        let vector = |member: &str| values(member)?.as_slice().try_into().ok();
        let size: [f64; 2] = values("size")?.as_slice().try_into().ok()?;
        let focal = self.number(&format!("{view}.focal"))?;
        Some(Picture {
            eye: vector("eye")?,
            axes: [vector("right")?, vector("up")?, vector("forward")?],
            half: size.map(|pixels| 0.5 * pixels / focal),
            depths,
        })
    }

    /// All paths that are set.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.values.keys().map(String::as_str)
    }

    /// Sets a texture of floating-point texels (depth included), row by row.
    pub fn texture(&mut self, variable: &str, size: [u32; 2], texels: &[[f32; 4]]) {
        let words = texels.iter().map(|t| t.map(f32::to_bits)).collect();
        self.textures
            .insert(variable.to_owned(), ([size[0], size[1], 1], words));
    }

    /// Sets a texture of unsigned integers, row by row.
    pub fn texture_of_words(&mut self, variable: &str, size: [u32; 2], texels: &[[u32; 4]]) {
        self.textures.insert(
            variable.to_owned(),
            ([size[0], size[1], 1], texels.to_vec()),
        );
    }

    /// Makes what the variables of these names are connected to.
    ///
    /// # Errors
    /// Where a block has a member that nothing is known of.
    pub(crate) fn connect<'n>(
        &self,
        module: &Module,
        names: impl Iterator<Item = &'n str>,
    ) -> Result<Connected, Report> {
        self.connect_moved(module, names, &mut |number| number)
    }

    /// The same with every `f32` changed: of blocks, arrays and textures.
    pub(crate) fn connect_moved<'n>(
        &self,
        module: &Module,
        names: impl Iterator<Item = &'n str>,
        change: &mut dyn FnMut(f32) -> f32,
    ) -> Result<Connected, Report> {
        let mut connected = Connected::default();
        for name in names {
            let variable = module.global_variables.iter().map(|(_, v)| v);
            let Some(variable) = variable
                .into_iter()
                .find(|v| v.name.as_deref() == Some(name))
            else {
                continue;
            };
            match &module.types[variable.ty].inner {
                TypeInner::Image { class, .. } => {
                    let texture = self.made_texture(name, class, change);
                    connected.textures.push((name.to_owned(), texture));
                }
                TypeInner::Sampler { .. } => connected.samplers.push(name.to_owned()),
                _ => {
                    let mut words = Vec::new();
                    let mut block = Block {
                        host: self,
                        module,
                        words: &mut words,
                        change: &mut *change,
                    };
                    block.write(variable.ty, 0, name)?;
                    connected
                        .buffers
                        .push((name.to_owned(), Buffer::from_words(&words)));
                }
            }
        }
        Ok(connected)
    }

    /// Width and height of the textures that passes read, texels.
    fn seen_size(&self) -> [u32; 2] {
        let size = self.values.get("view_target.seen_size").map(Vec::as_slice);
        match size {
            Some(&[width, height]) => [width, height].map(|x| x.clamp(1.0, 4096.0) as u32),
            _ => [16, 16],
        }
    }

    /// A texture that was set, or one in which everything is defined.
    fn made_texture(
        &self,
        name: &str,
        class: &ImageClass,
        change: &mut dyn FnMut(f32) -> f32,
    ) -> Texture {
        let kind = match class {
            ImageClass::Sampled {
                kind: ScalarKind::Uint,
                ..
            } => Kind::Uint,
            ImageClass::Sampled {
                kind: ScalarKind::Sint,
                ..
            } => Kind::Sint,
            _ => Kind::Float,
        };
        if let Some((size, words)) = self.textures.get(name) {
            return Texture::from_words(kind, *size, &changed(kind, words, change));
        }
        // As large as what a pass reads; the same small pattern over and over.
        const PERIOD: u32 = 16;
        let [width, height] = self.seen_size();
        let texel = |i: u32| {
            let part = |at: u32| (at % PERIOD) as f32 / PERIOD as f32;
            let (x, y) = (part(i % width), part(i / width));
            match class {
                // Between 0.25 m and half a metre beyond a near plane of 5 cm.
                ImageClass::Depth { .. } => [0.1 + 0.1 * x * y, 0.0, 0.0, 1.0].map(f32::to_bits),
                ImageClass::Sampled {
                    kind: ScalarKind::Float,
                    ..
                } => [x - 0.5, y - 0.5, -1.0 - 0.25 * x, 1.0].map(f32::to_bits),
                // A distance, directions, an id.
                _ => [(1.0 + x).to_bits(), 0x1000_0800, 0x0800_1000, 1],
            }
        };
        let texels: Vec<[u32; 4]> = (0..width * height).map(texel).collect();
        Texture::from_words(kind, [width, height, 1], &changed(kind, &texels, change))
    }

    /// One more than the largest index that is set of an array.
    fn elements(&self, array: &str) -> usize {
        let prefix = format!("{array}[");
        let index = |path: &String| {
            let rest = path.strip_prefix(&prefix)?;
            rest.split_once(']')?.0.parse::<usize>().ok()
        };
        self.values
            .keys()
            .filter_map(index)
            .max()
            .map_or(0, |most| most.saturating_add(1))
    }
}

/// A uniform block or array while it is written.
struct Block<'a> {
    host: &'a Host,
    module: &'a Module,
    words: &'a mut Vec<u32>,
    change: &'a mut dyn FnMut(f32) -> f32,
}

impl Block<'_> {
    /// Writes a value of a type at an offset, in bytes.
    fn write(
        &mut self,
        ty: naga::Handle<naga::Type>,
        offset: usize,
        path: &str,
    ) -> Result<(), Report> {
        let module = self.module;
        match &module.types[ty].inner {
            TypeInner::Struct { members, span } => {
                grow(self.words, offset + *span as usize);
                for member in members {
                    let name = member.name.as_deref().unwrap_or_default();
                    let at = offset + member.offset as usize;
                    let path = match module.types[member.ty].inner {
                        // The same values as those of a buffer of that name.
                        TypeInner::Array { .. } => name.to_owned(),
                        _ => format!("{path}.{name}"),
                    };
                    self.write(member.ty, at, &path)?;
                }
                Ok(())
            }
            TypeInner::Array { base, size, stride } => {
                let count = match size {
                    naga::ArraySize::Constant(count) => count.get() as usize,
                    _ => self.host.elements(path).clamp(1, MOST_ELEMENTS),
                };
                grow(self.words, offset + count * *stride as usize);
                for index in 0..count {
                    let at = offset + index * *stride as usize;
                    self.write(*base, at, &format!("{path}[{index}]"))?;
                }
                Ok(())
            }
            TypeInner::Scalar(scalar) => self.numbers(path, offset, 1, *scalar),
            TypeInner::Vector { size, scalar } => {
                self.numbers(path, offset, *size as usize, *scalar)
            }
            _ => Err(Diagnostic::error(format!("`{path}` is of a type that cannot be set")).into()),
        }
    }

    fn numbers(
        &mut self,
        path: &str,
        offset: usize,
        count: usize,
        scalar: Scalar,
    ) -> Result<(), Report> {
        let zeros = vec![0.0; count];
        let waves = [self.host.elements("waves") as f64];
        // Elements of arrays are 0 where nothing is said; a block's member must be known.
        let value = match self.host.values.get(path) {
            Some(value) => value.as_slice(),
            None if path == "water.wave_count" => &waves,
            None if path.contains('[') => &zeros,
            None => {
                let unknown = Diagnostic::error(format!("the host knows no value of `{path}`"));
                return Err(unknown.with_help(format!("set it: --set {path}=…")).into());
            }
        };
        if value.len() != count {
            let message = format!("`{path}` has {count} numbers, not {}", value.len());
            return Err(Diagnostic::error(message).into());
        }
        grow(self.words, offset + 4 * count);
        for (index, &number) in value.iter().enumerate() {
            self.words[offset / 4 + index] = match scalar.kind {
                ScalarKind::Uint => number as u32,
                ScalarKind::Sint => number as i32 as u32,
                _ => (self.change)(number as f32).to_bits(),
            };
        }
        Ok(())
    }
}

/// Texels with every float of them changed.
fn changed(kind: Kind, texels: &[[u32; 4]], change: &mut dyn FnMut(f32) -> f32) -> Vec<[u32; 4]> {
    let mut word = |word: u32| change(f32::from_bits(word)).to_bits();
    let texel = |texel: &[u32; 4]| match kind {
        Kind::Float => texel.map(&mut word),
        _ => *texel,
    };
    texels.iter().map(texel).collect()
}

fn grow(words: &mut Vec<u32>, bytes: usize) {
    if words.len() < bytes.div_ceil(4) {
        words.resize(bytes.div_ceil(4), 0);
    }
}

/// Buffers, textures and samplers made for the variables of a function.
#[derive(Debug, Default)]
pub struct Connected {
    pub(super) buffers: Vec<(String, Buffer)>,
    pub(super) textures: Vec<(String, Texture)>,
    samplers: Vec<String>,
}

impl Connected {
    /// As what a call takes.
    pub fn resources(&self) -> Resources<'_> {
        let mut resources = Resources::new();
        for (name, buffer) in &self.buffers {
            resources = resources.buffer(name, buffer);
        }
        for (name, texture) in &self.textures {
            resources = resources.texture(name, texture);
        }
        for name in &self.samplers {
            resources = resources.sampler(name, Sampler::default());
        }
        resources
    }
}
