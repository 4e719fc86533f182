//! How far what a pass makes on the CPU is from what it makes on the GPU.

use std::collections::BTreeSet;

use meniscus_cpu::{Store, Texels};
use meniscus_pipeline::Format;

/// How far one texture or buffer that a pass writes is from the GPU's.
#[derive(Debug, Clone, PartialEq)]
pub struct PassDifference {
    /// The texture or buffer.
    pub resource: String,
    /// Its texels, or its words; of a list, the pixels in either of the two.
    pub texels: usize,
    /// Those of them that differ in any bit.
    pub differing: usize,
    /// Those of them that differ by more than [`bound`] allows.
    pub beyond: usize,
    /// The largest difference, as a share of the largest number of the texel.
    pub largest: f64,
}

/// How far numbers of a format may be apart: a share of the texel's largest number.
///
/// Half floats: two units in the last place, since adapters may cut where the CPU rounds. Single
/// precision: what divisions and roots that are good to a few units in the last place leave after
/// some hundred operations. Eight bits: one step. Whole numbers are equal.
pub fn bound(format: Format) -> f64 {
    match format {
        Format::Rgba16Float => f64::exp2(-9.0),
        Format::Rgba8Unorm => 1.001 / 255.0,
        Format::R32Uint | Format::Rgba32Uint => 0.0,
        _ => f64::exp2(-16.0),
    }
}

/// Numbers smaller than this count as of this size, so that rounding about 0 is not a difference.
const LEAST: f64 = 1e-3;

pub(super) fn of(cpu: &Store, gpu: &Store, name: &str, is_list: bool) -> Option<PassDifference> {
    if let (Some(cpu), Some(gpu)) = (cpu.textures.get(name), gpu.textures.get(name)) {
        return Some(of_textures(cpu, gpu, name));
    }
    let (cpu, gpu) = (cpu.buffers.get(name)?, gpu.buffers.get(name)?);
    let (texels, differing) = match is_list {
        true => {
            let (cpu, gpu) = (listed(cpu), listed(gpu));
            let either = cpu.union(&gpu).count();
            (either, cpu.symmetric_difference(&gpu).count())
        }
        false => (
            cpu.len(),
            cpu.iter().zip(gpu).filter(|(a, b)| a != b).count(),
        ),
    };
    Some(PassDifference {
        resource: name.to_owned(),
        texels,
        differing,
        beyond: differing,
        largest: f64::from(u8::from(differing > 0)),
    })
}

/// The pixels of a list, behind their count; threads append in any order.
fn listed(words: &[u32]) -> BTreeSet<u32> {
    let count = words.first().map_or(0, |count| *count as usize);
    words.iter().skip(1).take(count).copied().collect()
}

fn of_textures(cpu: &Texels, gpu: &Texels, name: &str) -> PassDifference {
    let mut found = PassDifference {
        resource: name.to_owned(),
        texels: gpu.words.len(),
        differing: 0,
        beyond: 0,
        largest: 0.0,
    };
    let allowed = bound(gpu.format);
    for (a, b) in cpu.words.iter().zip(&gpu.words) {
        if a == b {
            continue;
        }
        found.differing += 1;
        let share = match gpu.format {
            Format::R32Uint | Format::Rgba32Uint => 1.0,
            _ => share(a, b),
        };
        found.largest = found.largest.max(share);
        found.beyond += usize::from(share > allowed);
    }
    found
}

/// The largest difference of the numbers, as a share of the largest of them.
fn share(a: &[u32; 4], b: &[u32; 4]) -> f64 {
    let number = |word: &u32| f64::from(f32::from_bits(*word));
    let (mut apart, mut size) = (0.0_f64, LEAST);
    for (a, b) in a.iter().map(number).zip(b.iter().map(number)) {
        if a.is_finite() && b.is_finite() {
            apart = apart.max((a - b).abs());
            size = size.max(a.abs()).max(b.abs());
        } else if a.is_nan() != b.is_nan() || (!a.is_nan() && a != b) {
            return f64::INFINITY;
        }
    }
    apart / size
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(format: Format, numbers: &[[f32; 4]]) -> Texels {
        Texels {
            size: [numbers.len() as u32, 1],
            format,
            words: numbers.iter().map(|t| t.map(f32::to_bits)).collect(),
        }
    }

    #[test]
    fn what_is_equal_does_not_differ_and_what_is_no_number_does() {
        let one = texture(Format::Rgba32Float, &[[1.0, 2.0, f32::NAN, 0.0]; 3]);
        assert_eq!(of_textures(&one, &one, "x").differing, 0);
        let other = texture(Format::Rgba32Float, &[[1.0, 2.0, 3.0, 0.0]; 3]);
        let found = of_textures(&one, &other, "x");
        assert_eq!((found.differing, found.beyond), (3, 3));
        assert!(found.largest.is_infinite());
    }

    #[test]
    fn differences_are_held_to_the_format_s_bound() {
        for (format, step) in [(Format::Rgba16Float, 1e-3), (Format::Rgba32Float, 1e-5)] {
            let one = texture(format, &[[1.0; 4]; 2]);
            let near = texture(format, &[[1.0, 1.0 + step, 1.0, 1.0], [1.0; 4]]);
            let found = of_textures(&one, &near, "x");
            assert_eq!((found.differing, found.beyond), (1, 0), "{format:?}");
            let far = texture(format, &[[1.0, 1.0 + 9.0 * step, 1.0, 1.0], [1.0; 4]]);
            assert_eq!(of_textures(&one, &far, "x").beyond, 1, "{format:?}");
        }
    }

    #[test]
    fn lists_are_sets() {
        let store = |words: &[u32]| Store {
            buffers: [("list".to_owned(), words.to_vec())].into(),
            ..Store::default()
        };
        let one = store(&[2, 5, 7, 99]);
        let found = of(&one, &store(&[2, 7, 5, 0]), "list", true);
        assert_eq!(found.map(|f| (f.texels, f.differing)), Some((2, 0)));
        let found = of(&one, &store(&[1, 7, 5, 0]), "list", true);
        assert_eq!(found.map(|f| (f.texels, f.differing)), Some((2, 1)));
    }
}
