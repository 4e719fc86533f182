// Where a world point (metres) appears in the seen buffers, in texels.
// By default straight ahead, as in a picture without refraction.
//
// needs: screen/seen_view

fn reproject(point: vec3f) -> vec2f {
    return view_pixel(view_seen(), point).xy;
}
