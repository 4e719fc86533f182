//! Explanations for people.

use std::fmt::{self, Write as _};

use crate::explain::{DroppedSaid, Explanation, PassSaid, Work};
use crate::explain_clusters::ClustersSaid;

/// Columns of a line.
const WIDTH: usize = 100;

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size;
        writeln!(f, "{}\n{}\n", self.pipeline, self.about)?;
        self.summary(f, width, height)?;
        writeln!(f, "\nWhat is known")?;
        let longest = self.facts.iter().map(|fact| fact.name.len()).max();
        for fact in &self.facts {
            let holds = if fact.holds { "yes" } else { "no" };
            let mut said = fact.says.to_owned();
            if !fact.numbers.is_empty() {
                let _ = write!(said, " ({})", fact.numbers);
            }
            let name = pad(fact.name, longest.unwrap_or(0));
            entry(f, &format!("  {holds:<3}  {name}  "), &said)?;
        }
        writeln!(f, "\nPasses, in the order they run")?;
        let longest = self.passes.iter().map(|pass| pass.name.chars().count());
        let longest = longest.max().unwrap_or(0);
        for pass in &self.passes {
            let kept = if pass.kept { "kept   " } else { "dropped" };
            let lead = format!("  {kept}  {}  ", pad(&pass.name, longest));
            entry(f, &lead, &said_of(pass))?;
            let lead = " ".repeat(lead.chars().count());
            match &pass.dropped {
                Some(dropped) => {
                    entry(f, &lead, &why(dropped))?;
                    if dropped.promise != "choice" {
                        entry(f, &lead, &format!("saves {}", pass.work))?;
                    }
                }
                None => {
                    let slots = pass.slots.iter();
                    let slots: Vec<String> = slots.map(|(s, m)| format!("{s}: {m}")).collect();
                    if !slots.is_empty() {
                        entry(f, &lead, &slots.join(", "))?;
                    }
                    if let Some(clusters) = &pass.clusters {
                        entry(f, &lead, &out_of_view(clusters))?;
                    }
                }
            }
        }
        self.rest(f)
    }
}

impl Explanation {
    fn summary(&self, f: &mut fmt::Formatter<'_>, width: u32, height: u32) -> fmt::Result {
        let [kept, whole] = &self.total;
        let part = |what: &str, kept: u64, whole: u64| match kept == whole {
            true => format!("{} {what}", grouped(kept)),
            false => format!("{} of {} {what}", grouped(kept), grouped(whole)),
        };
        let said = format!(
            "{width}×{height} pixels: {}, {}, {}, {}; {} of textures and buffers instead of {}.",
            part("passes", kept.passes, whole.passes),
            part("draws", kept.draws, whole.draws),
            part("dispatches", kept.dispatches, whole.dispatches),
            part("triangles to draw", kept.triangles, whole.triangles),
            bytes(kept.bytes),
            bytes(whole.bytes),
        );
        let said = match kept.bytes == whole.bytes {
            true => said.replace(&format!(" instead of {}", bytes(whole.bytes)), ""),
            false => said,
        };
        entry(f, "", &said)?;
        if let Some(allocated) = self.allocated_bytes.filter(|bytes| *bytes != kept.bytes) {
            let said = "Textures that are never needed at once share memory, so that a frame takes";
            entry(f, "", &format!("{said} {}.", bytes(allocated)))?;
        }
        let promise = match self.within_px > 0.0 {
            true => format!(
                "What is shown moves by no more than {} px because of that; with --exact, by nothing.",
                self.within_px
            ),
            false => "No bit of the picture changes because of that.".to_owned(),
        };
        entry(f, "", &promise)
    }

    fn rest(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.shortcuts.is_empty() {
            writeln!(f, "\nShortcuts")?;
        }
        for shortcut in &self.shortcuts {
            let taken = if shortcut.taken {
                "taken    "
            } else {
                "not taken"
            };
            let lead = format!("  {taken}  {}  ", shortcut.name);
            let said = format!(
                "{} instead of {}",
                shortcut.passes.join(", "),
                shortcut.instead_of.join(", ")
            );
            entry(f, &lead, &said)?;
            let lead = " ".repeat(lead.chars().count());
            entry(f, &lead, &shortcut.because)?;
        }
        writeln!(f, "\nObjects")?;
        let longest = self.objects.iter().map(|o| o.side.len()).max().unwrap_or(0);
        for objects in &self.objects {
            let lead = format!("  {}  ", pad(objects.side, longest));
            let mut said = format!(
                "{} ({})",
                counted(objects.objects, "object"),
                counted(objects.triangles, "triangle")
            );
            if objects.objects > 0 {
                let _ = write!(said, ", {}", drawn(&objects.drawn_by, &objects.not_by));
            }
            entry(f, &lead, &said)?;
        }
        match self.guarded {
            None => writeln!(f, "\nTextures and buffers (without guard bands)")?,
            Some([x, y]) => writeln!(f, "\nTextures and buffers (with a guard band: {x}×{y})")?,
        }
        let longest = self.resources.iter().map(|r| r.name.chars().count());
        let longest = longest.max().unwrap_or(0);
        for resource in &self.resources {
            let kept = if resource.kept { "kept   " } else { "dropped" };
            let lead = format!("  {kept}  {}  ", pad(&resource.name, longest));
            let mut said = format!("{}: {}", resource.what, bytes(resource.bytes));
            if let Some(dropped) = &resource.dropped {
                let _ = write!(said, "; {}", dropped.because);
            }
            entry(f, &lead, &said)?;
        }
        let gone = self.modules.iter().filter(|module| !module.kept);
        let gone: Vec<&str> = gone.map(|module| module.path.as_str()).collect();
        if !gone.is_empty() {
            writeln!(f, "\nModules that are not needed")?;
            entry(f, "  ", &gone.join(", "))?;
        }
        Ok(())
    }
}

fn said_of(pass: &PassSaid) -> String {
    match pass.work.triangles {
        0 => format!("{} over {}", pass.skeleton, pass.over),
        triangles => format!(
            "{} over {}: up to {}",
            pass.skeleton,
            pass.over,
            counted(triangles, "triangle")
        ),
    }
}

fn why(dropped: &DroppedSaid) -> String {
    let promise = match dropped.promise {
        "choice" => String::new(),
        "exact" => " (exact)".to_owned(),
        _ => format!(" (within {} px)", dropped.within_px),
    };
    format!("{}{promise}: {}", dropped.rule, dropped.because)
}

fn out_of_view(said: &ClustersSaid) -> String {
    let all = counted(said.clusters, "cluster");
    match said.appears {
        None => format!("draws all of {all}: its modules do not say where points appear"),
        Some(appears) => format!(
            "{} (exact): leaves out {} of {all}, with {}; points appear {appears}",
            said.rule,
            grouped(said.dropped),
            counted(said.triangles, "triangle"),
        ),
    }
}

fn drawn(by: &[String], not_by: &[String]) -> String {
    let by = match by.is_empty() {
        true => "not drawn".to_owned(),
        false => format!("drawn by {}", by.join(", ")),
    };
    match not_by.is_empty() {
        true => by,
        false => format!("{by}; left out: {}", not_by.join(", ")),
    }
}

impl fmt::Display for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        for (number, what) in [(self.draws, "draw"), (self.dispatches, "dispatch")] {
            match number {
                0 => {}
                1 => parts.push(format!("1 {what}")),
                _ => parts.push(counted(number, what)),
            }
        }
        if self.triangles > 0 {
            parts.push(format!("up to {}", counted(self.triangles, "triangle")));
        }
        if let Some(pixels) = self.pixels.filter(|pixels| *pixels > 0) {
            parts.push(counted(pixels, "pixel"));
        }
        f.write_str(&parts.join(", "))
    }
}

/// A lead, and words behind it that go on in lines as far in.
fn entry(f: &mut fmt::Formatter<'_>, lead: &str, said: &str) -> fmt::Result {
    let indent = lead.chars().count();
    let mut line = lead.to_owned();
    let mut column = indent;
    for (index, word) in said.split_whitespace().enumerate() {
        let letters = word.chars().count();
        if index > 0 && column + 1 + letters > WIDTH {
            writeln!(f, "{}", line.trim_end())?;
            line = " ".repeat(indent);
            column = indent;
        } else if index > 0 {
            line.push(' ');
            column += 1;
        }
        line.push_str(word);
        column += letters;
    }
    writeln!(f, "{}", line.trim_end())
}

fn pad(text: &str, width: usize) -> String {
    let missing = width.saturating_sub(text.chars().count());
    format!("{text}{}", " ".repeat(missing))
}

fn counted(number: u64, what: &str) -> String {
    match number {
        1 => format!("1 {what}"),
        _ => format!("{} {what}s", grouped(number)),
    }
}

/// A number with a thin gap between groups of three digits.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut said = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            said.push('\u{202f}');
        }
        said.push(digit);
    }
    said
}

fn bytes(number: u64) -> String {
    match number {
        0..10_000 => format!("{number} bytes"),
        _ => format!("{:.1} MB", number as f64 / 1e6),
    }
}
