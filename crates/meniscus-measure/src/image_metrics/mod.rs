//! How far apart two pictures are, by several measures under one roof.
//!
//! Every measure takes a picture and its reference, both as [`Image`]s, and gives a value and an error
//! map. A pixel that is NaN or infinite in either picture counts as the largest error of the measure;
//! its neighbours are judged as if both pictures were equal there.

mod filter;
mod flip;
mod flip_colour;
mod flip_hdr;
mod image;
mod pixelwise;
mod ssim;
mod yee;

pub use flip::{FlipOptions, flip};
pub use flip_hdr::{Exposures, flip_hdr};
pub use image::Image;
pub use pixelwise::{psnr, rmse};
pub use ssim::ssim;
pub use yee::{Viewing, Yee, yee};

use crate::{MeasureError, heat};

/// What a measure found.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The value over the whole picture.
    pub value: f64,
    /// The error of each pixel, row by row from the top left: 0 is none, 1 the largest there is.
    pub map: Vec<f32>,
}

impl Difference {
    /// The map in false colours ([`heat::ramp`], linear), three bytes a pixel.
    pub fn picture(&self) -> Vec<u8> {
        self.map
            .iter()
            .flat_map(|error| heat::ramp(f64::from(*error)))
            .collect()
    }
}

/// Which values of a measure are good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// Small ones: the value is an error.
    Lower,
    /// Large ones: the value is a likeness.
    Higher,
}

/// A measure that can be asked for by name.
#[derive(Debug, Clone, Copy)]
pub struct Metric {
    /// Its name, as on a command line.
    pub name: &'static str,
    /// What it is, in one line, with the source.
    pub about: &'static str,
    /// The unit of its value; empty for a bare number.
    pub unit: &'static str,
    /// Which values are good.
    pub better: Better,
    compute: fn(&Image, &Image) -> Result<Difference, MeasureError>,
}

impl Metric {
    /// Measures `test` against `reference`.
    ///
    /// # Errors
    /// [`MeasureError`] when the pictures differ in size, or are too small for the measure.
    pub fn compare(&self, reference: &Image, test: &Image) -> Result<Difference, MeasureError> {
        (self.compute)(reference, test)
    }

    /// Whether `value` is as good as `limit` or better.
    pub fn holds(&self, value: f64, limit: f64) -> bool {
        match self.better {
            Better::Lower => value <= limit,
            Better::Higher => value >= limit,
        }
    }
}

/// Every measure there is, in the order they are listed to people.
pub const METRICS: &[Metric] = &[
    Metric {
        name: "flip",
        about: "FLIP, what a viewer sees who flips between the two (Andersson et al. 2020)",
        unit: "",
        better: Better::Lower,
        compute: |reference, test| flip(reference, test, &FlipOptions::default()),
    },
    Metric {
        name: "flip-hdr",
        about: "FLIP for high dynamic range, the worst of several exposures (Andersson et al. 2021)",
        unit: "",
        better: Better::Lower,
        compute: |reference, test| flip_hdr(reference, test, &FlipOptions::default(), None),
    },
    Metric {
        name: "yee",
        about: "share of the pixels where a difference can be seen (Yee 2004)",
        unit: "",
        better: Better::Lower,
        compute: |reference, test| Ok(yee(reference, test, &Viewing::default())?.difference()),
    },
    Metric {
        name: "ssim",
        about: "structural similarity of the luma, 1 for equal pictures (Wang et al. 2004)",
        unit: "",
        better: Better::Higher,
        compute: ssim,
    },
    Metric {
        name: "psnr",
        about: "peak signal-to-noise ratio in linear colour clamped to [0, 1], 200 dB at most",
        unit: "dB",
        better: Better::Higher,
        compute: psnr,
    },
    Metric {
        name: "rmse",
        about: "root mean square error in linear colour clamped to [0, 1]",
        unit: "",
        better: Better::Lower,
        compute: rmse,
    },
];

/// The measure of that name.
///
/// # Errors
/// [`MeasureError::Value`] with the names there are.
pub fn metric(name: &str) -> Result<&'static Metric, MeasureError> {
    METRICS.iter().find(|m| m.name == name).ok_or_else(|| {
        let names: Vec<&str> = METRICS.iter().map(|m| m.name).collect();
        MeasureError::value(
            format!("metric {name:?}"),
            format!("there is none of that name; there are {}", names.join(", ")),
        )
    })
}

/// Two pictures of one size, with what is not finite taken out.
struct Pair {
    size: [usize; 2],
    reference: Vec<[f64; 3]>,
    test: Vec<[f64; 3]>,
    /// Pixels that are not finite in either picture; both hold the same colour there.
    broken: Vec<bool>,
}

impl Pair {
    fn of(reference: &Image, test: &Image) -> Result<Self, MeasureError> {
        let ([w, h], [x, y]) = (reference.size(), test.size());
        if [w, h] != [x, y] {
            return Err(MeasureError::value(
                "size of the pictures",
                format!("{x}×{y} beside a reference of {w}×{h}; both must have the same size"),
            ));
        }
        let mut pair = Self {
            size: [w as usize, h as usize],
            reference: Vec::with_capacity(reference.pixels().len()),
            test: Vec::with_capacity(reference.pixels().len()),
            broken: Vec::with_capacity(reference.pixels().len()),
        };
        for (a, b) in reference.pixels().iter().zip(test.pixels()) {
            let (a, b) = (a.map(f64::from), b.map(f64::from));
            let finite = |p: &[f64; 3]| p.iter().all(|c| c.is_finite());
            let (stand_in, broken) = match (finite(&a), finite(&b)) {
                (true, true) => ((a, b), false),
                (true, false) => ((a, a), true),
                (false, true) => ((b, b), true),
                (false, false) => (([0.0; 3], [0.0; 3]), true),
            };
            pair.reference.push(stand_in.0);
            pair.test.push(stand_in.1);
            pair.broken.push(broken);
        }
        Ok(pair)
    }

    fn clamped(mut self, most: f64) -> Self {
        for pixel in self.reference.iter_mut().chain(&mut self.test) {
            *pixel = pixel.map(|c| c.clamp(0.0, most));
        }
        self
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn narrowed(values: &[f64]) -> Vec<f32> {
    values.iter().map(|v| *v as f32).collect()
}

#[cfg(test)]
mod against_flip_evaluator;
#[cfg(test)]
mod tests;
