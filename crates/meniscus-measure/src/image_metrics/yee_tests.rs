use super::*;

#[test]
fn thresholds_rise_with_luminance_without_jumps() {
    let at = |log: f64| threshold_versus_intensity(10f64.powf(log)).log10();
    for i in -600..400 {
        let log = f64::from(i) / 100.0;
        let rise = at(log + 0.01) - at(log);
        // The pieces of the published fit meet to a hundredth of a decade.
        assert!((-0.012..0.03).contains(&rise), "{rise} at {log}");
    }
    // Weber's law in daylight.
    assert!((at(4.0) - at(3.0) - 1.0).abs() < 1e-9);
}

#[test]
fn sensitivity_peaks_between_coarse_and_fine() {
    let at = |cycles| contrast_sensitivity(cycles, FREQUENCY_LUMINANCE);
    let best = (1..6000)
        .map(|i| f64::from(i) / 100.0)
        .max_by(|a, b| at(*a).total_cmp(&at(*b)))
        .unwrap();
    assert!((best - BEST_FREQUENCY).abs() < 0.02, "{best}");
    assert!(contrast_sensitivity(1e4, 100.0) >= 0.0);
    assert!(contrast_sensitivity(3.0, 100.0) > contrast_sensitivity(3.0, 0.1));
}

#[test]
fn masking_only_ever_raises() {
    assert!((masking(0.0) - 1.0).abs() < 1e-12);
    let values: Vec<f64> = (0..100).map(|i| masking(f64::from(i))).collect();
    assert!(values.windows(2).all(|w| w[0] <= w[1]) && values[99] > 1.0);
}

#[test]
fn senseless_viewing_is_refused() {
    let image = Image::new([1, 1], vec![[0.5; 3]]).unwrap();
    let plain = Viewing::default();
    for viewing in [
        Viewing {
            field_of_view: 0.0,
            ..plain
        },
        Viewing {
            field_of_view: 180.0,
            ..plain
        },
        Viewing {
            field_of_view: f64::NAN,
            ..plain
        },
        Viewing {
            white: -1.0,
            ..plain
        },
        Viewing {
            white: f64::INFINITY,
            ..plain
        },
        Viewing {
            colour_weight: f64::NAN,
            ..plain
        },
    ] {
        assert!(yee(&image, &image, &viewing).is_err(), "{viewing:?}");
    }
}

#[test]
fn a_step_in_luminance_is_seen_once_it_is_large_enough() {
    let flat = |level: f32| Image::new([32, 32], vec![[level; 3]; 1024]).unwrap();
    let seen = |level| {
        yee(&flat(0.5), &flat(level), &Viewing::default())
            .unwrap()
            .visible_pixels
    };
    assert_eq!(seen(0.5), 0);
    assert_eq!(seen(0.505), 0);
    assert_eq!(seen(0.6), 1024);
}

#[test]
fn colour_alone_is_seen_in_daylight_and_not_at_night() {
    // About equal in luminance, far apart in hue.
    let flat = |colour: [f32; 3]| Image::new([16, 16], vec![colour; 256]).unwrap();
    let (a, b) = (flat([0.40, 0.20, 0.2]), flat([0.2, 0.2595, 0.2]));
    let seen = |viewing| yee(&a, &b, &viewing).unwrap().visible_pixels;
    let day = Viewing::default();
    assert_eq!(seen(day), 256);
    assert_eq!(
        seen(Viewing {
            colour_weight: 0.0,
            ..day
        }),
        0
    );
    assert_eq!(seen(Viewing { white: 0.1, ..day }), 0);
}

#[test]
fn a_busy_picture_hides_what_an_even_one_shows() {
    let noise = |i: usize| {
        if (i * 7919 / 13).is_multiple_of(2) {
            0.35
        } else {
            0.0
        }
    };
    let picture = |busy: bool, shift: f32| {
        let pixels = (0..64 * 64).map(|i| [0.3 + f32::from(u8::from(busy)) * noise(i) + shift; 3]);
        Image::new([64, 64], pixels.collect()).unwrap()
    };
    let seen = |busy| {
        yee(
            &picture(busy, 0.0),
            &picture(busy, 0.03),
            &Viewing::default(),
        )
        .unwrap()
        .visible_pixels
    };
    assert!(
        seen(true) < seen(false) / 4,
        "{} {}",
        seen(true),
        seen(false)
    );
}

#[test]
fn what_is_too_fine_to_be_resolved_is_judged_all_the_same() {
    // Thousands of cycles per degree: the sensitivity underflows.
    let picture = |level: f32| Image::new([64, 64], vec![[level; 3]; 64 * 64]).unwrap();
    let narrow = Viewing {
        field_of_view: 1e-3,
        ..Viewing::default()
    };
    let seen = |level| {
        yee(&picture(0.1), &picture(level), &narrow)
            .unwrap()
            .visible_pixels
    };
    assert_eq!((seen(0.1), seen(1.0)), (0, 64 * 64));
}

/// Pairs with known verdicts, which are not part of this project.
#[test]
fn known_pairs_get_their_verdicts() {
    let Some(directory) = std::env::var_os("MENISCUS_PERCEPTUAL_PAIRS") else {
        eprintln!("skipped: MENISCUS_PERCEPTUAL_PAIRS does not name the directory of the pairs");
        return;
    };
    for (name, differ) in [
        ("Bug1102605", true),
        ("Bug1471457", false),
        ("cam_mb", false),
    ] {
        let read = |suffix: &str| {
            let path = std::path::Path::new(&directory).join(format!("{name}{suffix}.tif"));
            Image::read(&path).unwrap()
        };
        let found = yee(&read("_ref"), &read(""), &Viewing::default()).unwrap();
        eprintln!("{name}: {} visible pixels", found.visible_pixels);
        assert_eq!(found.visible_pixels >= Yee::DEFAULT_LIMIT, differ, "{name}");
    }
}
