//! Textures: loads, stores, filtering and sizes.

use super::{Bound, Machine};
use crate::number::{Scalar, Whole};
use crate::op::{ImageOp, LANES, Leaf, Level, NONE, Register};
use crate::resources::{DepthTest, Sampler, Texture, Wrap};
use crate::texel;

/// One sample to be taken.
struct Sample<'t, S> {
    texture: &'t Texture,
    sampler: Sampler,
    at: [S; 3],
    dimensions: usize,
    layer: i64,
    offset: [i32; 3],
    compare: Option<S>,
}

impl<S: Scalar> Machine<'_, S> {
    fn int_at(&self, register: Register, lane: usize) -> i64 {
        if register == NONE {
            0
        } else {
            i64::from(self.ints[register as usize][lane] as i32)
        }
    }

    fn float_at(&self, register: Register, lane: usize) -> S {
        if register == NONE {
            S::from_f32(0.0)
        } else {
            self.floats[register as usize][lane]
        }
    }

    fn texel_place(&self, at: [Register; 3], layer: Register, lane: usize) -> [i64; 3] {
        let mut place = at.map(|register| self.int_at(register, lane));
        if layer != NONE {
            place[2] = self.int_at(layer, lane);
        }
        place
    }

    fn put_texel(&mut self, to: &[Leaf], lane: usize, texel: [u32; 4]) {
        for (&leaf, word) in to.iter().zip(texel) {
            match leaf {
                Leaf::Float(r) => {
                    self.floats[r as usize][lane] = S::from_f32(f32::from_bits(word));
                }
                Leaf::Int(r) => self.ints[r as usize][lane] = word,
            }
        }
    }

    pub(super) fn image(&mut self, index: u32, bound: &Bound<'_>) {
        let code = self.code;
        match &code.images[index as usize] {
            ImageOp::Load {
                image,
                at,
                layer,
                level,
                to,
            } => {
                let Some(texture) = bound.texture(*image) else {
                    return;
                };
                for lane in 0..LANES {
                    let place = self.texel_place(*at, *layer, lane);
                    let level = self.int_at(*level, lane);
                    let texel = usize::try_from(level)
                        .ok()
                        .and_then(|l| texture.load(l, place));
                    // Outside, WGSL allows zeros; that is what robust access gives.
                    self.put_texel(to, lane, texel.unwrap_or([0; 4]));
                }
            }
            ImageOp::Store {
                image,
                format,
                at,
                layer,
                from,
            } => {
                let Some(texture) = bound.texture(*image) else {
                    return;
                };
                for lane in self.writing_lanes() {
                    let place = self.texel_place(*at, *layer, lane);
                    let mut words = [0; 4];
                    for (word, &leaf) in words.iter_mut().zip(from) {
                        *word = match leaf {
                            Leaf::Float(r) => self.floats[r as usize][lane].to_f32().to_bits(),
                            Leaf::Int(r) => self.ints[r as usize][lane],
                        };
                    }
                    texture.store(place, texel::stored_texel(*format, words));
                }
            }
            ImageOp::Sample { .. } => self.sample(&code.images[index as usize], bound),
            ImageOp::Size { image, level, to } => {
                let Some(texture) = bound.texture(*image) else {
                    return;
                };
                for lane in 0..LANES {
                    let level = usize::try_from(self.int_at(*level, lane)).unwrap_or(0);
                    let size = texture.size(level);
                    for (&register, size) in to.iter().zip(size) {
                        self.ints[register as usize][lane] = size;
                    }
                }
            }
            ImageOp::Levels { image, to } => {
                let levels = bound.texture(*image).map_or(0, Texture::level_count);
                self.ints[*to as usize] = [levels as u32; LANES];
            }
            ImageOp::Layers { image, to } => {
                let layers = bound.texture(*image).map_or(0, |t| t.size(0)[2]);
                self.ints[*to as usize] = [layers; LANES];
            }
        }
    }

    fn sample(&mut self, op: &ImageOp, bound: &Bound<'_>) {
        let ImageOp::Sample {
            image,
            sampler,
            at,
            layer,
            offset,
            level,
            compare,
            gather,
            clamp_to_edge,
            to,
        } = op
        else {
            return;
        };
        let Some(texture) = bound.texture(*image) else {
            return;
        };
        let mut sampler = bound.sampler(*sampler);
        if *clamp_to_edge {
            sampler.wrap = [Wrap::Clamp; 3];
        }
        let dimensions = at.iter().filter(|&&register| register != NONE).count();
        for lane in 0..LANES {
            let sample = Sample {
                texture,
                sampler,
                at: at.map(|register| self.float_at(register, lane)),
                dimensions,
                layer: self.int_at(*layer, lane),
                offset: *offset,
                compare: (*compare != NONE).then(|| self.float_at(*compare, lane)),
            };
            let values = match gather {
                Some(component) => sample.gathered(*component as usize),
                None => {
                    let level = self.level(level, at, texture, lane);
                    sample.filtered(level)
                }
            };
            for (&leaf, value) in to.iter().zip(values) {
                match leaf {
                    Leaf::Float(r) => self.floats[r as usize][lane] = value,
                    Leaf::Int(r) => self.ints[r as usize][lane] = value.to_f64() as i64 as u32,
                }
            }
        }
    }

    /// The level of detail of a sample.
    fn level(&self, level: &Level, at: &[Register; 3], texture: &Texture, lane: usize) -> f64 {
        if texture.level_count() == 1 {
            return 0.0;
        }
        let number = |register: Register, lane: usize| self.float_at(register, lane).to_f64();
        let size = texture.size(0);
        let spread = |step: &dyn Fn(usize) -> f64| {
            (0..3)
                .map(|i| (step(i) * f64::from(size[i])).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        let by_quad = || {
            let quad = lane & !3;
            let across = |i: usize| number(at[i], quad + 1) - number(at[i], quad);
            let down = |i: usize| number(at[i], quad + 2) - number(at[i], quad);
            spread(&across).max(spread(&down)).log2()
        };
        match level {
            Level::Zero => 0.0,
            Level::Exact(Leaf::Float(register)) => number(*register, lane),
            Level::Exact(Leaf::Int(register)) => self.int_at(*register, lane) as f64,
            Level::Auto => by_quad(),
            Level::Bias(bias) => by_quad() + number(*bias, lane),
            Level::Gradient { x, y } => {
                let (across, down) = (|i: usize| number(x[i], lane), |i: usize| number(y[i], lane));
                spread(&across).max(spread(&down)).log2()
            }
        }
    }
}

impl<S: Scalar> Sample<'_, S> {
    fn filtered(&self, level: f64) -> [S; 4] {
        let most = (self.texture.level_count() - 1) as f64;
        // A level that is not a number is the largest.
        let level = if level > 0.0 { level.min(most) } else { 0.0 };
        if !self.sampler.between_levels {
            return self.on_level(level.round() as usize);
        }
        let low = level.floor();
        let rest = S::from_f64(level - low);
        let fine = self.on_level(low as usize);
        if low == most {
            return fine;
        }
        let coarse = self.on_level(low as usize + 1);
        std::array::from_fn(|i| between(fine[i], coarse[i], rest))
    }

    /// Nearest or mixed texels of one level.
    fn on_level(&self, level: usize) -> [S; 4] {
        if !self.sampler.linear {
            let scaled = self.scaled(level);
            let nearest = scaled.map(|x| whole(x.to_f64().floor()));
            return self.texel(level, nearest);
        }
        let (first, rest) = self.footprint(level);
        let mut corners = [[S::default(); 4]; 8];
        let count = 1 << self.dimensions;
        for (corner, texel) in corners.iter_mut().take(count).enumerate() {
            *texel = self.texel(
                level,
                std::array::from_fn(|i| first[i] + (corner >> i & 1) as i64),
            );
        }
        // Along x, then y, then z.
        for (axis, &rest) in rest.iter().enumerate().take(self.dimensions) {
            for pair in 0..count >> (axis + 1) {
                let (left, right) = (corners[2 * pair], corners[2 * pair + 1]);
                corners[pair] = std::array::from_fn(|i| between(left[i], right[i], rest));
            }
        }
        corners[0]
    }

    /// The four texels of a footprint: bottom left, bottom right, top right, top left.
    fn gathered(&self, component: usize) -> [S; 4] {
        let (first, _) = self.footprint(0);
        [[0, 1], [1, 1], [1, 0], [0, 0]]
            .map(|[x, y]| self.texel(0, [first[0] + x, first[1] + y, first[2]])[component.min(3)])
    }

    /// Coordinates in texels; the third is the layer where there are but two.
    fn scaled(&self, level: usize) -> [S; 3] {
        let size = self.texture.size(level);
        std::array::from_fn(|i| {
            if i < self.dimensions {
                let scaled = self.at[i].times(S::from_f64(f64::from(size[i])));
                scaled.plus(S::from_f64(f64::from(self.offset[i])))
            } else {
                S::from_f64(0.0)
            }
        })
    }

    /// The first texel of a footprint, and the weights of the second.
    fn footprint(&self, level: usize) -> ([i64; 3], [S; 3]) {
        let half = S::from_f32(0.5);
        let centred = self.scaled(level).map(|x| x.minus(half));
        let floor = centred.map(|x| x.whole(Whole::Floor));
        let first = floor.map(|x| whole(x.to_f64()));
        let rest = std::array::from_fn(|i| centred[i].minus(S::from_f64(first[i] as f64)));
        (first, rest)
    }

    /// A texel, the address modes applied, compared where a reference is given.
    fn texel(&self, level: usize, at: [i64; 3]) -> [S; 4] {
        let size = self.texture.size(level);
        let mut place = [0; 3];
        for i in 0..3 {
            place[i] = if i < self.dimensions {
                wrapped(at[i], i64::from(size[i]), self.sampler.wrap[i])
            } else if i == 2 {
                self.layer.clamp(0, i64::from(size[2]) - 1)
            } else {
                0
            };
        }
        let words = self.texture.load(level, place).unwrap_or([0; 4]);
        let texel = words.map(|word| match self.texture.kind() {
            crate::Kind::Sint => S::from_i32(word as i32),
            crate::Kind::Uint => S::from_u32(word),
            _ => S::from_f32(f32::from_bits(word)),
        });
        match self.compare {
            None => texel,
            Some(reference) => {
                let passes = passes(self.sampler.test, reference, texel[0]);
                [S::from_f32(if passes { 1.0 } else { 0.0 }); 4]
            }
        }
    }
}

/// `a (1 − t) + b t`
fn between<S: Scalar>(a: S, b: S, t: S) -> S {
    a.times(S::from_f32(1.0).minus(t)).plus(b.times(t))
}

/// A texel number; far outside for what is not a number or too large, never overflowing.
fn whole(x: f64) -> i64 {
    x.clamp(-1e9, 1e9) as i64
}

fn wrapped(at: i64, size: i64, wrap: Wrap) -> i64 {
    match wrap {
        Wrap::Clamp => at.clamp(0, size - 1),
        Wrap::Repeat => at.rem_euclid(size),
        Wrap::Mirror => {
            let twice = at.rem_euclid(2 * size);
            if twice < size {
                twice
            } else {
                2 * size - 1 - twice
            }
        }
    }
}

fn passes<S: Scalar>(test: DepthTest, reference: S, texel: S) -> bool {
    let (less, equal) = (reference.is_less(texel), reference.is_equal(texel));
    match test {
        DepthTest::Less => less,
        DepthTest::LessEqual => less || equal,
        DepthTest::Greater => texel.is_less(reference),
        DepthTest::GreaterEqual => texel.is_less(reference) || equal,
        DepthTest::Equal => equal,
        DepthTest::NotEqual => !equal,
        DepthTest::Always => true,
        DepthTest::Never => false,
    }
}
