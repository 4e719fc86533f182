//! One pass of a plan on the CPU.

use std::collections::BTreeSet;

use meniscus_pipeline::{PassKind, PlannedPass, Size};
use meniscus_shader::{Binding, BindingKind, Entry, LIVE_NUMBERS};
use meniscus_stress::{Buffer, Column, Pixels, Program, Resources, Sampler, Settings, Texture};

use crate::store::Store;
use crate::{CpuError, coding};

/// Gives what the host has of a binding's name, as bytes in the layout that the shader declares;
/// else why it cannot.
pub type Host<'a> = dyn Fn(&PlannedPass, &Binding) -> Result<Vec<u8>, String> + 'a;

/// Whether a pass draws triangles, so that it takes a GPU.
#[must_use]
pub fn is_drawn(pass: &PlannedPass) -> bool {
    matches!(pass.kind, PassKind::Draw(_))
}

/// What the variables of a pass's shader are connected to.
#[derive(Default)]
struct Connected {
    /// By the variable, the resource's name.
    buffers: Vec<(String, String, Buffer)>,
    textures: Vec<(String, String, Texture)>,
    samplers: Vec<String>,
}

/// Runs a pass: reads what it reads from the store and the host, and puts what it writes into the
/// store. `size` gives the width and height of views, pixels.
///
/// Pixels that a screen pass leaves alone keep what the store has.
///
/// # Errors
/// When the pass draws, when something that it reads is not there, and when its shader holds what
/// the evaluator cannot run.
pub fn run_pass(
    pass: &PlannedPass,
    store: &mut Store,
    host: &Host<'_>,
    size: &dyn Fn(Size) -> [u32; 2],
) -> Result<(), CpuError> {
    if is_drawn(pass) {
        return Err(CpuError::Draw {
            pass: pass.name.clone(),
        });
    }
    if pass.depth.is_some() {
        return Err(CpuError::Depth {
            pass: pass.name.clone(),
        });
    }
    let trapped = |trap| CpuError::Shader {
        pass: pass.name.clone(),
        trap,
    };
    let settings = Settings {
        numbers: pass
            .shader
            .constants(&pass.numbers)
            .map(|(name, value)| (name.to_owned(), value))
            .collect(),
        // As software drivers do.
        fused: false,
        ..Settings::default()
    };
    let program =
        Program::new(&pass.shader.module, &pass.shader.info, settings).map_err(trapped)?;
    let connected = Connected::new(pass, store, host)?;
    let resources = connected.resources();
    match &pass.shader.entry {
        Entry::Render { fragment, .. } => {
            let extent = target_size(pass, store)?;
            let entry = program.entry(fragment).map_err(trapped)?;
            // What covers the picture carries no values of its own.
            let pixels = entry
                .shade::<f32>(extent, &resources, &|_, _| None)
                .map_err(trapped)?;
            let locations: Vec<Option<u32>> = entry
                .outputs()
                .iter()
                .map(|binding| match binding {
                    Some(naga::Binding::Location { location, .. }) => Some(*location),
                    _ => None,
                })
                .collect();
            write_pixels(pass, store, &pixels, &locations);
        }
        Entry::Compute { name, workgroup } => {
            let entry = program.entry(name).map_err(trapped)?;
            let groups = groups(pass, *workgroup, store, size)?;
            entry.dispatch::<f32>(groups, &resources).map_err(trapped)?;
        }
    }
    connected.keep(pass, store);
    Ok(())
}

impl Connected {
    fn new(pass: &PlannedPass, store: &Store, host: &Host<'_>) -> Result<Self, CpuError> {
        let mut connected = Self::default();
        for binding in &pass.shader.bindings {
            let variable = binding.variable.clone();
            let wrong = |resource: &str, problem: String| CpuError::Resource {
                pass: pass.name.clone(),
                resource: resource.to_owned(),
                problem,
            };
            match binding.kind {
                BindingKind::Uniform(_) | BindingKind::Storage { .. } => {
                    let resource = binding.resource.clone();
                    let buffer = match store.buffer(&resource) {
                        Some(buffer) => buffer,
                        None if resource == LIVE_NUMBERS => {
                            let value = |name: &str| pass.numbers.get(name).copied();
                            Buffer::from_bytes(&pass.shader.live_bytes(value))
                        }
                        None => {
                            let bytes =
                                host(pass, binding).map_err(|problem| wrong(&resource, problem))?;
                            Buffer::from_bytes(&bytes)
                        }
                    };
                    connected.buffers.push((variable, resource, buffer));
                }
                BindingKind::Texture { .. } | BindingKind::StorageTexture { .. } => {
                    let name = texture_name(pass, binding);
                    let Some(texels) = store.textures.get(name) else {
                        return Err(wrong(name, "which is not there".to_owned()));
                    };
                    connected
                        .textures
                        .push((variable, name.to_owned(), texels.to_texture()));
                }
                BindingKind::Sampler => connected.samplers.push(variable),
            }
        }
        Ok(connected)
    }

    fn resources(&self) -> Resources<'_> {
        let mut resources = Resources::new();
        for (variable, _, buffer) in &self.buffers {
            resources = resources.buffer(variable, buffer);
        }
        for (variable, _, texture) in &self.textures {
            resources = resources.texture(variable, texture);
        }
        for variable in &self.samplers {
            resources = resources.sampler(variable, Sampler::default());
        }
        resources
    }

    /// Puts into the store what the shader has written itself.
    fn keep(&self, pass: &PlannedPass, store: &mut Store) {
        for binding in &pass.shader.bindings {
            match binding.kind {
                BindingKind::Storage {
                    read_only: false, ..
                } => {
                    let held = self.buffers.iter().find(|(v, ..)| *v == binding.variable);
                    if let (Some((_, name, buffer)), true) =
                        (held, store.buffers.contains_key(&binding.resource))
                    {
                        store.buffers.insert(name.clone(), buffer.words());
                    }
                }
                BindingKind::StorageTexture { .. } => {
                    let held = self.textures.iter().find(|(v, ..)| *v == binding.variable);
                    if let Some((_, name, texture)) = held
                        && let Some(texels) = store.textures.get_mut(name)
                    {
                        texels.words = texture.words();
                    }
                }
                _ => {}
            }
        }
    }
}

/// The texture that a binding stands for: an output's target, or the one it is connected to.
fn texture_name<'a>(pass: &'a PlannedPass, binding: &'a Binding) -> &'a str {
    if matches!(binding.kind, BindingKind::StorageTexture { .. }) {
        let names = [&binding.resource, &binding.variable];
        let output = pass.shader.outputs.iter().position(|o| names.contains(&o));
        if let Some(target) = output.and_then(|index| pass.targets.get(index)) {
            return target;
        }
    }
    &binding.resource
}

fn target_size(pass: &PlannedPass, store: &Store) -> Result<[u32; 2], CpuError> {
    let first = pass.targets.first();
    let texels = first.and_then(|name| store.textures.get(name));
    texels
        .map(|texels| texels.size)
        .ok_or_else(|| CpuError::Resource {
            pass: pass.name.clone(),
            resource: first.cloned().unwrap_or_default(),
            problem: "which it is to cover and which is not there".to_owned(),
        })
}

fn groups(
    pass: &PlannedPass,
    workgroup: [u32; 3],
    store: &Store,
    size: &dyn Fn(Size) -> [u32; 2],
) -> Result<[u32; 3], CpuError> {
    let covering = |[width, height]: [u32; 2]| {
        [
            width.div_ceil(workgroup[0].max(1)),
            height.div_ceil(workgroup[1].max(1)),
            1,
        ]
    };
    Ok(match &pass.kind {
        PassKind::DispatchFixed(groups) => *groups,
        PassKind::Dispatch(view) => covering(size(*view)),
        PassKind::DispatchIndirect(name) => match store.buffers.get(name).map(Vec::as_slice) {
            Some([x, y, z, ..]) => [*x, *y, *z],
            _ => {
                return Err(CpuError::Resource {
                    pass: pass.name.clone(),
                    resource: name.clone(),
                    problem: "which is to say how many workgroups run and does not".to_owned(),
                });
            }
        },
        _ => covering(target_size(pass, store)?),
    })
}

/// Puts what a fragment stage returns into its targets, where the pixel was not discarded.
fn write_pixels(
    pass: &PlannedPass,
    store: &mut Store,
    pixels: &Pixels<f32>,
    locations: &[Option<u32>],
) {
    for (index, name) in pass.targets.iter().enumerate() {
        let Some(texels) = store.textures.get_mut(name) else {
            continue;
        };
        let columns: Vec<&Column<f32>> = locations
            .iter()
            .zip(&pixels.value.columns)
            .filter(|(location, _)| **location == Some(index as u32))
            .map(|(_, column)| column)
            .collect();
        for (pixel, texel) in texels.words.iter_mut().enumerate() {
            if !pixels.kept[pixel] {
                continue;
            }
            let mut words = [0, 0, 0, 0];
            for (word, column) in words.iter_mut().zip(&columns) {
                *word = bits(column, pixel);
            }
            *texel = coding::kept(texels.format, words);
        }
    }
}

fn bits(column: &Column<f32>, lane: usize) -> u32 {
    match column {
        Column::Float(numbers) => numbers[lane].to_bits(),
        Column::Uint(words) => words[lane],
        Column::Sint(words) => words[lane] as u32,
        Column::Bool(words) => u32::from(words[lane]),
    }
}

/// The textures and buffers that a pass reads or writes, those of the host included.
#[must_use]
pub fn uses(pass: &PlannedPass) -> BTreeSet<&str> {
    let bound = pass.shader.bindings.iter().map(|b| texture_name(pass, b));
    let mut names: BTreeSet<&str> = bound
        .chain(pass.targets.iter().map(String::as_str))
        .collect();
    if let PassKind::DispatchIndirect(name) = &pass.kind {
        names.insert(name);
    }
    names
}

/// The textures and buffers that a pass writes.
#[must_use]
pub fn writes(pass: &PlannedPass) -> BTreeSet<&str> {
    let written = |b: &&Binding| {
        matches!(
            b.kind,
            BindingKind::StorageTexture { .. }
                | BindingKind::Storage {
                    read_only: false,
                    ..
                }
        )
    };
    let stored = pass
        .shader
        .bindings
        .iter()
        .filter(written)
        .map(|b| texture_name(pass, b));
    stored
        .chain(pass.targets.iter().map(String::as_str))
        .chain(pass.depth.as_deref())
        .collect()
}
