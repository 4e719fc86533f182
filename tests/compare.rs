//! `meniscus compare`: what it prints, and how it ends.

mod common;

use std::path::Path;

use common::{Said, folder, meniscus};
use image::{Rgb, RgbImage};

/// A grey gradient, with `change` added to every colour.
fn picture(path: &Path, change: i16) {
    let colour = |x: u32, y: u32| {
        let grey = (60 + x + 2 * y) as i16 + change;
        Rgb([grey.clamp(0, 255) as u8; 3])
    };
    RgbImage::from_fn(32, 24, colour)
        .save(path)
        .expect("a picture is written");
}

/// Two pictures that differ by `change` in every channel.
fn pair(directory: &Path, change: i16) -> [String; 2] {
    [("a.png", 0), ("b.png", change)].map(|(name, change)| {
        let path = directory.join(name);
        picture(&path, change);
        path.to_str().expect("UTF-8").to_owned()
    })
}

fn compare([a, b]: &[String; 2], more: &[&str]) -> Said {
    let arguments = ["compare", a, b].into_iter().chain(more.iter().copied());
    meniscus(arguments)
}

/// The number in `NAME VALUE UNIT`.
#[track_caller]
fn value(said: &Said, metric: &str) -> f64 {
    let mut words = said.out.split_whitespace();
    assert_eq!(words.next(), Some(metric), "{said:?}");
    let number = words.next().and_then(|word| word.parse().ok());
    number.unwrap_or_else(|| panic!("no number: {said:?}"))
}

/// Measures that are errors, and those that are likenesses.
const ERRORS: [&str; 4] = ["flip", "flip-hdr", "yee", "rmse"];
const LIKENESSES: [&str; 2] = ["ssim", "psnr"];

#[test]
fn a_picture_is_as_good_as_itself_by_every_measure() {
    let there = folder();
    let same = pair(there.path(), 0);
    for metric in ERRORS {
        let said = compare(&same, &["--metric", metric, "--limit", "0"]);
        assert_eq!(
            (said.code, value(&said, metric)),
            (Some(0), 0.0),
            "{said:?}"
        );
    }
    for (metric, best) in LIKENESSES.into_iter().zip(["1", "200"]) {
        let said = compare(&same, &["--metric", metric, "--limit", best]);
        assert_eq!(said.code, Some(0), "{said:?}");
    }
}

#[test]
fn a_larger_change_is_worse_by_every_measure() {
    let there = folder();
    for (metrics, sign) in [(&ERRORS[..], 1.0), (&LIKENESSES[..], -1.0)] {
        for metric in metrics.iter().filter(|m| **m != "yee") {
            let measured = [4, 16, 64].map(|change| {
                let said = compare(&pair(there.path(), change), &["--metric", metric]);
                assert_eq!(said.code, Some(0), "without a limit all is well: {said:?}");
                sign * value(&said, metric)
            });
            assert!(measured.is_sorted(), "{metric}: {measured:?}");
            assert!(measured[0] < measured[2], "{metric}: {measured:?}");
        }
    }
}

#[test]
fn the_end_tells_on_which_side_of_the_limit_it_is() {
    let there = folder();
    let pair = pair(there.path(), 20);
    for (metric, good, bad) in [("rmse", "0.5", "0.001"), ("psnr", "5", "90")] {
        let within = compare(&pair, &["--metric", metric, "--limit", good]);
        assert_eq!(within.code, Some(0), "{within:?}");
        let beyond = compare(&pair, &["--metric", metric, "--limit", bad]);
        assert_eq!(beyond.code, Some(1), "{beyond:?}");
        assert_eq!(value(&beyond, metric), value(&within, metric));
        assert!(beyond.err.contains("limit"), "{beyond:?}");
    }
}

#[test]
fn the_map_is_as_large_as_the_pictures_and_dark_where_they_agree() {
    let there = folder();
    let map = there.path().join("map.png");
    let name = map.to_str().expect("UTF-8");
    let mut brightest = Vec::new();
    for change in [0, 60] {
        let said = compare(&pair(there.path(), change), &["--map", name]);
        assert_eq!(said.code, Some(0), "{said:?}");
        let map = image::open(&map).expect("a map").into_rgb8();
        assert_eq!(map.dimensions(), (32, 24));
        let light = |p: &Rgb<u8>| p.0.iter().map(|c| u32::from(*c)).sum::<u32>();
        brightest.push(map.pixels().map(light).max());
    }
    assert!(brightest[0] < brightest[1], "{brightest:?}");
}

#[test]
fn what_cannot_be_compared_ends_with_2_and_says_why() {
    let there = folder();
    let same = pair(there.path(), 0);
    let small = there.path().join("small.png");
    RgbImage::new(8, 8).save(&small).expect("a picture");
    let text = there.path().join("text.png");
    std::fs::write(&text, "no picture").expect("a file");
    let inside = format!("{}/map.png", text.display());
    let with = |path: &Path| [same[0].clone(), path.to_str().expect("UTF-8").to_owned()];
    for (said, words) in [
        (compare(&with(&small), &[]), "same size"),
        (compare(&with(&text), &[]), "text.png"),
        (
            compare(&with(&there.path().join("none.png")), &[]),
            "none.png",
        ),
        (compare(&same, &["--metric", "flipp"]), "flip-hdr"),
        (compare(&same, &["--limit", "nan"]), "finite"),
        // A file is no directory that a map could be put in.
        (compare(&same, &["--map", &inside]), "text.png"),
    ] {
        assert_eq!(said.code, Some(2), "{said:?}");
        assert!(said.err.contains(words) && said.out.is_empty(), "{said:?}");
    }
}
