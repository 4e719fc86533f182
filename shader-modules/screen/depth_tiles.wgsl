// The nearest and the farthest that was drawn in squares of texels.
//
// domain: depth_tiles_across(size 1 to 16384)

// The side of a tile, texels.
const TILE = 8;

// As 1 / depth along `forward`, 1/m; 0 where nothing was drawn.
struct DepthTile {
    nearest: f32,
    farthest: f32,
}

// How many tiles cover a texture, along each axis.
fn depth_tiles_across(size: vec2f) -> vec2i {
    return (vec2i(size) + TILE - 1) / TILE;
}
