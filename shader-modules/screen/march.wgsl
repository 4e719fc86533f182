// Where a ray first passes behind what was drawn: a march along its line on the screen.
// McGuire & Mara 2014, "Efficient GPU Screen-Space Ray Tracing", JCGT 3(4): a perspective-correct
// DDA, a hit where the depths that the ray has within a step overlap the drawn surface and its
// thickness, then bisection. World space, metres; depth along `forward`; texels.
// A ray that leaves the buffers shows what is where it does so; one that goes on behind something
// until its end, or comes back to the camera's side, shows the pixel itself. Normals and id are not
// known: for fillings of `colour` that fetch what was drawn at the texel.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, screen/drawn, screen/march_line, water/body
// requires: reproject = screen/plain, colour = screen/resampled
// number thickness: 0 to 100 m, step 0.05
// number stride: 1 to 64 px, step 1
// number jitter: 0 to 1, step 0.1
// number march_steps: 1 to 4096, step 64
// number refinements: 0 to 12, step 1
// number reach: 0.1 to 1000 m, step 1
// domain: intersect(ray.origin seen 0.1 to 1e4, texel -100 to 1e4)

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

// A number in [0, 1) that differs between neighbouring texels.
// Jimenez 2014, "Next Generation Post Processing in Call of Duty", interleaved gradient noise.
fn march_noise(texel: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(floor(texel), vec2f(0.06711056, 0.00583715))));
}

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    let march = march_of(ray, reach);
    let step = stride * march_texel(march);
    // Texels are looked at in their middles, along the axis on which the line is longer: at their edges all
    // looks of a line would hang in the balance at once.
    let shift = (march_to_middle(march) + floor(stride * jitter * march_noise(texel))) / stride;
    var before = 0.0;
    var after = 0.0;
    var met = false;
    // Light that the water reflects meets nothing that was drawn.
    let returns = water.camera_side * ray.direction.z > 0.0;
    let steps = select(march_steps, 0, returns);
    // Every step covers what lies between the middles of the gaps to its neighbours. Its place is told by its
    // number: the rounding of many sums adds up to texels that are missed.
    for (var i = 0; i < steps && !met; i++) {
        if before >= march.inside {
            break;
        }
        let place = f32(i) + shift;
        after = min((place + 0.5) * step, march.inside);
        met = march_meets(march, before, after, drawn(march_at(march, place * step)), thickness);
        before = select(after, before, met);
    }
    if met {
        return march_hit(ray, march, before, after, refinements);
    }
    let left = march.inside < 1.0 && before >= march.inside;
    return march_missed(ray, march, left, texel);
}
