// Diffuse shading by the sun and by light from all around, with tile lines where a material has
// them. World space, metres; linear RGB. The lines lie in the axis plane that the geometric normal
// is nearest to.
//
// provides: shade
// needs: shading/light, shading/surface_point
// domain: shade()

struct Material {
    colour: vec3f,
    line_colour: vec3f,
    tile_size: f32,
    line_width: f32,
    tile_offset: f32,
}

struct Object {
    material: u32,
}

var<storage, read> objects: array<Object>;
var<storage, read> materials: array<Material>;

// Whether a point is on a line between tiles.
fn on_line(material: Material, point: SurfacePoint) -> bool {
    let n = abs(point.geometric_normal);
    var at = point.position.xy;
    if n.x >= n.y && n.x >= n.z {
        at = point.position.yz;
    } else if n.y >= n.z {
        at = point.position.xz;
    }
    let part = fract((at + material.tile_offset) / max(material.tile_size, 1e-6));
    return any(part * material.tile_size < vec2f(material.line_width));
}

fn shade(point: SurfacePoint) -> vec3f {
    let material = materials[objects[point.object].material];
    let albedo = select(material.colour, material.line_colour, on_line(material, point));
    let normal = point.normal * point.facing;
    let sunlight = light.sun_colour * max(dot(normal, light.sun_direction), 0.0);
    return albedo * (sunlight + light.ambient * (0.5 + 0.5 * normal.z));
}
