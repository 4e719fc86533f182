// The solid point seen at a place of the seen buffers, from those that hold positions and normals:
// what the slot does by default, to be connected to other buffers.
//
// provides: seen
// needs: screen/seen, screen/seen_point
// number neighbours: 0 to 24, step 1
// domain: seen(texel -100 to 1e4)

// How many texels around one that shows nothing are asked in its place.
override neighbours: i32 = 24;

fn seen(texel: vec2f) -> Seen {
    return seen_at(texel, neighbours);
}
