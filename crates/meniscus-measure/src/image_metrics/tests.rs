use super::*;
use crate::random::SplitMix64;
use crate::{MAX_PSNR_DB, colour_error};

const SIZE: [u32; 2] = [40, 24];

/// Smooth colours with an edge and a few points.
fn picture() -> Image {
    let pixels = (0..SIZE[0] * SIZE[1]).map(|i| {
        let (x, y) = ((i % SIZE[0]) as f32 / 40.0, (i / SIZE[0]) as f32 / 24.0);
        let edge = if x + y > 1.0 { 0.4 } else { 0.0 };
        let point = if i % 97 == 0 { 0.3 } else { 0.0 };
        [
            0.1 + 0.4 * x + point,
            0.2 + 0.3 * y + edge,
            0.5 - 0.3 * x * y,
        ]
    });
    Image::new(SIZE, pixels.collect()).unwrap()
}

fn noisy(amplitude: f32) -> Image {
    let mut random = SplitMix64(17);
    let pixels = picture();
    let pixels = pixels.pixels().iter();
    let pixels = pixels.map(|p| p.map(|c| c + amplitude * (random.unit() as f32 - 0.5)));
    Image::new(SIZE, pixels.collect()).unwrap()
}

fn with_pixel(image: &Image, index: usize, colour: [f32; 3]) -> Image {
    let mut pixels = image.pixels().to_vec();
    pixels[index] = colour;
    Image::new(image.size(), pixels).unwrap()
}

fn value(metric: &Metric, a: &Image, b: &Image) -> f64 {
    metric.compare(a, b).unwrap().value
}

#[test]
fn equal_pictures_are_equal_by_every_measure() {
    for metric in METRICS {
        let found = metric.compare(&picture(), &picture()).unwrap();
        let best = match metric.name {
            "ssim" => 1.0,
            "psnr" => MAX_PSNR_DB,
            _ => 0.0,
        };
        assert!(
            (found.value - best).abs() < 1e-12,
            "{}: {}",
            metric.name,
            found.value
        );
        assert!(found.map.iter().all(|e| e.abs() < 1e-6), "{}", metric.name);
    }
}

#[test]
fn the_pictures_may_be_exchanged() {
    for metric in METRICS {
        let [there, back] = [
            value(metric, &picture(), &noisy(0.2)),
            value(metric, &noisy(0.2), &picture()),
        ];
        // Only the exposures of HDR-FLIP depend on which picture is the reference.
        let tolerance = if metric.name == "flip-hdr" {
            0.05
        } else {
            1e-12
        };
        assert!(
            (there / back - 1.0).abs() <= tolerance,
            "{}: {there} {back}",
            metric.name
        );
    }
}

#[test]
fn more_noise_is_worse_by_every_measure() {
    for metric in METRICS {
        let values: Vec<f64> = [0.05, 0.1, 0.2, 0.4, 0.8]
            .map(|amplitude| value(metric, &picture(), &noisy(amplitude)))
            .to_vec();
        for pair in values.windows(2) {
            // No better by definition of the measure; strictly worse but where Yee sees nothing yet.
            let worse =
                !metric.holds(pair[1], pair[0]) || metric.name == "yee" && pair[0] == pair[1];
            assert!(worse, "{}: {values:?}", metric.name);
        }
        assert!(values[0] != values[4]);
    }
}

#[test]
fn maps_stay_between_none_and_the_largest() {
    let white = Image::new(SIZE, vec![[1.0; 3]; 960]).unwrap();
    let black = Image::new(SIZE, vec![[0.0; 3]; 960]).unwrap();
    let hot = Image::new(SIZE, vec![[1e30, -1e30, f32::MAX]; 960]).unwrap();
    for metric in METRICS {
        for other in [&noisy(0.8), &white, &black, &hot] {
            let found = metric.compare(&picture(), other).unwrap();
            assert!(found.value.is_finite(), "{}", metric.name);
            assert!(
                found.map.iter().all(|e| (0.0..=1.0).contains(e)),
                "{}",
                metric.name
            );
            assert_eq!(found.picture().len(), 3 * 960);
        }
    }
    let largest = flip(&black, &white, &FlipOptions::default()).unwrap().value;
    assert!(largest > 0.9 && largest <= 1.0, "{largest}");
}

#[test]
fn a_broken_pixel_is_the_largest_error_and_spoils_no_neighbour() {
    let at = 12 * 40 + 20;
    for broken in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for metric in METRICS {
            let spoilt = with_pixel(&picture(), at, [0.5, broken, 0.5]);
            for (a, b) in [
                (&picture(), &spoilt),
                (&spoilt, &picture()),
                (&spoilt, &spoilt),
            ] {
                let found = metric.compare(a, b).unwrap();
                assert_eq!(found.map[at], 1.0, "{}", metric.name);
                let others = found.map.iter().enumerate().filter(|(i, _)| *i != at);
                assert!(others.map(|(_, e)| *e).all(|e| e < 1e-6), "{}", metric.name);
                let perfect = value(metric, &picture(), &picture());
                assert!(!metric.holds(found.value, perfect), "{}", metric.name);
            }
        }
    }
}

#[test]
fn pictures_of_different_sizes_are_refused() {
    let other = Image::new([24, 40], vec![[0.5; 3]; 960]).unwrap();
    for metric in METRICS {
        let said = metric.compare(&picture(), &other).unwrap_err().to_string();
        assert!(said.contains("24×40") && said.contains("40×24"), "{said}");
    }
}

#[test]
fn a_single_pixel_is_a_picture_to_all_but_ssim() {
    let one = |c: f32| Image::new([1, 1], vec![[c; 3]]).unwrap();
    for metric in METRICS {
        let found = metric.compare(&one(0.2), &one(0.8));
        assert_eq!(found.is_err(), metric.name == "ssim", "{}", metric.name);
    }
}

#[test]
fn ratio_and_root_mean_square_agree_with_each_other_and_with_the_ablation() {
    let (a, b) = (picture(), noisy(0.3));
    let (root, ratio) = (rmse(&a, &b).unwrap().value, psnr(&a, &b).unwrap().value);
    assert!((ratio + 20.0 * root.log10()).abs() < 1e-9);
    let masked = colour_error(b.pixels(), a.pixels(), &[true; 960])
        .unwrap()
        .unwrap();
    assert!((masked.rmse - root).abs() < 1e-12 && (masked.psnr - ratio).abs() < 1e-9);
}

#[test]
fn similarity_follows_its_definition_for_even_pictures() {
    // Without structure only the luminance term is left.
    let even = |code: u8| Image::from_srgb8([16, 16], &[code; 768]).unwrap();
    let (x, y) = (51.0 / 255.0, 204.0 / 255.0);
    let expected = (2.0 * x * y + 1e-4) / (x * x + y * y + 1e-4);
    let found = ssim(&even(51), &even(204)).unwrap().value;
    assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    // A picture and its negative are as unlike as can be.
    let stripes = |odd: bool| {
        let pixels = (0..256).map(|i| {
            if (i % 2 == 0) == odd {
                [1.0; 3]
            } else {
                [0.0; 3]
            }
        });
        Image::new([16, 16], pixels.collect()).unwrap()
    };
    assert!(ssim(&stripes(true), &stripes(false)).unwrap().value < -0.9);
}

#[test]
fn flip_forgives_from_afar_what_it_sees_from_near() {
    let at = |pixels_per_degree| {
        flip(&picture(), &noisy(0.4), &FlipOptions { pixels_per_degree })
            .unwrap()
            .value
    };
    assert!(at(20.0) > at(67.0) && at(67.0) > at(200.0));
    for senseless in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = FlipOptions {
            pixels_per_degree: senseless,
        };
        assert!(flip(&picture(), &picture(), &options).is_err());
    }
}

#[test]
fn only_high_dynamic_range_sees_errors_in_the_highlights() {
    let bright = |factor: f32| {
        let pixels = picture();
        let pixels = pixels.pixels().iter().enumerate();
        let pixels = pixels.map(|(i, p)| {
            if i < 400 {
                p.map(|c| c * 50.0 * factor)
            } else {
                *p
            }
        });
        Image::new(SIZE, pixels.collect()).unwrap()
    };
    let (a, b) = (bright(1.0), bright(1.5));
    let low = flip(&a, &b, &FlipOptions::default()).unwrap().value;
    let high = flip_hdr(&a, &b, &FlipOptions::default(), None)
        .unwrap()
        .value;
    assert!(low < 0.01 && high > 0.05, "{low} {high}");
}

#[test]
fn measures_are_found_by_name_and_unknown_names_are_answered_with_all() {
    for known in METRICS {
        assert_eq!(metric(known.name).unwrap().about, known.about);
    }
    let said = metric("flop").unwrap_err().to_string();
    assert!(METRICS.iter().all(|m| said.contains(m.name)), "{said}");
}
