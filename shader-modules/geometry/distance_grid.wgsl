// The grids of signed distances to the scene's triangles, and what they say of points.
// World space, metres; trilinear between voxels.
//
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

// The finer one first.
var<storage, read> distance_grids: array<DistanceGrid>;
var<storage, read> distance_voxels: array<DistanceVoxel>;

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

// The voxel next to a place, or the last one before it, as an index. `most`: as of `distance_at`.
fn distance_index(grid: DistanceGrid, at: vec3f, most: u32) -> u32 {
    let voxel = vec3u(clamp(at, vec3f(0.0), grid.size - 1.0));
    let index = (voxel.z * u32(grid.size.y) + voxel.y) * u32(grid.size.x) + voxel.x;
    return grid.first + min(index, most);
}

// The distance at a point, trilinear between voxels; `most`: neither grid has more of them.
fn distance_at(grid: DistanceGrid, point: vec3f, most: u32) -> f32 {
    let place = distance_place(grid, point);
    let low = clamp(floor(place), vec3f(0.0), grid.size - 2.0);
    let t = clamp(place - low, vec3f(0.0), vec3f(1.0));
    let i = distance_index(grid, low, most);
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
fn distance_normal(grid: DistanceGrid, point: vec3f, otherwise: vec3f, most: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0; i < 4; i++) {
        let corner = vec2f(vec2i(1 - 2 * (i & 1), 1 - (i & 2)));
        let way = vec3f(corner, corner.x * corner.y);
        sum += way * distance_at(grid, point + 0.5 * grid.voxel * way, most);
    }
    let size = length(sum);
    return select(otherwise, sum / max(size, 1e-9), size > 1e-9);
}
