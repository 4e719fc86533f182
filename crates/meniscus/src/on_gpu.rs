//! Functions of modules on an adapter, for `eval`, `stress` and whoever checks the evaluator.

use meniscus_gpu::{Compute, Given, GivenTexels, Gpu};
use meniscus_source::{Diagnostic, Report};
use meniscus_stress::modules::{Device, Kernel, Launcher, Read, Texels};

/// An adapter that calls functions of modules.
#[derive(Debug)]
pub struct FunctionsOnGpu(pub Gpu);

impl Device for FunctionsOnGpu {
    fn name(&self) -> String {
        self.0.facts().name.clone()
    }

    fn launcher(&self, kernel: &Kernel) -> Result<Box<Launcher<'_>>, Report> {
        let given: Vec<(u32, Given<'_>)> = kernel
            .reads
            .iter()
            .map(|(binding, read)| (*binding, given(read)))
            .collect();
        let (module, constants) = (&kernel.module, &kernel.constants);
        let compute = Compute::new(&self.0, module, Kernel::ENTRY, &given, constants)
            .map_err(|error| Diagnostic::error(error.to_string()))?;
        let (inputs, outputs) = (kernel.input_words, kernel.output_words);
        Ok(Box::new(move |words, calls| {
            let mut found = Vec::with_capacity(calls * outputs);
            let most = (compute.most_threads() as usize).min(1 << 20);
            for first in (0..calls).step_by(most) {
                let count = (calls - first).min(most);
                let given = words.get(first * inputs..(first + count) * inputs);
                let given: Vec<u8> = given
                    .unwrap_or_default()
                    .iter()
                    .flat_map(|word| word.to_le_bytes())
                    .collect();
                let bytes = compute
                    .run(&given, 4 * count * outputs, count as u32)
                    .map_err(|error| error.to_string())?;
                let words = bytes.chunks_exact(4);
                found.extend(words.map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])));
            }
            Ok(found)
        }))
    }
}

fn given(read: &Read) -> Given<'_> {
    match read {
        Read::Uniform(words) => Given::Uniform(words),
        Read::Storage(words) => Given::Storage(words),
        Read::Sampler => Given::Sampler,
        Read::Texture {
            size,
            texels,
            words,
            filtered,
        } => Given::Texture {
            size: *size,
            texels: match texels {
                Texels::Float if *filtered => GivenTexels::Filtered,
                Texels::Float => GivenTexels::Float,
                Texels::Sint => GivenTexels::Sint,
                Texels::Uint => GivenTexels::Uint,
                Texels::Depth => GivenTexels::Depth,
            },
            words,
        },
    }
}
