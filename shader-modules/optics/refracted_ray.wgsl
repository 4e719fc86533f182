// True refraction at the water's surface; where all light is reflected, the mirrored ray.
// Snell's law in vectors; world space, unit directions.
//
// provides: deflect
// needs: geometry/ray, optics/deflected, optics/snell, water/body
// domain: deflect(normal unit)
// identity when not waves and not camera_submerged: within 0.01 px

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    let behind = refracted(incident.direction, normal, water.relative_index);
    if behind.total {
        return Deflected(Ray(incident.origin, reflect(incident.direction, normal)), true);
    }
    return Deflected(Ray(incident.origin, behind.direction), false);
}
