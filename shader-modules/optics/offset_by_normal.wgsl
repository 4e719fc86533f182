// What engines do for refraction: the camera's ray goes on, sheared by the tilt of the water's
// normal. `strength` 1 − 1/n, about 0.25, is how far waves turn a ray that looks straight down; flat
// water does not bend it at all. World space, unit directions.
//
// provides: deflect
// needs: geometry/ray, optics/deflected
// number strength: 0 to 4, step 0.05
// domain: deflect(normal unit)

override strength: f32 = 0.25;

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    let shear = strength * vec3f(normal.xy, 0.0) / max(normal.z, 1e-3);
    let sheared = incident.direction - shear;
    let size = length(sheared);
    let direction = select(incident.direction, sheared / max(size, 1e-6), size > 1e-6);
    return Deflected(Ray(incident.origin, direction), false);
}
