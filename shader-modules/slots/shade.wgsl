// The light that a surface point gives off, linear RGB. By default its normal as a colour.
//
// needs: shading/surface_point

fn shade(point: SurfacePoint) -> vec3f {
    return 0.5 + 0.5 * point.normal;
}
