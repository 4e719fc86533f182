//! Entry points of screen skeletons: a triangle over everything, or a thread a pixel.

use std::fmt::Write as _;

use meniscus_source::Report;

use super::{
    Signature, Written, check_state, finish, function, keep, outputs, render_entry, wrong,
    wrong_function,
};
use crate::compose::{Recipe, Stage};
use crate::library::Module;
use crate::shader::Entry;

/// Threads of a workgroup of a screen pass that runs as a compute shader.
const SCREEN_WORKGROUP: [u32; 3] = [8, 8, 1];
/// Threads of a workgroup that runs over a list.
const LIST_WORKGROUP: [u32; 3] = [64, 1, 1];

/// The function of a screen skeleton, checked.
fn screen_function<'m>(skeleton: &'m Module, recipe: &Recipe) -> Result<Signature<'m>, Report> {
    let screen = function(skeleton, "screen")?;
    if !matches!(screen.parameters, [pixel] if pixel.ty == "vec2f") {
        return Err(wrong_function(
            skeleton,
            &screen,
            "`screen` takes `pixel: vec2f` (pixels, centres at half integers)".into(),
        ));
    }
    check_state(skeleton, &screen, recipe)?;
    Ok(screen)
}

pub(super) fn render(skeleton: &Module, recipe: &Recipe) -> Result<Written, Report> {
    screen_function(skeleton, recipe)?;
    let outputs = outputs(skeleton, recipe)?;
    let (declared, result, end) = finish(skeleton, recipe, &outputs);
    let text = format!(
        "{declared}// One triangle that covers the screen.\n\
         @vertex\nfn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {{\n    \
         return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);\n}}\n\n\
         @fragment\nfn fragment_main(@builtin(position) position: vec4f){result} {{\n    \
         let state = screen(position.xy);\n{end}}}\n",
    );
    Ok(Written {
        text,
        entry: render_entry(),
        attributes: Vec::new(),
        outputs: outputs.into_iter().map(|(name, _)| name).collect(),
        drawing: None,
    })
}

pub(super) fn compute(skeleton: &Module, recipe: &Recipe) -> Result<Written, Report> {
    screen_function(skeleton, recipe)?;
    let outputs = outputs(skeleton, recipe)?;
    let mut text = String::new();
    let mut stores = String::new();
    for ((name, ty), output) in outputs.iter().zip(&recipe.outputs) {
        let _ = writeln!(
            text,
            "var target_{name}: texture_storage_2d<{}, write>;",
            output.format
        );
        let value = match ty.as_str() {
            "f32" => format!("vec4f(write_{name}(state))"),
            "u32" => format!("vec4u(write_{name}(state))"),
            _ => format!("write_{name}(state)"),
        };
        let _ = writeln!(
            stores,
            "    textureStore(target_{name}, vec2i(pixel), {value});"
        );
    }
    let list = recipe.stage == Stage::List;
    let workgroup = if list {
        LIST_WORKGROUP
    } else {
        SCREEN_WORKGROUP
    };
    let [x, y, _] = workgroup;
    let keep = keep(skeleton, recipe, "return");
    let size = match outputs.first() {
        Some((name, _)) => format!("vec2u(textureDimensions(target_{name}))"),
        None => return Err(wrong(skeleton, "a compute pass must write something")),
    };
    if list {
        // The number of workgroups along x is limited, so a long list is folded into rows.
        let _ = write!(
            text,
            "\n// Pixels as x + 65536 y, behind their count.\n\
             struct PassPixels {{ count: u32, pixels: array<u32> }}\nvar<storage, read> pass_pixels: PassPixels;\n\n\
             @compute @workgroup_size({x}, {y})\nfn compute_main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {{\n    \
             let index = thread.x + thread.y * groups.x * {x}u;\n    if index >= min(pass_pixels.count, arrayLength(&pass_pixels.pixels)) {{ return; }}\n    \
             let packed = pass_pixels.pixels[index];\n    let pixel = vec2f(vec2u(packed & 0xffffu, packed >> 16u)) + 0.5;\n    \
             let state = screen(pixel);\n{keep}{stores}}}\n"
        );
    } else {
        let _ = write!(
            text,
            "\n@compute @workgroup_size({x}, {y})\nfn compute_main(@builtin(global_invocation_id) thread: vec3u) {{\n    \
             if any(thread.xy >= {size}) {{ return; }}\n    let pixel = vec2f(thread.xy) + 0.5;\n    \
             let state = screen(pixel);\n{keep}{stores}}}\n"
        );
    }
    Ok(Written {
        text,
        entry: Entry::Compute {
            name: "compute_main".into(),
            workgroup,
        },
        attributes: Vec::new(),
        outputs: outputs.into_iter().map(|(name, _)| name).collect(),
        drawing: None,
    })
}
