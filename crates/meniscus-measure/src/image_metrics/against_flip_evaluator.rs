//! FLIP beside the program of its authors, where Python has it (`pip install flip-evaluator numpy`).

use std::process::Command;

use super::*;
use crate::random::SplitMix64;
use crate::{NpyData, npy_bytes, write_atomically};

const SIZE: [u32; 2] = [120, 80];

/// Reads pairs of arrays of linear colours and prints one mean per line.
const PROGRAM: &str = "
import sys
import numpy
import flip_evaluator
kind, *names = sys.argv[1:]
for reference, test in zip(names[::2], names[1::2]):
    result = flip_evaluator.evaluate(numpy.load(reference), numpy.load(test), kind,
                                     inputsRGB=False, applyMagma=False)
    print('mean', repr(float(result[1])))
";

/// Three kinds of pictures: smooth, with edges, with fine noise.
fn picture(kind: usize, brightness: f32) -> Vec<[f32; 3]> {
    let mut random = SplitMix64(kind as u64);
    (0..SIZE[0] * SIZE[1])
        .map(|i| {
            let (x, y) = ((i % SIZE[0]) as f32 / 120.0, (i / SIZE[0]) as f32 / 80.0);
            let colour = match kind {
                0 => [x, y, 1.0 - x * y],
                1 => {
                    let tile = ((x * 12.0) as u32 + (y * 8.0) as u32) % 3;
                    [[0.9, 0.1, 0.1], [0.1, 0.7, 0.2], [0.05, 0.1, 0.8]][tile as usize]
                }
                _ => [random.unit() as f32, 0.5 * x, random.unit() as f32 * y],
            };
            // Dark corners and highlights, for the exposures to differ.
            colour.map(|c| c * (brightness * (x * y).powi(2) + 0.05))
        })
        .collect()
}

fn disturbed(pixels: &[[f32; 3]], kind: usize) -> Vec<[f32; 3]> {
    let mut random = SplitMix64(99 + kind as u64);
    let width = SIZE[0] as usize;
    (0..pixels.len())
        .map(|i| {
            // Shifted by two pixels on one side, brighter and noisy on the other.
            let source = if i % width < width / 2 { i + 2 } else { i };
            let gain = 0.9 + 0.4 * random.unit() as f32;
            pixels[source.min(pixels.len() - 1)].map(|c| c * gain)
        })
        .collect()
}

fn agreement(kind: &str, brightness: f32, ours: impl Fn(&Image, &Image) -> f64) {
    let directory = tempfile::tempdir().unwrap();
    let mut names = Vec::new();
    let mut expected = Vec::new();
    for i in 0..3 {
        let clamp = |c: f32| if kind == "LDR" { c.min(1.0) } else { c };
        let reference: Vec<[f32; 3]> = picture(i, brightness)
            .iter()
            .map(|p| p.map(clamp))
            .collect();
        let test: Vec<[f32; 3]> = disturbed(&reference, i)
            .iter()
            .map(|p| p.map(clamp))
            .collect();
        for (name, pixels) in [("reference", &reference), ("test", &test)] {
            let path = directory.path().join(format!("{i}-{name}.npy"));
            let shape = [SIZE[1] as usize, SIZE[0] as usize, 3];
            let bytes = npy_bytes(&shape, NpyData::F32(pixels.as_flattened())).unwrap();
            write_atomically(&path, &bytes).unwrap();
            names.push(path);
        }
        let image = |pixels| Image::new(SIZE, pixels).unwrap();
        expected.push(ours(&image(reference), &image(test)));
    }
    let run = Command::new("python3")
        .args(["-c", PROGRAM, kind])
        .args(&names)
        .output();
    let Ok(run) = run else {
        eprintln!("skipped: there is no python3 to run flip-evaluator with");
        return;
    };
    if !run.status.success() {
        let said = String::from_utf8_lossy(&run.stderr);
        assert!(
            said.contains("ModuleNotFoundError"),
            "flip-evaluator failed: {said}"
        );
        eprintln!("skipped: python3 has no flip-evaluator (pip install flip-evaluator numpy)");
        return;
    }
    let theirs: Vec<f64> = String::from_utf8_lossy(&run.stdout)
        .lines()
        .filter_map(|line| line.strip_prefix("mean ")?.parse().ok())
        .collect();
    assert_eq!(theirs.len(), 3);
    for (ours, theirs) in expected.iter().zip(&theirs) {
        eprintln!("{kind}: ours {ours:.8}, theirs {theirs:.8}");
        assert!(*theirs > 0.01, "the pictures differ");
        // Four digits.
        assert!(
            (ours / theirs - 1.0).abs() < 5e-5,
            "{kind}: {ours} {theirs}"
        );
    }
}

#[test]
fn low_dynamic_range_agrees_to_four_digits() {
    agreement("LDR", 1.0, |reference, test| {
        flip(reference, test, &FlipOptions::default())
            .unwrap()
            .value
    });
}

#[test]
fn high_dynamic_range_agrees_to_four_digits() {
    agreement("HDR", 60.0, |reference, test| {
        flip_hdr(reference, test, &FlipOptions::default(), None)
            .unwrap()
            .value
    });
}
