// The sun and the sky.

// Linear RGB. `sun_direction`: unit vector towards the sun, world space. `sun_colour`: irradiance
// on a surface that faces it, over π; `ambient`: light from all around, over π. `horizon`, `zenith`:
// the sky's light; `deep`: what rays see that go down for ever.
struct Light {
    sun_direction: vec3f,
    sun_colour: vec3f,
    ambient: vec3f,
    horizon: vec3f,
    zenith: vec3f,
    deep: vec3f,
}

var<uniform> light: Light;
