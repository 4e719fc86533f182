// The solid point seen at a place of the seen buffers, from one texel that holds its plane.
// The point is where the ray that flat water deflects towards this very place meets the plane: no
// interpolation, and one load (more only where it matters whether an edge is near). World space, metres; texels with centres at half integers.
//
// provides: seen
// needs: geometry/octahedral, geometry/ray, screen/neighbours, screen/seen_point, screen/seen_view, water/body
// slots: deflect
// number edge_reach: 0 to 1 texel, step 0.05
// domain: seen(texel -100 to 1e4)

// How far from the place, along each axis, texels count as almost as near. Less than half a texel:
// an edge beyond the nearest texel's own centre is more likely than not farther away.
override edge_reach: f32 = 0.4;

// x: the bits of the plane's distance from the eye along its normal, metres. y, z: the geometric
// and the shading normal, octahedral, as pairs of 16-bit numbers. w: object id + 1, 0 for none.
var seen_plane: texture_2d<u32>;

fn seen(texel: vec2f) -> Seen {
    let last = vec2i(textureDimensions(seen_plane)) - 1;
    let middle = vec2i(floor(texel));
    var plane = textureLoad(seen_plane, clamp(middle, vec2i(0), last), 0);
    for (var i = 0; i < NEIGHBOURS && plane.w == 0u; i++) {
        plane = textureLoad(seen_plane, clamp(middle + neighbour(i), vec2i(0), last), 0);
    }
    var edge = false;
    for (var i = 0; i < 4; i++) {
        let beside = texel + edge_reach * (2.0 * vec2f(f32(i & 1), f32(i >> 1u)) - 1.0);
        let other = textureLoad(seen_plane, clamp(vec2i(floor(beside)), vec2i(0), last), 0);
        edge |= other.w != plane.w;
    }
    let normal = octahedral_decoded(unpack2x16snorm(plane.y));
    let shading_normal = octahedral_decoded(unpack2x16snorm(plane.z));
    let ray = view_ray(view_seen(), texel);
    // Level rays never meet the plane of the water; they are bent as if they just did.
    let fall = max(-water.camera_side * ray.direction.z, 1e-6);
    let way = max(water.camera_side * (ray.origin.z - water.level), 0.0) / fall;
    let crossing = ray.origin + min(way, 1e6) * ray.direction;
    let behind = deflect(Ray(crossing, ray.direction), vec3f(0.0, 0.0, 1.0)).ray;
    let slope = dot(normal, behind.direction);
    let offset = bitcast<f32>(plane.x) - dot(normal, crossing - ray.origin);
    let reach = offset / select(slope, 1e-6, abs(slope) < 1e-6);
    var position = crossing + min(reach, 1e6) * behind.direction;
    // Before the rest plane, under a crest, there is nothing that bends the ray.
    if reach < 0.0 {
        let straight = dot(normal, ray.direction);
        let before = bitcast<f32>(plane.x) / select(straight, 1e-6, abs(straight) < 1e-6);
        position = ray.origin + clamp(before, 0.0, way) * ray.direction;
    }
    return Seen(position, normal, shading_normal, f32(plane.w) - 1.0, edge);
}
