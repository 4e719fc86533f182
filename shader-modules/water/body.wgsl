// The water as a whole: its rest plane, refractive index and waves.
//
// needs: water/wave

// `level`: z of the rest plane, metres. `refractive_index`: of the water relative to the air.
// `relative_index`: that of the far side relative to the camera's side. `camera_side`: 1 with the
// eye above the water, −1 under it. `height_bound` (metres), `slope_bound` and `curvature_bound`
// (1/m): what the waves never exceed. `larger_index` N: the larger of the
// relative index and its inverse; `root_high` + `root_low`: √(N² − 1) as a sum of two floats.
// `wave_count`: how many waves there are, of which `waves` holds the first 64.
struct Water {
    level: f32,
    refractive_index: f32,
    relative_index: f32,
    camera_side: f32,
    height_bound: f32,
    slope_bound: f32,
    curvature_bound: f32,
    larger_index: f32,
    root_high: f32,
    root_low: f32,
    wave_count: u32,
    waves: array<Wave, 64>,
}

var<uniform> water: Water;
