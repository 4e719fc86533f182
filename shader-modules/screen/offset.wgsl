// What engines do for refraction: a shift on the screen in proportion to how deep the water is.
// The ray is taken as far as what was drawn at the pixel itself lies behind the water, in depth
// along `forward`, and projected. The foreground test: where the shifted texel shows what is not
// behind the water, the pixel itself is shown instead. World space, metres; texels.
// Normals and id are not known: for fillings of `colour` that fetch what was drawn at the texel.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, screen/drawn, screen/seen_view
// slots: side
// requires: reproject = screen/plain, colour = screen/resampled
// domain: intersect(ray.origin seen 0.1 to 1e4, texel -100 to 1e4)

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    let view = view_seen();
    let depth = dot(ray.origin - view.eye, view.forward);
    let there = drawn_about(vec2i(floor(texel)));
    if there <= 0.0 {
        return no_hit(ray, texel);
    }
    let behind = max(1.0 / there - depth, 0.0);
    let position = ray.origin + behind / max(dot(ray.direction, view.forward), 0.05) * ray.direction;
    let shifted = view_pixel(view, position).xy;
    let beside = drawn(vec2i(floor(shifted)));
    let seen = view_ray(view, shifted).direction;
    let reach = 1.0 / max(beside, 1e-9) / dot(seen, view.forward);
    let kept = beside > 0.0 && side(view.eye + reach * seen);
    let shown_at = select(texel, shifted, kept);
    return Hit(position, vec3f(0.0), vec3f(0.0), -1.0, shown_at, 0.0, true, ray.direction);
}
