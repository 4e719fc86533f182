// Draws solid surfaces, each vertex where `place` says that it appears.
// Outputs: `colour` linear RGB; `position` the world point (metres) and object id, `apparent` the
// same with the point where it appears; `normal` the geometric and the shading normal, octahedral;
// `plane` the distance of the tangent plane from the eye, both normals and the id + 1, as bits;
// `height` how far it is above the rest plane (metres); `object` the id + 1; `shown` the world point and id.
//
// skeleton: draw
// appears: as place says
// outputs: colour, position, apparent, normal, plane, height, object, shown
// slots: place, shade, side
// needs: geometry/octahedral, screen/target, shading/surface_point, water/body
// number handedness: -1 to 1, step 2
// flat: geometric_normal

// −1 where `place` mirrors, so that what turns to the eye is turned round: 1 elsewhere.
override handedness: f32 = 1.0;

struct Varying {
    clip: vec4f,
    world: vec3f,
    apparent: vec3f,
    normal: vec3f,
    geometric_normal: vec3f,
    object: u32,
}

fn vertex(position: vec3f, normal: vec3f, geometric_normal: vec3f, object: u32) -> Varying {
    let apparent = place(position);
    return Varying(view_clip(view_target, apparent), position, apparent, normal, geometric_normal, object);
}

struct Drawn {
    point: SurfacePoint,
    apparent: vec3f,
}

fn fragment(v: Varying, front: bool) -> Drawn {
    let normal = normalize(v.normal);
    let facing = select(-handedness, handedness, front);
    return Drawn(SurfacePoint(v.world, normal, v.geometric_normal, facing, v.object), v.apparent);
}

fn keep(drawn: Drawn) -> bool {
    return side(drawn.point.position);
}

fn write_colour(drawn: Drawn) -> vec4f {
    return vec4f(shade(drawn.point), 1.0);
}

fn write_position(drawn: Drawn) -> vec4f {
    return vec4f(drawn.point.position, f32(drawn.point.object));
}

fn write_apparent(drawn: Drawn) -> vec4f {
    return vec4f(drawn.apparent, f32(drawn.point.object));
}

fn write_normal(drawn: Drawn) -> vec4f {
    return vec4f(octahedral_encoded(drawn.point.geometric_normal), octahedral_encoded(drawn.point.normal));
}

fn write_plane(drawn: Drawn) -> vec4u {
    let point = drawn.point;
    let distance = dot(point.geometric_normal, point.position - view_target.eye);
    let normal = pack2x16snorm(octahedral_encoded(point.geometric_normal));
    let shading_normal = pack2x16snorm(octahedral_encoded(point.normal));
    return vec4u(bitcast<u32>(distance), normal, shading_normal, point.object + 1u);
}

fn write_height(drawn: Drawn) -> f32 {
    return drawn.point.position.z - water.level;
}

fn write_object(drawn: Drawn) -> f32 {
    return f32(drawn.point.object + 1u);
}

fn write_shown(drawn: Drawn) -> vec4f {
    return vec4f(drawn.point.position, f32(drawn.point.object));
}
