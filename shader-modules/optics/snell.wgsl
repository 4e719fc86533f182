// Refraction of a direction at a surface, in vectors.
// The tangential part of the direction times the refractive index is the same on both sides
// (Snell's law); unit vectors, no angles.
//
// domain: refracted(incident unit, normal unit, index 0.4 to 2.5 near sine(incident, normal)) against refraction

// `direction` is zero where all light is reflected.
struct Refraction {
    direction: vec3f,
    total: bool,
}

// `index`: refractive index behind the surface relative to that before it. `normal` may point to
// either side.
fn refracted(incident: vec3f, normal: vec3f, index: f32) -> Refraction {
    let facing = normal * select(1.0, -1.0, dot(incident, normal) > 0.0);
    let along = incident - dot(incident, facing) * facing;
    let tangential = along / index;
    let rest = 1.0 - dot(tangential, tangential);
    if rest <= 0.0 {
        return Refraction(vec3f(0.0), true);
    }
    return Refraction(normalize(tangential - sqrt(rest) * facing), false);
}
