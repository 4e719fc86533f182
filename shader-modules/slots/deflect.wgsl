// How a ray goes on behind the water. `incident`: where it meets the water (world space, metres)
// and its direction; `normal`: the water's, unit, upwards. By default it goes straight on.
//
// needs: geometry/ray, optics/deflected

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    return Deflected(incident, false);
}
