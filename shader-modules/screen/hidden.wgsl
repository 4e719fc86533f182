// Whether a ray passes behind what is seen, on its way from the water to its hit.
// Points of the way are held against the heights of what is seen where they appear: one that lies
// deeper may have met something that is hidden there. All seen rays run away from the water, so
// that of two points at one place the deeper is the farther. The way's image is taken to be a
// parabola. World space, metres; texels with centres at half integers.
//
// provides: occluded
// needs: geometry/ray, geometry/hit, screen/target, water/body
// slots: reproject
// number samples: 1 to 64, step 1
// number samples_per_px: 0.1 to 4 1/px, step 0.1
// number tolerance_px: 0 to 16 px, step 0.05
// domain: occluded(texel -100 to 1e4)

override samples: i32 = 32;
override samples_per_px: f32 = 1.5;
override tolerance_px: f32 = 0.5;

// Over the rest plane, metres; 0 where nothing was drawn.
var seen_height: texture_2d<f32>;

fn occluded(ray: Ray, hit: Hit, texel: vec2f) -> bool {
    let count = min(i32(ceil(samples_per_px * length(hit.texel - texel))), samples);
    if count < 2 {
        return false;
    }
    // A ray that meets nothing goes on for ever.
    let end = select(ray.origin + 1e5 * ray.direction, hit.position, hit.found);
    // Heights are counted from the water against the ray's way.
    let up = select(1.0, -1.0, ray.direction.z > 0.0);
    let height = up * (ray.origin.z - water.level);
    let fall = up * (end.z - ray.origin.z);
    // How far from the eye both ends of the way appear.
    let near = distance(ray.origin, view_target.eye);
    let far = near + distance(ray.origin, end) / water.relative_index;
    // Its middle appears here, and so far beside the straight line.
    let half = far / (near + far);
    let middle = reproject(mix(ray.origin, end, 0.5));
    let bow = (middle - mix(texel, hit.texel, half)) / (half * (1.0 - half));
    let pixel = tolerance_px / view_target.focal;
    var hidden = false;
    for (var i = 1; i < count && !hidden; i++) {
        let across = f32(i) / f32(count);
        let place = mix(texel, hit.texel, across) + across * (1.0 - across) * bow;
        let drawn = up * textureLoad(seen_height, vec2i(place), 0).x;
        // Equal steps in the picture are longer where the way is farther.
        let part = across * near / mix(far, near, across);
        let below = drawn - height - part * fall;
        hidden = drawn != 0.0 && below > pixel * mix(near, far, part);
    }
    return hidden;
}
