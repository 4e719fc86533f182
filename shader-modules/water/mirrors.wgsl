// What flat water mirrors to an eye under it: points on its side of the rest plane whose light arrives at
// more than the critical angle. World space, metres.
// With e and s the distances of the eye and the point from the plane, and d the horizontal one, all light
// is reflected where tan² θ = d² / (e + s)² exceeds 1 / (N² − 1).
//
// provides: side
// needs: screen/target, water/body
// domain: side(point -1e4 to 1e4 from 1e-6)

fn side(point: vec3f) -> bool {
    let apart = point.xy - view_target.eye.xy;
    let below = water.camera_side * (point.z - water.level);
    let depth = abs(view_target.eye.z - water.level) + below;
    return below >= 0.0 && dot(apart, apart) * water.root_high * water.root_high > depth * depth;
}
