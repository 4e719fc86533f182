//! Recording a frame's steps, with or without instruments.

use crate::pipelines::Stages;
use crate::queries::Queries;
use crate::steps::{Attachment, Clear, Draw, Step, Work, Workgroups};
use crate::{Gpu, GpuError};

/// Where timestamps go.
#[derive(Debug)]
pub(crate) struct Stopwatch {
    pub queries: Queries,
    /// A texture of one pixel; where there is one, compute passes are timed by raster passes on it
    /// before and after them. Software adapters take the timestamps of a compute pass together
    /// with the next raster pass, when it is over.
    pub pixel: Option<wgpu::TextureView>,
}

impl Stopwatch {
    /// None where the adapter has no timestamps, or there is nothing to time.
    pub fn new(gpu: &Gpu, steps: &[Step]) -> Result<Option<Self>, GpuError> {
        if !gpu.has_timestamps() || steps.is_empty() {
            return Ok(None);
        }
        let queries = Queries::new(gpu, wgpu::QueryType::Timestamp, 2 * steps.len() as u32, 1)?;
        if !gpu.is_software() || !steps.iter().any(Step::has_compute) {
            return Ok(Some(Self {
                queries,
                pixel: None,
            }));
        }
        let descriptor = wgpu::TextureDescriptor {
            label: Some("mark"),
            size: wgpu::Extent3d::default(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        };
        let pixel = gpu.create("a pixel to time by", || {
            let texture = gpu.device().create_texture(&descriptor);
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        })?;
        let pixel = Some(pixel);
        Ok(Some(Self { queries, pixel }))
    }
}

/// What is measured while a frame runs.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Instrument<'a> {
    Nothing,
    /// Two timestamps a pass.
    Timestamps(&'a Stopwatch),
    /// One pipeline-statistics query a pass.
    Statistics(&'a wgpu::QuerySet),
}

/// Indices of a pass's timestamps.
fn pass_stamps(index: usize) -> (u32, u32) {
    (2 * index as u32, 2 * index as u32 + 1)
}

/// Records clears, each a render pass of its own; the first carries the begin timestamp.
pub(crate) fn clears(
    encoder: &mut wgpu::CommandEncoder,
    clears: &[Clear],
    stamp: Option<(&wgpu::QuerySet, u32)>,
) {
    for (index, clear) in clears.iter().enumerate() {
        let attachment = Attachment {
            view: clear.view.clone(),
            clear: Some(clear.to),
        };
        let stamp = stamp.filter(|_| index == 0);
        let writes = stamp.map(|(query_set, begin)| wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: None,
        });
        let (colours, depth) = if clear.depth {
            (vec![], Some(depth_attachment(&attachment)))
        } else {
            (vec![Some(colour_attachment(&attachment))], None)
        };
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear"),
            color_attachments: &colours,
            depth_stencil_attachment: depth,
            timestamp_writes: writes,
            ..Default::default()
        }));
    }
}

/// Records a raster pass of one pixel that takes a timestamp when it begins.
fn mark(
    encoder: &mut wgpu::CommandEncoder,
    pixel: &wgpu::TextureView,
    queries: &wgpu::QuerySet,
    stamp: u32,
) {
    let clear = Clear {
        view: pixel.clone(),
        depth: false,
        to: wgpu::Color::TRANSPARENT,
    };
    clears(encoder, &[clear], Some((queries, stamp)));
}

/// Records one step.
pub(crate) fn step(
    encoder: &mut wgpu::CommandEncoder,
    index: usize,
    step: &Step,
    instrument: Instrument,
) {
    for buffer in &step.zeroes {
        encoder.clear_buffer(buffer, 0, None);
    }
    let (begin, end) = pass_stamps(index);
    let watch = match instrument {
        Instrument::Timestamps(watch) => Some(watch),
        _ => None,
    };
    let pixel = watch
        .and_then(|w| w.pixel.as_ref())
        .filter(|_| step.has_compute());
    let queries = watch.map(|watch| &watch.queries.set);
    if let (Some(pixel), Some(queries)) = (pixel, queries) {
        mark(encoder, pixel, queries, begin);
    }
    // Either the marks carry the timestamps or the passes do: the first clear, or else the step
    // itself, the begin; the step the end.
    let stamps = queries.filter(|_| pixel.is_none());
    clears(
        encoder,
        &step.clears,
        stamps.map(|queries| (queries, begin)),
    );
    let own_begin = step.clears.is_empty().then_some(begin);
    if let Some(tiles) = step.tiles() {
        tiles.classify(encoder);
    }
    let statistics = match instrument {
        Instrument::Statistics(queries) => Some((queries, index as u32)),
        _ => None,
    };
    match (&step.work, &step.pipeline.stages) {
        (
            Work::Render {
                colours,
                depth,
                tiles,
                draw,
            },
            Stages::Render(pipeline),
        ) => {
            let colours: Vec<_> = colours.iter().map(|c| Some(colour_attachment(c))).collect();
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(&step.name),
                color_attachments: &colours,
                depth_stencil_attachment: depth.as_deref().map(depth_attachment),
                timestamp_writes: stamps.map(|query_set| wgpu::RenderPassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: own_begin,
                    end_of_pass_write_index: Some(end),
                }),
                ..Default::default()
            });
            if let Some((queries, index)) = statistics {
                pass.begin_pipeline_statistics_query(queries, index);
            }
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &step.bindings, &[]);
            match draw {
                Draw::Scene(geometry, ranges) => {
                    pass.set_vertex_buffer(0, geometry.vertices.slice(..));
                    pass.set_index_buffer(geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
                    for range in ranges {
                        pass.draw_indexed(range.clone(), 0, 0..1);
                    }
                }
                Draw::Screen(rects) => {
                    for rect in rects {
                        let size = rect.high - rect.low;
                        pass.set_scissor_rect(rect.low.x, rect.low.y, size.x, size.y);
                        match tiles {
                            Some(tiles) => tiles.draw(&mut pass),
                            None => pass.draw(0..3, 0..1),
                        }
                    }
                }
                Draw::Nothing => {}
            }
            if let Some(moving) = &step.moving {
                moving.record(&mut pass);
            }
            if statistics.is_some() {
                pass.end_pipeline_statistics_query();
            }
        }
        (Work::Compute(workgroups), Stages::Compute(pipeline)) => {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(&step.name),
                timestamp_writes: stamps.map(|query_set| wgpu::ComputePassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: own_begin,
                    end_of_pass_write_index: Some(end),
                }),
            });
            if let Some((queries, index)) = statistics {
                pass.begin_pipeline_statistics_query(queries, index);
            }
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &step.bindings, &[]);
            match workgroups {
                Workgroups::Direct([x, y, z]) => pass.dispatch_workgroups(*x, *y, *z),
                Workgroups::Indirect(buffer) => pass.dispatch_workgroups_indirect(buffer, 0),
            }
            if statistics.is_some() {
                pass.end_pipeline_statistics_query();
            }
        }
        // Work and stages are made together, from one kind of pass.
        _ => {}
    }
    if let (Some(pixel), Some(queries)) = (pixel, queries) {
        mark(encoder, pixel, queries, end);
    }
}

fn colour_attachment(attachment: &Attachment) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view: &attachment.view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: attachment
                .clear
                .map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear),
            store: wgpu::StoreOp::Store,
        },
    }
}

fn depth_attachment(attachment: &Attachment) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view: &attachment.view,
        depth_ops: Some(wgpu::Operations {
            load: match attachment.clear {
                // Infinitely far: depth is reversed.
                Some(_) => wgpu::LoadOp::Clear(0.0),
                None => wgpu::LoadOp::Load,
            },
            store: wgpu::StoreOp::Store,
        }),
        stencil_ops: None,
    }
}
