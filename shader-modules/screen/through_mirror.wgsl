// Where a world point (metres) appears in flat water as in a mirror, in texels of the seen buffers.
//
// provides: reproject
// needs: optics/mirrored_point, screen/seen_view
// domain: reproject(point -1e4 to 1e4 from 1e-6)

fn reproject(point: vec3f) -> vec2f {
    return view_pixel(view_seen(), mirrored_point(point)).xy;
}
