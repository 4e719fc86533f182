//! Rendering only what has changed since the last frame.

use crate::record::Instrument;
use crate::{Frame, GpuError};

/// What [`Frame::refresh`] did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refreshed {
    /// How many passes ran; with none, the last frame stands as it was.
    pub passes: usize,
    /// From submission to the end of waiting, milliseconds; 0 where no pass ran.
    pub wall_ms: f64,
}

impl Frame {
    /// Brings the frame up to date and waits for it: runs the passes of which an input has changed
    /// since they ran last, those that make anew what these read and is no longer there, and those
    /// that write over what these write. What comes out is what [`Frame::render`] makes.
    ///
    /// An input is a byte that the pass's shader reads of what [`Frame::update`] wrote, the
    /// triangles that it draws, or what an earlier pass made.
    ///
    /// # Errors
    /// As [`Frame::render`]; after one, the next call runs all passes.
    pub fn refresh(&mut self) -> Result<Refreshed, GpuError> {
        self.keep_up()?;
        let mut reuse = std::mem::take(&mut self.parts().reuse);
        let chosen = reuse.passes();
        let passes = chosen.iter().filter(|run| **run).count();
        let ran = match passes {
            0 => Ok(0.0),
            _ => self.run(Instrument::Nothing, None, Some(chosen)),
        };
        match ran {
            Ok(_) => reuse.done(),
            Err(_) => reuse.forget(),
        }
        self.parts().reuse = reuse;
        ran.map(|wall_ms| Refreshed { passes, wall_ms })
    }

    /// The names of the passes that the last [`Frame::refresh`] ran, in order.
    pub fn refreshed(&self) -> impl Iterator<Item = &str> {
        let steps = self.steps().iter().zip(self.reuse().chosen());
        steps
            .filter(|(_, run)| **run)
            .map(|(step, _)| step.name.as_str())
    }
}
