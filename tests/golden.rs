//! Pictures that people have looked at, and from which new ones may not differ much.
//!
//! A golden image that is missing fails; it is never made in passing. `MENISCUS_GOLDEN=write` makes
//! them all anew: look at each before it is committed (README.md).

mod common;

use std::path::{Path, PathBuf};

use common::{folder, meniscus, text, words};
use image::RgbImage;

/// How far a picture may be from its golden image.
struct Tolerance {
    /// Mean of the absolute differences of all channels, of 255.
    mean: f64,
    /// Share of the pixels of which a channel differs by more than [`VISIBLE`], `0 ..= 1`.
    visible: f64,
}

/// A difference that can be seen, of 255.
const VISIBLE: u8 = 8;

/// The golden images were made with Mesa's software rasteriser. Its versions differ in the last bits,
/// which move an edge by a pixel here and there.
const SAME_RASTERISER: Tolerance = Tolerance {
    mean: 0.1,
    visible: 0.003,
};

/// Others place edges and filter textures in ways of their own. The ray tracer on the CPU, which
/// rasterises nothing, is 0.04 and 0.07 % away from these images where water is flat; a refractive
/// index of 1.34 instead of 1.333 moves them by 3.2 and 14 %.
const OTHER_ADAPTER: Tolerance = Tolerance {
    mean: 0.5,
    visible: 0.015,
};

fn golden(name: &str) -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    tests.join("golden").join(format!("{name}.png"))
}

fn open(path: &Path) -> RgbImage {
    match image::open(path) {
        Ok(picture) => picture.to_rgb8(),
        Err(error) => panic!("{}: {error}", path.display()),
    }
}

/// Renders at 160×90 and compares with the golden image of this name.
#[track_caller]
fn looks_like(name: &str, arguments: &str) {
    let there = folder();
    let path = there.path().join("picture.png");
    let line = format!("render {arguments} --size 160x90");
    let mut line = words(&line);
    line.extend(["-o", text(&path)]);
    let told = meniscus(&line).done();
    let golden = golden(name);
    if std::env::var_os("MENISCUS_GOLDEN").is_some_and(|said| said == "write") {
        std::fs::create_dir_all(golden.parent().expect("a directory")).expect("a directory");
        std::fs::copy(&path, &golden).expect("the golden image can be written");
        return;
    }
    assert!(
        golden.exists(),
        "{} is missing; make it by `MENISCUS_GOLDEN=write cargo test --test golden`, and look at it",
        golden.display()
    );
    let (picture, golden_picture) = (open(&path), open(&golden));
    assert_eq!(picture.dimensions(), golden_picture.dimensions(), "{name}");
    let (mean, visible) = difference(&picture, &golden_picture);
    let tolerance = match told.contains("llvmpipe") {
        true => SAME_RASTERISER,
        false => OTHER_ADAPTER,
    };
    if mean > tolerance.mean || visible > tolerance.visible {
        // It is kept, to be looked at.
        let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
        std::fs::copy(&path, &kept).expect("the picture can be kept");
        panic!(
            "{name}: mean difference {mean:.3} of 255 (at most {}), {:.2} % of the pixels differ \
             visibly (at most {:.2} %), rendered {told}the picture: {}\nthe golden one: {}",
            tolerance.mean,
            100.0 * visible,
            100.0 * tolerance.visible,
            kept.display(),
            golden.display()
        );
    }
}

/// Mean absolute difference of the channels, and share of the pixels that differ visibly.
fn difference(one: &RgbImage, other: &RgbImage) -> (f64, f64) {
    let mut sum = 0.0;
    let mut visible = 0;
    for (a, b) in one.pixels().zip(other.pixels()) {
        let apart: [u8; 3] = std::array::from_fn(|channel| a.0[channel].abs_diff(b.0[channel]));
        sum += apart.iter().map(|d| f64::from(*d)).sum::<f64>();
        visible += usize::from(apart.iter().any(|d| *d > VISIBLE));
    }
    let pixels = f64::from(one.width() * one.height());
    (sum / (3.0 * pixels), visible as f64 / pixels)
}

#[test]
fn without_refraction() {
    looks_like("none", "refraction/none");
}

#[test]
fn the_broad_phase_through_flat_water() {
    looks_like("broad-flat", "refraction/broad --set water.rms_slope=0");
}

#[test]
fn both_phases_through_flat_water() {
    looks_like(
        "combined-flat",
        "refraction/combined --set water.rms_slope=0",
    );
}

#[test]
fn both_phases_through_waves() {
    looks_like(
        "combined-waves",
        "refraction/combined --set water.rms_slope=0.05",
    );
}

#[test]
fn from_under_the_water() {
    looks_like("underwater", "refraction/ray-traced --scene underwater");
}

#[test]
fn golden_images_tell_methods_apart_even_with_the_loose_tolerance() {
    if std::env::var_os("MENISCUS_GOLDEN").is_some() {
        return;
    }
    for (one, other) in [
        ("none", "broad-flat"),
        ("none", "combined-waves"),
        ("combined-flat", "combined-waves"),
    ] {
        let (mean, visible) = difference(&open(&golden(one)), &open(&golden(other)));
        assert!(mean > 2.0 * OTHER_ADAPTER.mean, "{one}, {other}: {mean}");
        assert!(
            visible > 2.0 * OTHER_ADAPTER.visible,
            "{one}, {other}: {visible}"
        );
    }
    // Through flat water the narrow phase changes nothing.
    let (mean, _) = difference(
        &open(&golden("broad-flat")),
        &open(&golden("combined-flat")),
    );
    assert!(mean < OTHER_ADAPTER.mean, "{mean}");
}
