// What was drawn of the far side of the water: positions, normals and ids.
// World space, metres; texels with centres at half integers. Where nothing was drawn the id is −1.
//
// needs: geometry/octahedral, screen/neighbours, screen/seen_point
// domain: seen_at(texel -100 to 1e4, neighbours 0 to 24)

var seen_position: texture_2d<f32>;
var seen_normal: texture_2d<f32>;

// The point seen at a place of the seen buffers, clamped to them; at the water's edge, where the
// nearest texel may show nothing, that of one of so many neighbours. The position is bilinear over the texels
// that show the same object; the normals are the nearest texel's.
fn seen_at(texel: vec2f, neighbours: i32) -> Seen {
    let last = vec2i(textureDimensions(seen_position)) - 1;
    var nearest = clamp(vec2i(floor(texel)), vec2i(0), last);
    var kept = textureLoad(seen_position, nearest, 0);
    for (var i = 0; i < min(neighbours, NEIGHBOURS) && kept.w < 0.0; i++) {
        nearest = clamp(vec2i(floor(texel)) + neighbour(i), vec2i(0), last);
        kept = textureLoad(seen_position, nearest, 0);
    }
    let corner = floor(texel - 0.5);
    let part = clamp(texel - 0.5 - corner, vec2f(0.0), vec2f(1.0));
    var sum = vec4f(0.0);
    var edge = false;
    for (var i = 0; i < 4; i++) {
        let step = vec2i(i & 1, i >> 1u);
        let point = textureLoad(seen_position, clamp(vec2i(corner) + step, vec2i(0), last), 0);
        let weights = select(1.0 - part, part, step == vec2i(1));
        let weight = weights.x * weights.y * f32(point.w == kept.w);
        let beside = abs(vec2f(vec2i(corner) + step) + 0.5 - texel) < vec2f(0.5 + EDGE_REACH);
        edge |= all(beside) && point.w != kept.w;
        sum += weight * vec4f(point.xyz - kept.xyz, 1.0);
    }
    let normals = textureLoad(seen_normal, nearest, 0);
    return Seen(
        kept.xyz + sum.xyz / max(sum.w, 1e-6),
        octahedral_decoded(normals.xy),
        octahedral_decoded(normals.zw),
        kept.w,
        edge,
    );
}
