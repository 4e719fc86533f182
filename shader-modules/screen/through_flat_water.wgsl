// Where a world point appears in the seen buffers through flat water, in texels.
// Liu, Han, Fei 2020 (corrected): the same transform as the broad phase, then the camera.
//
// provides: reproject
// needs: screen/seen_view, optics/flat_water
// domain: reproject(point -1e4 to 1e4 from 1e-6)
// identity when not waves: within 0.01 px

fn reproject(point: vec3f) -> vec2f {
    return view_pixel(view_seen(), apparent_point(point, view_target.eye)).xy;
}
