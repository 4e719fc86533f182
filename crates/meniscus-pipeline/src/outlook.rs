//! What one camera sees of a scene, as far as it can be told from boxes around its objects.

use glam::{DVec2, DVec3, UVec2};
use meniscus_scene::{Camera, Scene, View, Water, WaterGeometry};

use crate::cull::Frustum;
use crate::facts::Facts;
use crate::host::BLOCK_WAVES;

/// How many times as wide and high as its frame a view may be: see `Size::Guarded`.
pub(crate) const WIDEST: f64 = 1.5;

/// Pixels by which the water's rectangle is widened: the shaders' rays are rounded, and a fragment
/// may be asked for by a neighbour.
const MARGIN_PX: f64 = 1.0;

/// How far, in radians, rays may be off in single precision.
const ROUNDING: f64 = 1e-5;

/// Boxes around a scene's objects: made once, or for each moment where objects move, and asked for
/// each frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneBounds(Vec<Bounds>);

#[derive(Debug, Clone, Copy, PartialEq)]
struct Bounds {
    low: DVec3,
    high: DVec3,
    triangles: u64,
}

/// Pixels of a frame: those from `low` up to, but not, `high`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    /// The top left pixel.
    pub low: UVec2,
    /// The first column to the right of it, and the first row below it.
    pub high: UVec2,
}

/// Objects and their triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counted {
    /// How many objects.
    pub objects: u64,
    /// How many triangles they have.
    pub triangles: u64,
}

/// What one camera sees of a scene at one moment. Everything is careful: what may be seen counts as
/// seen. Making it takes no memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlook {
    /// What plans depend on.
    pub facts: Facts,
    /// Width and height of the frame, pixels.
    pub size: UVec2,
    /// The pixels that may show water; none where no pixel does.
    pub water: Option<Rect>,
    /// No slope of the water is steeper, metres per metre.
    pub slope_bound: f64,
    /// No wave reaches further from the rest plane, metres; 0 where rays meet the rest plane.
    pub reach: f64,
    /// Objects that lie wholly on the camera's side of the water.
    pub near: Counted,
    /// Objects that lie wholly on the other side.
    pub far: Counted,
    /// Objects that may have parts on both sides.
    pub straddling: Counted,
}

impl SceneBounds {
    /// Boxes around the objects of a scene.
    pub fn new(scene: &Scene) -> Self {
        let empty = Bounds {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
            triangles: 0,
        };
        let mut all = vec![empty; scene.objects.len()];
        for triangle in &scene.mesh.triangles {
            let object = triangle.object as usize;
            if object >= all.len() {
                all.resize(object + 1, empty);
            }
            let bounds = &mut all[object];
            bounds.triangles += 1;
            for corner in triangle.corners {
                if let Some(position) = scene.mesh.positions.get(corner as usize) {
                    bounds.low = bounds.low.min(position.as_dvec3());
                    bounds.high = bounds.high.max(position.as_dvec3());
                }
            }
        }
        all.retain(|bounds| bounds.triangles > 0);
        Self(all)
    }
}

/// The water as an eye finds it.
struct Surface {
    displaced: bool,
    /// How far waves that rays meet reach from the rest plane at most, metres.
    reach: f64,
    /// z of the rest plane as the shaders know it, so that both draw the line at the same height.
    level: f64,
    /// 1 with the eye above the rest plane or on it, −1 below.
    up: f64,
    /// Whether the eye is so near the surface that any ray may meet it, and that either side may be
    /// taken for the camera's.
    amid: bool,
}

impl Surface {
    fn of(water: &Water, camera: &Camera) -> Self {
        let displaced = !water.is_flat() && water.geometry == WaterGeometry::Displaced;
        let reach = if displaced { water.height_bound() } else { 0.0 };
        let level = f64::from(water.level as f32);
        let above_rest = camera.eye.z - level;
        Self {
            displaced,
            reach,
            level,
            up: if above_rest < 0.0 { -1.0 } else { 1.0 },
            amid: above_rest.abs() <= reach + ROUNDING * (1.0 + level.abs()),
        }
    }
}

impl Rect {
    /// All pixels of a frame.
    pub fn all(size: UVec2) -> Self {
        Self {
            low: UVec2::ZERO,
            high: size,
        }
    }

    /// The pixels of a frame of `size` pixels that may show water, whatever stands before it; none
    /// where no pixel does.
    pub fn of_water(water: &Water, camera: &Camera, size: UVec2) -> Option<Self> {
        let surface = Surface::of(water, camera);
        match surface.amid {
            true => Some(Self::all(size)),
            false => below_horizon(&camera.view(size), surface.up),
        }
    }

    /// How many pixels.
    pub fn pixels(&self) -> u64 {
        let size = (self.high - self.low).as_u64vec2();
        size.x * size.y
    }
}

impl Outlook {
    /// What the scene's camera sees in a frame of `size` pixels. `bounds` are those of the scene.
    pub fn new(scene: &Scene, bounds: &SceneBounds, size: UVec2) -> Self {
        let water = &scene.water;
        let waves = !water.is_flat();
        // As wide as a guard band may make it.
        let widest = Frustum::new(&scene.camera.view(size), WIDEST);
        let Surface {
            displaced,
            reach,
            level,
            up,
            amid,
        } = Surface::of(water, &scene.camera);
        let surface = match displaced {
            true => water.level + water.height(scene.camera.eye.truncate()),
            false => water.level,
        };
        let submerged = scene.camera.eye.z < surface;
        let rect = Rect::of_water(water, &scene.camera, size);
        let [mut near, mut far, mut straddling] = [Counted::default(); 3];
        let mut near_in_frame = false;
        for object in &bounds.0 {
            let (least, most) = match up > 0.0 {
                true => (object.low.z - level, object.high.z - level),
                false => (level - object.high.z, level - object.low.z),
            };
            let (is_near, is_far) = match amid {
                true => (true, true),
                // What lies in the plane is drawn with what is above it: it may be taken for both.
                false => (most >= -reach, least <= reach),
            };
            let counted = match (is_near, is_far) {
                (true, true) => &mut straddling,
                (true, false) => &mut near,
                _ => &mut far,
            };
            counted.objects += 1;
            counted.triangles += object.triangles;
            near_in_frame |= is_near && !widest.misses(object.low, object.high);
        }
        let any_near = near.objects + straddling.objects > 0;
        let any_far = far.objects + straddling.objects > 0;
        let water_visible = rect.is_some();
        let height = (scene.camera.eye.z - water.level).abs();
        let held = [
            ("waves", waves),
            ("displaced", displaced),
            ("many_waves", water.waves.len() > BLOCK_WAVES),
            ("camera_submerged", submerged),
            ("water_visible", water_visible),
            ("dry_visible", rect != Some(Rect::all(size))),
            // The water may mirror what stands outside the frame.
            ("near_visible", near_in_frame || any_near && water_visible),
            ("far_visible", any_far && water_visible),
            ("fine_edges", height >= FINE_EDGES_NEAR * scene.camera.near),
        ];
        Self {
            facts: held.iter().fold(Facts::default(), |facts, (name, holds)| {
                facts.with(name, *holds)
            }),
            size,
            water: rect,
            slope_bound: water.slope_bound(),
            reach,
            near,
            far,
            straddling,
        }
    }
}

/// How many times the near plane's distance the eye stays from the water for edges to count as fine.
///
/// Nearer than that, what is drawn partly lies before the near plane, by which edges are not divided:
/// 1 cm above water of index 1.72, at a near plane of 5 cm, points moved by more than 0.42 px.
const FINE_EDGES_NEAR: f64 = 2.0;

/// The pixels whose rays go towards a plane below (`up` 1) or above (−1) the eye. How steeply a
/// pixel's ray goes is linear in the pixel: what goes down is cut from the picture by a line.
fn below_horizon(view: &View, up: f64) -> Option<Rect> {
    let size = view.size.as_dvec2();
    let corners = [
        DVec2::ZERO,
        DVec2::new(size.x, 0.0),
        size,
        DVec2::new(0.0, size.y),
    ];
    // Not a unit vector's: divided by its length, it would no longer be linear.
    let descent = |corner: DVec2| {
        let centred = corner - 0.5 * size;
        let z = view.forward.z * view.focal + view.right.z * centred.x - view.up.z * centred.y;
        -up * z + ROUNDING * (view.focal + centred.length())
    };
    let mut bounds: Option<(DVec2, DVec2)> = None;
    let mut include = |point: DVec2| {
        let (low, high) = bounds.unwrap_or((point, point));
        bounds = Some((low.min(point), high.max(point)));
    };
    for (index, &corner) in corners.iter().enumerate() {
        let next = corners[(index + 1) % corners.len()];
        let (here, there) = (descent(corner), descent(next));
        // What is not a number may be anything.
        if here.is_nan() || here > 0.0 {
            include(corner);
        }
        if (here > 0.0) != (there > 0.0) {
            include(corner.lerp(next, here / (here - there)));
        }
    }
    let (low, high) = bounds?;
    let low = (low - MARGIN_PX).floor().clamp(DVec2::ZERO, size);
    let high = (high + MARGIN_PX).ceil().clamp(DVec2::ZERO, size);
    Some(Rect {
        low: low.as_uvec2(),
        high: high.as_uvec2(),
    })
}
