// The solid point seen at a place of the seen buffers, from one texel that holds its plane.
// The point is where the ray that flat water deflects towards this very place meets the plane: no
// interpolation, and one load (more only where it matters whether an edge is near). World space,
// metres; texels with centres at half integers.
//
// provides: seen
// needs: geometry/octahedral, screen/neighbours, screen/seen_point, screen/seen_through
// number edge_reach: 0 to 1 texel, step 0.05
// number neighbours: 0 to 24, step 1
// domain: seen(texel -100 to 1e4)

// How far from the place, along each axis, texels count as almost as near. Less than half a texel:
// an edge beyond the nearest texel's own centre is more likely than not farther away.
override edge_reach: f32 = 0.4;

// How many texels around one that shows nothing are asked in its place.
override neighbours: i32 = 24;

// x: the bits of the plane's distance from the eye along its normal, metres. y, z: the geometric
// and the shading normal, octahedral, as pairs of 16-bit numbers. w: object id + 1, 0 for none.
var seen_plane: texture_2d<u32>;

fn seen(texel: vec2f) -> Seen {
    let last = vec2i(textureDimensions(seen_plane)) - 1;
    let middle = vec2i(floor(texel));
    var plane = vec4u(0u);
    for (var i = 0; i <= min(neighbours, NEIGHBOURS); i++) {
        let step = select(neighbour(i - 1), vec2i(0), i == 0);
        plane = textureLoad(seen_plane, clamp(middle + step, vec2i(0), last), 0);
        if plane.w != 0u {
            break;
        }
    }
    var edge = false;
    for (var i = 0; i < 4; i++) {
        let beside = texel + edge_reach * (2.0 * vec2f(f32(i & 1), f32(i >> 1u)) - 1.0);
        let other = textureLoad(seen_plane, clamp(vec2i(floor(beside)), vec2i(0), last), 0);
        edge |= other.w != plane.w;
    }
    let normal = octahedral_decoded(unpack2x16snorm(plane.y));
    let shading_normal = octahedral_decoded(unpack2x16snorm(plane.z));
    let position = seen_through(texel, normal, bitcast<f32>(plane.x));
    return Seen(position, normal, shading_normal, f32(plane.w) - 1.0, edge);
}
