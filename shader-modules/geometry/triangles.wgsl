// The triangles of the scene, and their surfaces. World space, metres.
//
// needs: geometry/hit, geometry/octahedral, geometry/ray
// domain: the triangles of a scene, coordinates to 1e6 m

// Corners, the object's id, and the shading normals at the corners, octahedral in 16 bits each.
struct Triangle {
    first: vec3f,
    object: u32,
    second: vec3f,
    first_normal: u32,
    third: vec3f,
    second_normal: u32,
    third_normal: u32,
}

var<storage, read> triangles: array<Triangle>;

fn corner_normal(packed: u32) -> vec3f {
    return octahedral_decoded(unpack2x16snorm(packed));
}

// The hit of a ray at a point of a triangle, given by the barycentric weights of the corners.
// Without a `texel`, which stays the one given, for the caller to replace.
fn triangle_surface(ray: Ray, index: u32, weights: vec3f, texel: vec2f) -> Hit {
    let triangle = triangles[index];
    let position = triangle.first * weights.x + triangle.second * weights.y + triangle.third * weights.z;
    let across = cross(triangle.second - triangle.first, triangle.third - triangle.first);
    let normal = across / max(length(across), 1e-30);
    let between = corner_normal(triangle.first_normal) * weights.x
        + corner_normal(triangle.second_normal) * weights.y
        + corner_normal(triangle.third_normal) * weights.z;
    let size = length(between);
    // Normals that cancel each other have no direction to give.
    let shading_normal = select(normal, between / max(size, 1e-6), size > 1e-6);
    return Hit(position, normal, shading_normal, f32(triangle.object), texel, 0.0, true, ray.direction);
}
