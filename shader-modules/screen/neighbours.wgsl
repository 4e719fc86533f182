// The texels around one, nearest first.
//
// domain: neighbour(i 0 to 23)

// How many there are: the 24 of a square of five by five.
const NEIGHBOURS = 24;

// The step to the i-th nearest neighbour, 0 ≤ i < NEIGHBOURS. The steps of one quadrant are kept as
// pairs of four-bit numbers, x + 2 and y, nearest first; the other three are this one turned.
fn neighbour(i: i32) -> vec2i {
    let shift = u32(clamp(i, 0, NEIGHBOURS - 1) / 4) * 4u;
    let x = i32((0x413232u >> shift) & 15u) - 2;
    let y = i32((0x222211u >> shift) & 15u);
    let half_turned = select(vec2i(x, y), vec2i(-x, -y), (i & 2) == 2);
    return select(half_turned, vec2i(-half_turned.y, half_turned.x), (i & 1) == 1);
}
