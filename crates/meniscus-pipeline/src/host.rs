//! What the host offers to shaders: a closed list of resources, checked without a GPU.
//!
//! A uniform block's struct may declare any of the listed members, in any order; the host writes
//! each where naga's layout puts it, so that no struct is declared twice.

/// Type of a value that the host writes into a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "WGSL's names say all there is to say")]
pub enum ValueType {
    F32,
    U32,
    Vec2,
    Vec3,
    Vec4,
}

/// A named list of members with their types.
pub type Members = &'static [(&'static str, ValueType)];

/// Members of `view_target`, the view that a pass draws: see `meniscus_scene::View`. `seen_size`:
/// the size of the view with which the textures were drawn that the pass reads; the rest of that
/// view is the same.
pub const VIEW: Members = &[
    ("eye", ValueType::Vec3),
    ("right", ValueType::Vec3),
    ("up", ValueType::Vec3),
    ("forward", ValueType::Vec3),
    ("focal", ValueType::F32),
    ("size", ValueType::Vec2),
    ("near", ValueType::F32),
    ("seen_size", ValueType::Vec2),
];

/// Members of `water`.
///
/// `level`: z of the rest plane. `refractive_index`: of the water relative to the air.
/// `relative_index`: of the far side relative to the camera's side. `camera_side`: 1 with the eye
/// above the rest plane or on it, −1 below. `height_bound`, `slope_bound`: what the wave sum
/// cannot exceed, and `curvature_bound` (1/m) what its second derivatives cannot. `root_high` +
/// `root_low`: √(N² − 1), N being the larger of the index and its inverse, as a sum of two floats;
/// `larger_index`: N. `wave_count`: how many terms the sum has; see [`BLOCK_ARRAYS`] for the terms.
pub const WATER: Members = &[
    ("level", ValueType::F32),
    ("refractive_index", ValueType::F32),
    ("relative_index", ValueType::F32),
    ("camera_side", ValueType::F32),
    ("height_bound", ValueType::F32),
    ("slope_bound", ValueType::F32),
    ("curvature_bound", ValueType::F32),
    ("larger_index", ValueType::F32),
    ("root_high", ValueType::F32),
    ("root_low", ValueType::F32),
    ("time", ValueType::F32),
    ("wave_count", ValueType::U32),
];

/// Members of `light`: the sun and the sky, see `meniscus_scene::{Sun, Sky}`.
pub const LIGHT: Members = &[
    ("sun_direction", ValueType::Vec3),
    ("sun_colour", ValueType::Vec3),
    ("ambient", ValueType::Vec3),
    ("horizon", ValueType::Vec3),
    ("zenith", ValueType::Vec3),
    ("deep", ValueType::Vec3),
];

/// Uniform blocks by the variable's name.
///
/// There are three and should not be more: with a fourth in one shader, Mesa 22.3's software driver
/// writes outside its memory while it looks for uniforms to inline, and crashes.
pub const BLOCKS: &[(&str, Members)] = &[("view_target", VIEW), ("water", WATER), ("light", LIGHT)];

/// Arrays of [`ARRAYS`] that a block may hold as a member of the same name, with the number of
/// elements that are to be declared: the first so many, and zeros behind the last. Drivers read
/// uniform blocks faster than storage where all pixels read the same.
pub const BLOCK_ARRAYS: &[(&str, &str, usize)] = &[("water", "waves", BLOCK_WAVES)];

/// How many waves the block `water` holds.
pub const BLOCK_WAVES: usize = 64;

/// The members of an element of an array that a block may hold, and how many it holds.
pub fn block_array(block: &str, member: &str) -> Option<(Members, usize)> {
    let (.., length) = BLOCK_ARRAYS
        .iter()
        .find(|a| (a.0, a.1) == (block, member))?;
    let (_, members) = ARRAYS.iter().find(|(array, _)| *array == member)?;
    Some((members, *length))
}

/// Read-only storage arrays by the variable's name, with the members of an element.
///
/// `waves`: the terms of the sum, `phase` with the time's part in it, in [0, 2π); at least one.
/// `materials`: `line_width` 0 where there is no pattern.
/// `triangles`: `first`, `second`, `third` corner in world space, counter-clockwise as seen from
/// outside; the shading normals there as `pack2x16snorm` of the octahedral map; in the order of the
/// leaves of `bvh_nodes`; at least one, of no area where the scene has none.
/// `bvh_nodes`: boxes, the root first. With a `count` of 0, `first` is the first of two children,
/// which stand side by side; else a leaf has so many triangles (1 to 4), from `first`. No leaf is
/// deeper than [`BVH_DEPTH`] under the root.
/// `bvh_wide_nodes`: the same tree with up to four children a node, the root first. `low` + `step` ·
/// a byte is where a face of a child's box lies; `low_x` … `high_z` hold such a byte of each child,
/// the first child's lowest. `first` … `fourth` name the children: 8 times a node of this array; or
/// 8 times the first triangle, and how many it has (1 to 4); or 2³² − 1 where there is none. No walk
/// has more than [`WIDE_BVH_STACK`] nodes to come back to.
/// `distance_grids`: two, the first finer and about what the water covers, the second about
/// everything; voxels stand at `low` + `voxel` · (x, y, z), `size` of them along the axes, from
/// `first` in `distance_voxels` (metres to the nearest triangle, negative behind it) and
/// `distance_objects` (its object's id), x fastest, then y.
pub const ARRAYS: &[(&str, Members)] = &[
    (
        "waves",
        &[
            ("wave_vector", ValueType::Vec2),
            ("amplitude", ValueType::F32),
            ("phase", ValueType::F32),
        ],
    ),
    (
        "materials",
        &[
            ("colour", ValueType::Vec3),
            ("line_colour", ValueType::Vec3),
            ("tile_size", ValueType::F32),
            ("line_width", ValueType::F32),
            ("tile_offset", ValueType::F32),
        ],
    ),
    ("objects", &[("material", ValueType::U32)]),
    (
        "triangles",
        &[
            ("first", ValueType::Vec3),
            ("second", ValueType::Vec3),
            ("third", ValueType::Vec3),
            ("first_normal", ValueType::U32),
            ("second_normal", ValueType::U32),
            ("third_normal", ValueType::U32),
            ("object", ValueType::U32),
        ],
    ),
    (
        "bvh_nodes",
        &[
            ("low", ValueType::Vec3),
            ("high", ValueType::Vec3),
            ("first", ValueType::U32),
            ("count", ValueType::U32),
        ],
    ),
    (
        "bvh_wide_nodes",
        &[
            ("low", ValueType::Vec3),
            ("step", ValueType::Vec3),
            ("low_x", ValueType::U32),
            ("low_y", ValueType::U32),
            ("low_z", ValueType::U32),
            ("high_x", ValueType::U32),
            ("high_y", ValueType::U32),
            ("high_z", ValueType::U32),
            ("first", ValueType::U32),
            ("second", ValueType::U32),
            ("third", ValueType::U32),
            ("fourth", ValueType::U32),
        ],
    ),
    (
        "distance_grids",
        &[
            ("low", ValueType::Vec3),
            ("size", ValueType::Vec3),
            ("voxel", ValueType::F32),
            ("first", ValueType::U32),
        ],
    ),
    ("distance_voxels", &[("distance", ValueType::F32)]),
    ("distance_objects", &[("object", ValueType::U32)]),
];

/// The most steps from the root of `bvh_nodes` to a leaf: the entries that a stack must have.
pub const BVH_DEPTH: usize = 32;

/// The most nodes of `bvh_wide_nodes` that wait while a ray walks: the entries that a stack must have.
pub const WIDE_BVH_STACK: usize = 48;

/// Vertex attributes. `geometric_normal`, `object` and `material` belong to the triangle and are
/// carried by its first vertex: `@interpolate(flat, first)`.
pub const ATTRIBUTES: Members = &[
    ("position", ValueType::Vec3),
    ("normal", ValueType::Vec3),
    ("geometric_normal", ValueType::Vec3),
    ("object", ValueType::U32),
];

/// The host's sampler, bilinear and clamped to the edge.
pub const SAMPLERS: &[&str] = &["linear_sampler"];
