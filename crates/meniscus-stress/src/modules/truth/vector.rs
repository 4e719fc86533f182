//! Vectors of three numbers, for truths.

pub(super) type Vector = [f64; 3];

/// Three numbers of a list from one on.
pub(super) fn vector(numbers: &[f64], first: usize) -> Vector {
    [numbers[first], numbers[first + 1], numbers[first + 2]]
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The volume between three vectors.
pub(super) fn volume(a: Vector, b: Vector, c: Vector) -> f64 {
    dot(a, cross(b, c))
}

pub(super) fn length(a: Vector) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

pub(super) fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + t · b`
pub(super) fn along(a: Vector, t: f64, b: Vector) -> Vector {
    [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]]
}

/// The direction of a vector.
pub(super) fn unit(a: Vector) -> Vector {
    let length = length(a);
    a.map(|x| x / length)
}
