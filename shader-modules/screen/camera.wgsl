// A pinhole camera: rays through pixels, and where points appear.
// World space, metres; pixels with centres at half integers and y down. Depth is reversed and
// without a far plane: near / distance along `forward`, 0 at infinity.
//
// needs: geometry/ray
// domain: View(eye -1e4 to 1e4 from 1e-6, right is 1 0 0, up is 0 0.6 0.8, forward is 0 0.8 -0.6, focal 1 to 1e5, size 1 to 16384, near 1e-3 to 1, seen_size 1 to 16384)
// domain: view_ray(pixel -1e4 to 2e4 from 1e-6) against camera ray
// domain: view_clip(point -1e4 to 1e4 from 1e-6)
// domain: view_pixel(point -1e4 to 1e4 from 1e-6) against camera pixel
// domain: view_is_nearer(point -1e4 to 1e4 from 1e-6, depth 0 to 1)

struct View {
    eye: vec3f,
    right: vec3f,
    up: vec3f,
    forward: vec3f,
    // Focal length, pixels.
    focal: f32,
    // Width and height, pixels.
    size: vec2f,
    // Distance of the near plane, metres.
    near: f32,
    // Size of the view with which the textures were drawn that a pass reads, pixels.
    seen_size: vec2f,
}

// The ray from the eye through a point of the picture.
fn view_ray(view: View, pixel: vec2f) -> Ray {
    let centred = pixel - 0.5 * view.size;
    let direction = view.forward * view.focal + view.right * centred.x - view.up * centred.y;
    return Ray(view.eye, normalize(direction));
}

// Clip-space position of a world point.
fn view_clip(view: View, point: vec3f) -> vec4f {
    let offset = point - view.eye;
    let scale = 2.0 * view.focal / view.size;
    return vec4f(
        dot(offset, view.right) * scale.x,
        dot(offset, view.up) * scale.y,
        view.near,
        dot(offset, view.forward),
    );
}

// Where a world point appears, in pixels (xy), and its distance along `forward`, metres (z).
// A point that is not before the eye appears where one just before it would.
fn view_pixel(view: View, point: vec3f) -> vec3f {
    let depth = dot(point - view.eye, view.forward);
    return vec3f(view_at_depth(view, point, max(depth, 1e-6)), depth);
}

// Where a world point appears of which the distance along `forward` is known, metres and more than 0.
fn view_at_depth(view: View, point: vec3f, depth: f32) -> vec2f {
    let offset = point - view.eye;
    let centred = vec2f(dot(offset, view.right), -dot(offset, view.up)) * (view.focal / depth);
    return 0.5 * view.size + centred;
}

// How far a ray is followed: metres along it, and the depths along `forward` of its ends, more than 0.
struct ViewEnds {
    far: f32,
    depths: vec2f,
}

// A ray followed for `reach` metres or, where it comes back, to the near plane. Its end there has the near
// plane's very depth, of which a difference of the way and the origin's depth would keep few digits.
fn view_ends(view: View, ray: Ray, reach: f32) -> ViewEnds {
    let depth = max(dot(ray.origin - view.eye, view.forward), 1e-6);
    let fall = -dot(ray.direction, view.forward);
    let to_near = max(depth - view.near, 1e-3) / max(fall, 1e-6);
    let last = select(depth - reach * fall, min(view.near, depth), to_near < reach);
    return ViewEnds(min(reach, to_near), vec2f(depth, max(last, 1e-6)));
}

// Whether a point stands before what a depth buffer holds at its pixel.
fn view_is_nearer(view: View, point: vec3f, depth: f32) -> bool {
    return depth * dot(point - view.eye, view.forward) < view.near;
}
