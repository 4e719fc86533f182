//! Which clusters of triangles a pass cannot show: their boxes, moved as the pass's modules say that
//! they move points, lie outside of its view.

use glam::{DVec2, DVec3};
use meniscus_scene::{View, Water};
use meniscus_shader::{Filling, Library, Name};
use meniscus_source::Diagnostic;
use std::collections::BTreeMap;

/// Pixels by which a view is widened: the adapter's vertices are rounded.
const MARGIN_PX: f64 = 1.0;

/// Boxes are widened by this part of the numbers in them, since single precision rounds those.
const ROUNDED: f64 = 1e-5;

/// Where a point may appear, as a module says in a line of its header, `appears: …`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum Appears {
    /// Where it is.
    InPlace,
    /// Before the water where it is; behind it on the vertical through it, on its side of the rest
    /// plane: no farther from that than it is where what lies behind is the optically denser, and no
    /// nearer where it is the thinner.
    OnVertical,
    /// As far behind the rest plane as it is before it.
    Mirrored,
}

/// The words for them.
const WORDS: [(&str, Appears); 3] = [
    ("in place", Appears::InPlace),
    ("on its vertical", Appears::OnVertical),
    ("mirrored", Appears::Mirrored),
];

impl Appears {
    /// In the words of a header.
    pub fn words(self) -> &'static str {
        let of = WORDS.iter().find(|(_, appears)| *appears == self);
        of.map_or("", |(words, _)| words)
    }

    /// Where a pass's vertices appear; none where its skeleton, or what fills the slot that the
    /// skeleton names, says nothing.
    pub(crate) fn of(
        library: &Library,
        skeleton: &str,
        slots: &BTreeMap<String, Filling>,
    ) -> Option<Self> {
        let said = library.get(skeleton)?.header.appears.as_ref()?;
        let Some(slot) = slot_of(said) else {
            return read(said).ok();
        };
        let module = match slots.get(slot) {
            Some(filling) => library.get(&filling.module.value)?,
            // What facts choose may be anything.
            None => library.slot(slot).filter(|s| s.header.when.is_empty())?,
        };
        read(module.header.appears.as_ref()?).ok()
    }
}

/// The slot of `as SLOT says`.
fn slot_of(said: &Name) -> Option<&str> {
    said.text.strip_prefix("as ")?.strip_suffix(" says")
}

/// # Errors
/// When the words say nothing known.
fn read(said: &Name) -> Result<Appears, Diagnostic> {
    let known = WORDS.iter().find(|(words, _)| *words == said.text);
    known.map(|(_, appears)| *appears).ok_or_else(|| {
        Diagnostic::error(format!("points do not appear `{}`", said.text))
            .at(&said.place, "not known")
            .with_suggestion(&said.text, WORDS.iter().map(|(words, _)| *words))
            .with_help("write `in place`, `on its vertical` or `mirrored`; in a skeleton also `as SLOT says`")
    })
}

/// Whether a header's line is understood.
///
/// # Errors
/// When it is not, or names a slot that is not there.
pub(crate) fn check(library: &Library, said: &Name) -> Result<(), Diagnostic> {
    match slot_of(said) {
        None => read(said).map(drop),
        Some(slot) if library.slot(slot).is_some() => Ok(()),
        Some(slot) => {
            Err(Diagnostic::error(format!("there is no slot `{slot}`"))
                .at(&said.place, "named here"))
        }
    }
}

/// The half-spaces beyond the sides of a picture and before its near plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frustum {
    eye: DVec3,
    /// Normals that point out of the view.
    sides: [DVec3; 4],
    forward: DVec3,
    near: f64,
}

impl Frustum {
    /// Of a view that is so many times as wide and high.
    pub fn new(view: &View, times: f64) -> Self {
        let half: DVec2 = 0.5 * times * view.size.as_dvec2() + MARGIN_PX;
        let side = |way: DVec3, half: f64| way * view.focal - view.forward * half;
        Self {
            eye: view.eye,
            sides: [
                side(view.right, half.x),
                side(-view.right, half.x),
                side(view.up, half.y),
                side(-view.up, half.y),
            ],
            forward: view.forward,
            near: 0.99 * view.near,
        }
    }

    /// Whether a box, which may reach to infinity, lies outside.
    pub fn misses(&self, low: DVec3, high: DVec3) -> bool {
        let (low, high) = (low - self.eye, high - self.eye);
        let least = |normal: DVec3| {
            let part = |normal: f64, low: f64, high: f64| match normal {
                0.0 => 0.0,
                _ => normal * if normal > 0.0 { low } else { high },
            };
            part(normal.x, low.x, high.x)
                + part(normal.y, low.y, high.y)
                + part(normal.z, low.z, high.z)
        };
        -least(-self.forward) < self.near || self.sides.iter().any(|&side| least(side) > 0.0)
    }
}

/// Which boxes a pass cannot show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cull {
    frustum: Frustum,
    appears: Appears,
    /// z of the rest plane, metres.
    level: f64,
    /// Whether the eye is above it.
    above: bool,
    /// Whether what lies behind the water is the optically denser.
    denser: bool,
}

impl Cull {
    /// For what is drawn in a view, from above the water or from below.
    pub fn new(view: &View, water: &Water, eye_above: bool, appears: Appears) -> Self {
        Self {
            frustum: Frustum::new(view, 1.0),
            appears,
            level: water.level,
            above: eye_above,
            denser: (water.refractive_index >= 1.0) == eye_above,
        }
    }

    /// Whether nothing within a box (world space, metres) can show.
    pub fn misses(&self, low: DVec3, high: DVec3) -> bool {
        let (mut low, mut high) = (low, high);
        let level = self.level;
        match self.appears {
            Appears::InPlace => {}
            Appears::Mirrored => {
                (low.z, high.z) = (2.0 * level - high.z, 2.0 * level - low.z);
            }
            Appears::OnVertical if self.denser => {
                (low.z, high.z) = (low.z.min(level), high.z.max(level));
            }
            Appears::OnVertical if self.above => low.z = f64::NEG_INFINITY,
            Appears::OnVertical => high.z = f64::INFINITY,
        }
        let finite = |v: DVec3| {
            v.to_array()
                .map(|x| if x.is_finite() { x.abs() } else { 0.0 })
        };
        let most = finite(low)
            .into_iter()
            .chain(finite(high))
            .fold(level.abs(), f64::max);
        let wider = ROUNDED * (most + self.frustum.eye.abs().max_element());
        self.frustum.misses(low - wider, high + wider)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;
    use meniscus_scene::{Camera, WaterGeometry};

    fn view(eye: DVec3, target: DVec3) -> View {
        let camera = Camera {
            eye,
            target,
            field_of_view: 0.9,
            near: 0.05,
        };
        camera.view(UVec2::new(320, 180))
    }

    fn water(refractive_index: f64) -> Water {
        Water {
            level: 0.0,
            refractive_index,
            waves: Vec::new(),
            time: 0.0,
            geometry: WaterGeometry::Flat,
        }
    }

    /// Numbers between 0 and 1, by Knuth's linear congruential generator.
    fn random() -> impl FnMut() -> f64 {
        let mut state = 3_u64;
        move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    fn shows(view: &View, point: DVec3) -> bool {
        let near = (point - view.eye).dot(view.forward) >= view.near;
        let at = view.project(point).filter(|_| near);
        at.is_some_and(|at| at.cmpge(DVec2::ZERO).all() && at.cmple(view.size.as_dvec2()).all())
    }

    #[test]
    fn nothing_that_shows_is_missed_wherever_it_may_appear() {
        let mut random = random();
        let mut missed = [0; 3];
        for case in 0..30_000 {
            let eye = DVec3::new(0.0, 0.0, 4.0 * random() - 2.0);
            let target = eye + DVec3::new(random() - 0.5, 1.0, 1.6 * random() - 0.8);
            let view = view(eye, target);
            let index = [1.333, 0.7][case % 2];
            let low = 12.0 * DVec3::new(random() - 0.5, random() - 0.3, 0.4 * random() - 0.2);
            let high = low + DVec3::new(random(), random(), random());
            let within = low + (high - low) * DVec3::new(random(), random(), random());
            let above = eye.z >= 0.0;
            let behind = if above {
                within.z < 0.0
            } else {
                within.z > 0.0
            };
            for (kind, (_, appears)) in WORDS.into_iter().enumerate() {
                let cull = Cull::new(&view, &water(index), above, appears);
                let z = match appears {
                    Appears::InPlace => within.z,
                    Appears::Mirrored => -within.z,
                    Appears::OnVertical if !behind => within.z,
                    Appears::OnVertical if (index > 1.0) == above => random() * within.z,
                    Appears::OnVertical => within.z / (random() + 1e-3),
                };
                let misses = cull.misses(low, high);
                missed[kind] += usize::from(misses);
                assert!(
                    !(misses && shows(&view, within.with_z(z))),
                    "{appears:?} {low} {high}"
                );
            }
        }
        // It is worth asking.
        assert!(missed.iter().all(|&n| n > 9_000), "{missed:?}");
    }

    #[test]
    fn what_is_not_finite_is_never_missed() {
        let view = view(DVec3::Z, DVec3::new(0.0, 1.0, 0.8));
        for (_, appears) in WORDS {
            let cull = Cull::new(&view, &water(1.333), true, appears);
            assert!(cull.misses(DVec3::new(-1.0, -9.0, 0.0), DVec3::new(1.0, -8.0, 0.5)));
            assert!(!cull.misses(DVec3::NAN, DVec3::NAN));
            assert!(!cull.misses(DVec3::NEG_INFINITY, DVec3::INFINITY));
        }
    }
}
