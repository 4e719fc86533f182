//! Pipelines given as differences to others.

use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report};

use crate::file::{self, Value, VariantFile};
use crate::pipeline::{self, Pipeline};
use crate::steps::Steps;

/// Changes a pipeline as a variant says: what it removes, what it adds, what it sets.
///
/// # Errors
/// All that leads nowhere.
pub(crate) fn apply(pipeline: &mut Pipeline, variant: VariantFile) -> Result<(), Report> {
    let mut report = Report::default();
    pipeline
        .textures
        .extend(pipeline::textures(variant.textures));
    pipeline.buffers.extend(pipeline::buffers(variant.buffers));
    if let Some(output) = variant.output {
        pipeline.output = output.colour;
    }
    for (after, steps) in variant.insert_after.0 {
        match position(pipeline, &after) {
            Err(unknown) => report.add(unknown),
            Ok(at) => {
                let mut added = Steps::behind(pipeline);
                added.add(steps, "");
                added.end(pipeline, Some(at), &mut report);
            }
        }
    }
    for name in &variant.remove {
        match position(pipeline, name) {
            Err(unknown) => report.add(unknown),
            Ok(at) => {
                pipeline.passes.remove(at);
                pipeline.forget(&name.value);
            }
        }
    }
    for (key, value) in variant.set.iter() {
        if let Err(wrong) = pipeline.put(key, value) {
            report.add(wrong);
        }
    }
    report.into_result(())
}

/// Where a pass stands.
fn position(pipeline: &Pipeline, name: &Spanned<String>) -> Result<usize, Diagnostic> {
    let found = pipeline
        .passes
        .iter()
        .position(|pass| pass.name.value == name.value);
    found.ok_or_else(|| {
        let mut unknown =
            Diagnostic::error(format!("`{}` has no pass `{}`", pipeline.name, name.value));
        if let Some(place) = &name.place {
            unknown = unknown.at(place, "unknown pass");
        }
        unknown.with_suggestion(
            &name.value,
            pipeline.passes.iter().map(|p| p.name.value.as_str()),
        )
    })
}

impl Pipeline {
    /// Takes away the shortcuts that refer to a pass which is gone, and their passes.
    fn forget(&mut self, pass: &str) {
        let named = |p: &pipeline::Pass| p.like.iter().any(|like| like.value == pass);
        let with_it = self.passes.iter().filter(|p| named(p));
        let mut gone: Vec<String> = with_it.filter_map(|p| p.shortcut.clone()).collect();
        let refer = self.shortcuts.values().filter(|s| s.refers_to(pass));
        gone.extend(refer.map(|s| s.name.value.clone()));
        self.shortcuts.retain(|name, _| !gone.contains(name));
        self.passes
            .retain(|p| p.shortcut.as_ref().is_none_or(|s| !gone.contains(s)));
    }

    pub(crate) fn put(
        &mut self,
        key: &Spanned<String>,
        value: &Spanned<Value>,
    ) -> Result<(), Diagnostic> {
        let wrong = |message: String| {
            let place = key.place.as_ref().or(value.place.as_ref());
            let diagnostic = Diagnostic::error(message);
            match place {
                Some(place) => diagnostic.at(place, ""),
                None => diagnostic,
            }
        };
        let mut parts = key.value.split('.');
        let pass_name = parts.next().unwrap_or_default();
        let path: Vec<&str> = parts.collect();
        let names: Vec<String> = self.passes.iter().map(|p| p.name.value.clone()).collect();
        let Some(pass) = self.passes.iter_mut().find(|p| p.name.value == pass_name) else {
            return Err(wrong(format!("`{}` has no pass `{pass_name}`", self.name))
                .with_suggestion(pass_name, names.iter().map(String::as_str)));
        };
        if let [connections @ ("reads" | "writes"), name] = path[..] {
            let Value::Module(resource) = &value.value else {
                return Err(wrong(format!(
                    "`{}` wants the name of a resource",
                    key.value
                )));
            };
            let resource = Spanned {
                value: resource.clone(),
                place: value.place.clone(),
            };
            if connections == "reads" {
                pass.reads.insert(name.to_owned(), resource);
                return Ok(());
            }
            match pass
                .writes
                .iter_mut()
                .find(|(output, _)| output.value == name)
            {
                Some((_, texture)) => *texture = resource,
                None => {
                    let place = key.place.clone();
                    let value = name.to_owned();
                    pass.writes.push((Spanned { value, place }, resource));
                }
            }
            return Ok(());
        }
        let Some((last, way)) = path.split_last() else {
            return Err(wrong(format!(
                "`{}` names a pass; a slot or number must follow",
                key.value
            ))
            .with_help(
                "write PASS.SLOT, PASS.SLOT.NUMBER, PASS.reads.VARIABLE or PASS.writes.OUTPUT",
            ));
        };
        let mut fillings = &mut pass.slots;
        let mut numbers = &mut pass.numbers;
        for slot in way {
            let known: Vec<String> = fillings.keys().cloned().collect();
            let Some(filling) = fillings.get_mut(*slot) else {
                return Err(wrong(format!("nothing fills `{slot}` in `{}`", key.value))
                    .with_suggestion(slot, known.iter().map(String::as_str)));
            };
            fillings = &mut filling.slots;
            numbers = &mut filling.numbers;
        }
        match &value.value {
            Value::Number(_) if fillings.contains_key(*last) => {
                return Err(wrong(format!(
                    "`{}` names a slot, which wants a module",
                    key.value
                )));
            }
            Value::Number(number) => {
                let number = file::finite(*number)
                    .ok_or_else(|| wrong(format!("`{}` wants a finite number", key.value)))?;
                numbers.insert(
                    (*last).to_owned(),
                    Spanned {
                        value: number,
                        place: value.place.clone(),
                    },
                );
            }
            _ => {
                let slot = Spanned {
                    value: (*last).to_owned(),
                    place: key.place.clone(),
                };
                let filling = file::filling(&slot, value)?;
                fillings.insert(slot.value, filling);
            }
        }
        Ok(())
    }
}
