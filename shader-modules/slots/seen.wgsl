// The solid point seen behind the water at a place of the seen buffers (texels, centres at half
// integers). World space, metres. By default what the position and normal buffers hold.
//
// needs: screen/neighbours, screen/seen, screen/seen_point

fn seen(texel: vec2f) -> Seen {
    return seen_at(texel, NEIGHBOURS);
}
