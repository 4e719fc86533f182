// What a ray meets first of all triangles of the scene: a walk through a tree of boxes with up to
// four children each, the nearest first. Boxes are kept in bytes: see Ylitie, Karras and Laine 2017,
// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs". World space, metres. The
// stack is as deep as the host's trees may be. A walk of more than 4,096 nodes (far beyond what a
// million triangles ask for) ends with the nearest triangle found until then; a ray that is not
// finite meets nothing. For coordinates up to 1e6 m.
//
// provides: intersect
// needs: geometry/box, geometry/hit, geometry/nearest, geometry/ray, geometry/triangle
// slots: reproject
// domain: the triangles of a scene, coordinates to 1e6 m

// `low` + `step` · byte is where a face of a child's box lies; of `low_x` … `high_z` the first child
// has the lowest byte. A child is 8 times a node, or 8 times its first triangle and how many it has,
// or NO_CHILD.
struct WideBvhNode {
    low: vec3f,
    first: u32,
    step: vec3f,
    second: u32,
    low_x: u32,
    low_y: u32,
    low_z: u32,
    third: u32,
    high_x: u32,
    high_y: u32,
    high_z: u32,
    fourth: u32,
}

var<storage, read> bvh_wide_nodes: array<WideBvhNode>;

const MOST_NODES = 4096;
const STACK = 48;
const NO_CHILD = 0xffffffffu;

fn four_bytes(word: u32) -> vec4f {
    return vec4f((vec4u(word) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u));
}

// A child, and where the ray enters it.
struct Entered {
    child: u32,
    distance: f32,
}

// Two of them, the nearer first.
fn nearer_first(a: ptr<function, Entered>, b: ptr<function, Entered>) {
    let swapped = (*b).distance < (*a).distance;
    let first = *a;
    let second = *b;
    (*a).child = select(first.child, second.child, swapped);
    (*a).distance = select(first.distance, second.distance, swapped);
    (*b).child = select(second.child, first.child, swapped);
    (*b).distance = select(second.distance, first.distance, swapped);
}

fn nearest_triangle(ray: Ray) -> Nearest {
    let sheared = sheared_ray(ray);
    let inverse = box_inverse(ray.direction);
    let backwards = inverse < vec3f(0.0);
    var nearest = Nearest(1e30, vec3f(0.0), 0u);
    // Nodes that are yet to be visited, and where the ray enters them.
    var stack: array<u32, STACK>;
    var entries: array<f32, STACK>;
    var top = 0;
    var at = 0u;
    var goes_on = true;
    for (var visit = 0; visit < MOST_NODES && goes_on;) {
        // Down to a leaf. A loop within the loop, since processors that run rays side by side go
        // through what either a node or a leaf asks for with all of them.
        for (; visit < MOST_NODES && goes_on && (at & 7u) == 0u; visit++) {
            let node = bvh_wide_nodes[at >> 3u];
            let base = (node.low - ray.origin) * inverse;
            let scale = node.step * inverse;
            let near_x = base.x + scale.x * four_bytes(select(node.low_x, node.high_x, backwards.x));
            let near_y = base.y + scale.y * four_bytes(select(node.low_y, node.high_y, backwards.y));
            let near_z = base.z + scale.z * four_bytes(select(node.low_z, node.high_z, backwards.z));
            let far_x = base.x + scale.x * four_bytes(select(node.high_x, node.low_x, backwards.x));
            let far_y = base.y + scale.y * four_bytes(select(node.high_y, node.low_y, backwards.y));
            let far_z = base.z + scale.z * four_bytes(select(node.high_z, node.low_z, backwards.z));
            let enters = max(max(near_x, near_y), max(near_z, vec4f(0.0)));
            let leaves = min(min(far_x, far_y), min(far_z, vec4f(nearest.distance))) * 1.000001;
            let children = vec4u(node.first, node.second, node.third, node.fourth);
            let met = (enters <= leaves) & (children != vec4u(NO_CHILD));
            let distances = select(vec4f(1e30), enters, met);
            var a = Entered(children.x, distances.x);
            var b = Entered(children.y, distances.y);
            var c = Entered(children.z, distances.z);
            var d = Entered(children.w, distances.w);
            nearer_first(&a, &b);
            nearer_first(&c, &d);
            nearer_first(&a, &c);
            nearer_first(&b, &d);
            nearer_first(&b, &c);
            if d.distance < 1e30 && top < STACK {
                stack[top] = d.child;
                entries[top] = d.distance;
                top++;
            }
            if c.distance < 1e30 && top < STACK {
                stack[top] = c.child;
                entries[top] = c.distance;
                top++;
            }
            if b.distance < 1e30 && top < STACK {
                stack[top] = b.child;
                entries[top] = b.distance;
                top++;
            }
            at = a.child;
            goes_on = a.distance < 1e30;
            // What waits on the stack may lie behind what has been met since.
            for (var i = 0; i < STACK && !goes_on && top > 0; i++) {
                top--;
                goes_on = entries[top] <= nearest.distance;
                at = stack[top];
            }
        }
        nearest = nearest_in_leaf(nearest, sheared, at >> 3u, select(0u, at & 7u, goes_on));
        visit++;
        goes_on = false;
        for (var i = 0; i < STACK && !goes_on && top > 0; i++) {
            top--;
            goes_on = entries[top] <= nearest.distance;
            at = stack[top];
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
