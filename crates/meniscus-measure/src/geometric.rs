//! The distance between the world point whose colour a pixel shows and the one it should show.
//!
//! A pixel's **position error** is the distance, in pixels, between the two points' projections
//! through flat water (the caller projects: through the mirrored camera for total reflection). Two
//! depths on one apparent ray are 0 px apart, so the distance in metres is told beside it.
//!
//! Only pixels whose true ray meets water first count, the same ones for every pipeline.

use crate::{
    BorderErrors, ColourError, Errors, FlipOptions, Image, MeasureError, Summary, colour_error,
    flip,
};

/// The object that a pixel without a world point has.
const NO_OBJECT: i32 = -1;
/// The object of a texel whose id is not a number: it equals no object of a scene.
const UNREADABLE: i32 = i32::MIN;

/// The world point of which a pixel shows the colour, and the object it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// World space, metres.
    pub position: [f64; 3],
    /// Object id; any negative id means that nothing was hit.
    pub object: i32,
}

impl Seen {
    /// Nothing was hit.
    pub const NOTHING: Self = Self {
        position: [0.0; 3],
        object: NO_OBJECT,
    };

    /// A texel of a `shown` buffer: position in x, y, z and object id in w.
    ///
    /// An id that is not finite belongs to no object, and makes the position unreadable as well.
    pub fn from_texel([x, y, z, w]: [f32; 4]) -> Self {
        if !w.is_finite() {
            return Self {
                position: [f64::NAN; 3],
                object: UNREADABLE,
            };
        }
        Self {
            position: [x, y, z].map(f64::from),
            // Ids are whole and below 2^24, so exact; a blend of two ids becomes a wrong object.
            object: if w < 0.0 { NO_OBJECT } else { w.round() as i32 },
        }
    }

    fn misses(&self) -> bool {
        self.object < 0 && self.object != UNREADABLE
    }

    fn is_finite(&self) -> bool {
        self.position.iter().all(|c| c.is_finite())
    }
}

/// What one side of a comparison knows of each pixel, row by row from the top left.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// The world points of which the colours are shown.
    pub points: &'a [Seen],
    /// Where those points stand on the screen, in pixels; `None` where a point has no projection.
    pub projected: &'a [Option<[f64; 2]>],
    /// Linear colours.
    pub colours: &'a [[f32; 3]],
}

/// One frame beside the truth.
#[derive(Debug, Clone, Copy)]
pub struct Comparison<'a> {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Pixels nearer to the frame's edge than this are the border band.
    pub border_px: u32,
    /// The diagonal of the scene in metres: the error in metres where one of the two points is
    /// missing or not finite, and the cap of every error in metres.
    pub scene_diagonal_m: f64,
    /// Pixels whose true ray meets water first.
    pub water: &'a [bool],
    /// Pixels without a physical answer: left out, and counted.
    pub undefined: &'a [bool],
    /// What the pipeline shows.
    pub shown: Picture<'a>,
    /// What it should show.
    pub truth: Picture<'a>,
}

/// What a comparison says of one pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// The true ray does not meet water first.
    Dry,
    /// There is no physical answer.
    Undefined,
    /// The error in pixels and in metres, both finite and capped.
    Error {
        /// Distance on the screen in pixels.
        px: f64,
        /// Distance in the world in metres.
        m: f64,
        /// Another object than the true one, or one of the two is missing.
        wrong_object: bool,
    },
}

/// The outcome of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Pixels whose true ray meets water first, the undefined ones included.
    pub water_pixels: u64,
    /// Those of them without a physical answer.
    pub undefined_pixels: u64,
    /// Judged pixels whose shown or true point is NaN or infinite.
    pub non_finite_pixels: u64,
    /// The figures over the judged pixels; `None` where there is none.
    pub errors: Option<Errors>,
    /// What was found pixel by pixel, for an error map.
    pub verdicts: Vec<Verdict>,
}

impl Comparison<'_> {
    /// Judges the frame.
    ///
    /// * Objects differ: wrong object; the error is the distance.
    /// * One of the two misses: wrong object, and an error of the frame's diagonal.
    /// * Both miss: no error.
    /// * A NaN, an infinity or a point without a projection: an error of the frame's diagonal.
    /// * No error exceeds the frame's diagonal in pixels, or the scene's in metres.
    /// * Undefined pixels are left out, whatever is shown there.
    ///
    /// # Errors
    /// [`MeasureError::Length`] when a slice does not have one value per pixel,
    /// [`MeasureError::Value`] when the scene's diagonal is not a positive number.
    pub fn judge(&self) -> Result<Judgement, MeasureError> {
        self.check()?;
        let verdicts: Vec<Verdict> = (0..self.water.len()).map(|i| self.verdict(i)).collect();
        let judged: Vec<bool> = verdicts
            .iter()
            .map(|v| matches!(v, Verdict::Error { .. }))
            .collect();
        let in_border: Vec<bool> = (0..judged.len())
            .map(|i| judged[i] && self.is_border(i))
            .collect();
        let flip = self.flip(&judged)?;
        let errors = match self.figures(&verdicts, &flip, &judged)? {
            None => None,
            Some(whole) => {
                let border = self.figures(&verdicts, &flip, &in_border)?;
                Some(Errors::new(whole, border))
            }
        };
        let count =
            |which: &dyn Fn(usize) -> bool| (0..judged.len()).filter(|i| which(*i)).count() as u64;
        Ok(Judgement {
            water_pixels: count(&|i| self.water[i]),
            undefined_pixels: count(&|i| verdicts[i] == Verdict::Undefined),
            non_finite_pixels: count(&|i| judged[i] && !self.is_finite(i)),
            errors,
            verdicts,
        })
    }

    fn check(&self) -> Result<(), MeasureError> {
        let pixels = self.size[0] as usize * self.size[1] as usize;
        for (what, found) in [
            ("mask of the water", self.water.len()),
            ("mask of the undefined pixels", self.undefined.len()),
            ("points shown", self.shown.points.len()),
            (
                "projections of the points shown",
                self.shown.projected.len(),
            ),
            ("colours shown", self.shown.colours.len()),
            ("true points", self.truth.points.len()),
            ("projections of the true points", self.truth.projected.len()),
            ("true colours", self.truth.colours.len()),
        ] {
            MeasureError::check_length(what, found, pixels)?;
        }
        if !(self.scene_diagonal_m.is_finite() && self.scene_diagonal_m > 0.0) {
            return Err(MeasureError::value(
                "diagonal of the scene",
                format!(
                    "{} m, where a positive number of metres is needed",
                    self.scene_diagonal_m
                ),
            ));
        }
        Ok(())
    }

    fn diagonal_px(&self) -> f64 {
        f64::from(self.size[0]).hypot(f64::from(self.size[1]))
    }

    fn is_border(&self, i: usize) -> bool {
        let [width, height] = self.size.map(|s| s as usize);
        let (x, y) = (i % width, i / width);
        let to_edge = x.min(width - 1 - x).min(y).min(height - 1 - y);
        to_edge < self.border_px as usize
    }

    // A miss has no position, so only what is shown there can be broken.
    fn is_finite(&self, i: usize) -> bool {
        let (shown, truth) = (&self.shown.points[i], &self.truth.points[i]);
        shown.is_finite() && (truth.misses() || truth.is_finite())
    }

    fn verdict(&self, i: usize) -> Verdict {
        if !self.water[i] {
            return Verdict::Dry;
        }
        if self.undefined[i] {
            return Verdict::Undefined;
        }
        let (shown, truth) = (&self.shown.points[i], &self.truth.points[i]);
        let (px, m) = if !self.is_finite(i) || shown.misses() != truth.misses() {
            (f64::INFINITY, f64::INFINITY)
        } else if shown.misses() || shown.position == truth.position {
            (0.0, 0.0)
        } else {
            (
                match (self.shown.projected[i], self.truth.projected[i]) {
                    (Some(a), Some(b)) => distance(&a, &b),
                    _ => f64::INFINITY,
                },
                distance(&shown.position, &truth.position),
            )
        };
        Verdict::Error {
            px: capped(px, self.diagonal_px()),
            m: capped(m, self.scene_diagonal_m),
            wrong_object: shown.misses() != truth.misses()
                || !truth.misses() && shown.object != truth.object,
        }
    }

    /// FLIP of each pixel; none without a pixel to judge. What is not judged is taken to be right, so
    /// that it does not reach into its neighbourhood.
    fn flip(&self, judged: &[bool]) -> Result<Vec<f32>, MeasureError> {
        if !judged.contains(&true) {
            return Ok(Vec::new());
        }
        let pixels = self.shown.colours.iter().zip(self.truth.colours);
        let shown = pixels
            .zip(judged)
            .map(|((shown, truth), judged)| match judged {
                true => *shown,
                false => *truth,
            });
        let shown = Image::new(self.size, shown.collect())?;
        let truth = Image::new(self.size, self.truth.colours.to_vec())?;
        Ok(flip(&truth, &shown, &FlipOptions::default())?.map)
    }

    fn figures(
        &self,
        verdicts: &[Verdict],
        flip: &[f32],
        inside: &[bool],
    ) -> Result<Option<BorderErrors>, MeasureError> {
        let mut px = Vec::new();
        let mut metres = Vec::new();
        let mut wrong = 0usize;
        for (verdict, _) in verdicts.iter().zip(inside).filter(|(_, inside)| **inside) {
            if let Verdict::Error {
                px: p,
                m,
                wrong_object,
            } = verdict
            {
                px.push(*p);
                metres.push(*m);
                wrong += usize::from(*wrong_object);
            }
        }
        let colour = colour_error(self.shown.colours, self.truth.colours, inside)?;
        let (Some(position_px), Some(position_m), Some(ColourError { rmse, psnr })) =
            (Summary::of(&px), Summary::of(&metres), colour)
        else {
            return Ok(None);
        };
        let flip = flip.iter().zip(inside).filter(|(_, inside)| **inside);
        let flip = flip.map(|(error, _)| f64::from(*error));
        let share = |count: usize| count as f64 / px.len() as f64;
        Ok(Some(BorderErrors {
            position_px,
            position_m,
            within_half_px: share(px.iter().filter(|e| **e <= 0.5).count()),
            wrong_object: share(wrong),
            rmse,
            psnr,
            flip: Some(flip.sum::<f64>() / px.len() as f64),
        }))
    }
}

fn distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    // Not the plain sum of squares: 1e200 m apart is far, not infinitely far.
    a.iter()
        .zip(b)
        .fold(0.0, |sum, (a, b)| f64::hypot(sum, a - b))
}

fn capped(error: f64, most: f64) -> f64 {
    // `min` returns `most` for a NaN.
    error.min(most)
}

#[cfg(test)]
#[path = "geometric_tests.rs"]
mod tests;
