// Fills what no surface covers with the sky.
// Outputs: `colour` linear RGB; `shown` nothing (id −1).
//
// skeleton: screen
// outputs: colour, shown
// needs: screen/target, sky/gradient

var front_depth: texture_depth_2d;

struct Uncovered {
    direction: vec3f,
    covered: bool,
}

fn screen(pixel: vec2f) -> Uncovered {
    let covered = textureLoad(front_depth, vec2i(pixel), 0) > 0.0;
    return Uncovered(view_ray(view_target, pixel).direction, covered);
}

fn keep(uncovered: Uncovered) -> bool {
    return !uncovered.covered;
}

fn write_colour(uncovered: Uncovered) -> vec4f {
    return vec4f(sky_colour(uncovered.direction), 1.0);
}

fn write_shown(uncovered: Uncovered) -> vec4f {
    return vec4f(0.0, 0.0, 0.0, -1.0);
}
