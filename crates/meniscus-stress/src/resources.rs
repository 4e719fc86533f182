//! Buffers, textures and samplers that a shader reads and writes, shared between threads.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::shape::Kind;

/// A buffer with the layout that WGSL gives it, in words of four bytes.
///
/// Words are atomic, so that workgroups on several threads may write to one buffer.
#[derive(Debug, Default)]
pub struct Buffer {
    words: Vec<AtomicU32>,
}

impl Buffer {
    /// Zeros; the size is rounded up to whole words.
    #[must_use]
    pub fn zeros(bytes: usize) -> Self {
        Self::from_words(&vec![0; bytes.div_ceil(4)])
    }

    /// From bytes, as they would be sent to a GPU; padded with zeros to whole words.
    #[must_use]
    pub fn from_bytes(bytes: &[u8]) -> Self {
        let word = |chunk: &[u8]| {
            let mut padded = [0; 4];
            padded[..chunk.len()].copy_from_slice(chunk);
            AtomicU32::new(u32::from_le_bytes(padded))
        };
        Self {
            words: bytes.chunks(4).map(word).collect(),
        }
    }

    /// From words.
    #[must_use]
    pub fn from_words(words: &[u32]) -> Self {
        Self {
            words: words.iter().map(|&w| AtomicU32::new(w)).collect(),
        }
    }

    /// From numbers.
    #[must_use]
    pub fn from_floats(numbers: &[f32]) -> Self {
        Self {
            words: numbers
                .iter()
                .map(|n| AtomicU32::new(n.to_bits()))
                .collect(),
        }
    }

    /// What is in it.
    #[must_use]
    pub fn words(&self) -> Vec<u32> {
        self.words
            .iter()
            .map(|w| w.load(Ordering::Relaxed))
            .collect()
    }

    /// What is in it, as `f32`s.
    #[must_use]
    pub fn floats(&self) -> Vec<f32> {
        self.words
            .iter()
            .map(|w| f32::from_bits(w.load(Ordering::Relaxed)))
            .collect()
    }

    /// Its size.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.words.len() * 4
    }

    /// The word nearest to a place; 0 in an empty buffer.
    #[inline]
    pub(crate) fn load(&self, word: usize) -> u32 {
        match self.words.get(word).or(self.words.last()) {
            Some(w) => w.load(Ordering::Relaxed),
            None => 0,
        }
    }

    #[inline]
    pub(crate) fn store(&self, word: usize, value: u32) {
        if let Some(w) = self.words.get(word) {
            w.store(value, Ordering::Relaxed);
        }
    }

    pub(crate) fn atomic(&self, word: usize) -> Option<&AtomicU32> {
        self.words.get(word)
    }
}

/// A texture: four words a texel, whatever its format.
///
/// Floating-point texels (depth and normalised ones included) are `f32`; absent channels are
/// (0, 0, 0, 1). Layers, slices and cube faces lie one behind the other.
#[derive(Debug)]
pub struct Texture {
    kind: Kind,
    levels: Vec<TextureLevel>,
}

#[derive(Debug)]
struct TextureLevel {
    size: [u32; 3],
    words: Vec<AtomicU32>,
}

impl Texture {
    /// Zeros. Width, height, and depth, layers or faces, each at least 1; of floating-point texels
    /// (depth included) or integers.
    #[must_use]
    pub fn zeros(kind: Kind, size: [u32; 3]) -> Self {
        Self {
            kind,
            levels: vec![TextureLevel::zeros(size)],
        }
    }

    /// Of floating-point texels, row by row; what is missing is 0, what is too much is left out.
    #[must_use]
    pub fn from_floats(size: [u32; 3], texels: &[[f32; 4]]) -> Self {
        let texture = Self::zeros(Kind::Float, size);
        texture.levels[0].fill(texels.iter().map(|t| t.map(f32::to_bits)));
        texture
    }

    /// Of integers.
    #[must_use]
    pub fn from_words(kind: Kind, size: [u32; 3], texels: &[[u32; 4]]) -> Self {
        let texture = Self::zeros(kind, size);
        texture.levels[0].fill(texels.iter().copied());
        texture
    }

    /// Adds the next, smaller level, of half the size rounded down.
    pub fn push_level(&mut self, texels: &[[f32; 4]]) {
        let [width, height, depth] = self.levels[self.levels.len() - 1].size;
        let level = TextureLevel::zeros([(width / 2).max(1), (height / 2).max(1), depth]);
        level.fill(texels.iter().map(|t| t.map(f32::to_bits)));
        self.levels.push(level);
    }

    /// What its texels are.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Width, height and depth or layers of a level; of the last where there is no such level.
    #[must_use]
    pub fn size(&self, level: usize) -> [u32; 3] {
        self.levels[level.min(self.levels.len() - 1)].size
    }

    /// Number of levels.
    #[must_use]
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// The texels of the largest level, row by row.
    #[must_use]
    pub fn floats(&self) -> Vec<[f32; 4]> {
        self.levels[0]
            .texels()
            .map(|t| t.map(f32::from_bits))
            .collect()
    }

    /// The texels of the largest level, as bits.
    #[must_use]
    pub fn words(&self) -> Vec<[u32; 4]> {
        self.levels[0].texels().collect()
    }

    /// The bits of a texel; none outside.
    #[inline]
    pub(crate) fn load(&self, level: usize, at: [i64; 3]) -> Option<[u32; 4]> {
        let level = self.levels.get(level)?;
        let first = level.first_word(at)?;
        let words = level.words.get(first..first + 4)?;
        Some(std::array::from_fn(|i| words[i].load(Ordering::Relaxed)))
    }

    pub(crate) fn store(&self, at: [i64; 3], texel: [u32; 4]) {
        let level = &self.levels[0];
        if let Some(first) = level.first_word(at) {
            for (word, value) in level.words[first..first + 4].iter().zip(texel) {
                word.store(value, Ordering::Relaxed);
            }
        }
    }
}

impl TextureLevel {
    fn zeros(size: [u32; 3]) -> Self {
        let size = size.map(|s| s.max(1));
        let texels = size.iter().map(|&s| s as usize).product::<usize>();
        Self {
            size,
            words: (0..texels * 4).map(|_| AtomicU32::new(0)).collect(),
        }
    }

    fn fill(&self, texels: impl Iterator<Item = [u32; 4]>) {
        for (word, value) in self.words.iter().zip(texels.flatten()) {
            word.store(value, Ordering::Relaxed);
        }
    }

    fn texels(&self) -> impl Iterator<Item = [u32; 4]> {
        let texel = |c: &[AtomicU32]| std::array::from_fn(|i| c[i].load(Ordering::Relaxed));
        self.words.chunks_exact(4).map(texel)
    }

    #[inline]
    fn first_word(&self, at: [i64; 3]) -> Option<usize> {
        let inside = at
            .iter()
            .zip(self.size)
            .all(|(&a, s)| a >= 0 && a < i64::from(s));
        let [width, height, _] = self.size.map(|s| s as usize);
        let [x, y, z] = at.map(|a| a as usize);
        inside.then(|| ((z * height + y) * width + x) * 4)
    }
}

/// What lies outside a texture's edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The texel at the edge.
    #[default]
    Clamp,
    /// The texture again.
    Repeat,
    /// The texture mirrored.
    Mirror,
}

/// How a depth is compared by a comparison sampler: reference against texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[allow(missing_docs, reason = "WebGPU's names say all there is to say")]
pub enum DepthTest {
    #[default]
    LessEqual,
    Less,
    GreaterEqual,
    Greater,
    Equal,
    NotEqual,
    Always,
    Never,
}

/// How a texture is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampler {
    /// Address modes along x, y and z.
    pub wrap: [Wrap; 3],
    /// Whether the texels around are mixed.
    pub linear: bool,
    /// Whether the two nearest levels are mixed.
    pub between_levels: bool,
    /// For comparison samplers.
    pub test: DepthTest,
}

impl Default for Sampler {
    /// Bilinear, clamped to the edge.
    fn default() -> Self {
        Self {
            wrap: [Wrap::Clamp; 3],
            linear: true,
            between_levels: false,
            test: DepthTest::default(),
        }
    }
}

/// What a shader's variables are connected to, by the variables' names.
#[derive(Debug, Default)]
pub struct Resources<'a> {
    pub(crate) buffers: BTreeMap<String, &'a Buffer>,
    pub(crate) textures: BTreeMap<String, &'a Texture>,
    pub(crate) samplers: BTreeMap<String, Sampler>,
}

impl<'a> Resources<'a> {
    /// Nothing.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Connects a buffer.
    #[must_use]
    pub fn buffer(mut self, variable: &str, buffer: &'a Buffer) -> Self {
        self.buffers.insert(variable.to_owned(), buffer);
        self
    }

    /// Connects a texture, for reading, sampling or storing.
    #[must_use]
    pub fn texture(mut self, variable: &str, texture: &'a Texture) -> Self {
        self.textures.insert(variable.to_owned(), texture);
        self
    }

    /// Connects a sampler.
    #[must_use]
    pub fn sampler(mut self, variable: &str, sampler: Sampler) -> Self {
        self.samplers.insert(variable.to_owned(), sampler);
        self
    }
}
