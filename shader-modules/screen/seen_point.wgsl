// A solid point that was drawn behind the water.

// `object` is −1 where nothing was seen; the rest means nothing then. `edge`: whether a texel
// that is almost as near to the place shows another object, so that it is not certain which one is
// seen there.
struct Seen {
    position: vec3f,
    normal: vec3f,
    shading_normal: vec3f,
    object: f32,
    edge: bool,
}

// How far from the place, along each axis, texels count as almost as near: less than half a texel,
// because an edge beyond the nearest texel's own centre is more likely than not farther away.
const EDGE_REACH = 0.4;
