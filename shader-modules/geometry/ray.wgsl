// A ray in world space.

// A point on the ray (metres) and its unit direction of travel.
struct Ray {
    origin: vec3f,
    direction: vec3f,
}
