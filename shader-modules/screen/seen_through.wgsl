// Where the ray that flat water deflects towards a place of the seen buffers meets a plane.
// No interpolation: the plane is a texel's, the ray belongs to the place itself. World space, metres;
// texels with centres at half integers.
//
// needs: geometry/ray, screen/seen_view, water/body
// slots: deflect
// domain: seen_through(texel -100 to 1e4, normal unit, distance -1e4 to 1e4 from 1e-6)

// `normal`: the plane's, unit; `distance`: of the plane from the eye along it, metres.
fn seen_through(texel: vec2f, normal: vec3f, distance: f32) -> vec3f {
    let ray = view_ray(view_seen(), texel);
    // Level rays never meet the plane of the water; they are bent as if they just did.
    let fall = max(-water.camera_side * ray.direction.z, 1e-6);
    let way = min(max(water.camera_side * (ray.origin.z - water.level), 0.0) / fall, 1e6);
    let crossing = ray.origin + way * ray.direction;
    let behind = deflect(Ray(crossing, ray.direction), vec3f(0.0, 0.0, 1.0)).ray;
    let slope = dot(normal, behind.direction);
    let offset = distance - dot(normal, crossing - ray.origin);
    let reach = offset / select(slope, 1e-6, abs(slope) < 1e-6);
    if reach < 0.0 {
        // Before the rest plane, under a crest, there is nothing that bends the ray.
        let straight = dot(normal, ray.direction);
        let before = distance / select(straight, 1e-6, abs(straight) < 1e-6);
        return ray.origin + clamp(before, 0.0, way) * ray.direction;
    }
    return crossing + min(reach, 1e6) * behind.direction;
}
