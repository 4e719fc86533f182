//! What arguments and results look like, and how the caller hands them over.

use crate::number::Scalar;

/// What a single number is in WGSL.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// `f32`
    Float,
    /// `i32`
    Sint,
    /// `u32`
    Uint,
    /// `bool`
    Bool,
}

impl Kind {
    /// Its name in WGSL.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Float => "f32",
            Self::Sint => "i32",
            Self::Uint => "u32",
            Self::Bool => "bool",
        }
    }
}

/// The type of an argument or a result.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Shape {
    /// A number.
    Scalar(Kind),
    /// A vector.
    Vector {
        /// Number of components.
        size: usize,
        /// What they are.
        kind: Kind,
    },
    /// A matrix of `f32`.
    Matrix {
        /// Number of columns.
        columns: usize,
        /// Number of rows.
        rows: usize,
    },
    /// An array of a fixed length.
    Array {
        /// What it holds.
        of: Box<Shape>,
        /// How many.
        length: usize,
    },
    /// A structure.
    Struct {
        /// Its name in WGSL.
        name: String,
        /// Names and types of its members.
        members: Vec<(String, Shape)>,
    },
}

impl Shape {
    /// Number of single numbers.
    #[must_use]
    pub fn leaf_count(&self) -> usize {
        match self {
            Self::Scalar(_) => 1,
            Self::Vector { size, .. } => *size,
            Self::Matrix { columns, rows } => columns * rows,
            Self::Array { of, length } => of.leaf_count().saturating_mul(*length),
            Self::Struct { members, .. } => members.iter().map(|(_, m)| m.leaf_count()).sum(),
        }
    }

    /// Path (`.origin.x`, `[2]`) and kind of every single number, in order; the path is empty for
    /// a plain number.
    #[must_use]
    pub fn leaves(&self) -> Vec<(String, Kind)> {
        let mut found = Vec::new();
        self.walk(String::new(), &mut found);
        found
    }

    fn walk(&self, path: String, found: &mut Vec<(String, Kind)>) {
        const NAMES: [char; 4] = ['x', 'y', 'z', 'w'];
        match self {
            Self::Scalar(kind) => found.push((path, *kind)),
            Self::Vector { size, kind } => {
                found.extend(
                    NAMES
                        .iter()
                        .take(*size)
                        .map(|n| (format!("{path}.{n}"), *kind)),
                );
            }
            Self::Matrix { columns, rows } => {
                for column in 0..*columns {
                    let names = NAMES.iter().take(*rows);
                    found.extend(names.map(|n| (format!("{path}[{column}].{n}"), Kind::Float)));
                }
            }
            Self::Array { of, length } => {
                for i in 0..*length {
                    of.walk(format!("{path}[{i}]"), found);
                }
            }
            Self::Struct { members, .. } => {
                for (name, shape) in members {
                    shape.walk(format!("{path}.{name}"), found);
                }
            }
        }
    }
}

impl Shape {
    /// For every single number the vector of `f32`s that it is part of, as a range of numbers; that
    /// of itself alone elsewhere.
    #[must_use]
    pub fn vectors(&self) -> Vec<std::ops::Range<usize>> {
        let mut found = Vec::new();
        self.gather_vectors(&mut found);
        found
    }

    fn gather_vectors(&self, found: &mut Vec<std::ops::Range<usize>>) {
        let first = found.len();
        match self {
            Self::Vector {
                size,
                kind: Kind::Float,
            } => found.extend((0..*size).map(|_| first..first + size)),
            Self::Array { of, length } => (0..*length).for_each(|_| of.gather_vectors(found)),
            Self::Struct { members, .. } => {
                for (_, member) in members {
                    member.gather_vectors(found);
                }
            }
            _ => found.extend((first..first + self.leaf_count()).map(|leaf| leaf..leaf + 1)),
        }
    }
}

impl std::fmt::Display for Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Scalar(kind) => write!(f, "{}", kind.name()),
            Self::Vector { size, kind } => write!(f, "vec{size}<{}>", kind.name()),
            Self::Matrix { columns, rows } => write!(f, "mat{columns}x{rows}<f32>"),
            Self::Array { of, length } => write!(f, "array<{of}, {length}>"),
            Self::Struct { name, .. } => write!(f, "{name}"),
        }
    }
}

/// One single number of a value, for many lanes.
#[derive(Debug, Clone, PartialEq)]
pub enum Column<S> {
    /// `f32`
    Float(Vec<S>),
    /// `i32`
    Sint(Vec<i32>),
    /// `u32`
    Uint(Vec<u32>),
    /// `bool`
    Bool(Vec<bool>),
}

impl<S: Scalar> Column<S> {
    /// As many zeros.
    #[must_use]
    pub fn zeros(kind: Kind, lanes: usize) -> Self {
        match kind {
            Kind::Float => Self::Float(vec![S::from_f32(0.0); lanes]),
            Kind::Sint => Self::Sint(vec![0; lanes]),
            Kind::Uint => Self::Uint(vec![0; lanes]),
            Kind::Bool => Self::Bool(vec![false; lanes]),
        }
    }

    /// Number of lanes.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Float(c) => c.len(),
            Self::Sint(c) => c.len(),
            Self::Uint(c) => c.len(),
            Self::Bool(c) => c.len(),
        }
    }

    /// Whether there is no lane.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What it is in WGSL.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Float(_) => Kind::Float,
            Self::Sint(_) => Kind::Sint,
            Self::Uint(_) => Kind::Uint,
            Self::Bool(_) => Kind::Bool,
        }
    }

    /// One lane as an `f64`: true is 1. NaN for a lane that is not there.
    #[must_use]
    pub fn as_f64(&self, lane: usize) -> f64 {
        match self {
            Self::Float(c) => c.get(lane).map(|x| x.to_f64()),
            Self::Sint(c) => c.get(lane).map(|&x| f64::from(x)),
            Self::Uint(c) => c.get(lane).map(|&x| f64::from(x)),
            Self::Bool(c) => c.get(lane).map(|&x| f64::from(u8::from(x))),
        }
        .unwrap_or(f64::NAN)
    }
}

/// A value in many lanes: a column for every single number of it, in the order of
/// [`Shape::leaves`].
#[derive(Debug, Clone, PartialEq)]
pub struct Lanes<S> {
    /// Its columns.
    pub columns: Vec<Column<S>>,
}

impl<S: Scalar> Lanes<S> {
    /// Zeros of a shape.
    #[must_use]
    pub fn zeros(shape: &Shape, lanes: usize) -> Self {
        let leaves = shape.leaves();
        Self {
            columns: leaves
                .iter()
                .map(|(_, kind)| Column::zeros(*kind, lanes))
                .collect(),
        }
    }

    /// An `f32` in each lane.
    #[must_use]
    pub fn scalars(values: &[f32]) -> Self {
        let column = values.iter().map(|&v| S::from_f32(v)).collect();
        Self {
            columns: vec![Column::Float(column)],
        }
    }

    /// A vector (or anything else that is made of `f32`s alone) in each lane.
    #[must_use]
    pub fn vectors<const N: usize>(values: &[[f32; N]]) -> Self {
        let column = |i: usize| values.iter().map(|v| S::from_f32(v[i])).collect();
        Self {
            columns: (0..N).map(|i| Column::Float(column(i))).collect(),
        }
    }

    /// The column of a number that is an `f32`; none where it is not, or not there.
    #[must_use]
    pub fn floats(&self, leaf: usize) -> Option<&[S]> {
        match self.columns.get(leaf) {
            Some(Column::Float(c)) => Some(c),
            _ => None,
        }
    }

    /// Some of the lanes, one behind the other; none beyond the last.
    #[must_use]
    pub fn part(&self, lanes: std::ops::Range<usize>) -> Self {
        fn cut<T: Copy>(column: &[T], lanes: &std::ops::Range<usize>) -> Vec<T> {
            column.get(lanes.clone()).unwrap_or_default().to_vec()
        }
        let part = |column: &Column<S>| match column {
            Column::Float(c) => Column::Float(cut(c, &lanes)),
            Column::Sint(c) => Column::Sint(cut(c, &lanes)),
            Column::Uint(c) => Column::Uint(cut(c, &lanes)),
            Column::Bool(c) => Column::Bool(cut(c, &lanes)),
        };
        Self {
            columns: self.columns.iter().map(part).collect(),
        }
    }

    /// Every number of one lane, as `f64`.
    #[must_use]
    pub fn lane(&self, lane: usize) -> Vec<f64> {
        self.columns.iter().map(|c| c.as_f64(lane)).collect()
    }

    /// The same values in another number system, through `f64`.
    #[must_use]
    pub fn converted<T: Scalar>(&self) -> Lanes<T> {
        let convert = |column: &Column<S>| match column {
            Column::Float(c) => Column::Float(c.iter().map(|x| T::from_f64(x.to_f64())).collect()),
            Column::Sint(c) => Column::Sint(c.clone()),
            Column::Uint(c) => Column::Uint(c.clone()),
            Column::Bool(c) => Column::Bool(c.clone()),
        };
        Lanes {
            columns: self.columns.iter().map(convert).collect(),
        }
    }
}
