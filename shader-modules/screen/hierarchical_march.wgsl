// Where a ray first passes behind what was drawn: the march of `screen/march`, texel by texel, which
// leaves out whole tiles that the ray crosses before all, or behind all, that was drawn in them.
// After Uludag 2014, "Hi-Z Screen-Space Cone-Traced Reflections", GPU Pro 5, with one level over the
// texels. World space, metres; depth along `forward`; texels. It finds what a march of stride 1
// without jitter finds; misses show what they show there.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, screen/depth_tiles, screen/drawn, screen/leaving, screen/march_line, water/body
// requires: reproject = screen/plain, colour = screen/resampled
// number thickness: 0 to 100 m, step 0.05
// number march_tiles: 1 to 4096, step 16
// number reach: 0.1 to 1000 m, step 1
// domain: intersect(ray.origin seen 0.1 to 1e4, texel -100 to 1e4)

// How far every drawn surface is taken to go on behind its front.
override thickness: f32 = 0.1;
override march_tiles: i32 = 256;
// How far the ray is followed.
override reach: f32 = 30.0;

var<storage, read> depth_tiles: array<DepthTile>;

// Where the march leaves the tile that it is in at a place.
fn tile_end(march: March, at: f32, tile: vec2i) -> f32 {
    let low = vec2f(tile * TILE);
    // Just beyond the edge, so that the next place is in the next tile.
    let beyond = 0.01 * march_texel(march);
    return max(leaving_part(march.texel, march.way, low, low + f32(TILE)) + beyond, at + beyond);
}

// Whether the ray may meet something that was drawn in a tile.
fn tile_meets(march: March, before: f32, after: f32, index: i32) -> bool {
    let tile = depth_tiles[index];
    let ends = march.inverse_depth + march.gain * vec2f(before, after);
    let behind = min(ends.x, ends.y) <= tile.nearest;
    return behind && tile.farthest <= max(ends.x, ends.y) * (1.0 + thickness * tile.farthest);
}

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    let march = march_of(ray, reach);
    let across = depth_tiles_across(vec2f(textureDimensions(seen_depth)));
    let step = march_texel(march);
    var before = 0.0;
    var after = 0.0;
    var met = false;
    // Light that the water reflects meets nothing that was drawn.
    let returns = water.camera_side * ray.direction.z > 0.0;
    let tiles = select(march_tiles, 0, returns);
    for (var i = 0; i < tiles && !met; i++) {
        // Apart, so that neighbouring rays leave tiles out together and try texels together.
        var end = before;
        var meets = false;
        for (var j = i; j < tiles && !meets && before < march.inside; j++) {
            let tile = clamp(march_at(march, before) / TILE, vec2i(0), across - 1);
            end = min(tile_end(march, before, tile), march.inside);
            meets = tile_meets(march, before, end, tile.y * across.x + tile.x);
            before = select(end, before, meets);
        }
        if !meets {
            break;
        }
        // A tile's diagonal is no longer along an axis than its side.
        for (var j = 0; j < 2 * TILE && !met && before < end; j++) {
            after = min(before + step, end);
            met = march_meets(march, before, after, drawn(march_at(march, 0.5 * (before + after))), thickness);
            before = select(after, before, met);
        }
        before = select(end, before, met);
    }
    if met {
        return march_hit(ray, march, before, after, 0);
    }
    let left = march.inside < 1.0 && before >= march.inside;
    return march_missed(ray, march, left, texel);
}
