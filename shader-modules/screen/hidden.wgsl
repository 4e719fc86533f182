// Whether a ray passes behind what is seen, on its way from the water to its hit.
// Points of the way are held against what is seen where they appear: one that lies deeper than the
// surface seen there may have met something that this surface hides. Behind flat water every seen ray
// runs away from the water, so that of two points at one place the deeper is the farther. World space, metres.
//
// provides: occluded
// needs: geometry/ray, geometry/hit, screen/target, water/body
// slots: reproject, seen
// number samples: 1 to 64, step 1
// number tolerance_px: 0 to 16 px, step 0.05

override samples: i32 = 8;
override tolerance_px: f32 = 0.25;

fn occluded(ray: Ray, hit: Hit, texel: vec2f) -> bool {
    let way = hit.position - ray.origin;
    let apart = length(hit.texel - texel);
    let count = min(i32(ceil(apart)), samples);
    var hidden = false;
    for (var i = 1; i < count && !hidden; i++) {
        let part = f32(i) / f32(count);
        let point = ray.origin + part * way;
        let there = seen(reproject(point));
        let reach = distance(ray.origin, view_target.eye) + part * length(way) / water.relative_index;
        let deeper = water.camera_side * (there.position.z - point.z);
        hidden = there.object >= 0.0 && deeper > tolerance_px * reach / view_target.focal;
    }
    return hidden;
}
