// The light of directions that meet nothing: from horizon to zenith, and what lies deep below.
// Linear RGB.

struct Sky {
    horizon: vec3f,
    zenith: vec3f,
    deep: vec3f,
}

var<uniform> sky: Sky;

// Along a unit direction in world space.
fn sky_colour(direction: vec3f) -> vec3f {
    if direction.z < 0.0 {
        return sky.deep;
    }
    return mix(sky.horizon, sky.zenith, direction.z);
}
