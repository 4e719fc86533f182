// Fetches the colour that was drawn where the hit appears in the seen buffers.
// Bilinear, clamped to the buffers, over the texels that show anything (alpha 1); where none does, at
// the water's edge, the nearest neighbour that does; beyond these, the sky. Without `neighbours` what shows
// nothing is the sky, up to the middle between texels. `shown` is fetched with
// the colour's own texels and weights, from the nearest texel where they show different objects.
//
// provides: colour
// needs: geometry/ray, geometry/hit, screen/neighbours, sky/gradient
// number neighbours: 0 to 24, step 1
// domain: colour()
// domain: shown()

// How many texels around one that shows nothing are asked in its place.
override neighbours: i32 = 24;

var seen_colour: texture_2d<f32>;
var shown_of_seen_colour: texture_2d<f32>;
var linear_sampler: sampler;

fn colour(hit: Hit, ray: Ray) -> vec3f {
    if !hit.found {
        return sky_colour(hit.direction);
    }
    let size = textureDimensions(seen_colour);
    var drawn = textureSampleLevel(seen_colour, linear_sampler, hit.texel / vec2f(size), 0.0);
    for (var i = 0; i < min(neighbours, NEIGHBOURS) && drawn.a < 0.01; i++) {
        let texel = vec2i(floor(hit.texel)) + neighbour(i);
        drawn = textureLoad(seen_colour, clamp(texel, vec2i(0), vec2i(size) - 1), 0);
    }
    if drawn.a < select(0.01, 0.5, neighbours == 0) {
        return sky_colour(ray.direction);
    }
    return drawn.rgb / drawn.a;
}

fn shown(hit: Hit, ray: Ray) -> vec4f {
    if !hit.found {
        return vec4f(0.0, 0.0, 0.0, -1.0);
    }
    let last = vec2i(textureDimensions(shown_of_seen_colour)) - 1;
    let texel = clamp(hit.texel, vec2f(0.5), vec2f(last) + 0.5);
    var nearest = textureLoad(shown_of_seen_colour, vec2i(texel), 0);
    for (var i = 0; i < min(neighbours, NEIGHBOURS) && nearest.w < 0.0; i++) {
        nearest = textureLoad(shown_of_seen_colour, clamp(vec2i(texel) + neighbour(i), vec2i(0), last), 0);
    }
    let corner = floor(texel - 0.5);
    let part = texel - 0.5 - corner;
    var sum = vec3f(0.0);
    for (var i = 0; i < 4; i++) {
        let step = vec2i(i & 1, i >> 1u);
        let point = textureLoad(shown_of_seen_colour, min(vec2i(corner) + step, last), 0);
        if point.w != nearest.w {
            return nearest;
        }
        let weights = select(1.0 - part, part, step == vec2i(1));
        sum += weights.x * weights.y * (point.xyz - nearest.xyz);
    }
    return vec4f(nearest.xyz + sum, nearest.w);
}
