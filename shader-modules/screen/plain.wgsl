// Where a world point appears in the seen buffers without refraction, in texels.
//
// provides: reproject
// needs: screen/seen_view
// domain: reproject(point -1e4 to 1e4 from 1e-6)

fn reproject(point: vec3f) -> vec2f {
    return view_pixel(view_seen(), point).xy;
}
