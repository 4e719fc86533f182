//! One pass: its recipe, its shader, and what runs.

use std::collections::BTreeMap;

use meniscus_shader::{Filling, Output, Recipe, Shader, Stage};
use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report};

use crate::cull::Appears;
use crate::file::{Dispatch, Over, Runs};
use crate::interface::{self, SHOWN, SHOWN_OF, about};
use crate::pipeline::{Pass, PassOver};
use crate::plan::{Covers, Format, PassKind, PlannedPass, Size, Texture};
use crate::planner::Planner;
use crate::sweep::PIXELS;

/// The most workgroups along an axis that every adapter allows.
const MAX_GROUPS: u32 = 65_535;
/// How the variables of a compute pass's targets begin.
const TARGET: &str = "target_";

impl Planner<'_> {
    pub(crate) fn plan(
        &mut self,
        pass: &Pass,
        name: String,
        outputs: Vec<(Spanned<String>, Spanned<String>)>,
        depth: Option<&Spanned<String>>,
    ) -> Result<(), Report> {
        let mut size = None;
        for texture in outputs.iter().map(|(_, texture)| texture).chain(depth) {
            let declared = self.declared(texture)?;
            if *size.get_or_insert(declared.size) != declared.size {
                return Err(about(
                    pass,
                    format!("`{}` writes textures of different sizes", pass.name.value),
                )
                .into());
            }
        }
        let size = size.unwrap_or(Size::Frame);
        let stage = match &pass.over {
            PassOver::Screen(Over::List { .. }, _) => Stage::List,
            PassOver::Screen(_, Runs::Compute) => Stage::Compute,
            _ => Stage::Render,
        };
        if stage != Stage::Render {
            for (_, texture) in &outputs {
                let format = self.declared(texture)?.format;
                if format.storage_name().is_none() {
                    return Err(about(
                        pass,
                        format!(
                            "no compute shader writes the format {format:?} of `{}`",
                            texture.value
                        ),
                    )
                    .with_help("run it as `Fragment`, or give the texture another format")
                    .into());
                }
            }
        }
        let recipe = Recipe {
            skeleton: pass.skeleton.clone(),
            slots: pass
                .slots
                .iter()
                .map(|(slot, filling)| (slot.clone(), with_twins(filling)))
                .collect(),
            reads: self.reads(pass, &outputs),
            outputs: outputs
                .iter()
                .map(|(output, texture)| {
                    let format = self.textures.get(&texture.value).map(|t| t.format);
                    Output {
                        name: output.clone(),
                        format: format
                            .and_then(Format::storage_name)
                            .unwrap_or("rgba16float")
                            .to_owned(),
                    }
                })
                .collect(),
            facts: self.facts.names(),
            stage,
        };
        self.composer
            .check_numbers(&pass.skeleton.value, &pass.numbers)
            .into_result(())?;
        let shader = self.composer.compose(&recipe)?;
        self.check(pass, &recipe, &shader, &outputs, depth)?;
        let kind = self.kind(pass, depth)?;
        let guarded = |name: &str| {
            self.textures
                .get(name)
                .is_some_and(|t| t.size == Size::Guarded)
        };
        let view_seen = if interface::read_textures(&shader).into_iter().any(guarded) {
            Size::Guarded
        } else {
            Size::Frame
        };
        let targets: Vec<String> = outputs
            .iter()
            .map(|(_, texture)| texture.value.clone())
            .collect();
        self.written.extend(targets.iter().cloned());
        self.written.extend(depth.map(|d| d.value.clone()));
        let depth = match (&pass.over, depth) {
            (PassOver::Draw(_), None) => {
                let own = format!("{name} (depth)");
                self.textures.insert(
                    own.clone(),
                    Texture {
                        format: Format::Depth32Float,
                        size,
                    },
                );
                self.written.insert(own.clone());
                Some(own)
            }
            (_, depth) => depth.map(|d| d.value.clone()),
        };
        let appears = Appears::of(self.composer.library(), &pass.skeleton.value, &pass.slots);
        self.passes.push(PlannedPass {
            name,
            kind,
            covers: match &pass.over {
                PassOver::Screen(Over::Water, _) => Covers::Water,
                PassOver::Screen(Over::Dry, _) => Covers::Dry,
                _ => Covers::All,
            },
            numbers: numbers(pass, &shader),
            shader,
            targets,
            depth,
            view_target: size,
            view_seen,
            appears,
        });
        Ok(())
    }

    fn kind(&self, pass: &Pass, depth: Option<&Spanned<String>>) -> Result<PassKind, Report> {
        let buffer = |name: &Spanned<String>| match self.pipeline.buffers.get(&name.value) {
            Some(_) => Ok(name.value.clone()),
            None => {
                let mut unknown = Diagnostic::error(format!("there is no buffer `{}`", name.value));
                if let Some(place) = &name.place {
                    unknown = unknown.at(place, "not among `buffers`");
                }
                let known = self.pipeline.buffers.keys().map(String::as_str);
                Err(Report::from(unknown.with_suggestion(&name.value, known)))
            }
        };
        let indirect = |name: &Spanned<String>| {
            let found = buffer(name)?;
            if self
                .pipeline
                .buffers
                .get(&found)
                .is_some_and(|b| b.value.indirect)
            {
                return Ok(found);
            }
            let mut wrong = Diagnostic::error(format!(
                "the buffer `{found}` holds no arguments of a dispatch"
            ));
            if let Some(place) = &name.place {
                wrong = wrong.at(place, "used as arguments");
            }
            Err(Report::from(
                wrong.with_help("declare it with `indirect: true`"),
            ))
        };
        if depth.is_some() && !matches!(pass.over, PassOver::Draw(_)) {
            return Err(about(pass, "only a Draw writes depth".into()).into());
        }
        if let Some(depth) = depth
            && self.declared(depth)?.format != Format::Depth32Float
        {
            return Err(
                about(pass, format!("`{}` is no depth texture", depth.value))
                    .with_help("give it the format Depth32Float")
                    .into(),
            );
        }
        Ok(match &pass.over {
            PassOver::Draw(geometry) => PassKind::Draw(*geometry),
            PassOver::Screen(Over::List { pixels, arguments }, _) => {
                buffer(pixels)?;
                PassKind::DispatchIndirect(indirect(arguments)?)
            }
            PassOver::Screen(_, Runs::Compute) => PassKind::ScreenCompute,
            PassOver::Screen(..) => PassKind::Screen,
            PassOver::Compute(Dispatch::Pixels(of)) => PassKind::Dispatch(*of),
            PassOver::Compute(Dispatch::Fixed(x, y, z)) => {
                if [x, y, z].into_iter().any(|n| !(1..=MAX_GROUPS).contains(n)) {
                    return Err(about(
                        pass,
                        format!("a dispatch has 1 to {MAX_GROUPS} workgroups along each axis"),
                    )
                    .into());
                }
                PassKind::DispatchFixed([*x, *y, *z])
            }
            PassOver::Compute(Dispatch::Indirect(arguments)) => {
                PassKind::DispatchIndirect(indirect(arguments)?)
            }
        })
    }

    /// Names of resources by variable: what the pass says, the twins with what is shown, and the
    /// resources that the entry points themselves declare.
    fn reads(
        &self,
        pass: &Pass,
        outputs: &[(Spanned<String>, Spanned<String>)],
    ) -> BTreeMap<String, String> {
        let twin = |texture: &str| format!("{texture}{SHOWN}");
        let mut reads = BTreeMap::new();
        for texture in self.pipeline.textures.keys() {
            reads.insert(format!("{SHOWN_OF}{texture}"), twin(texture));
        }
        for (variable, resource) in &pass.reads {
            reads.insert(variable.clone(), resource.value.clone());
            reads.insert(format!("{SHOWN_OF}{variable}"), twin(&resource.value));
        }
        for (output, texture) in outputs {
            reads.insert(format!("{TARGET}{}", output.value), texture.value.clone());
        }
        if let PassOver::Screen(Over::List { pixels, .. }, _) = &pass.over {
            reads.insert(PIXELS.to_owned(), pixels.value.clone());
        }
        reads
    }
}

/// A filling whose connections lead to what is shown in the textures, too.
fn with_twins(filling: &Filling) -> Filling {
    let mut twinned = filling.clone();
    for (variable, resource) in &filling.reads {
        // Without a place: whether anything asks for it is not the writer's concern.
        let twin = Spanned::unplaced(format!("{}{SHOWN}", resource.value));
        twinned
            .reads
            .entry(format!("{SHOWN_OF}{variable}"))
            .or_insert(twin);
    }
    for inner in twinned.slots.values_mut() {
        *inner = with_twins(inner);
    }
    twinned
}

/// The values of a pass's numbers, by the names of the `override`s in its shader.
fn numbers(pass: &Pass, shader: &Shader) -> BTreeMap<String, f64> {
    let mut set = pass.numbers.clone();
    for (slot, filling) in &pass.slots {
        filling.numbers_below(slot, &mut set);
    }
    set.into_iter()
        .filter_map(|(path, value)| Some((shader.number(&path)?.to_owned(), value.value)))
        .collect()
}
