//! A pipeline as a graph: what each pass reads and writes, in the DOT language of Graphviz and as a
//! picture of our own.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use meniscus_shader::Filling;

use crate::pipeline::Pipeline;
use crate::plan::{Plan, PlannedPass};
use crate::uses::Uses;

/// Widths of two letters, height of a line and space around texts in the picture, in its units.
const TWO_LETTERS: usize = 15;
const LINE: usize = 16;
const SPACE: usize = 12;
/// How what is left out is drawn.
const GREY: &str = ", color=gray75, fontcolor=gray60";
/// Height of the lane of a texture or buffer.
const LANE: usize = 34;

impl Plan {
    /// Passes (boxes, in the order they run, with what fills their slots) and what lies between them
    /// (ovals, cylinders), in DOT: an arrow from a pass to what it writes, and from there to who
    /// reads it. What the host offers is left out. `pipeline`: what the plan was made of. Equal plans
    /// give equal bytes.
    pub fn dot(&self, pipeline: &Pipeline) -> String {
        self.drawn(pipeline, None)
    }

    /// The same, with what another plan of the pipeline has and this one has not, in grey.
    pub fn dot_over(&self, pipeline: &Pipeline, whole: &Plan) -> String {
        self.drawn(pipeline, Some(whole))
    }

    fn drawn(&self, pipeline: &Pipeline, whole: Option<&Plan>) -> String {
        let mut text =
            String::from("digraph {\n    rankdir=LR;\n    node [fontname=\"sans-serif\"];\n");
        self.dot_resources(&mut text, "", |_| true);
        if let Some(whole) = whole {
            let here =
                |name: &str| self.textures.contains_key(name) || self.buffers.contains_key(name);
            whole.dot_resources(&mut text, GREY, |name| !here(name));
        }
        for (number, pass) in self.passes.iter().enumerate() {
            let title = format!("{}. {}", number + 1, pass.name);
            self.dot_pass(&mut text, &lines(pipeline, title, pass), pass, "");
        }
        for pass in whole.iter().flat_map(|whole| &whole.passes) {
            if let (Some(whole), false) = (whole, self.passes.iter().any(|p| p.name == pass.name)) {
                whole.dot_pass(
                    &mut text,
                    &lines(pipeline, pass.name.clone(), pass),
                    pass,
                    GREY,
                );
            }
        }
        text.push_str("}\n");
        text
    }

    fn dot_resources(&self, text: &mut String, style: &str, which: impl Fn(&str) -> bool) {
        for (name, kind) in self.resources().filter(|(name, _)| which(name)) {
            let shape = match self.textures.contains_key(name) {
                true => "ellipse",
                false => "cylinder",
            };
            let frame = match name == self.output {
                true => ", penwidth=3",
                false => "",
            };
            let _ = writeln!(
                text,
                "    {} [label={}, shape={shape}{frame}{style}];",
                quoted(&format!("r {name}")),
                quoted(&format!("{name}\n{kind}"))
            );
        }
    }

    fn dot_pass(&self, text: &mut String, said: &[String], pass: &PlannedPass, style: &str) {
        let id = quoted(&format!("p {}", pass.name));
        let label = quoted(&said.join("\n"));
        let _ = writeln!(text, "    {id} [label={label}, shape=box{style}];");
        let arrow = match style {
            "" => String::new(),
            _ => format!(" [{}]", style.trim_start_matches(", ")),
        };
        let uses = self.uses(pass);
        for name in uses.reads {
            let _ = writeln!(text, "    {} -> {id}{arrow};", quoted(&format!("r {name}")));
        }
        for name in uses.writes {
            let _ = writeln!(text, "    {id} -> {}{arrow};", quoted(&format!("r {name}")));
        }
    }

    /// The same as an SVG picture: passes from left to right in the order they run, with what fills
    /// their slots; below them a lane for each texture and buffer, from the first pass that uses it
    /// to the last. A full dot is written by the pass above it, a hollow one read, a ringed one both.
    /// Equal plans give equal bytes.
    pub fn svg(&self, pipeline: &Pipeline) -> String {
        let columns: Vec<Vec<String>> = self
            .passes
            .iter()
            .enumerate()
            .map(|(number, pass)| lines(pipeline, format!("{}. {}", number + 1, pass.name), pass))
            .collect();
        let resources: Vec<(&str, String)> = self.resources().collect();
        let letters = |texts: &[&str]| texts.iter().map(|t| t.chars().count()).max().unwrap_or(0);
        let labels: Vec<&str> = resources
            .iter()
            .flat_map(|(name, kind)| [*name, kind.as_str()])
            .collect();
        let mut x = letters(&labels) * TWO_LETTERS / 2 + 2 * SPACE;
        let rows = columns.iter().map(Vec::len).max().unwrap_or(0);
        let top = rows * LINE + 3 * SPACE;
        let mut boxes = String::new();
        let mut centres = Vec::new();
        for texts in &columns {
            let shown: Vec<&str> = texts.iter().map(String::as_str).collect();
            let width = letters(&shown) * TWO_LETTERS / 2 + 2 * SPACE;
            let height = texts.len() * LINE + SPACE;
            let _ = writeln!(
                boxes,
                "<rect x=\"{x}\" y=\"{SPACE}\" width=\"{width}\" height=\"{height}\" rx=\"4\" class=\"pass\"/>"
            );
            for (row, line) in texts.iter().enumerate() {
                let class = if row == 0 { " class=\"name\"" } else { "" };
                let y = SPACE + (row + 1) * LINE;
                let at = x + SPACE;
                let _ = writeln!(
                    boxes,
                    "<text x=\"{at}\" y=\"{y}\"{class}>{}</text>",
                    escaped(line)
                );
            }
            centres.push((x + width / 2, SPACE + height));
            x += width + SPACE;
        }
        let height = top + resources.len() * LANE + SPACE;
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{x}\" height=\"{height}\" viewBox=\"0 0 {x} {height}\">\n<title>{}</title>\n{STYLE}<rect width=\"{x}\" height=\"{height}\" class=\"page\"/>\n",
            escaped(&self.pipeline)
        );
        let uses: Vec<Uses> = self.passes.iter().map(|pass| self.uses(pass)).collect();
        self.lanes(&mut text, &resources, &uses, &centres, top);
        text.push_str(&boxes);
        text.push_str("</svg>\n");
        text
    }

    /// Lanes, and the stems between them and the passes, which `centres` says the feet of.
    fn lanes(
        &self,
        text: &mut String,
        resources: &[(&str, String)],
        uses: &[Uses],
        centres: &[(usize, usize)],
        top: usize,
    ) {
        let lane = |row: usize| top + row * LANE + LANE / 2;
        for ((x, foot), used) in centres.iter().zip(uses) {
            let lowest = resources
                .iter()
                .rposition(|(name, _)| used.reads.contains(name) || used.writes.contains(name));
            if let Some(row) = lowest {
                let end = lane(row);
                let _ = writeln!(text, "<path d=\"M{x} {foot}V{end}\" class=\"stem\"/>");
            }
        }
        for (row, (name, kind)) in resources.iter().enumerate() {
            let y = lane(row);
            let class = match *name == self.output {
                true => "name",
                false => "plain",
            };
            let _ = writeln!(
                text,
                "<text x=\"{SPACE}\" y=\"{}\" class=\"{class}\">{}</text>\n<text x=\"{SPACE}\" y=\"{}\" class=\"kind\">{}</text>",
                y - 2,
                escaped(name),
                y + LINE - 4,
                escaped(kind)
            );
            let touched: Vec<(usize, bool, bool)> = centres
                .iter()
                .zip(uses)
                .map(|((x, _), used)| (*x, used.reads.contains(name), used.writes.contains(name)))
                .filter(|(_, reads, writes)| *reads || *writes)
                .collect();
            if let (Some((first, ..)), Some((last, ..))) = (touched.first(), touched.last()) {
                let _ = writeln!(text, "<path d=\"M{first} {y}H{last}\" class=\"lane\"/>");
            }
            for (x, reads, writes) in touched {
                let (class, words) = match (reads, writes) {
                    (true, true) => ("both", "read and written"),
                    (true, false) => ("read", "read"),
                    _ => ("written", "written"),
                };
                let _ = writeln!(
                    text,
                    "<circle cx=\"{x}\" cy=\"{y}\" r=\"5\" class=\"{class}\"><title>{} is {words}</title></circle>",
                    escaped(name)
                );
            }
        }
    }

    /// Textures, then buffers, with what they are.
    fn resources(&self) -> impl Iterator<Item = (&str, String)> {
        let textures = self
            .textures
            .iter()
            .map(|(name, texture)| (name.as_str(), texture.to_string()));
        let buffers = self
            .buffers
            .iter()
            .map(|(name, buffer)| (name.as_str(), buffer.to_string()));
        textures.chain(buffers)
    }
}

/// What is said of a pass: its title, its skeleton, and what fills its slots.
fn lines(pipeline: &Pipeline, title: String, pass: &PlannedPass) -> Vec<String> {
    let mut said = vec![title];
    let declared = pipeline.passes.iter().find(|p| p.name.value == pass.name);
    if let Some(declared) = declared {
        said.push(declared.skeleton.value.clone());
        fillings(&declared.slots, "", &mut said);
    }
    said
}

fn fillings(slots: &BTreeMap<String, Filling>, indent: &str, said: &mut Vec<String>) {
    for (slot, filling) in slots {
        said.push(format!("{indent}{slot}: {}", filling.module.value));
        // A space that SVG does not swallow.
        fillings(&filling.slots, &format!("{indent}\u{a0}\u{a0}"), said);
    }
}

/// A DOT string.
fn quoted(text: &str) -> String {
    let escaped = text
        .replace('\\', "\\\\")
        .replace('"', "\\\"")
        .replace('\n', "\\n");
    format!("\"{escaped}\"")
}

/// A text in XML, which has no place for control characters.
fn escaped(text: &str) -> String {
    let plain: String = text.chars().filter(|c| !c.is_control()).collect();
    plain
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

const STYLE: &str = "<style>
text { font: 12px ui-monospace, monospace; fill: #222 }
.name { font-weight: bold }
.kind { font-size: 10px; fill: #666 }
.page { fill: #fff }
.pass { fill: #e8f1f8; stroke: #36648b }
.stem { stroke: #b5c7d6; fill: none }
.lane { stroke: #36648b; stroke-width: 2; fill: none }
.written { fill: #36648b; stroke: #36648b }
.read { fill: #fff; stroke: #36648b; stroke-width: 2 }
.both { fill: #36648b; stroke: #e8a33d; stroke-width: 3 }
</style>
";
