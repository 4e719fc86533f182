// Copies a picture: what engines call grabbing the opaque scene.
// Outputs: `colour` linear RGB; `shown` the world point (metres) and object id of that colour.
//
// skeleton: screen
// outputs: colour, shown

var source: texture_2d<f32>;
var shown_of_source: texture_2d<f32>;

fn screen(pixel: vec2f) -> vec2i {
    return vec2i(pixel);
}

fn keep(texel: vec2i) -> bool {
    return true;
}

fn write_colour(texel: vec2i) -> vec4f {
    return textureLoad(source, texel, 0);
}

fn write_shown(texel: vec2i) -> vec4f {
    return textureLoad(shown_of_source, texel, 0);
}
