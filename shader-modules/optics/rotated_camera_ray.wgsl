// The published deflection, to the letter: the camera's ray is turned as the flat normal is turned
// to become the wave's. Liu, Han, Fei 2020, section 3.2. It needs apparent positions in the seen
// buffers, since the ray is not refracted. Kept for comparison.
//
// provides: deflect
// needs: geometry/ray, geometry/rotation, optics/deflected
// domain: deflect(normal unit)

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    let up = vec3f(0.0, 0.0, 1.0);
    return Deflected(Ray(incident.origin, rotate_between(incident.direction, up, normal)), false);
}
