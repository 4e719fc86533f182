// Where a ray first passes behind what was drawn: a march along its line on the screen.
// McGuire & Mara 2014, "Efficient GPU Screen-Space Ray Tracing", JCGT 3(4): a perspective-correct
// DDA (what is linear along the line is 1 / depth), a hit where the depths that the ray has within
// a step overlap the drawn surface and its thickness, then bisection. World space, metres; depth
// along `forward`; texels. Valid only where world rays are straight on the screen.
// A ray that leaves the buffers shows what is where it does so; one that goes on behind something
// until its end, or comes back to the camera's side, shows the pixel itself. Normals and id are not known: for
// fillings of `colour` that fetch what was drawn at the texel.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, screen/neighbours, screen/seen_view, screen/target, water/body
// requires: reproject = screen/plain, colour = screen/resampled
// number thickness: 0 to 100 m, step 0.05
// number stride: 1 to 64 px, step 1
// number jitter: 0 to 1, step 0.1
// number march_steps: 1 to 4096, step 64
// number refinements: 0 to 12, step 1
// number reach: 0.1 to 1000 m, step 1
// domain: intersect(texel -100 to 1e4)

var seen_depth: texture_depth_2d;

// How far every drawn surface is taken to go on behind its front.
override thickness: f32 = 0.1;
override stride: f32 = 1.0;
// The part of a step by which pixels' marches begin apart.
override jitter: f32 = 0.0;
override march_steps: i32 = 1024;
// Bisections of the step in which the ray passed behind; more than log₂(stride) gain nothing.
override refinements: i32 = 0;
// How far the ray is followed.
override reach: f32 = 30.0;

// The ray on the screen, from 0 (its origin) to 1.
struct March {
    texel: vec2f,
    way: vec2f,
    // 1 / depth at 0, and what it gains until 1.
    inverse_depth: f32,
    gain: f32,
}

// A number in [0, 1) that differs between neighbouring texels.
// Jimenez 2014, "Next Generation Post Processing in Call of Duty", interleaved gradient noise.
fn march_noise(texel: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(floor(texel), vec2f(0.06711056, 0.00583715))));
}

// 1 / depth of what was drawn at a texel, 0 where nothing was.
fn march_drawn(texel: vec2i) -> f32 {
    let last = vec2i(textureDimensions(seen_depth)) - 1;
    return textureLoad(seen_depth, clamp(texel, vec2i(0), last), 0) / view_target.near;
}

// The same between texels; exact on planes.
fn march_drawn_between(texel: vec2f) -> f32 {
    let corner = vec2i(floor(texel - 0.5));
    let part = texel - 0.5 - floor(texel - 0.5);
    let upper = mix(march_drawn(corner), march_drawn(corner + vec2i(1, 0)), part.x);
    let lower = mix(march_drawn(corner + vec2i(0, 1)), march_drawn(corner + vec2i(1, 1)), part.x);
    return mix(upper, lower, part.y);
}

// The part of the march, from 0, that stays within the buffers.
fn march_inside(march: March) -> f32 {
    let bound = select(vec2f(0.0), vec2f(textureDimensions(seen_depth)), march.way > vec2f(0.0));
    let still = abs(march.way) < vec2f(1e-6);
    let crossings = (bound - march.texel) / select(march.way, vec2f(1.0), still);
    let parts = select(crossings, vec2f(1.0), still);
    return clamp(min(parts.x, parts.y), 0.0, 1.0);
}

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    // A ray that comes back is followed as far as the near plane.
    let view = view_seen();
    let depth = dot(ray.origin - view.eye, view.forward);
    let fall = -dot(ray.direction, view.forward);
    let far = min(reach, max(depth - view.near, 1e-3) / max(fall, 1e-6));
    let first = view_pixel(view, ray.origin);
    let last = view_pixel(view, ray.origin + far * ray.direction);
    let inverse = 1.0 / vec2f(max(first.z, 1e-6), max(last.z, 1e-6));
    let march = March(first.xy, last.xy - first.xy, inverse.x, inverse.y - inverse.x);
    let inside = march_inside(march);
    let longest = max(abs(march.way.x), abs(march.way.y));
    let step = stride / max(longest, 1.0);
    var at = step * jitter * march_noise(texel);
    var before = 0.0;
    var after = 0.0;
    var met = false;
    // Every step covers what lies between the middles of the gaps to its neighbours.
    // Light that the water reflects meets nothing that was drawn.
    let returns = water.camera_side * ray.direction.z > 0.0;
    let steps = select(march_steps, 0, returns);
    for (var i = 0; i < steps && !met; i++) {
        if before >= inside {
            break;
        }
        after = min(at + 0.5 * step, inside);
        let ends = march.inverse_depth + march.gain * vec2f(before, after);
        let drawn = march_drawn(vec2i(floor(march.texel + at * march.way)));
        let behind = min(ends.x, ends.y) <= drawn;
        met = behind && drawn <= max(ends.x, ends.y) * (1.0 + thickness * drawn);
        before = select(after, before, met);
        at += step;
    }
    if !met {
        // Where the ray leaves the buffers, what is at their edge is the nearest to it.
        let left = inside < 1.0 && before >= inside;
        let shown_at = select(texel, march.texel + inside * march.way, left);
        var shows = march_drawn(vec2i(floor(shown_at))) > 0.0;
        for (var i = 0; i < NEIGHBOURS && !shows; i++) {
            shows = march_drawn(vec2i(floor(shown_at)) + neighbour(i)) > 0.0;
        }
        return Hit(ray.origin, vec3f(0.0), vec3f(0.0), -1.0, shown_at, 0.0, shows, ray.direction);
    }
    for (var i = 0; i < refinements; i++) {
        let middle = 0.5 * (before + after);
        let drawn = march_drawn(vec2i(floor(march.texel + middle * march.way)));
        let behind = march.inverse_depth + march.gain * middle <= drawn;
        before = select(middle, before, behind);
        after = select(after, middle, behind);
    }
    // Both sides are linear in the march where a plane was drawn: one secant step is exact there,
    // also a little outside of the two texels that were compared.
    let start = march.inverse_depth + march.gain * before - march_drawn_between(march.texel + before * march.way);
    let end = march.inverse_depth + march.gain * after - march_drawn_between(march.texel + after * march.way);
    let secant = select(0.5, start / (start - end), start - end > 1e-9);
    let part = clamp(mix(before, after, clamp(secant, -1.0, 2.0)), 0.0, inside);
    // t / depth is linear along the march, too.
    let t = part * far * inverse.y / (march.inverse_depth + march.gain * part);
    let position = ray.origin + t * ray.direction;
    return Hit(position, vec3f(0.0), vec3f(0.0), -1.0, march.texel + part * march.way, 0.0, true, ray.direction);
}
