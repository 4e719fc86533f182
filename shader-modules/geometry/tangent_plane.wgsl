// Where a refracted ray meets the tangent plane of the surface seen near it.
// Liu, Han, Fei 2020, narrow phase, eq. 3. World space, metres. A ray that runs along the plane, or
// meets it behind its origin, is taken to meet the seen point itself. Where nothing is seen (the sky,
// or a wave that stands before the bank) the ray's own points are looked for, the farthest first, then
// at doubling distances; if they show nothing either there is no hit, and that is certain. The
// residual is the distance from the ray of what is seen where the hit appears, in pixels: it tells
// the error without a reference, but not of a nearer surface that hides there. Where another object
// is seen there or right beside it, the plane may not reach as far, and the residual is larger than
// any bound.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, screen/residual, screen/seen_point
// slots: reproject, seen
// number probes: 0 to 8, step 1
// number first_probe: 0.001 to 100 m, step 0.01
// domain: intersect(ray.origin seen 0.1 to 1e4, texel -100 to 1e4)
// identity when not waves and not camera_submerged and fine_edges: within 0.4 px

override probes: i32 = 6;
override first_probe: f32 = 0.1;

// What is farther than this along a ray appears where its end does.
const FARTHEST = 1e5;

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    var near: Seen;
    var position = ray.origin;
    var place = texel;
    var end = texel;
    var way = FARTHEST;
    // The first look and the probes in one loop, since processors that run pixels side by side go
    // through every loop for all of them.
    for (var i = 0; i <= probes + 1; i++) {
        near = seen(place);
        let shown = near.object >= 0.0;
        let slope = dot(near.normal, ray.direction);
        let offset = dot(near.normal, near.position - ray.origin);
        // |slope| ≥ 1e-4 and one sign: the quotient is finite and positive.
        let meets = slope * offset > 0.0 && abs(slope) > 1e-4;
        let reach = select(way, offset / select(1.0, slope, meets), shown);
        let along = ray.origin + reach * ray.direction;
        // A sum of large numbers lies beside the plane by their rounding; it is put back onto it, along the ray.
        let beside = select(0.0, dot(near.normal, near.position - along) / select(1.0, slope, meets), shown);
        position = select(along + beside * ray.direction, near.position, shown && !meets);
        place = reproject(position);
        if shown || i > probes {
            break;
        }
        end = select(end, place, i == 0);
        way = select(2.0 * way, first_probe, i == 0);
    }
    if near.object < 0.0 {
        var nothing = no_hit(ray, end);
        nothing.residual = select(UNKNOWN_RESIDUAL, 0.0, is_seen(end));
        return nothing;
    }
    let there = seen(place);
    var residual = UNKNOWN_RESIDUAL;
    if there.object >= 0.0 && is_seen(place) {
        residual = residual_px(ray, there.position) + select(0.0, OTHER_OBJECT, there.edge || there.object != near.object);
    }
    // A curved surface has turned on the way from the one place to the other. What is seen there from the
    // other side is another face (objects are drawn open where the water cuts them), and lit otherwise.
    let same_side = dot(near.normal, ray.direction) * dot(there.normal, ray.direction) >= 0.0;
    let turned = select(near.shading_normal, there.shading_normal, there.object == near.object && same_side);
    return Hit(position, near.normal, turned, near.object, place, residual, true, ray.direction);
}
