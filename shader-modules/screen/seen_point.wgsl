// A solid point that was drawn behind the water.

// `object` is −1 where nothing was seen; the rest means nothing then. `edge`: whether the four texels
// around the place show more than one object, so that it is not certain which one is seen there.
struct Seen {
    position: vec3f,
    normal: vec3f,
    shading_normal: vec3f,
    object: f32,
    edge: bool,
}
