//! Where points behind flat water appear to an eye, in double precision, and how far the straight
//! edges drawn between such points lie from what they stand for.

use glam::{DVec2, DVec3};
use meniscus_scene::View;

/// How many pixels a point may slip along an edge for each pixel that the edge may bow. A bow shows
/// as a wrong outline; a slip only as a slightly wrong point of the same surface.
const SLIP_PER_BOW: f64 = 4.0;

/// From how many pixels on an edge is looked at in its quarters too, not in the middle alone, where
/// a curve that turns one way and then the other may meet its chord.
const LONG_PX: f64 = 32.0;

/// By how much the picture is widened, beyond its guard band, before an edge counts as out of sight.
const MARGIN: f64 = 1.1;

/// Newton steps at most; about six are taken, more only near the critical angle.
const STEPS: u32 = 64;

/// An eye on one side of flat water, and the picture it draws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sight {
    view: View,
    level: f64,
    /// 1 for an eye above the water or on it, −1 below.
    side: f64,
    /// Refractive index of the far side relative to the eye's.
    relative_index: f64,
}

/// A point with the place where it appears. World space, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sighted {
    pub world: DVec3,
    pub apparent: DVec3,
}

impl Sight {
    /// Through water whose rest plane lies at `level`, as single precision knows it; `view` is the
    /// largest that is drawn.
    pub fn new(view: View, level: f32, eye_above: bool, relative_index: f64) -> Self {
        Self {
            view,
            level: f64::from(level),
            side: if eye_above { 1.0 } else { -1.0 },
            relative_index,
        }
    }

    /// z of the rest plane, metres.
    pub fn level(&self) -> f32 {
        self.level as f32
    }

    /// Whether the eye is above the water or on it.
    pub fn eye_above(&self) -> bool {
        self.side > 0.0
    }

    /// A point and where it appears: on the vertical through it, where the straightened camera ray
    /// passes (Liu, Han, Fei 2020). Points on the eye's side of the plane appear where they are.
    pub fn sighted(&self, world: DVec3) -> Sighted {
        let behind = self.side * (self.level - world.z);
        if behind <= 0.0 || self.relative_index == 1.0 {
            let apparent = world;
            return Sighted { world, apparent };
        }
        let before = (self.side * (self.view.eye.z - self.level)).max(0.0);
        let apart = (world - self.view.eye).truncate().length();
        let index = self.relative_index;
        let ratio = if index >= 1.0 {
            shrink(before, behind, apart, index)
        } else {
            1.0 / shrink(behind, before, apart, 1.0 / index)
        };
        let apparent = world
            .truncate()
            .extend(self.level - self.side * behind * ratio);
        Sighted { world, apparent }
    }

    /// How far a straight edge between two apparent points lies from where its points appear,
    /// pixels: the distance across it or, where that counts more, a part of that along it. 0 where
    /// the edge, and every triangle of which it is the longest, is out of sight. The ends may be
    /// given in any order: the result is the same to the last bit.
    ///
    /// It is never more than the edge's own length in the picture without water, beyond which no
    /// point of it can be mistaken for another: what stands on the water beyond the critical
    /// distance of an eye below appears with its lowest micrometre drawn out to the window's edge.
    pub fn bow(&self, a: &Sighted, b: &Sighted) -> f64 {
        let (a, b) = if precedes(a.world, b.world) {
            (a, b)
        } else {
            (b, a)
        };
        if a.world == a.apparent && b.world == b.apparent {
            return 0.0;
        }
        let middle = self.deviation(a, b, 0.5);
        let radius = 0.87 * a.apparent.distance(b.apparent) + middle.metres();
        if !self.shows(middle.drawn, radius) {
            return 0.0;
        }
        let away = (0.5 * (a.world + b.world)).distance(self.view.eye);
        let length = self.view.focal * a.world.distance(b.world) / away.max(self.view.near);
        self.bow_in_sight(a, b, &middle).min(length)
    }

    /// An upper bound of [`Sight::bow`] at a fraction of its cost, for ends that are not on either
    /// side of the plane; the same for either order of them.
    ///
    /// For an eye on the side of the lower index, at the height f, the apparent height bends along
    /// no direction by more than 1 / (2 f) per metre, which is reached for N near 1. The middle of
    /// an edge of length ℓ is thus at most ℓ² / (16 f) from its chord.
    pub fn bow_bound(&self, a: &Sighted, b: &Sighted) -> f64 {
        let view = &self.view;
        let before = self.side * (view.eye.z - self.level);
        if self.relative_index < 1.0 || before <= 0.0 {
            return f64::INFINITY;
        }
        let off = a.world.distance_squared(b.world) / (16.0 * before);
        let [a, b] = [a, b].map(|end| end.apparent - view.eye);
        let depth = a.dot(view.forward).min(b.dot(view.forward)) - off;
        let distance = a.length().max(b.length()) + off;
        if depth > view.near {
            view.focal * off * distance / (depth * depth)
        } else {
            f64::INFINITY
        }
    }

    fn bow_in_sight(&self, a: &Sighted, b: &Sighted, middle: &Deviation) -> f64 {
        let ends = [a.apparent, b.apparent];
        let [Some(first), Some(second)] = ends.map(|end| self.pixel(end)) else {
            // Partly behind the eye: what shows may be as near as the picture begins.
            return self.view.focal * middle.metres() / self.view.near;
        };
        let along = (second - first).normalize_or_zero();
        let mut bow = self.pixels(middle, along);
        if first.distance_squared(second) > LONG_PX * LONG_PX {
            for part in [0.25, 0.75] {
                bow = bow.max(self.pixels(&self.deviation(a, b, part), along));
            }
        }
        bow
    }

    fn deviation(&self, a: &Sighted, b: &Sighted, part: f64) -> Deviation {
        let between = |a: DVec3, b: DVec3| (1.0 - part) * a + part * b;
        Deviation {
            drawn: between(a.apparent, b.apparent),
            right: self.sighted(between(a.world, b.world)).apparent,
        }
    }

    fn pixels(&self, deviation: &Deviation, along: DVec2) -> f64 {
        let (Some(drawn), Some(right)) = (self.pixel(deviation.drawn), self.pixel(deviation.right))
        else {
            return self.view.focal * deviation.metres() / self.view.near;
        };
        let off = right - drawn;
        off.perp_dot(along).abs().max(off.length() / SLIP_PER_BOW)
    }

    /// Relative to the picture's middle; none before the near plane.
    fn pixel(&self, point: DVec3) -> Option<DVec2> {
        let view = &self.view;
        let offset = point - view.eye;
        let depth = offset.dot(view.forward);
        (depth > view.near)
            .then(|| DVec2::new(offset.dot(view.right), offset.dot(view.up)) * (view.focal / depth))
    }

    /// Whether a ball may show in the picture.
    fn shows(&self, centre: DVec3, radius: f64) -> bool {
        let view = &self.view;
        let offset = centre - view.eye;
        let depth = offset.dot(view.forward);
        let half = 0.5 * MARGIN * view.size.as_dvec2() / view.focal;
        // Beyond a side of the picture, by the distance from the plane through it and the eye.
        let beyond = |way: DVec3, half: f64| {
            (offset.dot(way).abs() - depth * half) / (1.0 + half * half).sqrt()
        };
        depth + radius > view.near
            && beyond(view.right, half.x) < radius
            && beyond(view.up, half.y) < radius
    }
}

/// A point of an edge where it is drawn, and where it appears.
struct Deviation {
    drawn: DVec3,
    right: DVec3,
}

impl Deviation {
    fn metres(&self) -> f64 {
        self.drawn.distance(self.right)
    }
}

fn precedes(a: DVec3, b: DVec3) -> bool {
    a.to_array() < b.to_array()
}

/// By how much a depth on the side of the higher index shrinks to the eye: 1 / √(N² + M u²),
/// M = N² − 1, where u is the tangent of the angle on the side of the lower index at which light
/// crosses the plane: the root of H(u) = f u + s u / √(N² + M u²) − d.
///
/// H rises and is concave for u ≥ 0, so that Newton's method climbs to the root from any lower
/// bound, never past it. `low` (f) and `high` (s): distances from the plane on the side of the lower
/// and of the higher index; `apart` (d): horizontal distance, metres; `n` (N) ≥ 1.
fn shrink(low: f64, high: f64, apart: f64, n: f64) -> f64 {
    let m = (n - 1.0) * (n + 1.0);
    let least = 1e-15 * (low + high + apart) + f64::MIN_POSITIVE;
    let (f, s) = (low.max(least), high.max(least));
    let ratio = |u: f64| 1.0 / (n * n + m * u * u).sqrt();
    let mut u = (n * apart / (s + f * n)).max((apart - s / m.sqrt()) / f);
    for _ in 0..STEPS {
        let r = ratio(u);
        let step = (f * u + s * u * r - apart) / (f + s * n * n * r * r * r);
        u -= step;
        if step.abs() <= 1e-14 * u {
            break;
        }
    }
    ratio(u)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use glam::UVec2;
    use meniscus_scene::Camera;

    pub(crate) fn view(eye: DVec3) -> View {
        let camera = Camera {
            eye,
            target: DVec3::new(0.0, 3.0, -1.0),
            field_of_view: 0.9,
            near: 0.05,
        };
        camera.view(UVec2::new(640, 360))
    }

    pub(crate) fn sight(height: f64, index: f64) -> Sight {
        let above = height >= 0.0;
        let relative = if above { index } else { 1.0 / index };
        Sight::new(view(DVec3::new(0.0, -1.0, height)), 0.0, above, relative)
    }

    #[test]
    fn light_goes_the_way_of_snells_law() {
        for height in [2.0, 0.01, -0.3, -5.0] {
            for index in [1.333, 2.4, 1.0 / 1.5] {
                let sight = sight(height, index);
                for (apart, far) in [(0.0, 1.0), (0.5, 2.0), (7.0, 0.1), (40.0, 30.0)] {
                    let world = sight.view.eye.with_z(-far * height.signum()) + apart * DVec3::X;
                    let apparent = sight.sighted(world).apparent;
                    assert_eq!(apparent.truncate(), world.truncate());
                    // The straightened ray meets the plane where the real one does.
                    let line = height / (height - apparent.z);
                    let (before, after) = (line * apart, (1.0 - line) * apart);
                    let sine = |run: f64, rise: f64| run / run.hypot(rise);
                    let (i, t) = (sine(before, height), sine(after, far));
                    let n = sight.relative_index;
                    assert!((i - n * t).abs() < 1e-9, "{height} {index} {apart} {far}");
                }
            }
        }
    }

    #[test]
    fn shrinking_stays_between_its_limits_for_every_input() {
        let sizes = [0.0, 1e-300, 1e-12, 1e-3, 1.0, 1e6, 1e38];
        for n in [1.0, 1.0 + 1e-12, 1.333, 2.5] {
            for low in sizes {
                for high in sizes {
                    for apart in sizes {
                        let r = shrink(low, high, apart, n);
                        assert!(
                            r >= 0.0 && r <= 1.0 / n + 1e-12,
                            "{low} {high} {apart} {n}: {r}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_bows_that_is_not_bent_or_not_seen() {
        let ends = [[-1.0, 2.0, -2.0], [1.5, 4.0, -1.0]].map(DVec3::from_array);
        let bow = |sight: Sight, by: DVec3| {
            let [a, b] = ends.map(|end| sight.sighted(end + by));
            assert_eq!(sight.bow(&a, &b).to_bits(), sight.bow(&b, &a).to_bits());
            sight.bow(&a, &b)
        };
        assert!(bow(sight(1.7, 1.333), DVec3::ZERO) > 1.0);
        assert_eq!(bow(sight(1.7, 1.0), DVec3::ZERO), 0.0);
        assert_eq!(
            bow(sight(1.7, 1.333), 3.0 * DVec3::Z),
            0.0,
            "on the eye's side"
        );
        assert_eq!(
            bow(sight(1.7, 1.333), 30.0 * DVec3::NEG_Y),
            0.0,
            "behind the eye"
        );
        assert_eq!(
            bow(sight(1.7, 1.333), 60.0 * DVec3::X),
            0.0,
            "beside the picture"
        );
    }

    #[test]
    fn an_edge_never_bows_beyond_its_bound() {
        let mut nearest = 0.0_f64;
        let mut state = 1_u64;
        let mut random = move || {
            // Knuth's linear congruential generator; its upper bits.
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for i in 0..20_000 {
            let index = [1.01, 1.333, 2.4][i % 3];
            let sight = sight(10_f64.powf(2.0 * random() - 1.0), index);
            let depth = 10_f64.powf(4.0 * random() - 3.0);
            let from = DVec3::new(4.0 * random() - 2.0, 8.0 * random(), -depth);
            let way = DVec3::new(random() - 0.5, random() - 0.5, depth * (random() - 0.5));
            let ends = [from, from + way * random()].map(|end| sight.sighted(end));
            let (bow, bound) = (
                sight.bow(&ends[0], &ends[1]),
                sight.bow_bound(&ends[0], &ends[1]),
            );
            assert!(bow <= bound * (1.0 + 1e-6) + 1e-9, "{bow} {bound} {ends:?}");
            assert_eq!(
                bound.to_bits(),
                sight.bow_bound(&ends[1], &ends[0]).to_bits()
            );
            nearest = nearest.max(bow / bound);
        }
        assert!(nearest > 0.1, "far from every bow: {nearest}");
    }

    #[test]
    fn a_vertical_edge_slips_but_does_not_bow() {
        let sight = sight(1.7, 1.333);
        let ends = [-2.0, -0.1].map(|z| sight.sighted(DVec3::new(0.0, 3.0, z)));
        let slip = sight.pixels(&sight.deviation(&ends[0], &ends[1], 0.5), DVec2::Y);
        let across = sight.pixels(&sight.deviation(&ends[0], &ends[1], 0.5), DVec2::X);
        assert!(slip > 0.0 && (across / slip - SLIP_PER_BOW).abs() < 1e-9);
    }
}
