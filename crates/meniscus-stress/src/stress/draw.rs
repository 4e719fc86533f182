//! How single numbers of inputs are drawn, changed and chosen.

use fastrand::Rng;

use super::domain::Range;
use crate::shape::Kind;
use crate::ulp::{at_rank, rank};

/// A single number of an input, and where it may lie.
#[derive(Debug, Clone)]
pub(super) struct Leaf {
    pub(super) kind: Kind,
    pub(super) range: Range,
    /// Numbers that are drawn together, told of the first: of a unit vector or a point.
    pub(super) count: usize,
}

impl Leaf {
    pub(super) fn draw(&self, rng: &mut Rng) -> u32 {
        match self.range {
            Range::Bits(low, high) => at_rank(rng.i64(rank(low)..=rank(high))).to_bits(),
            Range::Linear(low, high) => {
                let (low, high) = (f64::from(low), f64::from(high));
                self.nearest(((low + (high - low) * rng.f64()) as f32).to_bits())
            }
            Range::Log(low, high) => {
                let (a, b) = (f64::from(low.abs()).ln(), f64::from(high.abs()).ln());
                let magnitude = (a + (b - a) * rng.f64()).exp() as f32;
                self.nearest(magnitude.copysign(low).to_bits())
            }
            Range::Coordinate(low, high, least) => {
                let negative = if high <= 0.0 || low >= 0.0 {
                    high <= 0.0
                } else {
                    rng.bool()
                };
                let reach = f64::from(if negative { -low } else { high });
                let (a, b) = (f64::from(least).ln(), reach.ln());
                let magnitude = if rng.u8(0..16) == 0 {
                    0.0
                } else {
                    (a + (b - a) * rng.f64()).exp()
                };
                let signed = if negative { -magnitude } else { magnitude };
                self.nearest((signed as f32).to_bits())
            }
            Range::Whole(low, high) => rng.i64(low..=high) as u32,
            Range::Unit | Range::Seen(_) => rng.f32().to_bits(),
        }
    }

    /// The nearest number inside.
    pub(super) fn nearest(&self, word: u32) -> u32 {
        match self.range {
            Range::Bits(low, high) | Range::Linear(low, high) | Range::Log(low, high) => {
                let x = f32::from_bits(word);
                if x.is_nan() {
                    low.to_bits()
                } else {
                    x.clamp(low, high).to_bits()
                }
            }
            Range::Coordinate(low, high, least) => {
                let x = f32::from_bits(word);
                let far = x.abs() >= least;
                let inside = if far {
                    x.clamp(low, high)
                } else {
                    0.0_f32.clamp(low, high)
                };
                inside.to_bits()
            }
            Range::Whole(low, high) => {
                let n = if self.kind == Kind::Sint {
                    i64::from(word as i32)
                } else {
                    i64::from(word)
                };
                n.clamp(low, high) as u32
            }
            Range::Unit | Range::Seen(_) => word,
        }
    }

    pub(super) fn special(&self) -> Vec<Vec<u32>> {
        let found: Vec<u32> = match self.range {
            Range::Unit => return axes(self.count),
            Range::Seen(ref picture) => return picture.special(),
            Range::Whole(low, high) => {
                let all = [low, low + 1, -1, 0, 1, high - 1, high];
                all.iter()
                    .filter(|n| (low..=high).contains(n))
                    .map(|&n| n as u32)
                    .collect()
            }
            Range::Coordinate(low, high, least) => {
                let mut all = vec![low, high, 0.0, least, -least, 1.0, -1.0, 0.5, -2.0];
                all.extend([1.0_f32.next_down(), 1.0_f32.next_up()]);
                all.retain(|x| (low..=high).contains(x));
                all.into_iter().map(f32::to_bits).collect()
            }
            Range::Bits(low, high) | Range::Linear(low, high) | Range::Log(low, high) => {
                let least = f32::from_bits(1);
                let mut all = vec![low, low.next_up(), high.next_down(), high];
                for x in [0.0, least, 1e-40, f32::MIN_POSITIVE, 1.0, f32::MAX] {
                    all.extend([x, -x]);
                }
                all.extend([1.0_f32.next_down(), 1.0_f32.next_up(), 0.5, 2.0]);
                all.retain(|x| (low..=high).contains(x));
                all.into_iter().map(f32::to_bits).collect()
            }
        };
        let mut found: Vec<Vec<u32>> = found.into_iter().map(|word| vec![word]).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// Steps in rank of every size, both ways.
pub(super) fn step(rng: &mut Rng) -> i64 {
    let size = 1_i64 << rng.u32(0..28);
    let step = rng.i64(1..=size);
    if rng.bool() { step } else { -step }
}

/// A number moved by up to so many ulps either way; 0 and what is not finite stay.
pub(crate) fn nudged(number: f32, ulps: i64, rng: &mut Rng) -> f32 {
    if number == 0.0 || !number.is_finite() {
        return number;
    }
    // As often to the end as anywhere between.
    let far = if rng.bool() { ulps } else { rng.i64(0..=ulps) };
    let moved = at_rank(rank(number) + if rng.bool() { far } else { -far });
    if moved.is_finite() { moved } else { number }
}

pub(super) fn unit(count: usize, rng: &mut Rng) -> Vec<u32> {
    loop {
        // Points of the ball, pushed out to its surface.
        let v: Vec<f64> = (0..count).map(|_| 2.0 * rng.f64() - 1.0).collect();
        let square: f64 = v.iter().map(|x| x * x).sum();
        if (1e-4..=1.0).contains(&square) {
            return v
                .iter()
                .map(|x| ((x / square.sqrt()) as f32).to_bits())
                .collect();
        }
    }
}

pub(super) fn normalise(words: &mut [u32]) {
    let numbers = words.iter().map(|&w| f64::from(f32::from_bits(w)));
    let length = numbers.map(|x| x * x).sum::<f64>().sqrt();
    for word in words {
        let x = f64::from(f32::from_bits(*word)) / length;
        *word = if x.is_finite() {
            (x as f32).to_bits()
        } else {
            1.0_f32.to_bits()
        };
    }
}

/// The axes both ways, and directions barely off them.
fn axes(count: usize) -> Vec<Vec<u32>> {
    let mut found = Vec::new();
    for axis in 0..count {
        for sign in [1.0_f32, -1.0] {
            for off in [0.0_f32, 1e-30, 1e-7, 1e-3] {
                let mut v = vec![off; count];
                v[axis] = sign;
                let mut words: Vec<u32> = v.into_iter().map(f32::to_bits).collect();
                normalise(&mut words);
                found.push(words);
            }
        }
    }
    found
}
