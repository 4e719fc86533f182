//! Progress on the terminal.

use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};

use super::say::tell;

/// A bar that shows what is being done; nothing where there is no terminal.
pub(crate) struct Bar {
    bar: ProgressBar,
    /// What was said last, so that a log shows each step once.
    last: Mutex<String>,
}

impl Bar {
    pub fn new() -> Self {
        let bar = ProgressBar::new(1000);
        if let Ok(style) = ProgressStyle::with_template("{msg:28} {wide_bar} {percent:>3} %") {
            bar.set_style(style);
        }
        Self {
            bar,
            last: Mutex::default(),
        }
    }

    /// Says what is being done, and how much of it is done (0 to 1).
    pub fn tell(&self, what: &str, part: f64) {
        self.bar
            .set_position((1000.0 * part.clamp(0.0, 1.0)) as u64);
        let mut last = self
            .last
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        if *last != what {
            what.clone_into(&mut last);
            self.bar.set_message(what.to_owned());
            if self.bar.is_hidden() {
                tell(&format!("{what} …"));
            }
        }
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
