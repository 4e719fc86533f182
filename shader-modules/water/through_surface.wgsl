// Follows a ray that starts on the water through further meetings with it: a ray may leave through
// a trough and come in again, or be totally reflected. At each it is refracted exactly, or
// mirrored where all light is reflected; after the third it meets the water no more. World space,
// metres. What it meets beside the water is found by `inside`.
//
// provides: intersect
// needs: geometry/hit, geometry/ray, optics/snell, water/body
// slots: leave, inside: intersect
// domain: rays that start on the water. Each further meeting magnifies what rounding did before; where
// one grazes the water no figure can be promised.

const MOST_MEETINGS = 3;

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    var way = ray;
    var hit = no_hit(ray, texel);
    for (var i = 0; i <= MOST_MEETINGS; i++) {
        hit = inside(way, texel);
        let met = leave(way);
        let to_hit = select(1e30, dot(hit.position - way.origin, way.direction), hit.found);
        let to_water = select(1e30, dot(met.point - way.origin, way.direction), met.found);
        if to_hit <= to_water || i == MOST_MEETINGS {
            break;
        }
        // Upwards the ray comes from the water, if it comes from below the surface.
        let upwards = dot(way.direction, met.normal) > 0.0;
        let index = select(water.refractive_index, 1.0 / water.refractive_index, upwards);
        let beyond = refracted(way.direction, met.normal, index);
        let direction = select(beyond.direction, reflect(way.direction, met.normal), beyond.total);
        way = Ray(met.point, direction);
    }
    return hit;
}
