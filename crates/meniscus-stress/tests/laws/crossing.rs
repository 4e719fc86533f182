//! The crossing of flat water against halving, an independent solution.

use meniscus_stress::modules::{Choice, truth};
use meniscus_stress::{Dual, Lanes};

use crate::lab::*;

const LANES: usize = 4000;

/// Ranges of the distances on the sides of the lower and the higher index, and apart.
type Ranges = [(f64, f64); 3];
const ROOM: Ranges = [(0.3, 30.0), (0.01, 10.0), (0.05, 200.0)];
const GAME: Ranges = [(0.01, 1000.0), (0.001, 100.0), (0.001, 3000.0)];
const SIX_DECADES: Ranges = [(1e-3, 1e3), (1e-3, 1e3), (1e-3, 3e3)];

/// Indices that are floats, so that the truth solves the same problem.
fn indices() -> [f64; 6] {
    [1.333_f32, 1.0001, 1.05, 1.5, 2.0, 2.5].map(f64::from)
}

/// Largest error of the tangent in units of 2⁻²³ of it, plain and divided by (1 + condition).
fn largest_error(module: &str, function: &str, ranges: &Ranges) -> (f64, f64) {
    let composer = composer(&[]);
    let mut rng = rng();
    let (mut largest, mut scaled) = (0.0_f64, 0.0_f64);
    for index in indices() {
        let lab = Lab::with(&composer, module, &Choice::default()).water(index, true);
        let [low, high, mut apart] =
            ranges.map(|(least, most)| decades(&mut rng, least, most, LANES));
        let root = ((index - 1.0) * (index + 1.0)).sqrt();
        for lane in (0..LANES).step_by(2) {
            // Every other one near the critical distance.
            let near = 1.0 + f64::exp2(-24.0 * rng.f64()) * if rng.bool() { 1.0 } else { -0.5 };
            let critical = f64::from((high[lane] / root * near) as f32);
            apart[lane] = critical.clamp(ranges[2].0, ranges[2].1) as f32 as f64;
        }
        let solve = truth("crossing", &lab.host).expect("a truth");
        let arguments = [scalars::<f32>(&low), scalars(&high), scalars(&apart)];
        let found = lab.call(function, &arguments);
        let conditions = condition(&lab, function, [&low, &high, &apart]);
        for lane in 0..LANES {
            let right = solve(&[low[lane], high[lane], apart[lane]]);
            let error = (number(&found, 0, lane) / right[0] - 1.0).abs() * f64::exp2(23.0);
            assert!(
                error.is_finite(),
                "{module}: {} {} {}",
                low[lane],
                high[lane],
                apart[lane]
            );
            largest = largest.max(error);
            scaled = scaled.max(error / (1.0 + conditions[lane]));
        }
    }
    (largest, scaled)
}

fn condition(lab: &Lab, function: &str, given: [&[f64]; 3]) -> Vec<f64> {
    let mut sums = vec![0.0; given[0].len()];
    for seeded in 0..3 {
        let argument = |(at, column): (usize, &&[f64])| {
            let dual = |&x: &f64| Dual::new(x, if at == seeded { x } else { 0.0 });
            let column = meniscus_stress::Column::Float(column.iter().map(dual).collect());
            Lanes {
                columns: vec![column],
            }
        };
        let arguments: Vec<Lanes<Dual>> = given.iter().enumerate().map(argument).collect();
        let found = lab.call(function, &arguments);
        for (sum, dual) in sums.iter_mut().zip(found.floats(0).expect("floats")) {
            *sum += (dual.slope / dual.value).abs();
        }
    }
    sums
}

#[test]
fn the_split_form_is_right_to_4_ulp_over_six_decades_without_a_fused_multiplication() {
    for ranges in [ROOM, GAME, SIX_DECADES] {
        let (error, _) = largest_error("optics/crossing_split", "crossing", &ranges);
        println!("split {ranges:?}: {error}");
        assert!(error <= 4.0, "{error}");
    }
}

#[test]
fn the_plain_form_is_right_to_4_ulp_times_the_condition() {
    for ranges in [ROOM, GAME, SIX_DECADES] {
        let (error, scaled) = largest_error("optics/flat_crossing", "flat_crossing", &ranges);
        println!("plain {ranges:?}: {error}, scaled {scaled}");
        assert!(scaled <= 4.0, "{scaled} (unscaled {error})");
    }
}

#[test]
fn the_schemes_for_comparison_are_worse_each_as_its_header_says() {
    let error = |module: &str| {
        let (error, _) = largest_error(module, "crossing", &ROOM);
        println!("{module}: {error}");
        error
    };
    assert!(error("optics/crossing_newton") > 100.0);
    assert!(error("optics/crossing_bisection") > 100.0);
    assert!(error("optics/crossing_fixed_point") > 1e4);
}

#[test]
fn schemes_that_are_allowed_more_steps_converge_to_the_same_crossing() {
    let composer = composer(&[]);
    let mut rng = rng();
    let (low, high) = (
        within(&mut rng, 1.0, 3.0, LANES),
        within(&mut rng, 0.5, 2.0, LANES),
    );
    let apart = within(&mut rng, 0.1, 3.0, LANES);
    for (module, steps) in [
        ("optics/crossing_newton", 16.0),
        ("optics/crossing_bisection", 40.0),
        ("optics/crossing_fixed_point", 64.0),
    ] {
        let more = Choice {
            numbers: [("steps".to_owned(), steps)].into(),
            ..Choice::default()
        };
        let lab = Lab::with(&composer, module, &more);
        let solve = truth("crossing", &lab.host).expect("a truth");
        let found: Lanes<f64> = lab.call(
            "crossing",
            &[scalars(&low), scalars(&high), scalars(&apart)],
        );
        for lane in 0..LANES {
            let right = solve(&[low[lane], high[lane], apart[lane]]);
            let error = (number(&found, 0, lane) / right[0] - 1.0).abs();
            // The square of √M is a float's.
            assert!(error < 2e-7, "{module}: {error}");
        }
    }
}

#[test]
fn the_seed_is_within_41_per_cent_of_the_root() {
    let lab = Lab::of("optics/crossing_seed");
    let mut rng = rng();
    for index in indices() {
        let mut host = lab.host.clone();
        host.water(index, true);
        let solve = truth("crossing", &host).expect("a truth");
        let (low, high) = (
            decades(&mut rng, 1e-3, 1e3, LANES),
            decades(&mut rng, 1e-3, 1e3, LANES),
        );
        let apart = decades(&mut rng, 1e-3, 3e3, LANES);
        let root = ((index - 1.0) * (index + 1.0)).sqrt();
        let found: Lanes<f64> = lab.call(
            "crossing_seed",
            &[
                scalars(&low),
                scalars(&high),
                scalars(&apart),
                scalars(&vec![index; LANES]),
                scalars(&vec![root; LANES]),
            ],
        );
        for lane in 0..LANES {
            let right = solve(&[low[lane], high[lane], apart[lane]])[0];
            let ratio = number(&found, 0, lane) / right;
            assert!((0.85..=1.42).contains(&ratio), "{ratio} at {index}");
        }
    }
}

#[test]
fn crossings_move_outwards_with_the_distance() {
    for module in ["optics/flat_crossing", "optics/crossing_split"] {
        let lab = Lab::of(module);
        let name = if module.ends_with("split") {
            "crossing"
        } else {
            "flat_crossing"
        };
        let mut rng = rng();
        let (low, high) = (
            decades(&mut rng, 1e-2, 1e2, LANES),
            decades(&mut rng, 1e-2, 1e2, LANES),
        );
        let apart = decades(&mut rng, 1e-2, 1e2, LANES);
        let further: Vec<f64> = apart.iter().map(|d| d * 1.001).collect();
        let near: Lanes<f32> = lab.call(name, &[scalars(&low), scalars(&high), scalars(&apart)]);
        let far: Lanes<f32> = lab.call(name, &[scalars(&low), scalars(&high), scalars(&further)]);
        for lane in 0..LANES {
            assert!(number(&far, 0, lane) > number(&near, 0, lane));
            // The ray beyond bends towards the vertical, the more the flatter it comes.
            assert!(number(&far, 1, lane) <= number(&near, 1, lane) * (1.0 + 2e-7));
        }
    }
}
