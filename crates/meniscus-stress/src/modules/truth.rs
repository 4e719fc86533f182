//! Independent solutions that headers may name: written from the physics, in `f64`, and sharing no
//! formula with modules.

use super::Host;

/// Names of the truths.
pub const TRUTHS: &[&str] = &["circle", "crossing", "refraction"];

/// The solution of a name, for what the host says of water and view; none where there is none of
/// that name.
pub fn truth(name: &str, host: &Host) -> Option<Box<crate::Truth<'static>>> {
    match name {
        "crossing" => {
            let index = host.number("water.larger_index")?;
            Some(Box::new(move |x| crossing(x[0], x[1], x[2], index)))
        }
        "circle" => Some(Box::new(|x| vec![x[0].cos(), x[0].sin()])),
        "refraction" => Some(Box::new(refraction)),
        _ => None,
    }
}

/// Snell's law sin α = N sin β along the plane, by halving the distance until it cannot be halved:
/// the tangent on the side of the lower index, and the ratio of the tangents.
fn crossing(low: f64, high: f64, apart: f64, index: f64) -> Vec<f64> {
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

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// By angles, in the plane of incidence: incident (3), normal (3), index; direction (3).
fn refraction(x: &[f64]) -> Vec<f64> {
    // Arguments are unit vectors to half a float's ulp; the truth takes their directions.
    let length = |v: &[f64]| dot(v, v).sqrt();
    let unit = |v: &[f64]| v.iter().map(|c| c / length(v)).collect::<Vec<f64>>();
    let (incident, normal, index) = (unit(&x[..3]), unit(&x[3..6]), x[6]);
    let side = if dot(&incident, &normal) > 0.0 {
        -1.0
    } else {
        1.0
    };
    let facing: Vec<f64> = normal.iter().map(|c| side * c).collect();
    let cosine = -dot(&incident, &facing);
    let along: Vec<f64> = (0..3).map(|i| incident[i] + cosine * facing[i]).collect();
    let sine = length(&along);
    let angle = sine.atan2(cosine).sin() / index;
    // Next to the critical angle rounding decides, and the truth has no opinion.
    if (angle - 1.0).abs() < 1e-5 {
        return vec![f64::NAN; 3];
    }
    if angle > 1.0 {
        return vec![0.0; 3];
    }
    let beyond = angle.asin();
    let tangent = |i: usize| if sine > 0.0 { along[i] / sine } else { 0.0 };
    (0..3)
        .map(|i| beyond.sin() * tangent(i) - beyond.cos() * facing[i])
        .collect()
}
