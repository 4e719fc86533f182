// The texels around one, nearest first.
//
// domain: neighbour(i 0 to 23)

// How many there are: the 24 of a square of five by five.
const NEIGHBOURS = 24;

// Steps to the texels of one quadrant, nearest first; the other three are this one turned.
const QUADRANT = array(
    vec2i(0, 1), vec2i(1, 1), vec2i(0, 2), vec2i(1, 2), vec2i(-1, 2), vec2i(2, 2),
);

// The step to the i-th nearest neighbour, 0 ≤ i < NEIGHBOURS.
fn neighbour(i: i32) -> vec2i {
    var quadrant = QUADRANT;
    let step = quadrant[clamp(i / 4, 0, 5)];
    switch i & 3 {
        case 0: { return step; }
        case 1: { return vec2i(-step.y, step.x); }
        case 2: { return -step; }
        default: { return vec2i(step.y, -step.x); }
    }
}
