// What engines do for refraction: the camera's ray goes on, sheared by the tilt of the water's
// normal. For a small tilt and a look straight down, `strength` 1 − 1/n ≈ 0.25 is how far waves turn
// the ray; flat water does not bend it at all. World space; the direction's part along the camera's
// ray keeps its length, so that it is no unit vector.
//
// provides: deflect
// needs: geometry/ray, optics/deflected
// number strength: 0 to 4, step 0.05

override strength: f32 = 0.25;

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    let shear = -strength * vec3f(normal.xy, 0.0) / max(normal.z, 1e-3);
    return Deflected(Ray(incident.origin, incident.direction + shear), false);
}
