//! Refraction from Snell's law in angles.

use super::vector::{along, dot, length, unit, vector};

/// Snell's law sin α = N sin β along the plane, by halving the distance until it cannot be halved:
/// the tangent on the side of the lower index, and the ratio of the tangents.
pub(super) fn crossing(low: f64, high: f64, apart: f64, index: f64) -> Vec<f64> {
    if low <= 0.0 || high <= 0.0 || apart <= 0.0 {
        return vec![f64::NAN; 2];
    }
    let (mut least, mut most) = (0.0, apart);
    for _ in 0..2000 {
        let x = 0.5 * (least + most);
        if x <= least || x >= most {
            break;
        }
        let y = apart - x;
        if x / x.hypot(low) < index * (y / y.hypot(high)) {
            least = x;
        } else {
            most = x;
        }
    }
    let tangent = 0.5 * (least + most) / low;
    // sin β = sin α / N, with cos β from it.
    let sine = tangent / tangent.hypot(1.0) / index;
    let other = sine / ((1.0 - sine) * (1.0 + sine)).sqrt();
    vec![tangent, other / tangent]
}

/// By angles, in the plane of incidence: incident (3), normal (3), index; direction (3).
pub(super) fn refraction(x: &[f64]) -> Vec<f64> {
    // Arguments are unit vectors to half a float's ulp; the truth takes their directions.
    let (incident, normal, index) = (unit(vector(x, 0)), unit(vector(x, 3)), x[6]);
    let side = if dot(incident, normal) > 0.0 {
        -1.0
    } else {
        1.0
    };
    let facing = normal.map(|c| side * c);
    let cosine = -dot(incident, facing);
    let tangential = along(incident, cosine, facing);
    let sine = length(tangential);
    let angle = sine.atan2(cosine).sin() / index;
    // Next to the critical angle rounding decides, and the truth has no opinion.
    if (angle - 1.0).abs() < 1e-5 {
        return vec![f64::NAN; 3];
    }
    if angle > 1.0 {
        return vec![0.0; 3];
    }
    let beyond = angle.asin();
    let sideways = tangential.map(|c| if sine > 0.0 { c / sine } else { 0.0 });
    let direction = along(facing.map(|c| -beyond.cos() * c), beyond.sin(), sideways);
    direction.to_vec()
}

/// Fresnel 1823 in angles: the mean of sin²(α − β) / sin²(α + β) and tan²(α − β) / tan²(α + β).
pub(super) fn fresnel(cosine: f64, index: f64) -> f64 {
    let incidence = cosine.abs().min(1.0).acos();
    let sine = incidence.sin() / index;
    if sine >= 1.0 {
        return 1.0;
    }
    let beyond = sine.asin();
    let (less, more) = (incidence - beyond, incidence + beyond);
    if more < 1e-6 {
        // Both quotients go to the same.
        return ((index - 1.0) / (index + 1.0)).powi(2);
    }
    let across = less.sin() / more.sin();
    // tan²(α − β) / tan²(α + β), which is 0 at Brewster's angle.
    let within = across * (more.cos() / less.cos());
    0.5 * (across * across + within * within)
}
