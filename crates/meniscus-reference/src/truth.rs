//! The answers for a picture.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::UVec2;
use meniscus_scene::{Scene, View};
use rayon::prelude::*;

use crate::path::{Path, Tracer};
use crate::shading;

/// What is true of one pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Linear RGB: of the solid that the ray ends on, else of the sky; black where `undefined`.
    pub colour: [f32; 3],
    /// The point seen, in world space (metres); 0 where nothing is.
    pub point: [f64; 3],
    /// Id of the object seen, −1 where there is none.
    pub object: i32,
    /// Whether the ray from the eye meets the water before any solid.
    pub water_first: bool,
    /// Whether there is no physical answer (see [`Path::undefined`]).
    pub undefined: bool,
    /// Whether the ray is totally reflected where it first meets the water.
    pub total: bool,
    /// How often the ray meets the water.
    pub events: u8,
}

/// What is true of every pixel of a view: row by row from the top, one value a pixel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Truth {
    /// Width and height, pixels.
    pub size: UVec2,
    /// As [`Sample::colour`].
    pub colour: Vec<[f32; 3]>,
    /// As [`Sample::point`].
    pub point: Vec<[f64; 3]>,
    /// As [`Sample::object`].
    pub object: Vec<i32>,
    /// As [`Sample::water_first`]: the mask that errors are counted over.
    pub water_first: Vec<bool>,
    /// As [`Sample::undefined`]: to be left out of that mask.
    pub undefined: Vec<bool>,
    /// As [`Sample::total`].
    pub total: Vec<bool>,
    /// As [`Sample::events`].
    pub events: Vec<u8>,
}

/// Traces every pixel of a view through its centre, on all cores.
///
/// `progress` is told the share done, from any thread, about once a row; the last call says 1.
pub fn trace(scene: &Scene, view: &View, progress: &(dyn Fn(f64) + Sync)) -> Truth {
    Tracer::new(scene).trace(view, progress)
}

impl Tracer<'_> {
    /// See [`trace`].
    pub fn trace(&self, view: &View, progress: &(dyn Fn(f64) + Sync)) -> Truth {
        let done = AtomicUsize::new(0);
        let rows: Vec<Vec<Sample>> = (0..view.size.y)
            .into_par_iter()
            .map(|y| {
                let row = (0..view.size.x)
                    .map(|x| self.sample(view, UVec2::new(x, y)))
                    .collect();
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress(done as f64 / f64::from(view.size.y));
                row
            })
            .collect();
        let mut truth = Truth {
            size: view.size,
            ..Truth::default()
        };
        for sample in rows.into_iter().flatten() {
            truth.push(sample);
        }
        truth
    }

    /// Traces some pixels, by column and row, on all cores; the answers come in the same order.
    pub fn trace_pixels(&self, view: &View, pixels: &[UVec2]) -> Vec<Sample> {
        pixels
            .par_iter()
            .map(|&pixel| self.sample(view, pixel))
            .collect()
    }

    fn sample(&self, view: &View, pixel: UVec2) -> Sample {
        self.see(&self.trace_pixel(view, pixel.as_dvec2() + 0.5))
    }

    /// What is seen along a path.
    pub fn see(&self, path: &Path) -> Sample {
        let colour = match &path.hit {
            _ if path.undefined.is_some() => glam::DVec3::ZERO,
            Some(hit) => shading::shade(self.scene, hit, path.direction),
            None => shading::sky(&self.scene.sky, path.direction),
        };
        Sample {
            colour: colour.as_vec3().to_array(),
            point: path.hit.map_or([0.0; 3], |hit| hit.point.to_array()),
            object: path.hit.map_or(-1, |hit| hit.object as i32),
            water_first: path.water_first(),
            undefined: path.undefined.is_some(),
            total: path.total(),
            events: path.events.len() as u8,
        }
    }
}

impl Truth {
    fn push(&mut self, sample: Sample) {
        self.colour.push(sample.colour);
        self.point.push(sample.point);
        self.object.push(sample.object);
        self.water_first.push(sample.water_first);
        self.undefined.push(sample.undefined);
        self.total.push(sample.total);
        self.events.push(sample.events);
    }
}
