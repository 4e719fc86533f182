//! Whether passes, textures and buffers fit together.

use meniscus_shader::{Binding, BindingKind, Recipe, Shader};
use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report};

use crate::interface::{self, about};
use crate::pipeline::Pass;
use crate::plan::Texture;
use crate::planner::Planner;

impl Planner<'_> {
    pub(crate) fn declared(&self, texture: &Spanned<String>) -> Result<Texture, Report> {
        self.textures.get(&texture.value).copied().ok_or_else(|| {
            let mut unknown = Diagnostic::error(format!("there is no texture `{}`", texture.value));
            if let Some(place) = &texture.place {
                unknown = unknown.at(place, "not among `textures`");
            }
            unknown
                .with_suggestion(
                    &texture.value,
                    self.pipeline.textures.keys().map(String::as_str),
                )
                .into()
        })
    }

    /// Checks every resource of a shader, and that what is read has been written.
    pub(crate) fn check(
        &mut self,
        pass: &Pass,
        recipe: &Recipe,
        shader: &Shader,
        outputs: &[(Spanned<String>, Spanned<String>)],
        depth: Option<&Spanned<String>>,
    ) -> Result<(), Report> {
        let mut report = Report::default();
        let composer = self.composer;
        let declared = |variable: &str| composer.declaration(recipe, variable);
        for binding in &shader.bindings {
            let name = &binding.resource;
            let texture = self.textures.get(name);
            if let Some(wrong) =
                interface::check_binding(pass, binding, shader, self.pipeline, texture, &declared)
            {
                report.add(wrong);
                continue;
            }
            if let BindingKind::StorageTexture { .. } = binding.kind {
                self.written.insert(name.clone());
                continue;
            }
            if !matches!(binding.kind, BindingKind::Texture { .. }) {
                continue;
            }
            let writes_it = outputs.iter().any(|(_, t)| t.value == *name)
                || depth.is_some_and(|d| d.value == *name);
            if writes_it {
                report.add(
                    about(
                        pass,
                        format!("`{}` reads and writes `{name}` at once", pass.name.value),
                    )
                    .with_help("write another texture"),
                );
            } else if !self.written.contains(name) && self.replaced.contains_key(name) {
                let why = format!("`{}` reads `{name}`", pass.name.value);
                self.barred.insert(self.replaced[name].clone(), why);
            } else if !self.written.contains(name) {
                report.add(
                    about(
                        pass,
                        format!(
                            "`{}` reads `{name}` before any pass has written it",
                            pass.name.value
                        ),
                    )
                    .with_help("put the pass that writes it before this one"),
                );
            }
            self.read.insert(name.clone());
        }
        for wrong in interface::check_attributes(pass, shader) {
            report.add(wrong);
        }
        for wrong in interface::check_targets(pass, outputs, &self.textures, shader) {
            report.add(wrong);
        }
        for (variable, resource) in &pass.reads {
            let known = |binding: &Binding| binding.variable == *variable;
            if !shader.bindings.iter().any(known)
                && composer.library().declaration(variable).is_none()
            {
                let mut unknown =
                    Diagnostic::error(format!("`{}` reads no `{variable}`", pass.name.value));
                if let Some(place) = &resource.place {
                    unknown = unknown.at(place, "connected to nothing");
                }
                report.add(unknown.with_suggestion(
                    variable,
                    shader.bindings.iter().map(|b| b.variable.as_str()),
                ));
            }
        }
        for (location, (output, texture)) in outputs.iter().enumerate() {
            let Some(format) = self.textures.get(&texture.value).map(|t| t.format) else {
                continue;
            };
            if let Some(wrong) =
                interface::check_target(pass, &output.value, location as u32, format, shader)
            {
                report.add(wrong);
            }
        }
        report.into_result(())
    }

    /// What results count must be declared.
    pub(crate) fn check_lists(&mut self) {
        for buffer in self.pipeline.lists.values() {
            if !self.pipeline.buffers.contains_key(&buffer.value) {
                let mut unknown =
                    Diagnostic::error(format!("there is no buffer `{}`", buffer.value));
                if let Some(place) = &buffer.place {
                    unknown = unknown.at(place, "not among `buffers`");
                }
                let known = self.pipeline.buffers.keys().map(String::as_str);
                self.report
                    .add(unknown.with_suggestion(&buffer.value, known));
            }
        }
    }

    pub(crate) fn check_output(&mut self) {
        let output = &self.pipeline.output;
        match self.declared(output) {
            Err(unknown) => self.report.extend(unknown),
            Ok(_) if self.report.is_ok() && !self.written.contains(&output.value) => {
                let mut never =
                    Diagnostic::error(format!("no pass writes the output `{}`", output.value));
                if let Some(place) = &output.place {
                    never = never.at(place, "comes out empty");
                }
                self.report.add(never);
            }
            Ok(_) => {}
        }
    }
}
