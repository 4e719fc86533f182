// Where a ray first passes behind what was drawn, each step placed as what was drawn is: a march
// for buffers in which world rays are curves, as after the broad phase.
// The hit test and the thickness are McGuire & Mara's (2014, JCGT 3(4)). The steps are those of a
// straight line between where the ray's ends appear, as far as it takes to move by `stride` on the screen
// or to reach what was drawn; each of their points is placed by itself. World space, metres; depth along `forward` of where points appear; texels.
// A ray that leaves the buffers shows what is where it does so; one that goes on behind something
// until its end, or comes back to the camera's side, shows the pixel itself. Normals and id are not
// known: for fillings of `colour` that fetch what was drawn at the texel.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, screen/camera, screen/drawn, screen/leaving, screen/seen_view, water/body
// slots: place
// requires: colour = screen/resampled
// number thickness: 0 to 100 m, step 0.05
// number stride: 0.25 to 64 px, step 0.25
// number march_steps: 1 to 4096, step 64
// number refinements: 0 to 12, step 1
// number reach: 0.1 to 1000 m, step 1
// domain: intersect(ray.origin seen 0.1 to 1e4, texel -100 to 1e4)

// How far every drawn surface is taken to go on behind its front.
override thickness: f32 = 0.1;
override stride: f32 = 1.0;
override march_steps: i32 = 256;
// Steps of regula falsi within the step in which the ray passed behind.
override refinements: i32 = 2;
// How far the ray is followed.
override reach: f32 = 30.0;

// A point of the ray: how far along it, where it appears and at what depth, and the depth of what was drawn
// there.
struct Marched {
    along: f32,
    texel: vec2f,
    depth: f32,
    drawn: f32,
}

// 1 / depth as depth; far away where nothing was drawn.
fn curved_depth(inverse: f32) -> f32 {
    return 1.0 / max(inverse, 1e-7);
}

fn marched(ray: Ray, along: f32) -> Marched {
    let appears = view_pixel(view_seen(), place(ray.origin + along * ray.direction));
    return Marched(along, appears.xy, appears.z, curved_depth(drawn(vec2i(floor(appears.xy)))));
}

// Where, from one point to another, the ray passes behind what was drawn if both are straight between them;
// half-way where it draws no nearer.
fn curved_secant(before: Marched, after: Marched) -> f32 {
    let start = before.drawn - before.depth;
    let fall = start - (after.drawn - after.depth);
    return select(0.5, start / fall, fall > 1e-9);
}

fn outside(texel: vec2f) -> bool {
    let half = 0.5 * vec2f(textureDimensions(seen_depth));
    return any(abs(texel - half) > half);
}

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    let view = view_seen();
    let ends = view_ends(view, ray, reach);
    let start = marched(ray, 0.0);
    let end = marched(ray, ends.far);
    // 1 / depth, of which the line between them has equal parts in equal steps on the screen. Right before the
    // eye, where a difference leaves few digits, steps may be longer.
    let inverse = 1.0 / max(vec2f(start.depth, end.depth), vec2f(max(0.05 * start.depth, view.near)));
    let stride_part = stride / max(length(end.texel - start.texel), stride);
    var gain = inverse.y - inverse.x;
    var part = 0.0;
    var counted_from = 0.0;
    var strides = 0.0;
    var before = start;
    var after = start;
    var met = false;
    var left = false;
    // Light that the water reflects meets nothing that was drawn.
    let returns = water.camera_side * ray.direction.z > 0.0;
    let steps = select(march_steps, 0, returns);
    for (var i = 0; i < steps && !met; i++) {
        // By the stride, or just beyond what was drawn, so that the next point is behind it where both run
        // straight; half-way at first, to see what lies between.
        let apart = select(1.02, 0.5, i == 0) * (1.0 - before.depth / before.drawn) + 1e-5;
        let to_gap = select(1.0, apart / max(-gain * before.depth, 1e-6), before.drawn > before.depth);
        // Strides are counted: the rounding of many sums adds up to texels that are missed.
        strides = select(strides + 1.0, 0.0, to_gap < stride_part);
        counted_from = select(counted_from, part + to_gap, to_gap < stride_part);
        part = min(counted_from + strides * stride_part, 1.0);
        after = marched(ray, ends.far * part * inverse.y / mix(inverse.x, inverse.y, part));
        left = outside(after.texel);
        met = after.drawn <= after.depth && before.depth <= after.drawn + thickness;
        if left || part >= 1.0 {
            break;
        }
        if !met {
            before = after;
            // By the whole way so far: of a difference between neighbours rounding would leave little.
            gain = (1.0 / max(after.depth, view.near) - inverse.x) / part;
        }
    }
    if !met {
        let size = vec2f(textureDimensions(seen_depth));
        let edge = leaving_place(before.texel, after.texel - before.texel, vec2f(0.0), size);
        let shown_at = select(texel, edge, left);
        let shows = drawn_about(vec2i(floor(shown_at))) > 0.0;
        return Hit(ray.origin, vec3f(0.0), vec3f(0.0), -1.0, shown_at, 0.0, shows, ray.direction);
    }
    before.drawn = curved_depth(drawn_between(before.texel));
    after.drawn = curved_depth(drawn_between(after.texel));
    for (var i = 0; i < refinements; i++) {
        let secant = clamp(curved_secant(before, after), -0.5, 1.5);
        var middle = marched(ray, max(mix(before.along, after.along, secant), 0.0));
        middle.drawn = curved_depth(drawn_between(middle.texel));
        if middle.drawn > middle.depth {
            before = middle;
        } else {
            after = middle;
        }
    }
    let weight = clamp(curved_secant(before, after), 0.0, 1.0);
    let position = ray.origin + mix(before.along, after.along, weight) * ray.direction;
    let shown_at = mix(before.texel, after.texel, weight);
    return Hit(position, vec3f(0.0), vec3f(0.0), -1.0, shown_at, 0.0, true, ray.direction);
}
