// What a ray meets in a field of signed distances to the scene's triangles: sphere tracing.
// Hart 1996, "Sphere tracing", The Visual Computer 12; steps of at least a part of a voxel, and a secant
// step where the sign changes. World space, metres.
// What is thinner than a voxel shows holes or vanishes, edges are rounded by about a voxel. A mesh
// need not be closed: a sheet has its back only behind itself, what is nearest to its rim is outside. Rays
// that come from behind a surface (out of an object, or behind a sheet) meet it two voxels early.
// A ray that leaves the grids, or takes all steps, meets nothing.
//
// provides: intersect
// needs: geometry/distance_grid, geometry/hit, geometry/ray
// slots: reproject
// number field_voxels: 4096 to 33554432, step 262144
// number march_steps: 1 to 1024, step 16
// number least_step: 0.01 to 2 voxels, step 0.01
// domain: the objects of a scene within its grids, coordinates to 1e4 m

// Of a voxel: the object that is nearest.
struct DistanceObject {
    object: u32,
}

var<storage, read> distance_objects: array<DistanceObject>;

// Voxels of the finer grid, which the host makes as small as that allows; the other one has half as
// many. The largest number that fillings of one pass ask for counts for all of them.
override field_voxels: i32 = 2097152;
override march_steps: i32 = 192;
override least_step: f32 = 0.25;

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    // Also keeps the number in the shader, where the host looks for it.
    let most = u32(field_voxels);
    let still = abs(ray.direction) < vec3f(1e-9);
    let inverse = 1.0 / select(ray.direction, vec3f(1e-9), still);
    var before = 0.0;
    var gap_before = 0.0;
    let first = distance_grid(ray.origin);
    var t = distance_entering(first, distance_place(first, ray.origin), inverse);
    var gap = 1.0;
    var within = true;
    for (var i = 0; i < march_steps && gap > 0.0 && within; i++) {
        let point = ray.origin + t * ray.direction;
        let grid = distance_grid(point);
        let place = distance_place(grid, point);
        within = distance_within(grid, place);
        gap = select(gap, distance_at(grid, point, most), within);
        if gap > 0.0 {
            before = t;
            gap_before = gap;
            // A grid knows nothing of what is beyond it.
            let leaving = distance_leaving(grid, place, inverse) + 0.01 * grid.voxel;
            t += min(max(gap, least_step * grid.voxel), leaving);
        }
    }
    if gap > 0.0 {
        return no_hit(ray, texel);
    }
    let met = mix(before, t, gap_before / max(gap_before - gap, 1e-12));
    let position = ray.origin + met * ray.direction;
    let grid = distance_grid(position);
    let normal = distance_normal(grid, position, -ray.direction, most);
    let nearest = distance_index(grid, round(distance_place(grid, position)), most);
    let object = f32(distance_objects[nearest].object);
    return Hit(position, normal, normal, object, reproject(position), 0.0, true, ray.direction);
}
