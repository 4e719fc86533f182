// The light of directions that meet nothing: from horizon to zenith, and what lies deep below.
// Linear RGB.
//
// needs: shading/light
// domain: sky_colour(direction unit)

// Along a unit direction in world space.
fn sky_colour(direction: vec3f) -> vec3f {
    if direction.z < 0.0 {
        return light.deep;
    }
    return mix(light.horizon, light.zenith, direction.z);
}
