// Looks through the water: each pixel's ray meets it, is deflected, and meets something behind.
// Where nothing stands before the sky, the sky; what stands before the water stays.
// Outputs: `colour` linear RGB; `shown` the world point (metres) and object id of that colour.
//
// skeleton: screen
// outputs: colour, shown
// needs: water/redirected

fn screen(pixel: vec2f) -> Redirected {
    return redirected(pixel);
}

fn keep(redirected: Redirected) -> bool {
    return redirected.kept;
}

fn write_colour(redirected: Redirected) -> vec4f {
    return redirected_colour(redirected);
}

fn write_shown(redirected: Redirected) -> vec4f {
    return redirected_shown(redirected);
}
