//! Which part of the picture a pass over the water has to touch: a rectangle, and within it what the
//! water may show through the things that stand before it.
//!
//! The second is left to the adapter's depth test, which rejects whole tiles at once. A pass over
//! the water is drawn as the plane that bounds the waves on the eye's side, against the depths of
//! what stands before the water. No wave is nearer than that plane, so that what it leaves out the
//! shader would have left as it was.

use glam::{DVec2, UVec2};
use meniscus_pipeline::{Covers, Rect};
use meniscus_scene::{View, Water, WaterGeometry};

use crate::host_scene::HostScene;

/// Rays and depths are rounded to single precision: by this part the plane is drawn nearer …
const NEARER: f64 = 1e-3;
/// … and by as much as it comes nearer in so many rows of pixels …
const ROWS: f64 = 4.0;
/// … and by what a depth between −1 and 1, as some interfaces keep it, is rounded to.
const ROUNDED: f64 = 2e-7;

/// Heights are rounded by this part of the numbers that they are the difference of.
const HEIGHT_ROUNDED: f64 = 1e-5;

/// Where passes over the water, and those over the rest, have to run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Region {
    size: UVec2,
    /// Whether passes over the water, and those over the rest, run everywhere.
    everywhere: bool,
    water: Option<Rect>,
    /// Clip-space corners of a triangle that covers the picture, at the depth of the plane that
    /// bounds the waves; where there is none before the eye, nearer than everything.
    pub plane: [[f32; 4]; 3],
}

impl Region {
    /// Of a frame of this size.
    pub fn new(host: &HostScene, size: UVec2) -> Self {
        let view = host.camera().view(size);
        Self {
            size,
            everywhere: false,
            water: Rect::of_water(host.water(), host.camera(), size),
            plane: plane(&view, host.water()),
        }
    }

    /// The whole picture for all passes.
    pub fn whole(size: UVec2) -> Self {
        Self {
            size,
            everywhere: true,
            water: None,
            plane: corners([1.0; 3]),
        }
    }

    /// The pixels that a pass has to touch, as rectangles that do not overlap.
    pub fn rects(&self, covers: Covers) -> Vec<Rect> {
        if self.everywhere {
            return vec![Rect::all(self.size)];
        }
        match (covers, self.water) {
            (Covers::All, _) | (Covers::Dry, None) => vec![Rect::all(self.size)],
            (Covers::Water, Some(water)) => vec![water],
            (Covers::Water, None) => vec![],
            (Covers::Dry, Some(water)) => self.around(water),
        }
    }

    /// What a picture has beside a rectangle.
    fn around(&self, rect: Rect) -> Vec<Rect> {
        let (low, high, size) = (rect.low, rect.high, self.size);
        let sides = [
            [0, 0, size.x, low.y],
            [0, high.y, size.x, size.y],
            [0, low.y, low.x, high.y],
            [high.x, low.y, size.x, high.y],
        ];
        let rect = |[left, top, right, bottom]: [u32; 4]| Rect {
            low: UVec2::new(left, top),
            high: UVec2::new(right, bottom),
        };
        let sides = sides.into_iter().map(rect);
        sides.filter(|side| side.pixels() > 0).collect()
    }
}

/// The triangle's corners at three reversed depths.
fn corners(depths: [f64; 3]) -> [[f32; 4]; 3] {
    let at = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]];
    std::array::from_fn(|i| [at[i][0], at[i][1], depths[i] as f32, 1.0])
}

/// The reversed depth of a plane is linear in the picture: near / distance, and the distance along
/// `forward` at which a pixel's ray meets it is h f / fall, where the ray falls by `fall` while it
/// runs f forwards.
fn plane(view: &View, water: &Water) -> [[f32; 4]; 3] {
    let reach = match water.geometry {
        WaterGeometry::Flat => 0.0,
        WaterGeometry::Displaced => water.height_bound(),
    };
    let level = f64::from(water.level as f32);
    let above = view.eye.z - level;
    let side = if above < 0.0 { -1.0 } else { 1.0 };
    let rounded = HEIGHT_ROUNDED * (1.0 + level.abs() + view.eye.z.abs());
    let height = above.abs() - reach - rounded;
    let size = view.size.as_dvec2();
    let fall = |pixel: DVec2| {
        let centred = pixel - 0.5 * size;
        let rise = view.forward.z * view.focal + view.right.z * centred.x - view.up.z * centred.y;
        -side * rise
    };
    let scale = view.near / (height * view.focal);
    let steep = view.up.z.abs() + view.right.z.abs();
    let depth = |pixel: DVec2| {
        let deeper = (1.0 + NEARER) * fall(pixel) + ROWS * steep;
        scale * deeper + ROUNDED
    };
    let seen = [
        DVec2::ZERO,
        DVec2::new(size.x, 0.0),
        size,
        DVec2::new(0.0, size.y),
    ];
    // What is nearer than the near plane would be cut off; and amid the waves there is no plane.
    let fits = |pixel: DVec2| depth(pixel) <= 1.0;
    if height > 0.0 && scale.is_finite() && seen.into_iter().all(fits) {
        let far = [
            DVec2::new(0.0, size.y),
            DVec2::new(2.0 * size.x, size.y),
            DVec2::new(0.0, -size.y),
        ];
        corners(far.map(depth))
    } else {
        corners([1.0; 3])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host_scene::tests::scene;
    use glam::DVec3;
    use meniscus_scene::Scene;

    const SIZE: UVec2 = UVec2::new(40, 30);

    fn scenes() -> Vec<Scene> {
        let mut all = Vec::new();
        for geometry in [WaterGeometry::Flat, WaterGeometry::Displaced] {
            for height in [1.7, 0.3, -0.4, -3.0, 0.015] {
                for look in [[0.0, 3.0, -0.1], [0.4, 1.0, -3.0], [1.0, 2.0, 3.0]] {
                    let mut scene = scene();
                    scene.water.geometry = geometry;
                    scene.camera.eye.z = height;
                    scene.camera.target = scene.camera.eye + DVec3::from_array(look);
                    all.push(scene);
                }
            }
        }
        all
    }

    fn pixels() -> impl Iterator<Item = UVec2> {
        (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| UVec2::new(x, y)))
    }

    fn holds(rect: &Rect, pixel: UVec2) -> bool {
        pixel.cmpge(rect.low).all() && pixel.cmplt(rect.high).all()
    }

    #[test]
    fn water_and_rest_make_up_the_picture_without_overlap() {
        for scene in scenes() {
            let region = Region::new(&HostScene::new(&scene), SIZE);
            let mut rects = region.rects(Covers::Water);
            rects.extend(region.rects(Covers::Dry));
            for pixel in pixels() {
                let within = rects.iter().filter(|rect| holds(rect, pixel)).count();
                assert_eq!(within, 1, "{pixel} {rects:?}");
            }
        }
    }

    /// The plane's depth at a pixel, as the adapter interpolates it.
    fn depth(region: &Region, pixel: UVec2) -> f64 {
        let at = (pixel.as_dvec2() + 0.5) / SIZE.as_dvec2();
        let [a, b, c] = region.plane.map(|corner| f64::from(corner[2]));
        let (right, up) = (at.x, 1.0 - at.y);
        a + 0.5 * (right * (b - a) + up * (c - a))
    }

    #[test]
    fn no_water_is_nearer_than_the_plane_and_beside_the_horizon_it_is_not_far_off() {
        let mut close = 0;
        for scene in scenes() {
            let (water, view) = (&scene.water, scene.camera.view(SIZE));
            let region = Region::new(&HostScene::new(&scene), SIZE);
            let rects = region.rects(Covers::Water);
            for pixel in pixels() {
                let way = view.direction(pixel.as_dvec2() + 0.5);
                let bounds = match water.geometry {
                    WaterGeometry::Flat => [0.0, 0.0],
                    WaterGeometry::Displaced => [-water.height_bound(), water.height_bound()],
                };
                let met = bounds
                    .map(|bound| (water.level + bound - view.eye.z) / way.z)
                    .into_iter()
                    .filter(|distance| *distance > 0.0);
                let Some(first) = met.reduce(f64::min) else {
                    continue;
                };
                assert!(rects.iter().any(|rect| holds(rect, pixel)), "{pixel}");
                let water_depth = view.near / (first * way.dot(view.forward));
                let plane = depth(&region, pixel);
                // Nothing that is drawn has a depth beyond 1.
                let enough = plane > water_depth.min(0.999_999);
                assert!(enough, "{pixel}: {plane} {water_depth}");
                close += usize::from(plane < 1.2 * water_depth);
            }
        }
        assert!(close > 5000, "{close}");
    }
}
