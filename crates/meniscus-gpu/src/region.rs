//! Which part of the picture a pass over the water has to touch: a rectangle, and the depth at which
//! the water begins in it.
//!
//! What stands before the plane that bounds the waves on the eye's side stands before the water: there
//! a pass over the water would leave the picture as it is.

use glam::UVec2;
use meniscus_pipeline::{Covers, Rect};
use meniscus_scene::{View, Water, WaterGeometry};

use crate::host_scene::HostScene;

/// Rays and depths are rounded to single precision: by this part the plane is drawn nearer …
const NEARER: f64 = 1e-3;
/// … and by as much as it comes nearer in so many rows of pixels …
const ROWS: f64 = 0.05;
/// … and by what the terms of the plane's depth, and depths between −1 and 1, as some interfaces keep
/// them, are rounded to.
const ROUNDED: f64 = 2e-7;

/// Heights are rounded by this part of the numbers that they are the difference of.
const HEIGHT_ROUNDED: f64 = 1e-5;

/// Where passes over the water, and those over the rest, have to run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Region {
    pub size: UVec2,
    /// Whether passes over the water, and those over the rest, run everywhere.
    everywhere: bool,
    water: Option<Rect>,
    /// The reversed depth, at a pixel (x, y), of the plane that bounds the waves: the product with
    /// (x, y, 1). Where there is none before the eye, it is nearer than everything.
    pub plane: [f32; 3],
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
            plane: NEAREST,
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

/// No depth is nearer.
const NEAREST: [f32; 3] = [0.0, 0.0, 2.0];

/// The reversed depth of a plane is linear in the picture: near / distance, and the distance along
/// `forward` at which a pixel's ray meets it is h f / fall, where the ray falls by `fall` while it
/// runs f forwards.
fn plane(view: &View, water: &Water) -> [f32; 3] {
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
    // How much a pixel's ray falls, by its column, by its row, and at the picture's corner.
    let along = [-side * view.right.z, side * view.up.z];
    let corner =
        -side * view.forward.z * view.focal - 0.5 * (along[0] * size.x + along[1] * size.y);
    let scale = view.near / (height * view.focal);
    let steep = along[0].abs() + along[1].abs();
    let nearer = (1.0 + NEARER) * scale;
    // The terms of the product, which may nearly cancel.
    let terms = corner.abs() + (along[0] * size.x).abs() + (along[1] * size.y).abs();
    let largest = nearer.abs() * terms;
    let plane = [
        nearer * along[0],
        nearer * along[1],
        nearer * corner + scale * ROWS * steep + ROUNDED * (1.0 + largest),
    ];
    // Amid the waves there is no plane.
    match height > 0.0 && plane.iter().all(|part| part.is_finite()) {
        true => plane.map(|part| part as f32),
        false => NEAREST,
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

    /// The plane's depth at a pixel, in single precision.
    fn depth(region: &Region, pixel: UVec2) -> f64 {
        let at = pixel.as_vec2() + 0.5;
        let [x, y, rest] = region.plane;
        f64::from(x * at.x + y * at.y + rest)
    }

    #[test]
    fn no_water_is_nearer_than_the_plane_and_is_not_far_before_it() {
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
                // No depth is beyond 1.
                let least = water_depth.min(1.0);
                assert!(plane > least, "{pixel}: {plane} {water_depth}");
                close += usize::from(plane < 1.2 * water_depth);
            }
        }
        assert!(close > 5000, "{close}");
    }
}
