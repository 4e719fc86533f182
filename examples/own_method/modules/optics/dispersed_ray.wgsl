// Refraction of one colour of light: the refractive index rises towards the blue.
// After Cauchy's equation, n(λ) = n (1 + C (1/λ² − 1/λ₀²)), n being the scene's index. World space,
// unit directions. Where all light is reflected, the mirrored ray.
//
// provides: deflect
// needs: geometry/ray, optics/deflected, optics/snell, water/body
// number wavelength: 380 to 780 nm, step 10
// number dispersion: 0 to 1e5 nm², step 100
// domain: deflect(normal unit)

override wavelength: f32 = 450.0;
override dispersion: f32 = 3100.0;

// Sodium light, for which the scene's index is meant.
const REFERENCE = 589.3;

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    let rise = dispersion * (1.0 / (wavelength * wavelength) - 1.0 / (REFERENCE * REFERENCE));
    // The index is that of the far side relative to the camera's: under water it falls instead.
    let index = water.relative_index * select(1.0 / (1.0 + rise), 1.0 + rise, water.relative_index > 1.0);
    let behind = refracted(incident.direction, normal, index);
    if behind.total {
        return Deflected(Ray(incident.origin, reflect(incident.direction, normal)), true);
    }
    return Deflected(Ray(incident.origin, behind.direction), false);
}
