// What was drawn at a texel, told by the depths in `seen_depth`.
// As 1 / depth along `forward` (1/m), 0 where nothing was drawn: on the screen that is linear over a
// plane. Texels with centres at half integers; those outside are the nearest ones inside.
//
// needs: screen/neighbours, screen/target
// domain: drawn(texel -100 to 1e4)
// domain: drawn_between(texel -100 to 1e4)
// domain: drawn_about(texel -100 to 1e4)

var seen_depth: texture_depth_2d;

fn drawn(texel: vec2i) -> f32 {
    let last = vec2i(textureDimensions(seen_depth)) - 1;
    return textureLoad(seen_depth, clamp(texel, vec2i(0), last), 0) / view_target.near;
}

// The same between texels; exact on planes.
fn drawn_between(texel: vec2f) -> f32 {
    let corner = vec2i(floor(texel - 0.5));
    let part = texel - 0.5 - floor(texel - 0.5);
    let upper = mix(drawn(corner), drawn(corner + vec2i(1, 0)), part.x);
    let lower = mix(drawn(corner + vec2i(0, 1)), drawn(corner + vec2i(1, 1)), part.x);
    return mix(upper, lower, part.y);
}

// What was drawn at a texel or, where nothing was, at the nearest neighbour where something was.
fn drawn_about(texel: vec2i) -> f32 {
    var found = drawn(texel);
    for (var i = 0; i < NEIGHBOURS && found <= 0.0; i++) {
        found = drawn(texel + neighbour(i));
    }
    return found;
}
