//! Two frames of one moment, held against each other.

use std::collections::BTreeSet;

use glam::DVec3;
use meniscus_gpu::{Frame, GpuError, Pixels};
use meniscus_reference::apparent_pixel;
use meniscus_scene::{Scene, View};

use crate::lists::listed;

/// What is at a pixel with all pruning and with none, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// With all pruning.
    pub pruned: String,
    /// With none.
    pub whole: String,
}

/// Pixels of an output that differ.
pub(super) struct Found {
    pub output: String,
    pub pixels: usize,
    pub first: Place,
}

fn found(output: &str, differing: Vec<Place>) -> Option<Found> {
    let pixels = differing.len();
    differing.into_iter().next().map(|first| Found {
        output: output.to_owned(),
        pixels,
        first,
    })
}

/// What comes out of two frames, bit for bit: the picture, what is shown where the plans tell it,
/// and which pixels were listed.
pub(super) fn compare_bits(
    pruned: &Frame,
    whole: &Frame,
    size: [u32; 2],
) -> Result<impl Iterator<Item = Found>, GpuError> {
    let mut all = Vec::new();
    let outputs = [Some(&whole.plan().output), whole.plan().shown.as_ref()];
    for output in outputs.into_iter().flatten() {
        let (one, two) = (pruned.read(output)?, whole.read(output)?);
        all.extend(found(&format!("`{output}`"), differing(&one, &two)));
    }
    for name in whole.plan().lists.keys() {
        let list = |frame| listed(frame, name, size).map(BTreeSet::from_iter);
        let (one, two) = (list(pruned)?, list(whole)?);
        let said = |list: &BTreeSet<[u32; 2]>, pixel| match list.contains(pixel) {
            true => "listed".to_owned(),
            false => "not listed".to_owned(),
        };
        let differing = one.symmetric_difference(&two).map(|pixel| Place {
            pixel: *pixel,
            pruned: said(&one, pixel),
            whole: said(&two, pixel),
        });
        all.extend(found(&format!("the list `{name}`"), differing.collect()));
    }
    Ok(all.into_iter())
}

fn differing(pruned: &Pixels, whole: &Pixels) -> Vec<Place> {
    let bits = |texel: &[f32]| texel.iter().map(|n| n.to_bits()).collect::<Vec<_>>();
    let mut places = Vec::new();
    for y in 0..whole.size.y {
        for x in 0..whole.size.x {
            let (one, two) = (pruned.at(x, y), whole.at(x, y));
            if one.map(bits) != two.map(bits) {
                places.push(Place {
                    pixel: [x, y],
                    pruned: format!("{:?}", one.unwrap_or_default()),
                    whole: format!("{:?}", two.unwrap_or_default()),
                });
            }
        }
    }
    places
}

/// What a frame shows at its pixels.
pub(super) struct Seen(Pixels);

impl Seen {
    pub fn read(frame: &Frame) -> Result<Self, GpuError> {
        let plan = frame.plan();
        frame
            .read(plan.shown.as_ref().unwrap_or(&plan.output))
            .map(Self)
    }

    fn at(&self, x: i64, y: i64) -> Option<(DVec3, f32)> {
        let texel = self.0.at(u32::try_from(x).ok()?, u32::try_from(y).ok()?)?;
        let [x, y, z, object] = texel else {
            return None;
        };
        Some((DVec3::new((*x).into(), (*y).into(), (*z).into()), *object))
    }

    /// Whether an object is seen at a pixel or within so many pixels of it.
    fn has_near(&self, object: f32, x: i64, y: i64, reach: i64) -> bool {
        let around = || -reach..=reach;
        let mut places = around().flat_map(|i| around().map(move |j| (x + i, y + j)));
        places.any(|(x, y)| self.at(x, y).is_some_and(|(_, other)| other == object))
    }
}

/// By how many pixels what is shown lies elsewhere, at most; and the pixels where it is off by more
/// than `within_px`.
///
/// A pixel is right if its point appears, through flat water, that near to where the other frame's
/// point appears, and if the objects are the same or outlines pass so near: each object is seen by
/// the other frame as near as that.
pub(super) fn compare_shown(
    pruned: &Seen,
    whole: &Seen,
    scene: &Scene,
    view: &View,
    within_px: f64,
) -> (f64, Option<Found>) {
    let reach = within_px.ceil().max(1.0) as i64;
    let (mut largest, mut places) = (0.0_f64, Vec::new());
    for y in 0..i64::from(whole.0.size.y) {
        for x in 0..i64::from(whole.0.size.x) {
            let (Some(one), Some(two)) = (pruned.at(x, y), whole.at(x, y)) else {
                continue;
            };
            let moved = if one.1 == two.1 {
                match one.1 < 0.0 {
                    true => 0.0,
                    false => distance(one.0, two.0, scene, view),
                }
            } else if whole.has_near(one.1, x, y, reach) && pruned.has_near(two.1, x, y, reach) {
                0.0
            } else {
                f64::INFINITY
            };
            if moved <= within_px {
                largest = largest.max(moved);
            } else {
                let said = |(point, object): (DVec3, f32)| format!("object {object} at {point}");
                places.push(Place {
                    pixel: [x as u32, y as u32],
                    pruned: said(one),
                    whole: said(two),
                });
            }
        }
    }
    (largest, found("what is shown", places))
}

/// How far apart two points appear through flat water, pixels.
fn distance(one: DVec3, two: DVec3, scene: &Scene, view: &View) -> f64 {
    let [one, two] = [one, two].map(|point| apparent_pixel(point, scene, view));
    match (one, two) {
        (Some(one), Some(two)) => one.distance(two),
        (None, None) => 0.0,
        _ => f64::INFINITY,
    }
}
