// Where a ray meets a triangle, without leaks between neighbours.
// Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection", JCGT 2(1): space is sheared so
// that the ray becomes the z axis; signs of the edge functions then agree between triangles that
// share an edge. A sign that rounding lost counts as inside, for either neighbour. Both faces are
// met. World space, metres. Triangles seen from the side, or so large or far that areas overflow,
// are not met; nothing that is met is infinite or undefined.
//
// needs: geometry/ray
// domain: sheared_ray()

// A ray made ready for many tests: z is the axis that its direction is longest along.
struct ShearedRay {
    origin: vec3f,
    // How the axes are turned: 0, 1 or 2 places.
    turn: i32,
    shear: vec3f,
}

// `distance`: along the ray, metres; negative behind its origin. `weights`: barycentric.
struct TriangleHit {
    distance: f32,
    weights: vec3f,
    found: bool,
}

// The components so that the one of the longest axis is the last.
fn turned(v: vec3f, turn: i32) -> vec3f {
    return select(select(v.zxy, v.yzx, turn == 1), v, turn == 0);
}

fn sheared_ray(ray: Ray) -> ShearedRay {
    let size = abs(ray.direction);
    let x_longest = size.x > size.y && size.x > size.z;
    let turn = select(select(0, 2, size.y > size.z), 1, x_longest);
    let direction = turned(ray.direction, turn);
    return ShearedRay(ray.origin, turn, vec3f(direction.xy, 1.0) / direction.z);
}

fn triangle_hit(ray: ShearedRay, first: vec3f, second: vec3f, third: vec3f) -> TriangleHit {
    let first_from = turned(first - ray.origin, ray.turn);
    let second_from = turned(second - ray.origin, ray.turn);
    let third_from = turned(third - ray.origin, ray.turn);
    let a = first_from.xy - ray.shear.xy * first_from.z;
    let b = second_from.xy - ray.shear.xy * second_from.z;
    let c = third_from.xy - ray.shear.xy * third_from.z;
    let edges = vec3f(c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
    let least = min(min(edges.x, edges.y), edges.z);
    let most = max(max(edges.x, edges.y), edges.z);
    let area = edges.x + edges.y + edges.z;
    let weights = edges / area;
    let distance = ray.shear.z * dot(weights, vec3f(first_from.z, second_from.z, third_from.z));
    // Comparisons with what is undefined are false.
    let inside = (least >= 0.0 || most <= 0.0) && abs(area) > 0.0 && abs(area) < 1e38;
    return TriangleHit(distance, weights, inside && abs(distance) < 1e30);
}
