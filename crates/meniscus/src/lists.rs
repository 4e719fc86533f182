//! The pixels that a frame has listed.

use meniscus_gpu::{Frame, GpuError};

/// The pixels of a list, as columns and rows, in the order in which they came; none where the plan has no
/// such list, or no pass adds to it.
pub(crate) fn listed(
    frame: &Frame,
    name: &str,
    [width, height]: [u32; 2],
) -> Result<Vec<[u32; 2]>, GpuError> {
    let plan = frame.plan();
    let buffer = plan.lists.get(name);
    let Some(buffer) = buffer.filter(|buffer| plan.buffers.contains_key(*buffer)) else {
        return Ok(Vec::new());
    };
    let bytes = frame.read_buffer(buffer)?;
    let mut words = bytes
        .chunks_exact(4)
        .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let count = words.next().unwrap_or(0) as usize;
    let pixels = words.take(count).map(|word| [word & 0xffff, word >> 16]);
    Ok(pixels.filter(|[x, y]| *x < width && *y < height).collect())
}
