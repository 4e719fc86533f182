//! Where a function's inputs may lie, and how they are drawn from there.

use fastrand::Rng;

use super::draw::{Leaf, normalise, nudged, step, unit};
use super::picture::Picture;
use crate::function::Function;
use crate::shape::{Column, Kind, Lanes, Shape};
use crate::ulp::{at_rank, rank};

/// One input of a function: a word for every single number of its arguments, in the order of
/// [`Shape::leaves`](crate::Shape::leaves), argument by argument. An `f32` is its bits.
#[derive(Debug, Clone, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct Input(pub Vec<u32>);

/// The range of an argument's numbers.
#[derive(Debug, Clone, PartialEq)]
pub enum Range {
    /// Every `f32` between the bounds is equally likely: small numbers as often as large ones.
    Bits(f32, f32),
    /// Every number is equally likely.
    Linear(f32, f32),
    /// Every decade is equally likely; both bounds are positive, or both negative.
    Log(f32, f32),
    /// Every decade from a least magnitude on is equally likely, on both sides of 0 as far as the
    /// bounds reach; what would be nearer to 0 is 0: least and most, and the magnitude.
    Coordinate(f32, f32, f32),
    /// Integers, all equally likely; truth values are 0 and 1.
    Whole(i64, i64),
    /// A vector of length 1, all directions equally likely; for a whole argument.
    Unit,
    /// A point that a camera sees; for a whole argument of three numbers.
    Seen(Picture),
}

impl Range {
    /// Whether it is of several numbers together.
    fn is_of_vectors(&self) -> bool {
        matches!(self, Self::Unit | Self::Seen(_))
    }
}

/// A place for one number of an input, from all of its numbers.
pub type Place = dyn Fn(&[f64]) -> f64 + Send + Sync;

/// Puts one number of an input near a place that depends on the others: near a critical angle,
/// near a tangent.
pub struct Relation {
    /// The number that is moved, counted over all arguments.
    pub leaf: usize,
    /// Share of the inputs that are so moved, from 0 to 1.
    pub share: f64,
    /// The place, from all numbers of the input; not finite where there is none.
    pub place: Box<Place>,
}

impl std::fmt::Debug for Relation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Relation")
            .field("leaf", &self.leaf)
            .field("share", &self.share)
            .finish()
    }
}

/// Where the inputs of a function lie.
#[derive(Debug)]
pub struct Domain {
    /// A range for each single number, or one [`Range::Unit`] for a vector's first.
    leaves: Vec<Leaf>,
    relations: Vec<Relation>,
}

impl Domain {
    /// From a range for each argument; it holds for each of the argument's numbers.
    ///
    /// None where their number is not the function's, or a range does not suit its argument:
    /// out of order, not finite, a logarithm across 0, a unit vector of integers.
    #[must_use]
    pub fn new(function: &Function, ranges: &[Range]) -> Option<Self> {
        let arguments: Vec<_> = function.arguments().collect();
        if arguments.len() != ranges.len() {
            return None;
        }
        let mut leaves = Vec::new();
        for ((_, shape), range) in arguments.iter().zip(ranges) {
            leaves.extend(leaves_of(shape, range)?);
        }
        Some(Self {
            leaves,
            relations: Vec::new(),
        })
    }

    /// From a kind and a range for each single number; a unit vector has [`Range::Unit`] for each of
    /// its numbers, and tells how many they are with the first, 0 with the others.
    pub(crate) fn of_leaves(numbers: &[(Kind, Range, usize)]) -> Option<Self> {
        let leaf = |(kind, range, count): &(Kind, Range, usize)| match range {
            Range::Unit | Range::Seen(_) => Some(Leaf {
                kind: *kind,
                range: range.clone(),
                count: *count,
            }),
            _ => leaves_of(&Shape::Scalar(*kind), range)?.pop(),
        };
        Some(Self {
            leaves: numbers.iter().map(leaf).collect::<Option<_>>()?,
            relations: Vec::new(),
        })
    }

    /// Adds a relation; none where there is no such number, or it is part of a unit vector.
    #[must_use]
    pub fn with(mut self, relation: Relation) -> Option<Self> {
        let leaf = self.leaves.get(relation.leaf)?;
        if leaf.range.is_of_vectors() || leaf.kind != Kind::Float {
            return None;
        }
        self.relations.push(relation);
        Some(self)
    }

    /// Number of single numbers of an input.
    #[must_use]
    pub fn leaf_count(&self) -> usize {
        self.leaves.len()
    }

    /// The bounds of a single number; none for part of a unit vector and what is no `f32`.
    #[must_use]
    pub fn bounds(&self, leaf: usize) -> Option<(f32, f32)> {
        match self.leaves.get(leaf)?.range {
            Range::Bits(low, high)
            | Range::Linear(low, high)
            | Range::Log(low, high)
            | Range::Coordinate(low, high, _) => Some((low, high)),
            Range::Whole(..) | Range::Unit | Range::Seen(_) => None,
        }
    }

    /// Which of the numbers are `f32`s that vary.
    pub fn floats(&self) -> impl Iterator<Item = usize> {
        let fixed = |range: &Range| match *range {
            Range::Bits(low, high) | Range::Linear(low, high) | Range::Log(low, high) => {
                low == high
            }
            Range::Whole(..) | Range::Unit | Range::Seen(_) | Range::Coordinate(..) => false,
        };
        (0..self.leaves.len())
            .filter(move |&i| self.leaves[i].kind == Kind::Float && !fixed(&self.leaves[i].range))
    }

    /// The numbers of an input, as `f64`.
    #[must_use]
    pub fn numbers(&self, input: &Input) -> Vec<f64> {
        let number = |(leaf, &word): (&Leaf, &u32)| match leaf.kind {
            Kind::Float => f64::from(f32::from_bits(word)),
            Kind::Sint => f64::from(word as i32),
            Kind::Uint | Kind::Bool => f64::from(word),
        };
        self.leaves.iter().zip(&input.0).map(number).collect()
    }

    /// A random input.
    pub fn draw(&self, rng: &mut Rng) -> Input {
        let mut words = Vec::with_capacity(self.leaves.len());
        while words.len() < self.leaves.len() {
            let leaf = &self.leaves[words.len()];
            match &leaf.range {
                Range::Unit => words.extend(unit(leaf.count, rng)),
                Range::Seen(picture) => words.extend(picture.draw(rng)),
                _ => words.push(leaf.draw(rng)),
            }
        }
        let mut input = Input(words);
        for relation in &self.relations {
            if rng.f64() < relation.share {
                self.relate(&mut input, relation, rng);
            }
        }
        input
    }

    fn relate(&self, input: &mut Input, relation: &Relation, rng: &mut Rng) {
        let place = (relation.place)(&self.numbers(input)) as f32;
        if !place.is_finite() {
            return;
        }
        // Relative distances from an ulp to a factor of 2, every binade equally likely.
        let distance = f64::exp2(-24.0 * rng.f64()) * if rng.bool() { 1.0 } else { -0.5 };
        let near = (f64::from(place) * (1.0 + distance)) as f32;
        let leaf = &self.leaves[relation.leaf];
        input.0[relation.leaf] = leaf.nearest(near.to_bits());
    }

    /// Changes an input a little or a lot, staying inside.
    pub fn changed(&self, input: &Input, rng: &mut Rng) -> Input {
        let mut changed = input.clone();
        for _ in 0..=rng.usize(0..2) {
            if !self.relations.is_empty() && rng.u8(0..8) == 0 {
                let relation = &self.relations[rng.usize(0..self.relations.len())];
                self.relate(&mut changed, relation, rng);
                continue;
            }
            let at = rng.usize(0..self.leaves.len().max(1));
            let Some(leaf) = self.leaves.get(at) else {
                continue;
            };
            let first = self.unit_start(at);
            let word = changed.0[at];
            changed.0[at] = match leaf.range {
                Range::Whole(..) if rng.bool() => leaf.draw(rng),
                Range::Whole(..) => leaf.nearest(word ^ (1 << rng.u32(0..32))),
                Range::Unit => (f32::from_bits(word) + step(rng) as f32 * f32::EPSILON).to_bits(),
                _ => {
                    let moved = match rng.u8(0..8) {
                        0 => word ^ (1 << rng.u32(0..31)),
                        1 => leaf.draw(rng),
                        _ => {
                            at_rank(rank(f32::from_bits(word)).saturating_add(step(rng))).to_bits()
                        }
                    };
                    leaf.nearest(moved)
                }
            };
            if let Some((first, count)) = first {
                let vector = &mut changed.0[first..first + count];
                match &leaf.range {
                    Range::Seen(picture) => picture.hold(vector),
                    _ => normalise(vector),
                }
            }
        }
        changed
    }

    /// An input with every `f32` moved by up to so many ulps; 0 stays.
    pub(super) fn moved(&self, input: &Input, ulps: i64, rng: &mut Rng) -> Input {
        let moved = |(leaf, &word): (&Leaf, &u32)| match leaf.kind {
            Kind::Float => nudged(f32::from_bits(word), ulps, rng).to_bits(),
            _ => word,
        };
        Input(self.leaves.iter().zip(&input.0).map(moved).collect())
    }

    /// Where the unit vector begins that a number belongs to, and how many there are.
    fn unit_start(&self, at: usize) -> Option<(usize, usize)> {
        let starts = (0..=at).rev().take(4);
        let holds = |&i: &usize| {
            let leaf = &self.leaves[i];
            leaf.range.is_of_vectors() && leaf.count > at - i
        };
        starts
            .into_iter()
            .find(holds)
            .map(|i| (i, self.leaves[i].count))
    }

    /// Inputs of special numbers: 0, denormals, 1 and its neighbours, the bounds and theirs, the
    /// axes. All combinations, or `most` of them at random.
    #[must_use]
    pub fn special(&self, most: usize, rng: &mut Rng) -> Vec<Input> {
        let mut choices: Vec<Vec<Vec<u32>>> = Vec::new();
        let mut at = 0;
        while at < self.leaves.len() {
            choices.push(self.leaves[at].special());
            at += if self.leaves[at].range.is_of_vectors() {
                self.leaves[at].count
            } else {
                1
            };
        }
        let total = choices
            .iter()
            .fold(1_usize, |n, c| n.saturating_mul(c.len()));
        let combination = |pick: &mut dyn FnMut(usize) -> usize| {
            Input(
                choices
                    .iter()
                    .flat_map(|c| c[pick(c.len())].clone())
                    .collect(),
            )
        };
        if total <= most {
            let numbered = |mut index: usize| {
                combination(&mut |count| {
                    let digit = index % count;
                    index /= count;
                    digit
                })
            };
            return (0..total).map(numbered).collect();
        }
        (0..most)
            .map(|_| combination(&mut |count| rng.usize(0..count)))
            .collect()
    }

    /// Inputs as columns, for a call.
    #[must_use]
    pub fn lanes(&self, function: &Function, inputs: &[Input]) -> Vec<Lanes<f32>> {
        let mut at = 0;
        let argument = |shape: &Shape| {
            let column = |(_, kind): (String, Kind)| {
                at += 1;
                let words = inputs.iter().map(|i| i.0.get(at - 1).copied().unwrap_or(0));
                match kind {
                    Kind::Float => Column::Float(words.map(f32::from_bits).collect()),
                    Kind::Sint => Column::Sint(words.map(|w| w as i32).collect()),
                    Kind::Uint => Column::Uint(words.collect()),
                    Kind::Bool => Column::Bool(words.map(|w| w != 0).collect()),
                }
            };
            Lanes {
                columns: shape.leaves().into_iter().map(column).collect(),
            }
        };
        function
            .arguments()
            .map(|(_, shape)| shape)
            .map(argument)
            .collect()
    }
}

fn leaves_of(shape: &Shape, range: &Range) -> Option<Vec<Leaf>> {
    let kinds: Vec<Kind> = shape.leaves().into_iter().map(|(_, kind)| kind).collect();
    let all_are = |kind: Kind| kinds.iter().all(|&k| k == kind);
    let suits = match *range {
        Range::Bits(low, high) | Range::Linear(low, high) => {
            low <= high && low.is_finite() && high.is_finite() && all_are(Kind::Float)
        }
        Range::Coordinate(low, high, least) => {
            let reach = high.max(-low);
            low <= high
                && least > 0.0
                && least <= reach
                && reach.is_finite()
                && all_are(Kind::Float)
        }
        Range::Log(low, high) => {
            low <= high && low * high > 0.0 && high.is_finite() && all_are(Kind::Float)
        }
        Range::Whole(low, high) => {
            let fits = |kind: &Kind| match kind {
                Kind::Float => false,
                Kind::Sint => i32::try_from(low).is_ok() && i32::try_from(high).is_ok(),
                Kind::Uint => u32::try_from(low).is_ok() && u32::try_from(high).is_ok(),
                Kind::Bool => low >= 0 && high <= 1,
            };
            low <= high && kinds.iter().all(fits)
        }
        Range::Unit => matches!(shape, Shape::Vector { .. }) && all_are(Kind::Float),
        Range::Seen(_) => matches!(shape, Shape::Vector { size: 3, .. }) && all_are(Kind::Float),
    };
    let leaf = |(i, kind): (usize, Kind)| {
        let count = match (i, range) {
            (0, Range::Unit | Range::Seen(_)) => kinds.len(),
            (_, Range::Unit | Range::Seen(_)) => 0,
            _ => 1,
        };
        Leaf {
            kind,
            range: range.clone(),
            count,
        }
    };
    suits.then(|| kinds.iter().copied().enumerate().map(leaf).collect())
}
