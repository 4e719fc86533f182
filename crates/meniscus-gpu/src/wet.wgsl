// Where a picture may show water: where its depth is not before the plane that bounds the waves, or
// where nothing stands.

struct Region {
    // The plane's reversed depth at a pixel: dot(plane, vec3f(pixel, 1)).
    plane: vec3f,
    // The pixels that are looked at: from `low` up to, but not, `high`.
    low: vec2u,
    high: vec2u,
    size: vec2f,
}

@group(0) @binding(0) var<uniform> region: Region;
@group(0) @binding(1) var front: texture_depth_2d;

// The side of a square by which costs are counted, and to which rectangles are aligned.
const SQUARE = 4u;
const NOTHING = vec4u(0xffffffffu, 0xffffffffu, 0u, 0u);

fn may_show(x: u32, y: u32) -> bool {
    let before = textureLoad(front, vec2u(x, y), 0);
    return before == 0.0 || before <= dot(region.plane, vec3f(vec2f(vec2u(x, y)) + 0.5, 1.0));
}

fn row_shows(left: u32, right: u32, y: u32) -> bool {
    for (var x = left; x < right; x++) {
        if may_show(x, y) {
            return true;
        }
    }
    return false;
}

fn column_shows(x: u32, top: u32, bottom: u32) -> bool {
    for (var y = top; y < bottom; y++) {
        if may_show(x, y) {
            return true;
        }
    }
    return false;
}

// The rectangle around what may show water; looked for from its four sides.
fn wet_box(low: vec2u, high: vec2u) -> vec4u {
    var top = low.y;
    while top < high.y && !row_shows(low.x, high.x, top) {
        top++;
    }
    if top == high.y {
        return NOTHING;
    }
    // There is some: the others end where it is.
    var bottom = high.y;
    while !row_shows(low.x, high.x, bottom - 1u) {
        bottom--;
    }
    var left = low.x;
    while !column_shows(left, top, bottom) {
        left++;
    }
    var right = high.x;
    while !column_shows(right - 1u, top, bottom) {
        right--;
    }
    let ends = (vec2u(right, bottom) + SQUARE - 1u) / SQUARE;
    return vec4u(SQUARE * (vec2u(left, top) / SQUARE), SQUARE * ends);
}
