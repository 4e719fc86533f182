//! Shaders, plans and scenes made by hand.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use glam::{DVec2, DVec3, UVec2, Vec3};
use meniscus_gpu::{Frame, Gpu, GpuError, PipelineCache, SceneBuffers};
use meniscus_pipeline::{Buffer, Covers, Format, PassKind, Plan, PlannedPass, Size, Texture};
use meniscus_scene::{
    Camera, Material, Mesh, Object, Pattern, Scene, Sky, Sun, Triangle, Water, WaterGeometry, Wave,
};
use meniscus_shader::{Attribute, Binding, BindingKind, Entry, Sample, Shader};

/// The adapter that all tests share.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::open(None).unwrap_or_else(|error| panic!("{error}")))
}

/// A shader from WGSL with resources declared without numbers; each is connected to what bears its
/// name.
pub fn shader(text: &str, outputs: &[&str]) -> Arc<Shader> {
    let mut module =
        naga::front::wgsl::parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    let resources: Vec<_> = module
        .global_variables
        .iter()
        .filter(|(_, v)| {
            !matches!(
                v.space,
                naga::AddressSpace::Private | naga::AddressSpace::WorkGroup
            )
        })
        .map(|(handle, _)| handle)
        .collect();
    for (index, &handle) in resources.iter().enumerate() {
        module.global_variables.get_mut(handle).binding = Some(naga::ResourceBinding {
            group: 0,
            binding: index as u32,
        });
    }
    let info = naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::all(),
    )
    .validate(&module)
    .unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    let used = |stage: naga::ShaderStage, handle: naga::Handle<naga::GlobalVariable>| {
        let mut points = module.entry_points.iter().enumerate();
        points.any(|(i, e)| e.stage == stage && !info.get_entry_point(i)[handle].is_empty())
    };
    let bindings = resources
        .iter()
        .enumerate()
        .map(|(index, &handle)| {
            let variable = &module.global_variables[handle];
            let name = variable.name.clone().unwrap();
            Binding {
                index: index as u32,
                variable: name.clone(),
                resource: name,
                kind: kind(&module, variable, text),
                in_vertex: used(naga::ShaderStage::Vertex, handle),
                in_fragment: used(naga::ShaderStage::Fragment, handle),
                in_compute: used(naga::ShaderStage::Compute, handle),
            }
        })
        .collect();
    let point = |stage| module.entry_points.iter().find(|e| e.stage == stage);
    let entry = match point(naga::ShaderStage::Compute) {
        Some(compute) => Entry::Compute {
            name: compute.name.clone(),
            workgroup: compute.workgroup_size,
        },
        None => Entry::Render {
            vertex: point(naga::ShaderStage::Vertex).unwrap().name.clone(),
            fragment: point(naga::ShaderStage::Fragment).unwrap().name.clone(),
        },
    };
    let attributes = point(naga::ShaderStage::Vertex).map_or(vec![], attributes);
    Arc::new(Shader {
        bindings,
        entry,
        attributes,
        unread: Vec::new(),
        outputs: outputs.iter().map(|&o| o.to_owned()).collect(),
        text: text.to_owned(),
        hash: text.to_owned(),
        overrides: BTreeMap::new(),
        live: Vec::new(),
        module,
        info,
    })
}

fn attributes(vertex: &naga::EntryPoint) -> Vec<Attribute> {
    let located = |argument: &naga::FunctionArgument| match argument.binding {
        Some(naga::Binding::Location { location, .. }) => Some(Attribute {
            name: argument.name.clone().unwrap(),
            location,
        }),
        _ => None,
    };
    vertex
        .function
        .arguments
        .iter()
        .filter_map(located)
        .collect()
}

fn kind(module: &naga::Module, variable: &naga::GlobalVariable, text: &str) -> BindingKind {
    match (variable.space, &module.types[variable.ty].inner) {
        (naga::AddressSpace::Uniform, _) => BindingKind::Uniform(variable.ty),
        (naga::AddressSpace::Storage { access }, _) => BindingKind::Storage {
            ty: variable.ty,
            read_only: !access.contains(naga::StorageAccess::STORE),
        },
        (_, naga::TypeInner::Sampler { .. }) => BindingKind::Sampler,
        (_, &naga::TypeInner::Image { dim, class, .. }) => match class {
            naga::ImageClass::Storage { format, access } => BindingKind::StorageTexture {
                dimension: dim,
                format,
                reads: access.contains(naga::StorageAccess::LOAD),
            },
            naga::ImageClass::Depth { .. } => BindingKind::Texture {
                dimension: dim,
                sample: Sample::Depth,
                filtered: false,
            },
            naga::ImageClass::Sampled { kind, .. } => BindingKind::Texture {
                dimension: dim,
                sample: match kind {
                    naga::ScalarKind::Uint => Sample::Uint,
                    naga::ScalarKind::Sint => Sample::Sint,
                    _ => Sample::Float,
                },
                filtered: text.contains("textureSampleLevel("),
            },
            naga::ImageClass::External => panic!("no test has one"),
        },
        other => panic!("no test has {other:?}"),
    }
}

/// A pass over the frame's view.
pub fn pass(name: &str, kind: PassKind, shader: &Arc<Shader>, targets: &[&str]) -> PlannedPass {
    PlannedPass {
        name: name.to_owned(),
        kind,
        covers: Covers::All,
        shader: shader.clone(),
        numbers: BTreeMap::new(),
        targets: targets.iter().map(|&t| t.to_owned()).collect(),
        depth: None,
        view_target: Size::Frame,
        view_seen: Size::Frame,
        appears: None,
    }
}

/// A plan whose output is its first pass's first target.
pub fn plan(
    textures: &[(&str, Format, Size)],
    buffers: &[(&str, Buffer)],
    passes: Vec<PlannedPass>,
) -> Plan {
    let output = passes
        .iter()
        .flat_map(|p| &p.targets)
        .next()
        .cloned()
        .unwrap_or_default();
    let texture =
        |&(name, format, size): &(&str, Format, Size)| (name.to_owned(), Texture { format, size });
    Plan {
        pipeline: "test".to_owned(),
        textures: textures.iter().map(texture).collect(),
        buffers: buffers
            .iter()
            .map(|&(name, buffer)| (name.to_owned(), buffer))
            .collect(),
        lists: BTreeMap::new(),
        passes,
        output,
        shown: None,
        within_px: 0.0,
    }
}

/// A buffer of this many bytes.
pub fn buffer(bytes: u64) -> Buffer {
    Buffer {
        bytes,
        bytes_per_pixel: 0,
        indirect: false,
        zeroed: false,
    }
}

/// A scene of these triangles, each an object of its own; the eye looks along +y from the height
/// 1 m over flat water at 0, with a field of view of 90°.
pub fn scene(triangles: &[[[f32; 3]; 3]]) -> Scene {
    let positions: Vec<Vec3> = triangles.iter().flatten().map(|&p| p.into()).collect();
    let count = triangles.len() as u32;
    Scene {
        name: "test".to_owned(),
        about: String::new(),
        objects: (0..count)
            .map(|i| Object {
                name: i.to_string(),
                material: i,
            })
            .collect(),
        materials: (0..count)
            .map(|i| Material {
                colour: Vec3::splat(0.25 * (i + 1) as f32),
                pattern: Pattern::Plain,
            })
            .collect(),
        mesh: Mesh {
            normals: vec![Vec3::X; positions.len()],
            positions,
            triangles: (0..count)
                .map(|i| Triangle {
                    corners: [3 * i, 3 * i + 1, 3 * i + 2],
                    object: i,
                })
                .collect(),
        },
        moving: meniscus_scene::Moving::default(),
        water: Water {
            level: 0.0,
            refractive_index: 1.333,
            waves: vec![],
            time: 0.0,
            geometry: WaterGeometry::Flat,
        },
        camera: Camera {
            eye: DVec3::new(0.0, 0.0, 1.0),
            target: DVec3::new(0.0, 1.0, 1.0),
            field_of_view: std::f64::consts::FRAC_PI_2,
            near: 0.125,
        },
        sun: Sun {
            direction: DVec3::Z,
            colour: Vec3::ONE,
            ambient: Vec3::ZERO,
        },
        sky: Sky {
            horizon: Vec3::ONE,
            zenith: Vec3::ONE,
            deep: Vec3::ZERO,
        },
    }
}

/// A wave of this amplitude and 10 rad/m.
pub fn wave(amplitude: f64) -> Wave {
    Wave {
        amplitude,
        wave_vector: DVec2::new(6.0, 8.0),
        angular_frequency: 3.0,
        phase: 0.5,
    }
}

/// A frame of 8×8 pixels.
pub fn frame(plan: &Plan, scene: &Scene) -> Result<Frame, GpuError> {
    frame_of(plan, scene, UVec2::splat(8))
}

/// A frame of any size.
pub fn frame_of(plan: &Plan, scene: &Scene, size: UVec2) -> Result<Frame, GpuError> {
    let buffers = Arc::new(SceneBuffers::new(gpu(), scene)?);
    Frame::new(gpu(), plan, buffers, size, &PipelineCache::default())
}

/// A frame that was rendered once.
pub fn rendered(plan: &Plan, scene: &Scene) -> Frame {
    let mut frame = frame(plan, scene).unwrap_or_else(|error| panic!("{error}"));
    frame.render().unwrap_or_else(|error| panic!("{error}"));
    frame
}

/// The vertex stage of a pass that covers the screen.
pub const COVER: &str = "
@vertex fn cover(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}";

/// A vertex stage that draws the scene as `view_target` sees it.
pub const DRAW: &str = "
struct View { eye: vec3f, right: vec3f, up: vec3f, forward: vec3f, focal: f32, size: vec2f, near: f32 }
var<uniform> view_target: View;
struct Varied {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, first) object: u32,
    @location(1) @interpolate(flat, first) geometric_normal: vec3f,
    @location(2) world: vec3f,
}
@vertex fn place(@location(0) position: vec3f, @location(1) geometric_normal: vec3f, @location(2) object: u32) -> Varied {
    let v = position - view_target.eye;
    let half_size = 0.5 * view_target.size;
    let clip = vec4f(
        dot(v, view_target.right) * view_target.focal / half_size.x,
        dot(v, view_target.up) * view_target.focal / half_size.y,
        view_target.near,
        dot(v, view_target.forward),
    );
    return Varied(clip, object, geometric_normal, position);
}";
