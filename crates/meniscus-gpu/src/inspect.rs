//! A frame pass by pass: what each finds and leaves, for whoever runs some of them elsewhere.

use meniscus_pipeline::Format;

use crate::readback;
use crate::record::{self, Instrument};
use crate::resources::Target;
use crate::steps::{Attachment, Clear, Work};
use crate::{Frame, GpuError, formats};

/// A texture's texels: four words each, row by row from the top. Numbers are the bits of `f32`s
/// (depth and normalised ones included), absent channels 0, 0 and 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextureWords {
    /// Width and height.
    pub size: [u32; 2],
    /// What a texel is.
    pub format: Format,
    /// The texels.
    pub words: Vec<[u32; 4]>,
}

impl Frame {
    /// Runs one pass of the plan, with the clears that come before it, and waits for it. The frame is
    /// to be one whose textures share no memory ([`Skipping::NONE`]).
    ///
    /// [`Skipping::NONE`]: crate::Skipping::NONE
    ///
    /// # Errors
    /// As [`Frame::render`]; when there is no such pass.
    pub fn run_pass(&self, index: usize) -> Result<(), GpuError> {
        let mut chosen = vec![false; self.steps().len()];
        let Some(pass) = chosen.get_mut(index) else {
            return Err(GpuError::Plan(format!(
                "there is no pass of number {index}"
            )));
        };
        *pass = true;
        self.run(Instrument::Nothing, None, Some(&chosen)).map(drop)
    }

    /// Clears what is cleared before a pass or as it begins, and runs nothing: textures and buffers
    /// are then what the pass finds.
    ///
    /// # Errors
    /// As [`Frame::run_pass`].
    pub fn begin_pass(&self, index: usize) -> Result<(), GpuError> {
        let Some(step) = self.steps().get(index) else {
            return Err(GpuError::Plan(format!(
                "there is no pass of number {index}"
            )));
        };
        self.gpu().attempt("clearing before a pass", || {
            let mut encoder = self
                .gpu()
                .device()
                .create_command_encoder(&Default::default());
            for buffer in &step.zeroes {
                encoder.clear_buffer(buffer, 0, None);
            }
            record::clears(&mut encoder, &step.clears, None);
            record::clears(&mut encoder, &first_clears(&step.work), None);
            self.gpu().queue().submit([encoder.finish()]);
        })?;
        self.gpu().wait()
    }

    /// Reads a texture of the plan as it stands, bit for bit.
    ///
    /// # Errors
    /// As [`Frame::read`].
    pub fn texture_words(&self, texture: &str) -> Result<TextureWords, GpuError> {
        let target = self.texture(texture)?;
        let mut words = Vec::new();
        readback::rows(
            self.gpu(),
            &target.texture,
            target.format,
            target.size,
            |row| {
                formats::words(target.format, row, &mut words);
            },
        )?;
        Ok(TextureWords {
            size: target.size.to_array(),
            format: target.format,
            words,
        })
    }

    /// Writes a texture of the plan.
    ///
    /// # Errors
    /// When there is none of that name, when it is one of depth, which cannot be written, and when the
    /// number of texels is another.
    pub fn write_texture_words(&self, texture: &str, words: &[[u32; 4]]) -> Result<(), GpuError> {
        let target = self.texture(texture)?;
        let count = target.size.x as usize * target.size.y as usize;
        if formats::is_depth(target.format) || words.len() != count {
            return Err(GpuError::Plan(format!(
                "{} texels cannot be written to the texture `{texture}` of {count}",
                words.len()
            )));
        }
        let bytes = formats::encode(target.format, words);
        self.gpu().attempt("writing a texture", || {
            self.gpu().queue().write_texture(
                target.texture.as_image_copy(),
                &bytes,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(target.size.x * formats::texel_bytes(target.format)),
                    rows_per_image: None,
                },
                target.texture.size(),
            );
        })
    }

    fn texture(&self, name: &str) -> Result<&Target, GpuError> {
        let textures = &self.resources().textures;
        let missing = || GpuError::Plan(format!("there is no texture `{name}`"));
        textures.get(name).ok_or_else(missing)
    }

    /// Writes a buffer of the plan.
    ///
    /// # Errors
    /// When there is none of that name, and when the length is another.
    pub fn write_buffer(&self, buffer: &str, bytes: &[u8]) -> Result<(), GpuError> {
        let held = self.resources().buffers.get(buffer);
        let Some(held) = held.filter(|held| held.size() == bytes.len() as u64) else {
            return Err(GpuError::Plan(format!(
                "there is no buffer `{buffer}` of {} bytes",
                bytes.len()
            )));
        };
        self.gpu().attempt("writing a buffer", || {
            self.gpu().queue().write_buffer(held, 0, bytes);
        })
    }
}

/// What a render pass clears as it begins.
fn first_clears(work: &Work) -> Vec<Clear> {
    let Work::Render { colours, depth, .. } = work else {
        return Vec::new();
    };
    let clear = |attachment: &Attachment, depth: bool| {
        let view = attachment.view.clone();
        attachment.clear.map(|to| Clear { view, depth, to })
    };
    let colours = colours.iter().filter_map(|colour| clear(colour, false));
    let depth = depth.iter().filter_map(|depth| clear(depth, true));
    colours.chain(depth).collect()
}
