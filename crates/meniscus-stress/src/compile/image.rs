//! Textures: loads, samples, sizes and stores.

use naga::{Expression, Handle, ImageClass, ImageDimension, ImageQuery, SampleLevel, TypeInner};

use super::builder::{Builder, Result, Value};
use crate::op::{ImageOp, Leaf, Level, NONE, Op, Register};

impl Builder<'_> {
    fn handle(&mut self, expression: Handle<Expression>) -> Result<u32> {
        match self.value(expression)? {
            Value::Handle(slot) => Ok(slot),
            _ => self.wrong(),
        }
    }

    fn image_class(&self, image: Handle<Expression>) -> Result<(ImageDimension, ImageClass)> {
        match *self.type_of(image) {
            TypeInner::Image {
                class: ImageClass::External,
                ..
            } => self.unsupported("an external texture"),
            TypeInner::Image { dim, class, .. } => Ok((dim, class)),
            _ => self.wrong(),
        }
    }

    fn optional_int(&mut self, expression: Option<Handle<Expression>>) -> Result<Register> {
        expression.map_or(Ok(NONE), |e| self.single_int(e))
    }

    fn add_image(&mut self, op: ImageOp) {
        self.code.images.push(op);
        let index = self.code.images.len() as u32 - 1;
        self.push(Op::Image { index });
    }

    pub(super) fn image_expression(
        &mut self,
        expression: &Expression,
        whole: Handle<Expression>,
    ) -> Result<Vec<Leaf>> {
        match *expression {
            Expression::ImageLoad {
                image,
                coordinate,
                array_index,
                sample,
                level,
            } => {
                if sample.is_some() {
                    return self.unsupported("a multisampled texture");
                }
                let slot = self.handle(image)?;
                let at = three(&self.ints(coordinate)?);
                let layer = self.optional_int(array_index)?;
                let level = self.optional_int(level)?;
                let kinds = self.kinds(self.type_of(whole))?;
                let to = self.fresh(&kinds);
                self.add_image(ImageOp::Load {
                    image: slot,
                    at,
                    layer,
                    level,
                    to: to.clone(),
                });
                Ok(to)
            }
            Expression::ImageSample {
                image,
                sampler,
                gather,
                coordinate,
                array_index,
                offset,
                level,
                depth_ref,
                clamp_to_edge,
            } => {
                let (dimension, _) = self.image_class(image)?;
                if dimension == ImageDimension::Cube {
                    return self.unsupported("a cube texture");
                }
                let slot = self.handle(image)?;
                let sampler = self.handle(sampler)?;
                let at = three(&self.floats(coordinate)?);
                let layer = self.optional_int(array_index)?;
                let offset = self.constant_offset(offset)?;
                let level = self.detail(level)?;
                let compare = match depth_ref {
                    Some(depth) => self.single_float(depth)?,
                    None => NONE,
                };
                let kinds = self.kinds(self.type_of(whole))?;
                let to = self.fresh(&kinds);
                self.add_image(ImageOp::Sample {
                    image: slot,
                    sampler,
                    at,
                    layer,
                    offset,
                    level,
                    compare,
                    gather: gather.map(|component| component as u8),
                    clamp_to_edge,
                    to: to.clone(),
                });
                Ok(to)
            }
            Expression::ImageQuery { image, query } => {
                let (dimension, class) = self.image_class(image)?;
                if class.is_multisampled() {
                    return self.unsupported("a multisampled texture");
                }
                let image = self.handle(image)?;
                let count = match (query, dimension) {
                    (ImageQuery::Size { .. }, ImageDimension::D3) => 3,
                    (ImageQuery::Size { .. }, ImageDimension::D2 | ImageDimension::Cube) => 2,
                    _ => 1,
                };
                let level = match query {
                    ImageQuery::Size { level } => self.optional_int(level)?,
                    _ => NONE,
                };
                let to: Vec<_> = (0..count).map(|_| self.int()).collect();
                self.add_image(match query {
                    ImageQuery::Size { .. } => ImageOp::Size {
                        image,
                        level,
                        to: to.clone(),
                    },
                    ImageQuery::NumLevels => ImageOp::Levels { image, to: to[0] },
                    ImageQuery::NumLayers => ImageOp::Layers { image, to: to[0] },
                    ImageQuery::NumSamples => {
                        return self.unsupported("a multisampled texture");
                    }
                });
                Ok(to.into_iter().map(Leaf::Int).collect())
            }
            _ => self.wrong(),
        }
    }

    /// The offset of a sample is a constant in WGSL.
    fn constant_offset(&mut self, offset: Option<Handle<Expression>>) -> Result<[i32; 3]> {
        let mut found = [0; 3];
        let Some(offset) = offset else {
            return Ok(found);
        };
        for (i, register) in self.ints(offset)?.into_iter().enumerate().take(3) {
            let at = (register & !crate::op::CONSTANT) as usize;
            match self.code.int_constants.get(at) {
                Some(&word) if register & crate::op::CONSTANT != 0 => found[i] = word as i32,
                _ => return self.unsupported("an offset that is not a plain constant"),
            }
        }
        Ok(found)
    }

    fn detail(&mut self, level: SampleLevel) -> Result<Level> {
        Ok(match level {
            SampleLevel::Auto => Level::Auto,
            SampleLevel::Zero => Level::Zero,
            SampleLevel::Exact(level) => Level::Exact(self.single(level)?),
            SampleLevel::Bias(bias) => Level::Bias(self.single_float(bias)?),
            SampleLevel::Gradient { x, y } => Level::Gradient {
                x: three(&self.floats(x)?),
                y: three(&self.floats(y)?),
            },
        })
    }

    pub(super) fn image_store(
        &mut self,
        image: Handle<Expression>,
        coordinate: Handle<Expression>,
        array_index: Option<Handle<Expression>>,
        value: Handle<Expression>,
    ) -> Result<()> {
        let (_, ImageClass::Storage { format, .. }) = self.image_class(image)? else {
            return self.wrong();
        };
        let image = self.handle(image)?;
        let at = three(&self.ints(coordinate)?);
        let layer = self.optional_int(array_index)?;
        let from = self.leaves(value)?;
        self.add_image(ImageOp::Store {
            image,
            format,
            at,
            layer,
            from,
        });
        Ok(())
    }
}

fn three(registers: &[Register]) -> [Register; 3] {
    std::array::from_fn(|i| registers.get(i).copied().unwrap_or(NONE))
}
