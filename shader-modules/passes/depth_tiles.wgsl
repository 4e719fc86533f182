// Sums up the depths that were drawn: a thread a tile.
//
// skeleton: compute
// workgroup: 8, 8
// needs: screen/depth_tiles, screen/drawn

var<storage, read_write> depth_tiles: array<DepthTile>;

fn compute(thread: vec3u) {
    let size = textureDimensions(seen_depth);
    let across = depth_tiles_across(vec2f(size));
    let tile = vec2i(thread.xy);
    let index = tile.y * across.x + tile.x;
    if any(tile >= across) || index >= i32(arrayLength(&depth_tiles)) {
        return;
    }
    var sum = DepthTile(0.0, 1e30);
    for (var i = 0; i < TILE * TILE; i++) {
        let there = drawn(min(tile * TILE + vec2i(i % TILE, i / TILE), vec2i(size) - 1));
        sum = DepthTile(max(sum.nearest, there), min(sum.farthest, there));
    }
    depth_tiles[index] = sum;
}
