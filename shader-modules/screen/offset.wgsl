// What engines do for refraction: a shift on the screen in proportion to how deep the water is.
// The ray is taken as far as what was drawn at the pixel itself lies behind the water, in depth
// along `forward`, and projected. The foreground test: where the shifted texel shows what is not
// behind the water, the pixel itself is shown instead. World space, metres; texels.
// Normals and id are not known: for fillings of `colour` that fetch what was drawn at the texel.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, screen/neighbours, screen/seen_view
// slots: side
// requires: reproject = screen/plain, colour = screen/resampled
// domain: intersect(texel -100 to 1e4)

var seen_depth: texture_depth_2d;

// What was drawn at a texel: near plane / depth, 0 where nothing was.
fn offset_drawn(texel: vec2f) -> f32 {
    let last = vec2i(textureDimensions(seen_depth)) - 1;
    return textureLoad(seen_depth, clamp(vec2i(floor(texel)), vec2i(0), last), 0);
}

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    let view = view_seen();
    let depth = dot(ray.origin - view.eye, view.forward);
    var drawn = offset_drawn(texel);
    for (var i = 0; i < NEIGHBOURS && drawn <= 0.0; i++) {
        drawn = offset_drawn(texel + vec2f(neighbour(i)));
    }
    if drawn <= 0.0 {
        return no_hit(ray, texel);
    }
    let behind = max(view.near / drawn - depth, 0.0);
    let position = ray.origin + behind / max(dot(ray.direction, view.forward), 0.05) * ray.direction;
    let shifted = view_pixel(view, position).xy;
    let there = offset_drawn(shifted);
    let seen = view_ray(view, shifted).direction;
    let reach = view.near / max(there, 1e-9) / dot(seen, view.forward);
    let kept = there > 0.0 && side(view.eye + reach * seen);
    let shown_at = select(texel, shifted, kept);
    return Hit(position, vec3f(0.0), vec3f(0.0), -1.0, shown_at, 0.0, true, ray.direction);
}
