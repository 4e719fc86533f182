// Lists rectangles of a picture that hold every pixel that may show water (wet.wgsl).
// A workgroup looks at a block of 128 × 128 pixels, a thread at 8 × 8 of them. Rectangles are joined,
// four to one, where that costs less: a rectangle is drawn as two triangles, and adapters shade what
// lies along their common edge twice, by squares of pixels. Where all together cost as much as the
// picture, one triangle stands for them.

struct Found {
    count: atomic<u32>,
    cost: atomic<u32>,
}

@group(0) @binding(2) var<storage, read_write> found: Found;
// Corners in clip space: x and y of one, then of the opposite one.
@group(0) @binding(3) var<storage, read_write> tiles: array<vec4f>;
// Vertices, instances, first vertex, first instance.
@group(0) @binding(4) var<storage, read_write> arguments: array<u32, 4>;

const LEAF = 8u;
const BLOCK = 128u;
// Leaves in a row of a block.
const ROW = 16u;
const LEVELS = 4u;
// Where the nodes of 8, 16, 32, 64 and 128 pixels begin, of which there are 16, 8, 4, 2 and 1 in a row.
const FIRST = array(0u, 256u, 320u, 336u, 340u);

// Of every node: its rectangle (low, high), what its part of the picture costs, and whether it
// stands for the four below it.
var<workgroup> boxes: array<vec4u, 341>;
var<workgroup> costs: array<u32, 341>;
var<workgroup> joined: array<bool, 341>;

// Squares that are shaded for a rectangle; those on its diagonal twice.
fn cost_of(box: vec4u) -> u32 {
    if box.x >= box.z {
        return 0u;
    }
    let size = (box.zw - box.xy) / SQUARE;
    let long = max(size.x, size.y);
    let short = min(size.x, size.y);
    return size.x * size.y + select(long + short - 1u, long, long % short == 0u);
}

fn join(level: u32, index: u32) {
    let row = ROW >> level;
    let at = 2u * vec2u(index % row, index / row);
    var box = NOTHING;
    var apart = 0u;
    for (var i = 0u; i < 4u; i++) {
        let below = FIRST[level - 1u] + (at.y + (i >> 1u)) * 2u * row + at.x + (i & 1u);
        box = vec4u(min(box.xy, boxes[below].xy), max(box.zw, boxes[below].zw));
        apart += costs[below];
    }
    let node = FIRST[level] + index;
    let together = cost_of(box);
    boxes[node] = box;
    joined[node] = together <= apart;
    costs[node] = min(together, apart);
}

fn clip(pixel: vec2u) -> vec2f {
    let part = vec2f(pixel) / region.size;
    return vec2f(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y);
}

@compute @workgroup_size(256)
fn classify(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let origin = region.low / BLOCK;
    let blocks = (region.high.x + BLOCK - 1u) / BLOCK - origin.x;
    let place = vec2u(thread % ROW, thread / ROW);
    let block = BLOCK * (origin + vec2u(group.x % blocks, group.x / blocks));
    let low = block + LEAF * place;
    let box = wet_box(clamp(low, region.low, region.high), clamp(low + LEAF, region.low, region.high));
    boxes[thread] = box;
    costs[thread] = cost_of(box);
    joined[thread] = true;
    for (var level = 1u; level <= LEVELS; level++) {
        workgroupBarrier();
        if thread < (256u >> (2u * level)) {
            join(level, thread);
        }
    }
    workgroupBarrier();
    // The first thread of the largest node that stands for itself lists it.
    for (var level = LEVELS + 1u; level > 0u; level--) {
        let below = level - 1u;
        let node = FIRST[below] + (place.y >> below) * (ROW >> below) + (place.x >> below);
        if !joined[node] {
            continue;
        }
        let first = all((place & vec2u((1u << below) - 1u)) == vec2u(0u));
        if first && costs[node] > 0u {
            tiles[atomicAdd(&found.count, 1u)] = vec4f(clip(boxes[node].xy), clip(boxes[node].zw));
            atomicAdd(&found.cost, costs[node]);
        }
        break;
    }
}

@compute @workgroup_size(1)
fn finish() {
    let size = region.high - region.low;
    var count = atomicLoad(&found.count);
    if atomicLoad(&found.cost) * SQUARE * SQUARE >= size.x * size.y && count > 0u {
        // Its first triangle covers the picture, its second lies outside.
        tiles[0] = vec4f(-1.0, -1.0, 3.0, 3.0);
        count = 1u;
    }
    arguments[0] = 6u;
    arguments[1] = count;
    arguments[2] = 0u;
    arguments[3] = 0u;
    atomicStore(&found.count, 0u);
    atomicStore(&found.cost, 0u);
}
