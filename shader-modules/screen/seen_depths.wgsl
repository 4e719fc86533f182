// The solid point seen at a place of the seen buffers, from a depth buffer, normals and ids.
// The depth tells where the nearest texel's point appears; undone, flat water's transform tells where it is, and
// so its tangent plane. World space, metres; texels with centres at half integers.
//
// provides: seen
// needs: geometry/octahedral, screen/neighbours, screen/seen_point, screen/seen_through, screen/seen_view, water/body
// number edge_reach: 0 to 1 texel, step 0.05
// domain: seen(texel -100 to 1e4)

override edge_reach: f32 = 0.4;

// Reversed depth: near / distance along the view's axis, 0 where nothing is.
var seen_depth: texture_depth_2d;
var seen_normal: texture_2d<f32>;
// Object id + 1, 0 for none.
var seen_object: texture_2d<f32>;

// The point that appears at a place, at a distance along the ray's direction, through flat water.
fn unbent(appears: vec3f, direction: vec3f) -> vec3f {
    let below = water.camera_side * (water.level - appears.z);
    let n = water.larger_index;
    let m = water.root_high;
    // From the tangent t of the appearing angle, as the crossing's `shrink`: √(N² + M t²) from the side of the
    // lower index, √(1 − M t²) / N from the other, with M = N² − 1. With s = 1 / √(1 + t²) the latter is
    // √((N s − √M) (N s + √M)) / (N s), of which only one part cancels, at the critical angle.
    let steep = max(abs(direction.z), 1e-6);
    let tangent = length(direction.xy) / steep;
    let from_low = sqrt(n * n + m * tangent * (m * tangent));
    let from_high = sqrt(max((n * steep - m) * (n * steep + m), 1e-12)) / (n * steep);
    let ratio = select(from_high, from_low, water.relative_index >= 1.0);
    return vec3f(appears.xy, water.level - water.camera_side * below * select(1.0, ratio, below > 0.0));
}

fn seen(texel: vec2f) -> Seen {
    let last = vec2i(textureDimensions(seen_object)) - 1;
    let middle = vec2i(floor(texel));
    var nearest = clamp(middle, vec2i(0), last);
    var object = textureLoad(seen_object, nearest, 0).x;
    for (var i = 0; i < NEIGHBOURS && object == 0.0; i++) {
        nearest = clamp(middle + neighbour(i), vec2i(0), last);
        object = textureLoad(seen_object, nearest, 0).x;
    }
    var edge = false;
    for (var i = 0; i < 4; i++) {
        let beside = texel + edge_reach * (2.0 * vec2f(f32(i & 1), f32(i >> 1u)) - 1.0);
        edge |= textureLoad(seen_object, clamp(vec2i(floor(beside)), vec2i(0), last), 0).x != object;
    }
    let view = view_seen();
    let ray = view_ray(view, vec2f(nearest) + 0.5);
    let depth = view.near / max(textureLoad(seen_depth, nearest, 0), 1e-9);
    let appears = ray.origin + depth / max(dot(ray.direction, view.forward), 1e-6) * ray.direction;
    let normals = textureLoad(seen_normal, nearest, 0);
    let normal = octahedral_decoded(normals.xy);
    let distance = dot(normal, unbent(appears, ray.direction) - ray.origin);
    let position = seen_through(texel, normal, distance);
    return Seen(position, normal, octahedral_decoded(normals.zw), object - 1.0, edge);
}
