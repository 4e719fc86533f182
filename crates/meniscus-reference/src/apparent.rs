//! Where a point of the world appears in the picture.

use glam::{DVec2, DVec3};
use meniscus_scene::{Scene, View};

/// The place in the picture (pixels) at which a world point (metres) appears through flat water:
/// the rest plane without waves. A point on the eye's side of the plane appears where it is.
///
/// None if its light reaches the eye from behind the picture.
pub fn apparent_pixel(point: DVec3, scene: &Scene, view: &View) -> Option<DVec2> {
    let level = scene.water.level;
    let air = view.eye.z >= level;
    let below = if air {
        level - point.z
    } else {
        point.z - level
    };
    let across = (point - view.eye).truncate();
    let distance = across.length();
    if below <= 0.0 || distance == 0.0 {
        return view.project(point);
    }
    // An eye on the plane sees what an eye just off it does.
    let above = (view.eye.z - level).abs().max(1e-30);
    let index = scene.water.refractive_index;
    let (near_index, far_index) = if air { (1.0, index) } else { (index, 1.0) };
    let crossing = crossing([above, below], distance, [near_index, far_index]);
    let towards = across / distance * crossing;
    let down = if air { -above } else { above };
    view.project(view.eye + towards.extend(down).normalize())
}

/// The place in the picture (pixels) at which a world point (metres) appears in the mirror of the
/// rest plane, as by total reflection. None if its light reaches the eye from behind the picture.
pub fn mirrored_pixel(point: DVec3, scene: &Scene, view: &View) -> Option<DVec2> {
    view.project(DVec3::new(
        point.x,
        point.y,
        2.0 * scene.water.level - point.z,
    ))
}

/// How far from the first of two points, at these heights over and under a plane and this far
/// apart along it, light crosses the plane.
///
/// By Fermat's principle the optical path is stationary there. It is a convex function of the
/// crossing, so its derivative has one root, which is kept bracketed.
fn crossing(heights: [f64; 2], distance: f64, indices: [f64; 2]) -> f64 {
    let derivatives = |x: f64| {
        let rest = distance - x;
        let [first, second] = [heights[0].hypot(x), heights[1].hypot(rest)];
        let value = indices[0] * x / first - indices[1] * rest / second;
        let slope = indices[0] * (heights[0] / first).powi(2) / first
            + indices[1] * (heights[1] / second).powi(2) / second;
        (value, slope)
    };
    let (mut low, mut high) = (0.0, distance);
    let mut x = distance * heights[0] / (heights[0] + heights[1]);
    for step in 0..300 {
        let (value, slope) = derivatives(x);
        if value > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let newton = x - value / slope;
        // Every third step halves, or Newton could creep along one end of the bracket.
        let next = if newton > low && newton < high && step % 3 != 2 {
            newton
        } else {
            0.5 * (low + high)
        };
        if value == 0.0 || (newton - x).abs() <= f64::EPSILON * x || next == low || next == high {
            return newton.clamp(low, high);
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_crosses_where_the_sines_are_as_the_indices() {
        for a in [1e-7, 0.01, 1.7, 300.0] {
            for b in [1e-6, 0.02, 2.0, 50.0] {
                for d in [1e-6, 0.3, 5.0, 3000.0] {
                    for [n1, n2] in [[1.0, 1.333], [1.333, 1.0], [1.0, 0.4], [1.0, 1.0]] {
                        let x = crossing([a, b], d, [n1, n2]);
                        let sines = [x / x.hypot(a), (d - x) / (d - x).hypot(b)];
                        // The last bit of x is worth this much of a sine.
                        let bit = f64::EPSILON * d / b.min(a.hypot(x));
                        let off = n1 * sines[0] - n2 * sines[1];
                        assert!(off.abs() < 1e-14 + 8.0 * bit, "{a} {b} {d} {n1}: {off}");
                        // Light that goes back crosses at the same place.
                        let back = crossing([b, a], d, [n2, n1]);
                        assert!((x + back - d).abs() < 1e-9 * d, "{a} {b} {d}: {x} {back}");
                    }
                }
            }
        }
    }
}
