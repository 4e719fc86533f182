// Whether a ray passes behind what is seen, on its way from the water to its hit.
// Points of the way are held against the heights of what is seen where they appear: one that lies
// deeper may have met something that is hidden there. All seen rays run away from the water, so
// that of two points at one place the deeper is the farther. The way's image through flat water, or in it
// as a mirror, is taken to be a parabola. World space, metres; texels with centres at half integers.
//
// provides: occluded
// needs: geometry/ray, geometry/hit, screen/seen_view, screen/target, water/body
// number samples: 1 to 64, step 1
// number samples_per_px: 0.1 to 4 1/px, step 0.1
// number tolerance_px: 0 to 16 px, step 0.05
// domain: occluded(texel -100 to 1e4)

override samples: i32 = 32;
override samples_per_px: f32 = 1.2;
override tolerance_px: f32 = 0.5;

// Over the rest plane, metres; 0 where nothing was drawn.
var seen_height: texture_2d<f32>;

// How much less deep than they are points appear right behind the place where a ray is bent.
fn flattening(ray: Ray) -> f32 {
    let way = ray.origin - view_target.eye;
    let tangent = dot(way.xy, way.xy) / max(way.z * way.z, 1e-12);
    let n = water.larger_index * water.larger_index;
    let m = water.root_high * water.root_high;
    let from_low = inverseSqrt(n + m * tangent);
    let from_high = water.larger_index * inverseSqrt(max(1.0 - m * tangent, 1e-6));
    let bent = select(from_high, from_low, water.relative_index >= 1.0);
    // What is mirrored appears as far behind the water as it is before it.
    return select(bent, -1.0, water.camera_side * ray.direction.z > 0.0);
}

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
    // Were all of the way bent as its start is, its ends would appear here; how much it is bent changes
    // along it, and its image bows from the one to the other.
    let flatter = vec3f(1.0, 1.0, flattening(ray));
    let rest = vec3f(0.0, 0.0, water.level);
    let first = view_pixel(view_seen(), rest + flatter * (ray.origin - rest));
    let last = view_pixel(view_seen(), rest + flatter * (end - rest));
    let bow = hit.texel - last.xy;
    let pixel = tolerance_px / view_target.focal;
    var hidden = false;
    for (var i = 1; i < count && !hidden; i++) {
        let across = f32(i) / f32(count);
        // Equal steps in the picture are longer where the way is farther.
        let part = across * first.z / mix(last.z, first.z, across);
        let place = mix(first.xy, last.xy, across) + part * part * bow;
        let drawn = up * textureLoad(seen_height, vec2i(place), 0).x;
        let below = drawn - height - part * fall;
        hidden = drawn != 0.0 && below > pixel * mix(first.z, last.z, part);
    }
    return hidden;
}
