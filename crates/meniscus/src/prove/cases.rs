//! Configurations: a camera, a water and a time, drawn so that every rule has its turn.

use fastrand::Rng;
use meniscus_scene::Scene;

use super::Proof;

/// One configuration: settings of the scene beside those that were given.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Its number; 0 is the scene as it stands.
    pub number: u32,
    /// Keys and values, as `--set` takes them.
    pub settings: Vec<(&'static str, String)>,
}

/// What is done to a scene between two pictures of a case.
pub(super) struct Moment {
    pub name: &'static str,
    pub change: fn(&mut Scene),
}

/// Moments of every case, in order.
pub(super) const MOMENTS: [Moment; 5] = [
    Moment {
        name: "at first",
        change: |_| {},
    },
    Moment {
        name: "with nothing changed",
        change: |_| {},
    },
    Moment {
        name: "0.4 s later",
        change: |scene| scene.set_time(scene.water.time + 0.4),
    },
    Moment {
        name: "with another sun",
        change: |scene| scene.sun.colour *= 0.5,
    },
    Moment {
        name: "a step aside",
        change: |scene| {
            let aside = glam::DVec3::new(0.11, -0.07, 0.0);
            scene.camera.eye += aside;
            scene.camera.target += 2.0 * aside;
        },
    },
];

/// The scene as it stands, and random cases.
pub(super) fn drawn(proof: &Proof) -> Vec<Case> {
    let mut all = vec![Case {
        number: 0,
        settings: Vec::new(),
    }];
    for number in 1..=proof.cases {
        // A case depends on its number alone, not on how many there are.
        let mut rng = Rng::with_seed(proof.seed ^ (u64::from(number) << 32));
        let given = |key: &str| proof.settings.iter().any(|s| s.key.value.trim() == key);
        let mut settings = case(&mut rng);
        settings.retain(|(key, _)| !given(key));
        all.push(Case { number, settings });
    }
    all
}

/// A number between two, with few digits, so that it can be read and written again.
fn between(rng: &mut Rng, low: f64, high: f64) -> String {
    format!("{:.3}", low + (high - low) * rng.f64())
}

fn case(rng: &mut Rng) -> Vec<(&'static str, String)> {
    let mut settings: Vec<(&'static str, String)> = Vec::new();
    let mut set = |key, value| settings.push((key, value));
    set("camera.position.x", between(rng, -3.0, 3.0));
    set("camera.position.y", between(rng, -3.5, 1.8));
    // Above the water, high above it, under it, and amid the waves.
    let height = match rng.u8(0..10) {
        0..5 => between(rng, 0.3, 2.5),
        5 => between(rng, 4.0, 12.0),
        6..9 => between(rng, -1.6, -0.1),
        _ => between(rng, -0.05, 0.08),
    };
    let eye: f64 = height.parse().unwrap_or(1.0);
    set("camera.height", height);
    set("camera.target.x", between(rng, -3.2, 3.2));
    set("camera.target.y", between(rng, 2.0, 4.5));
    // At the water, level, up (where no water is in view from above), or steeply down.
    let target = match rng.u8(0..8) {
        0..4 => between(rng, -1.5, 0.0),
        4 => format!("{:.3}", eye + 0.3 * (rng.f64() - 0.5)),
        5 | 6 => between(rng, eye + 1.0, eye + 8.0),
        _ => between(rng, eye - 20.0, eye - 4.0),
    };
    set("camera.target.z", target);
    if rng.u8(0..3) == 0 {
        set("camera.field_of_view", between(rng, 15.0, 110.0));
    }
    if rng.u8(0..6) == 0 {
        set("camera.near", between(rng, 0.01, 0.6));
    }
    let slope = match rng.u8(0..4) {
        0 => "0".to_owned(),
        1 => between(rng, 0.0, 0.01),
        _ => between(rng, 0.01, 0.3),
    };
    set("water.rms_slope", slope);
    let geometry = ["flat", "displaced"][rng.usize(0..2)];
    set("water.geometry", geometry.to_owned());
    set("water.time", between(rng, 0.0, 60.0));
    if rng.u8(0..4) == 0 {
        set("water.refractive_index", between(rng, 1.0, 2.0));
    }
    settings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_seeds_draw_equal_cases_and_others_others() {
        let draw = |seed| case(&mut Rng::with_seed(seed));
        assert_eq!(draw(3), draw(3));
        assert_ne!(draw(3), draw(4));
    }
}
