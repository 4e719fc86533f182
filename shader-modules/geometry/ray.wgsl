// A ray in world space.
//
// domain: Ray(origin -1e4 to 1e4 from 1e-6, direction unit)

// A point on the ray (metres) and its unit direction of travel.
struct Ray {
    origin: vec3f,
    direction: vec3f,
}
