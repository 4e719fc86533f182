// A solid point that was drawn behind the water.

// `object` is −1 where nothing was seen; the rest means nothing then.
struct Seen {
    position: vec3f,
    normal: vec3f,
    shading_normal: vec3f,
    object: f32,
}
