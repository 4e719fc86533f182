// Looks through the water: each pixel's ray meets it, is deflected, and meets something behind.
// Where nothing stands before the sky, the sky; what stands before the water stays.
// Pixels whose residual exceeds `bound_px`, or from which something may hide on the ray's way, are
// listed, for a later pass to do them again.
// Outputs: `colour` linear RGB; `shown` the world point (metres) and object id of that colour.
//
// skeleton: screen
// outputs: colour, shown
// number bound_px: 0 to 64 px, step 0.05
// needs: water/redirected
// slots: occluded

// Pixels as x + 65536 y, behind their count.
struct List {
    count: atomic<u32>,
    pixels: array<u32>,
}

var<storage, read_write> listed: List;

override bound_px: f32 = 0.25;

struct Candidate {
    pixel: vec2f,
    redirected: Redirected,
}

fn screen(pixel: vec2f) -> Candidate {
    return Candidate(pixel, redirected(pixel));
}

fn keep(candidate: Candidate) -> bool {
    return candidate.redirected.kept;
}

fn also(candidate: Candidate) {
    let redirected = candidate.redirected;
    let texel = seen_texel(candidate.pixel);
    if redirected.wet && (redirected.hit.residual >= bound_px || occluded(redirected.ray, redirected.hit, texel)) {
        let place = atomicAdd(&listed.count, 1u);
        if place < arrayLength(&listed.pixels) {
            let pixel = vec2u(candidate.pixel);
            listed.pixels[place] = pixel.x | (pixel.y << 16u);
        }
    }
}

fn write_colour(candidate: Candidate) -> vec4f {
    return redirected_colour(candidate.redirected);
}

fn write_shown(candidate: Candidate) -> vec4f {
    return redirected_shown(candidate.redirected);
}
