// The published deflection, applied to the ray that flat water refracts: turned as the flat normal
// is turned to become the wave's. Liu, Han, Fei 2020, section 3.2. This is not refraction: per
// radian of tilt the ray turns by 1 instead of 1 − cos α / (n cos β). Kept for comparison.
//
// provides: deflect
// needs: geometry/ray, geometry/rotation, optics/deflected, optics/snell, water/body
// domain: deflect(normal unit)
// identity when not waves and not camera_submerged: within 0.01 px

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    let up = vec3f(0.0, 0.0, 1.0);
    let flat = refracted(incident.direction, up, water.relative_index);
    if flat.total {
        return Deflected(Ray(incident.origin, reflect(incident.direction, up)), true);
    }
    return Deflected(Ray(incident.origin, rotate_between(flat.direction, up, normal)), false);
}
