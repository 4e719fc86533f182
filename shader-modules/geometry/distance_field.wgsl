// What a ray meets in a field of signed distances to the scene's triangles: sphere tracing.
// Hart 1996, "Sphere tracing", The Visual Computer 12; distances trilinear between voxels, steps of
// at least a part of a voxel, and a secant step where the sign changes. World space, metres.
// What is thinner than a voxel shows holes or vanishes, edges are rounded by about a voxel. A mesh
// need not be closed: a sheet has its back only behind itself, what is nearest to its rim is outside. Rays
// that come from behind a surface (out of an object, or behind a sheet) meet it two voxels early.
// A ray that leaves the grids, or takes all steps, meets nothing.
//
// provides: intersect
// needs: geometry/hit, geometry/ray
// slots: reproject
// number field_voxels: 4096 to 33554432, step 262144
// number march_steps: 1 to 1024, step 16
// number least_step: 0.01 to 2 voxels, step 0.01
// domain: the objects of a scene within its grids, coordinates to 1e4 m

struct DistanceGrid {
    low: vec3f,
    voxel: f32,
    // Voxels along the axes.
    size: vec3f,
    first: u32,
}

struct DistanceVoxel {
    distance: f32,
}

struct DistanceObject {
    object: u32,
}

// The finer one first.
var<storage, read> distance_grids: array<DistanceGrid>;
var<storage, read> distance_voxels: array<DistanceVoxel>;
var<storage, read> distance_objects: array<DistanceObject>;

// Voxels of the finer grid, which the host makes as small as that allows; the other one has half as
// many. The largest number that fillings of one pass ask for counts for all of them.
override field_voxels: i32 = 2097152;
override march_steps: i32 = 192;
override least_step: f32 = 0.25;

// Where a point lies in a grid: from voxel 0, in voxels.
fn distance_place(grid: DistanceGrid, point: vec3f) -> vec3f {
    return (point - grid.low) / grid.voxel;
}

fn distance_within(grid: DistanceGrid, place: vec3f) -> bool {
    return all(place == clamp(place, vec3f(0.0), grid.size - 1.0));
}

// How far a ray goes until it leaves a grid. `inverse`: of its direction, finite.
fn distance_leaving(grid: DistanceGrid, place: vec3f, inverse: vec3f) -> f32 {
    let ends = select(vec3f(0.0), grid.size - 1.0, inverse > vec3f(0.0));
    let ways = (ends - place) * grid.voxel * inverse;
    return max(min(min(ways.x, ways.y), ways.z), 0.0);
}

// How far a ray from outside of a grid goes until it enters it; 0 where it never does.
fn distance_entering(grid: DistanceGrid, place: vec3f, inverse: vec3f) -> f32 {
    let nearer = select(grid.size - 1.0, vec3f(0.0), inverse > vec3f(0.0));
    let ways = (nearer - place) * grid.voxel * inverse;
    let entering = max(max(ways.x, ways.y), ways.z);
    let leaves = distance_leaving(grid, place, inverse);
    return select(0.0, entering + 0.01 * grid.voxel, entering > 0.0 && entering < leaves);
}

// The grid to look in: the finer one where it reaches.
fn distance_grid(point: vec3f) -> DistanceGrid {
    let finer = distance_grids[0];
    if distance_within(finer, distance_place(finer, point)) {
        return finer;
    }
    return distance_grids[1];
}

fn distance_index(grid: DistanceGrid, at: vec3f) -> u32 {
    let voxel = vec3u(clamp(at, vec3f(0.0), grid.size - 1.0));
    let index = (voxel.z * u32(grid.size.y) + voxel.y) * u32(grid.size.x) + voxel.x;
    // Neither grid has more; also keeps the number in the shader, where the host looks for it.
    return grid.first + min(index, u32(field_voxels));
}

// Trilinear.
fn distance_at(grid: DistanceGrid, point: vec3f) -> f32 {
    let place = distance_place(grid, point);
    let low = clamp(floor(place), vec3f(0.0), grid.size - 2.0);
    let t = clamp(place - low, vec3f(0.0), vec3f(1.0));
    let i = distance_index(grid, low);
    let row = u32(grid.size.x);
    let slice = row * u32(grid.size.y);
    // Lower and upper y, first at lower, then at upper z.
    let left = vec4f(
        distance_voxels[i].distance,
        distance_voxels[i + row].distance,
        distance_voxels[i + slice].distance,
        distance_voxels[i + slice + row].distance,
    );
    let right = vec4f(
        distance_voxels[i + 1u].distance,
        distance_voxels[i + row + 1u].distance,
        distance_voxels[i + slice + 1u].distance,
        distance_voxels[i + slice + row + 1u].distance,
    );
    let along = mix(left, right, t.x);
    let low_high = mix(along.xz, along.yw, t.y);
    return mix(low_high.x, low_high.y, t.z);
}

// The direction in which distances grow, from the corners of a tetrahedron; about the point within
// half a voxel, so that the edges between voxels do not show.
fn distance_normal(grid: DistanceGrid, point: vec3f, otherwise: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0; i < 4; i++) {
        let corner = vec2f(vec2i(1 - 2 * (i & 1), 1 - (i & 2)));
        let way = vec3f(corner, corner.x * corner.y);
        sum += way * distance_at(grid, point + 0.5 * grid.voxel * way);
    }
    let size = length(sum);
    return select(otherwise, sum / max(size, 1e-9), size > 1e-9);
}

fn intersect(ray: Ray, texel: vec2f) -> Hit {
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
        gap = select(gap, distance_at(grid, point), within);
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
    let normal = distance_normal(grid, position, -ray.direction);
    let nearest = distance_index(grid, round(distance_place(grid, position)));
    let object = f32(distance_objects[nearest].object);
    return Hit(position, normal, normal, object, reproject(position), 0.0, true, ray.direction);
}
