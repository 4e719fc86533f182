// A ray's line on the screen, for marches along it.
// McGuire & Mara 2014, "Efficient GPU Screen-Space Ray Tracing", JCGT 3(4): what is linear along the
// line is 1 / depth. World space, metres; depth along `forward`; texels. Valid only where world rays
// are straight on the screen.
//
// needs: geometry/ray, geometry/hit, screen/camera, screen/drawn, screen/leaving, screen/seen_view
// domain: rays from points that the picture shows

// From 0 (the ray's origin) to 1.
struct March {
    texel: vec2f,
    way: vec2f,
    // 1 / depth at 0, and what it gains until 1.
    inverse_depth: f32,
    gain: f32,
    // The ray's length until 1, metres.
    length: f32,
    // The part, from 0, that stays within the buffers.
    inside: f32,
}

// The line of a ray that is followed for `reach` metres; one that comes back, to the near plane.
fn march_of(ray: Ray, reach: f32) -> March {
    let view = view_seen();
    let ends = view_ends(view, ray, reach);
    let first = view_pixel(view, ray.origin).xy;
    let last = view_at_depth(view, ray.origin + ends.far * ray.direction, ends.depths.y);
    let inverse = 1.0 / ends.depths;
    var march = March(first, last - first, inverse.x, inverse.y - inverse.x, ends.far, 1.0);
    march.inside = leaving_part(march.texel, march.way, vec2f(0.0), vec2f(textureDimensions(seen_depth)));
    return march;
}

// What of the line is one texel along the axis on which it is longer.
fn march_texel(march: March) -> f32 {
    return 1.0 / max(max(abs(march.way.x), abs(march.way.y)), 1.0);
}

// How far the middle of the first texel is along the line, in texels, −½ to ½.
fn march_to_middle(march: March) -> f32 {
    let along_x = abs(march.way.x) >= abs(march.way.y);
    let first = select(march.texel.y, march.texel.x, along_x);
    let back = select(march.way.y, march.way.x, along_x) < 0.0;
    let ahead = floor(first) + 0.5 - first;
    return select(ahead, -ahead, back);
}

fn march_at(march: March, part: f32) -> vec2i {
    return vec2i(floor(march.texel + part * march.way));
}

// Whether depths that the ray has between two places overlap a surface that was drawn and goes on
// behind its front for `thickness`.
fn march_meets(march: March, before: f32, after: f32, there: f32, thickness: f32) -> bool {
    let ends = march.inverse_depth + march.gain * vec2f(before, after);
    let behind = min(ends.x, ends.y) <= there;
    return behind && there <= max(ends.x, ends.y) * (1.0 + thickness * there);
}

// The hit of a ray that passed behind what was drawn between two places: some bisections, then a
// secant step. Both sides are linear in the march where a plane was drawn: it is exact there, also a
// little outside of the two texels that were compared.
fn march_hit(ray: Ray, march: March, first: f32, last: f32, bisections: i32) -> Hit {
    var before = first;
    var after = last;
    for (var i = 0; i < bisections; i++) {
        let middle = 0.5 * (before + after);
        let behind = march.inverse_depth + march.gain * middle <= drawn(march_at(march, middle));
        before = select(middle, before, behind);
        after = select(after, middle, behind);
    }
    let start = march.inverse_depth + march.gain * before - drawn_between(march.texel + before * march.way);
    let end = march.inverse_depth + march.gain * after - drawn_between(march.texel + after * march.way);
    let secant = select(0.5, start / (start - end), start - end > 1e-9);
    let part = clamp(mix(before, after, clamp(secant, -1.0, 2.0)), 0.0, march.inside);
    // t / depth is linear along the march, too.
    let inverse = march.inverse_depth + march.gain;
    let t = part * march.length * inverse / (march.inverse_depth + march.gain * part);
    let position = ray.origin + t * ray.direction;
    return Hit(position, vec3f(0.0), vec3f(0.0), -1.0, march.texel + part * march.way, 0.0, true, ray.direction);
}

// What a ray shows that met nothing: where it left the buffers, what is at their edge, which is the
// nearest to it; else the pixel itself.
fn march_missed(ray: Ray, march: March, left: bool, texel: vec2f) -> Hit {
    let edge = leaving_place(march.texel, march.way, vec2f(0.0), vec2f(textureDimensions(seen_depth)));
    let shown_at = select(texel, edge, left);
    let shows = drawn_about(vec2i(floor(shown_at))) > 0.0;
    return Hit(ray.origin, vec3f(0.0), vec3f(0.0), -1.0, shown_at, 0.0, shows, ray.direction);
}
