// Mirror reflection at the water's surface, whatever the angle. World space, unit directions.
//
// provides: deflect
// needs: geometry/ray, optics/deflected
// domain: deflect(normal unit)

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    return Deflected(Ray(incident.origin, reflect(incident.direction, normal)), true);
}
