// A node of a tree of boxes with up to four children, and which of them a ray enters.
// Boxes are kept in bytes: see Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs
// Through Compressed Wide BVHs", HPG. World space, metres.
//
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

// Four of them, the nearest first.
struct EnteredChildren {
    first: Entered,
    second: Entered,
    third: Entered,
    fourth: Entered,
}

// The children that a ray enters before `farthest`, the others at 1e30; `inverse`: of its direction,
// finite. The far distances are enlarged by the rounding of all: see `geometry/box`.
fn entered_children(node: WideBvhNode, origin: vec3f, inverse: vec3f, farthest: f32) -> EnteredChildren {
    let backwards = inverse < vec3f(0.0);
    let base = (node.low - origin) * inverse;
    let scale = node.step * inverse;
    let near_x = base.x + scale.x * four_bytes(select(node.low_x, node.high_x, backwards.x));
    let near_y = base.y + scale.y * four_bytes(select(node.low_y, node.high_y, backwards.y));
    let near_z = base.z + scale.z * four_bytes(select(node.low_z, node.high_z, backwards.z));
    let far_x = base.x + scale.x * four_bytes(select(node.high_x, node.low_x, backwards.x));
    let far_y = base.y + scale.y * four_bytes(select(node.high_y, node.low_y, backwards.y));
    let far_z = base.z + scale.z * four_bytes(select(node.high_z, node.low_z, backwards.z));
    let enters = max(max(near_x, near_y), max(near_z, vec4f(0.0)));
    let leaves = min(min(far_x, far_y), min(far_z, vec4f(farthest))) * 1.000001;
    let children = vec4u(node.first, node.second, node.third, node.fourth);
    let met = (enters <= leaves) & (children != vec4u(NO_CHILD));
    let distances = select(vec4f(1e30), enters, met);
    var a = Entered(children.x, distances.x);
    var b = Entered(children.y, distances.y);
    var c = Entered(children.z, distances.z);
    var d = Entered(children.w, distances.w);
    // A sorting network.
    nearer_first(&a, &b);
    nearer_first(&c, &d);
    nearer_first(&a, &c);
    nearer_first(&b, &d);
    nearer_first(&b, &c);
    return EnteredChildren(a, b, c, d);
}
