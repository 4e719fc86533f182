// The nearest of the triangles that a ray has met, and what it meets there. World space, metres.
//
// needs: geometry/hit, geometry/ray, geometry/triangle, geometry/triangles
// domain: the triangles of a scene, coordinates to 1e6 m

// `distance`: along the ray, 1e30 where nothing has been met; `weights`: barycentric; `triangle`: its
// index.
struct Nearest {
    distance: f32,
    weights: vec3f,
    triangle: u32,
}

const MOST_IN_A_LEAF = 4u;

// The same after `count` triangles from `first`, at most four.
fn nearest_in_leaf(nearest: Nearest, ray: ShearedRay, first: u32, count: u32) -> Nearest {
    var found = nearest;
    for (var i = 0u; i < MOST_IN_A_LEAF; i++) {
        if i >= count {
            break;
        }
        let triangle = triangles[first + i];
        let hit = triangle_hit(ray, triangle.first, triangle.second, triangle.third);
        if hit.found && hit.distance >= 0.0 && hit.distance < found.distance {
            found = Nearest(hit.distance, hit.weights, first + i);
        }
    }
    return found;
}

// What a ray meets; `texel` as of `triangle_surface`.
fn nearest_hit(nearest: Nearest, ray: Ray, texel: vec2f) -> Hit {
    if !(nearest.distance < 1e30) {
        return no_hit(ray, texel);
    }
    return triangle_surface(ray, nearest.triangle, nearest.weights, texel);
}
