// Snell vertex transform as published: a point behind flat water stands on the straightened camera
// ray at the path's geometric length. Liu, Han, Fei 2020, eq. 2, with the horizontal direction and
// the camera's position corrected. World space, metres.
//
// provides: place
// needs: optics/flat_water, screen/target, water/body
// domain: place(point -1e4 to 1e4 from 1e-6)

fn place(point: vec3f) -> vec3f {
    let path = flat_path(point, view_target.eye);
    if path.point_depth <= 0.0 {
        return point;
    }
    let u = path.crossing.tangent;
    let tangents = select(vec2f(u * path.crossing.shrink, u), vec2f(u, u * path.crossing.shrink), path.eye_low);
    let slants = sqrt(1.0 + tangents * tangents);
    // Water point plus what is left of the way, with sin α = n sin β so that nothing is a difference.
    let depth = path.point_depth * slants.y / slants.x;
    let shift = path.point_depth * (water.relative_index - 1.0) * tangents.y;
    let apart = length(path.offset);
    let ahead = select(vec2f(0.0), path.offset / max(apart, 1e-18), apart > 0.0);
    return vec3f(point.xy + shift * ahead, water.level - water.camera_side * depth);
}
