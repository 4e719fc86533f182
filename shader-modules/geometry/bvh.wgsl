// What a ray meets first of all triangles of the scene: a walk through a tree of boxes with up to
// four children each, the nearest first. World space, metres. The stack is as deep as the host's trees
// may be. A walk of more than 4,096 nodes (far beyond what a million triangles ask for) ends with the
// nearest triangle found until then; a ray that is not finite meets nothing. For coordinates up to 1e6 m.
//
// provides: intersect
// needs: geometry/box, geometry/hit, geometry/nearest, geometry/ray, geometry/triangle, geometry/wide_node
// slots: reproject
// domain: the triangles of a scene, coordinates to 1e6 m

var<storage, read> bvh_wide_nodes: array<WideBvhNode>;

const MOST_NODES = 4096;
const STACK = 48;

fn nearest_triangle(ray: Ray) -> Nearest {
    let sheared = sheared_ray(ray);
    let inverse = box_inverse(ray.direction);
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
            let met = entered_children(node, ray.origin, inverse, nearest.distance);
            if met.fourth.distance < 1e30 && top < STACK {
                stack[top] = met.fourth.child;
                entries[top] = met.fourth.distance;
                top++;
            }
            if met.third.distance < 1e30 && top < STACK {
                stack[top] = met.third.child;
                entries[top] = met.third.distance;
                top++;
            }
            if met.second.distance < 1e30 && top < STACK {
                stack[top] = met.second.child;
                entries[top] = met.second.distance;
                top++;
            }
            at = met.first.child;
            goes_on = met.first.distance < 1e30;
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
