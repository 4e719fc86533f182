//! Numbers that change while a plan runs: a small buffer for each pass that reads some.

use meniscus_pipeline::{Plan, PlannedPass};
use wgpu::util::DeviceExt;

use crate::{Gpu, GpuError};

/// The buffers of live numbers, by the pass.
#[derive(Debug, Default)]
pub(crate) struct LiveNumbers(Vec<(String, wgpu::Buffer)>);

impl LiveNumbers {
    /// The buffer of a pass, with the plan's values.
    ///
    /// # Errors
    /// When the graphics library refuses it.
    pub fn add(&mut self, gpu: &Gpu, pass: &PlannedPass) -> Result<wgpu::Buffer, GpuError> {
        let what = format!("the live numbers of `{}`", pass.name);
        let descriptor = wgpu::util::BufferInitDescriptor {
            label: Some(&what),
            contents: &bytes(pass),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        };
        let buffer = gpu.create(&what, || gpu.device().create_buffer_init(&descriptor))?;
        self.0.push((pass.name.clone(), buffer.clone()));
        Ok(buffer)
    }

    /// Writes a pass's numbers as they stand in the plan; so many bytes.
    ///
    /// # Errors
    /// When the graphics library refuses it.
    pub fn write(&self, gpu: &Gpu, pass: &PlannedPass) -> Result<u64, GpuError> {
        let Some((_, buffer)) = self.0.iter().find(|(name, _)| *name == pass.name) else {
            return Ok(0);
        };
        let bytes = bytes(pass);
        gpu.attempt(
            &format!("writing the live numbers of `{}`", pass.name),
            || {
                gpu.queue().write_buffer(buffer, 0, &bytes);
            },
        )?;
        Ok(bytes.len() as u64)
    }
}

fn bytes(pass: &PlannedPass) -> Vec<u8> {
    pass.shader
        .live_bytes(|name| pass.numbers.get(name).copied())
}

/// Puts a live number into a plan, for a pass and for its twin that tells what is shown; the passes
/// of which it changed something.
///
/// # Errors
/// When there is no such pass or number, and when the value lies outside the number's range.
pub(crate) fn set(
    plan: &mut Plan,
    pass: &str,
    path: &str,
    value: f64,
) -> Result<Vec<usize>, GpuError> {
    let is_meant = |name: &str| {
        let rest = name.strip_prefix(pass);
        rest.is_some_and(|rest| rest.is_empty() || rest == meniscus_pipeline::SHOWN)
    };
    let mut known = Vec::new();
    let mut found = false;
    let mut changed = Vec::new();
    for (index, planned) in plan.passes.iter_mut().enumerate() {
        if !is_meant(&planned.name) {
            continue;
        }
        let mut numbers = planned.shader.live.iter();
        let Some(number) = numbers.find(|number| number.path == path) else {
            let paths = planned.shader.live.iter().map(|number| number.path.clone());
            known.extend(paths);
            continue;
        };
        found = true;
        if !(number.least..=number.most).contains(&value) {
            return Err(GpuError::Plan(format!(
                "`{path}` of pass `{pass}` goes from {} to {}; {value} is outside",
                number.least, number.most
            )));
        }
        if planned.numbers.insert(number.name.clone(), value) != Some(value) {
            changed.push(index);
        }
    }
    if found {
        return Ok(changed);
    }
    known.dedup();
    Err(GpuError::Plan(match known.is_empty() {
        true => format!("pass `{pass}` is not there, or has no live numbers"),
        false => format!(
            "pass `{pass}` has no live number `{path}`; it has {}",
            known.join(", ")
        ),
    }))
}
