// Snell vertex transform: a point behind flat water stands on the vertical through it where the
// straightened camera ray passes. Liu, Han, Fei 2020, broad phase; world space, metres.
//
// provides: place
// appears: on its vertical
// needs: optics/flat_water, screen/target
// domain: place(point -1e4 to 1e4 from 1e-6)

fn place(point: vec3f) -> vec3f {
    return apparent_point(point, view_target.eye);
}
