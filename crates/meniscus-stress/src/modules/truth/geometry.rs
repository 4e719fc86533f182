//! Where lines meet planes, spheres and triangles, and what a camera shows: by volumes, half chords and
//! angles.

use super::vector::{Vector, along, cross, dot, length, minus, unit, vector, volume};

/// By the line's moment (Plücker 1865): the point where a line of direction d and moment m = o × d
/// meets the plane n · x = δ is (n × m + δ d) / (n · d).
pub(super) fn plane(x: &[f64]) -> Vec<f64> {
    let (origin, direction, normal, distance) = (vector(x, 0), vector(x, 3), vector(x, 6), x[9]);
    let moment = cross(origin, direction);
    let point = along(cross(normal, moment), distance, direction);
    let slope = dot(normal, direction);
    let point = point.map(|c| c / slope);
    // Along the direction's longest component, so that least is lost.
    let longest = longest(direction);
    let t = (point[longest] - origin[longest]) / direction[longest];
    vec![if slope == 0.0 { f64::NAN } else { t }]
}

fn longest(v: Vector) -> usize {
    let larger = |a: usize, b: usize| if v[b].abs() > v[a].abs() { b } else { a };
    larger(larger(0, 1), 2)
}

/// By the half chord: the line passes the centre at the distance |(c − o) × d| / |d|.
pub(super) fn sphere(x: &[f64]) -> Vec<f64> {
    let (origin, direction, centre, radius) = (vector(x, 0), vector(x, 3), vector(x, 6), x[9]);
    let size = length(direction);
    let to_centre = minus(centre, origin);
    let off = length(cross(to_centre, direction)) / size;
    let middle = dot(to_centre, direction) / size;
    if off > radius {
        return vec![f64::NAN];
    }
    let half = ((radius - off) * (radius + off)).sqrt();
    // What is left of the way to the middle, as a quotient where it would be a small difference.
    let far = length(to_centre);
    let outside = (far - radius) * (far + radius);
    let first = match (outside >= 0.0, middle >= 0.0) {
        (true, true) => outside / (middle + half),
        (true, false) => f64::NAN,
        // From within, the ray leaves the sphere.
        (false, true) => middle + half,
        (false, false) => -outside / (half - middle),
    };
    vec![first / size]
}

/// By volumes: the weight of a corner is the volume between the ray's direction and the ways to the
/// other two, over that of all three. Ray (6) and corners (9); distance, weights (3).
pub(super) fn triangle(ray: &[f64], corners: &[f64]) -> Vec<f64> {
    let (origin, direction) = (vector(ray, 0), vector(ray, 3));
    let to = |corner: usize| minus(vector(corners, 3 * corner), origin);
    let (a, b, c) = (to(0), to(1), to(2));
    let parts = [
        volume(direction, b, c),
        volume(direction, c, a),
        volume(direction, a, b),
    ];
    let whole: f64 = parts.iter().sum();
    let distance = volume(a, b, c) / whole;
    let mut found = vec![distance];
    found.extend(parts.map(|part| part / whole));
    if whole == 0.0 {
        found.fill(f64::NAN);
    }
    found
}

/// Origin (3), turn, shear (3), corners (9): the direction is 1 / shear.z along the axis that the turn
/// makes the last, and shear.xy times as much along the two before it.
pub(super) fn sheared_triangle(x: &[f64]) -> Vec<f64> {
    let (turn, shear) = (x[3] as usize, vector(x, 4));
    let turned = [shear[0] / shear[2], shear[1] / shear[2], 1.0 / shear[2]];
    let direction: Vector = std::array::from_fn(|axis| turned[(axis + 3 - turn % 3) % 3]);
    let mut ray = x[..3].to_vec();
    ray.extend(direction);
    triangle(&ray, &x[7..16])
}

/// A camera's numbers: eye, right, up, forward, focal, size, near, seen_size.
const CAMERA: usize = 18;

/// By angles: how far off `forward`, and which way around it.
pub(super) fn camera_ray(x: &[f64]) -> Vec<f64> {
    let [right, up, forward] = [3, 6, 9].map(|first| vector(x, first));
    let (focal, size) = (x[12], [x[13], x[14]]);
    let (across, down) = (x[CAMERA] - 0.5 * size[0], x[CAMERA + 1] - 0.5 * size[1]);
    let off = across.hypot(down).atan2(focal);
    let around = down.atan2(across);
    let sideways = along(right.map(|c| around.cos() * c), -around.sin(), up);
    let direction = along(forward.map(|c| off.cos() * c), off.sin(), sideways);
    let mut found = x[..3].to_vec();
    found.extend(unit(direction));
    found
}

/// By Cramer's rule: the way to the point is a sum of the three axes, whatever angles they make.
pub(super) fn camera_pixel(x: &[f64]) -> Vec<f64> {
    let [right, up, forward] = [3, 6, 9].map(|first| vector(x, first));
    let (focal, size) = (x[12], [x[13], x[14]]);
    let way = minus(vector(x, CAMERA), vector(x, 0));
    let whole = volume(right, up, forward);
    let across = volume(way, up, forward) / whole;
    let above = volume(right, way, forward) / whole;
    let depth = volume(right, up, way) / whole;
    if depth <= 1e-6 {
        return vec![f64::NAN; 3];
    }
    let scale = focal / depth;
    vec![
        0.5 * size[0] + across * scale,
        0.5 * size[1] - above * scale,
        depth,
    ]
}
