//! What each pass of a plan does to the textures and buffers between passes.

use std::collections::{BTreeMap, BTreeSet};

use meniscus_pipeline::{Covers, Format, PassKind, Plan, PlannedPass, Size};
use meniscus_shader::{Binding, BindingKind};
use naga::valid::GlobalUse;

/// The texture that a binding stands for: an output's target, or the one it is connected to.
pub(crate) fn texture_name<'a>(pass: &'a PlannedPass, binding: &'a Binding) -> &'a str {
    if matches!(binding.kind, BindingKind::StorageTexture { .. }) {
        let names = [&binding.resource, &binding.variable];
        let output = pass
            .shader
            .outputs
            .iter()
            .position(|output| names.contains(&output));
        if let Some(target) = output.and_then(|index| pass.targets.get(index)) {
            return target;
        }
    }
    &binding.resource
}

/// The textures that a pass samples.
pub(crate) fn reads(pass: &PlannedPass) -> impl Iterator<Item = &str> {
    let sampled = |b: &&Binding| matches!(b.kind, BindingKind::Texture { .. });
    pass.shader
        .bindings
        .iter()
        .filter(sampled)
        .map(|b| texture_name(pass, b))
}

/// The textures that a pass writes, depth included.
pub(crate) fn writes(pass: &PlannedPass) -> BTreeSet<&str> {
    let stored = |b: &&Binding| matches!(b.kind, BindingKind::StorageTexture { .. });
    let stored = pass
        .shader
        .bindings
        .iter()
        .filter(stored)
        .map(|b| texture_name(pass, b));
    stored
        .chain(pass.targets.iter().map(String::as_str))
        .chain(pass.depth.as_deref())
        .collect()
}

/// By this name a pass over the water reads the depths of what stands before it.
const FRONT_DEPTH: &str = "front_depth";

/// The depths of what stands before the water, if a pass over the water reads them and can be drawn
/// as tiles.
pub(crate) fn front_depth<'a>(plan: &Plan, pass: &'a PlannedPass) -> Option<&'a str> {
    let of_screen = pass.kind == PassKind::Screen && pass.covers == Covers::Water;
    if !of_screen || pass.view_target != Size::Frame || pass.depth.is_some() {
        return None;
    }
    let front =
        |b: &&Binding| b.variable == FRONT_DEPTH && matches!(b.kind, BindingKind::Texture { .. });
    let name = texture_name(pass, pass.shader.bindings.iter().find(front)?);
    let texture = plan.textures.get(name)?;
    let fits = texture.size == Size::Frame && texture.format == Format::Depth32Float;
    // Tiles can stand for the shader's own triangle only where nothing else is handed on.
    let handed_on = |argument: &naga::FunctionArgument| {
        !matches!(argument.binding, Some(naga::Binding::BuiltIn(_)))
    };
    let mut stages = pass.shader.module.entry_points.iter();
    let fragment = stages.find(|entry| entry.stage == naga::ShaderStage::Fragment)?;
    let plain = !fragment.function.arguments.iter().any(handed_on);
    (fits && plain).then_some(name)
}

/// The textures that some pass stores to.
pub(crate) fn stored(plan: &Plan) -> BTreeSet<&str> {
    let bindings = plan
        .passes
        .iter()
        .flat_map(|pass| pass.shader.bindings.iter().map(move |b| (pass, b)));
    bindings
        .filter(|(_, b)| matches!(b.kind, BindingKind::StorageTexture { .. }))
        .map(|(pass, binding)| texture_name(pass, binding))
        .collect()
}

/// What a pass does to one texture or buffer. What is only cleared before the pass counts as
/// changed by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Use {
    /// Index into [`Uses::names`].
    pub resource: usize,
    /// Whether it matters what earlier passes of the frame have left there.
    pub needs: bool,
    /// Whether something else may be there afterwards.
    pub changes: bool,
}

/// What all passes do.
#[derive(Debug, Default, Clone)]
pub(crate) struct Uses<'a> {
    /// Textures and buffers. A texture that no pass writes is not among them.
    pub names: Vec<&'a str>,
    /// Of every pass, each resource once.
    pub passes: Vec<Vec<Use>>,
    /// Of every pass, the buffers that are zeroed before it.
    pub zeroes: Vec<Vec<&'a str>>,
    /// Of every pass, whether it reads what the last frame left: then it has to run in every frame.
    pub looks_back: Vec<bool>,
}

impl<'a> Uses<'a> {
    pub fn new(plan: &'a Plan) -> Self {
        let mut all = Self::default();
        let ever: BTreeSet<&str> = plan.passes.iter().flat_map(writes).collect();
        let mut indices = BTreeMap::new();
        let mut touched = BTreeSet::new();
        for pass in &plan.passes {
            let mut found: Vec<Use> = Vec::new();
            let mut add = |name: &'a str, needs: bool, changes: bool| {
                let next = indices.len();
                let resource = *indices.entry(name).or_insert(next);
                match found.iter_mut().find(|known| known.resource == resource) {
                    Some(known) => {
                        known.needs |= needs;
                        known.changes |= changes;
                    }
                    None => found.push(Use {
                        resource,
                        needs,
                        changes,
                    }),
                }
            };
            for name in reads(pass).filter(|name| ever.contains(name)) {
                // Read first and written later: it is cleared before.
                let first = touched.insert(name);
                add(name, !first, first);
            }
            for name in writes(pass) {
                let first = touched.insert(name);
                add(name, !first, true);
            }
            let (mut zeroes, mut looks_back) = (Vec::new(), false);
            for (name, access) in buffers(plan, pass) {
                let first = touched.insert(name);
                let zeroed = plan.buffers.get(name).is_some_and(|b| b.zeroed);
                if first && zeroed {
                    zeroes.push(name);
                }
                // Whoever writes some elements leaves the others as they are.
                add(name, !first, access.changes || first && zeroed);
                looks_back |= first && !zeroed && access.needs;
            }
            all.passes.push(found);
            all.zeroes.push(zeroes);
            all.looks_back.push(looks_back);
        }
        all.names = vec![""; indices.len()];
        for (name, index) in indices {
            all.names[index] = name;
        }
        all
    }

    /// The first and the last pass that touch each resource.
    pub fn lifetimes(&self) -> Vec<[usize; 2]> {
        let mut lives = vec![[usize::MAX, 0]; self.names.len()];
        for (index, pass) in self.passes.iter().enumerate() {
            for touched in pass {
                let life = &mut lives[touched.resource];
                *life = [life[0].min(index), index];
            }
        }
        lives
    }
}

struct Access {
    needs: bool,
    changes: bool,
}

/// The plan's buffers that a pass uses, each once.
fn buffers<'a>(plan: &'a Plan, pass: &'a PlannedPass) -> BTreeMap<&'a str, Access> {
    let mut found: BTreeMap<&str, Access> = BTreeMap::new();
    let mut add = |name: &'a str, needs: bool, changes: bool| {
        let access = found.entry(name).or_insert(Access {
            needs: false,
            changes: false,
        });
        access.needs |= needs;
        access.changes |= changes;
    };
    let shader = &pass.shader;
    for binding in &shader.bindings {
        let BindingKind::Storage { read_only, .. } = binding.kind else {
            continue;
        };
        let Some((name, _)) = plan.buffers.get_key_value(&binding.resource) else {
            continue;
        };
        let bound = |variable: &naga::GlobalVariable| {
            let number = variable.binding.as_ref().map(|b| b.binding);
            number == Some(binding.index)
        };
        let handle = shader.module.global_variables.iter();
        let handle = handle.filter(|(_, v)| bound(v)).map(|(h, _)| h).next();
        let used = (0..shader.module.entry_points.len())
            .filter_map(|index| handle.map(|h| shader.info.get_entry_point(index)[h]))
            .fold(GlobalUse::empty(), |sum, used| sum | used);
        let reads = read_only || used.intersects(GlobalUse::READ | GlobalUse::ATOMIC);
        add(name, reads, !read_only);
    }
    if let PassKind::DispatchIndirect(name) = &pass.kind
        && let Some((name, _)) = plan.buffers.get_key_value(name)
    {
        add(name, true, false);
    }
    found
}
