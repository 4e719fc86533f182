//! Triangles out of polygons.

use glam::{DVec2, DVec3};

/// Polygons that are not convex are refused beyond this many corners: cutting them takes time
/// with the third power.
pub(crate) const MOST_CORNERS: usize = 512;

/// Cuts a polygon, counter-clockwise seen from outside, into triangles of its corners' indices:
/// a fan if it is convex, else by clipping ears (Meisters 1975). A polygon that crosses itself
/// gets some triangulation; none if it is not convex and has too many corners.
pub(crate) fn triangulate(corners: &[DVec3]) -> Option<Vec<[usize; 3]>> {
    let count = corners.len();
    // Newell's normal, which serves for polygons that are not quite plane.
    let normal: DVec3 = (0..count)
        .map(|i| (corners[i] - corners[0]).cross(corners[(i + 1) % count] - corners[0]))
        .sum();
    let (across, along) = normal.normalize_or(DVec3::Z).any_orthonormal_pair();
    let flat: Vec<DVec2> = corners
        .iter()
        .map(|&p| DVec2::new(p.dot(across), p.dot(along)))
        .collect();
    let turn = |a: usize, b: usize, c: usize| (flat[b] - flat[a]).perp_dot(flat[c] - flat[b]);
    let convex = (0..count).all(|i| turn(i, (i + 1) % count, (i + 2) % count) >= 0.0);
    if count <= 3 || convex {
        return Some((1..count - 1).map(|i| [0, i, i + 1]).collect());
    }
    if count > MOST_CORNERS {
        return None;
    }
    let mut left: Vec<usize> = (0..count).collect();
    let mut triangles = Vec::with_capacity(count - 2);
    while left.len() > 3 {
        let ear = (0..left.len()).find(|&k| {
            let (a, b, c) = around(&left, k);
            let empty = left.iter().all(|&p| {
                [a, b, c].contains(&p)
                    || turn(a, b, p) < 0.0
                    || turn(b, c, p) < 0.0
                    || turn(c, a, p) < 0.0
            });
            turn(a, b, c) > 0.0 && empty
        });
        // Without an ear the polygon crosses itself or is a line: any corner will do.
        let k = ear.unwrap_or(0);
        let (a, b, c) = around(&left, k);
        triangles.push([a, b, c]);
        left.remove(k);
    }
    triangles.push([left[0], left[1], left[2]]);
    Some(triangles)
}

/// A corner between its neighbours.
fn around(left: &[usize], k: usize) -> (usize, usize, usize) {
    let count = left.len();
    (
        left[(k + count - 1) % count],
        left[k],
        left[(k + 1) % count],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[DVec3], triangle: [usize; 3]) -> f64 {
        let [a, b, c] = triangle.map(|i| corners[i]);
        0.5 * (b - a).cross(c - a).z
    }

    #[test]
    fn triangles_of_a_polygon_all_turn_its_way_and_add_up_to_its_area() {
        // Stars of every start and depth of notch; the fan of most is wrong.
        for points in 2..12 {
            for depth in [0.1, 0.5, 0.99, 1.0] {
                for start in 0..2 * points {
                    let corners: Vec<DVec3> = (0..2 * points)
                        .map(|i| {
                            let i = i + start;
                            let angle = std::f64::consts::PI * f64::from(i) / f64::from(points);
                            let radius = if i % 2 == 0 { 1.0 } else { depth };
                            (radius * DVec2::from_angle(angle)).extend(0.0)
                        })
                        .collect();
                    let whole: f64 = (0..corners.len())
                        .map(|i| 0.5 * corners[i].cross(corners[(i + 1) % corners.len()]).z)
                        .sum();
                    let triangles = triangulate(&corners).unwrap();
                    assert_eq!(triangles.len(), corners.len() - 2);
                    let areas = triangles.iter().map(|&t| area(&corners, t));
                    assert!(areas.clone().all(|area| area > -1e-12));
                    assert!((areas.sum::<f64>() - whole).abs() < 1e-12);
                }
            }
        }
    }
}
