//! A pipeline as a graph, in the DOT language of Graphviz.

use std::fmt::Write as _;

use meniscus_shader::BindingKind;

use crate::plan::Plan;

impl Plan {
    /// Passes (boxes, in the order they run) and what lies between them (ovals), in DOT: an arrow
    /// from a pass to what it writes, and from there to who reads it. What the host offers is left
    /// out. Equal plans give equal bytes.
    pub fn dot(&self) -> String {
        let mut text =
            String::from("digraph {\n    rankdir=LR;\n    node [fontname=\"sans-serif\"];\n");
        for (name, texture) in &self.textures {
            let label = format!("{name}\n{:?}, {:?}", texture.format, texture.size);
            let frame = if *name == self.output {
                ", penwidth=3"
            } else {
                ""
            };
            let _ = writeln!(
                text,
                "    {} [label={}, shape=ellipse{frame}];",
                quoted(&format!("r {name}")),
                quoted(&label)
            );
        }
        for name in self.buffers.keys() {
            let _ = writeln!(
                text,
                "    {} [label={}, shape=cylinder];",
                quoted(&format!("r {name}")),
                quoted(name)
            );
        }
        for (number, pass) in self.passes.iter().enumerate() {
            let id = quoted(&format!("p {}", pass.name));
            let label = format!("{}. {}", number + 1, pass.name);
            let _ = writeln!(text, "    {id} [label={}, shape=box];", quoted(&label));
            let known =
                |name: &str| self.textures.contains_key(name) || self.buffers.contains_key(name);
            for target in pass.targets.iter().chain(&pass.depth) {
                let _ = writeln!(text, "    {id} -> {};", quoted(&format!("r {target}")));
            }
            for binding in pass
                .shader
                .bindings
                .iter()
                .filter(|b| known(&b.resource) && !pass.targets.contains(&b.resource))
            {
                let resource = quoted(&format!("r {}", binding.resource));
                let (reads, writes) = match binding.kind {
                    BindingKind::Storage { read_only, .. } => (true, !read_only),
                    BindingKind::StorageTexture { reads, .. } => (reads, true),
                    _ => (true, false),
                };
                if reads {
                    let _ = writeln!(text, "    {resource} -> {id};");
                }
                if writes {
                    let _ = writeln!(text, "    {id} -> {resource};");
                }
            }
        }
        text.push_str("}\n");
        text
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
