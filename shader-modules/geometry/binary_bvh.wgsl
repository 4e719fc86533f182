// What a ray meets first of all triangles of the scene: a walk through a tree of boxes, two children
// a node, the nearer first. For comparison: rays take less time through the wide tree. World space,
// metres. The stack is as deep as the host's trees may be. A walk of more than 4,096 nodes (far beyond
// what a million triangles ask for) ends with the nearest triangle found until then; a ray that is not
// finite meets nothing. For coordinates up to 1e6 m.
//
// provides: intersect
// needs: geometry/box, geometry/hit, geometry/nearest, geometry/ray, geometry/triangle
// slots: reproject
// domain: the triangles of a scene, coordinates to 1e6 m

// With a `count` of 0, `first` is the first of two nodes; else the first of so many triangles.
struct BvhNode {
    low: vec3f,
    first: u32,
    high: vec3f,
    count: u32,
}

var<storage, read> bvh_nodes: array<BvhNode>;

const MOST_NODES = 4096;
const STACK = 32;

fn nearest_triangle(ray: Ray) -> Nearest {
    let sheared = sheared_ray(ray);
    let inverse = box_inverse(ray.direction);
    var nearest = Nearest(1e30, vec3f(0.0), 0u);
    // Nodes that are yet to be visited, 8 · first + count, and where the ray enters them.
    var stack: array<u32, STACK>;
    var entries: array<f32, STACK>;
    var top = 0;
    let root = bvh_nodes[0];
    var first = root.first;
    var count = root.count;
    var descends = true;
    for (var visit = 0; visit < MOST_NODES && descends;) {
        // Down to a leaf. Loops within the loop, since processors that run rays side by side go through
        // what either a node or a leaf asks for with all of them.
        for (; visit < MOST_NODES && count == 0u && descends; visit++) {
            let left = bvh_nodes[first];
            let right = bvh_nodes[first + 1u];
            let to_left = box_entry(ray.origin, inverse, left.low, left.high, nearest.distance);
            let to_right = box_entry(ray.origin, inverse, right.low, right.high, nearest.distance);
            let swapped = to_right < to_left;
            let far_entry = max(to_left, to_right);
            if far_entry < 1e30 && top < STACK {
                let far_first = select(right.first, left.first, swapped);
                stack[top] = (far_first << 3u) | select(right.count, left.count, swapped);
                entries[top] = far_entry;
                top++;
            }
            first = select(left.first, right.first, swapped);
            count = select(left.count, right.count, swapped);
            descends = min(to_left, to_right) < 1e30;
            // What waits on the stack may lie behind what has been met since.
            for (var i = 0; i < STACK && !descends && top > 0; i++) {
                top--;
                descends = entries[top] <= nearest.distance;
                first = stack[top] >> 3u;
                count = stack[top] & 7u;
            }
        }
        nearest = nearest_in_leaf(nearest, sheared, first, select(0u, count, descends));
        visit++;
        descends = false;
        for (var i = 0; i < STACK && !descends && top > 0; i++) {
            top--;
            descends = entries[top] <= nearest.distance;
            first = stack[top] >> 3u;
            count = stack[top] & 7u;
        }
    }
    return nearest;
}

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    var hit = nearest_hit(nearest_triangle(ray), ray, texel);
    if hit.found {
        hit.texel = reproject(hit.position);
    }
    return hit;
}
