//! From a pipeline and facts to a plan.

use std::collections::{BTreeMap, BTreeSet};

use meniscus_shader::{Binding, BindingKind, Composer, Filling, Output, Recipe, Shader, Stage};
use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report};

use crate::facts::Facts;
use crate::file::{Dispatch, Over, Runs};
use crate::interface::{self, SHOWN, SHOWN_OF, about};
use crate::pipeline::{Pass, PassOver, Pipeline};
use crate::plan::{Covers, Format, PassKind, Plan, PlannedPass, Pruning, Size, Texture};

/// The output whose textures have a twin with what is shown.
const COLOUR: &str = "colour";
/// The output of a skeleton that says what its colour shows.
const SHOWN_OUTPUT: &str = "shown";
/// The entry in `writes` that is no output but the depth texture.
const DEPTH: &str = "depth";
/// The variable of a list's pixels in an entry point.
const PIXELS: &str = "pass_pixels";
/// The most workgroups along an axis that every adapter allows.
const MAX_GROUPS: u32 = 65_535;
/// How the variables of a compute pass's targets begin.
const TARGET: &str = "target_";

impl Plan {
    /// A plan with everything left out that may be: see [`Plan::pruned`].
    ///
    /// # Errors
    /// As [`Plan::pruned`].
    pub fn new(
        pipeline: &Pipeline,
        composer: &Composer,
        facts: &Facts,
        shown: bool,
    ) -> Result<Self, Report> {
        Self::pruned(pipeline, composer, facts, Pruning::default(), shown)
    }

    /// Composes the passes that the facts leave, and checks everything that can be checked without
    /// a GPU. With `shown`, each pass that writes `colour` is followed by one that writes which
    /// world point and object that colour shows.
    ///
    /// # Errors
    /// All that is wrong, in the words of the pipeline's file and of the modules.
    pub fn pruned(
        pipeline: &Pipeline,
        composer: &Composer,
        facts: &Facts,
        pruning: Pruning,
        shown: bool,
    ) -> Result<Self, Report> {
        let facts = &match pruning {
            Pruning::None => facts.unpruned(),
            _ => *facts,
        };
        let mut planner = Planner {
            pipeline,
            composer,
            facts,
            textures: pipeline
                .textures
                .iter()
                .map(|(name, t)| (name.clone(), t.value))
                .collect(),
            written: BTreeSet::new(),
            read: BTreeSet::new(),
            passes: Vec::new(),
            report: Report::default(),
        };
        for pass in &pipeline.passes {
            planner.add(pass, shown);
        }
        planner.check_output();
        planner.check_lists();
        let Planner {
            textures,
            written,
            read,
            passes,
            report,
            ..
        } = planner;
        report.into_result(Self {
            pipeline: pipeline.name.clone(),
            // What is neither written nor read needs no memory.
            textures: textures
                .into_iter()
                .filter(|(name, _)| written.contains(name) || read.contains(name))
                .collect(),
            buffers: pipeline
                .buffers
                .iter()
                .map(|(name, b)| (name.clone(), b.value))
                .collect(),
            lists: pipeline
                .lists
                .iter()
                .map(|(name, buffer)| (name.clone(), buffer.value.clone()))
                .collect(),
            passes,
            output: pipeline.output.value.clone(),
            shown: shown.then(|| format!("{}{SHOWN}", pipeline.output.value)),
        })
    }
}

impl Pipeline {
    /// What is likely not meant, under given facts: fillings that nothing asks for.
    pub fn warnings(&self, composer: &Composer, facts: &Facts) -> Report {
        let mut report = Report::default();
        for pass in &self.passes {
            let recipe = Recipe {
                skeleton: pass.skeleton.clone(),
                slots: pass.slots.clone(),
                reads: BTreeMap::new(),
                outputs: Vec::new(),
                facts: facts.names(),
                stage: Stage::Render,
            };
            report.extend(composer.warnings(&recipe));
        }
        report
    }
}

struct Planner<'p> {
    pipeline: &'p Pipeline,
    composer: &'p Composer,
    facts: &'p Facts,
    textures: BTreeMap<String, Texture>,
    written: BTreeSet<String>,
    read: BTreeSet<String>,
    passes: Vec<PlannedPass>,
    report: Report,
}

impl Planner<'_> {
    fn add(&mut self, pass: &Pass, shown: bool) {
        match pass.when.as_ref().map(|rule| self.facts.hold(rule)) {
            Some(Err(unknown)) => return self.report.extend(unknown),
            Some(Ok(false)) => return,
            _ => {}
        }
        let writes: Vec<_> = pass
            .writes
            .iter()
            .filter(|(output, _)| output.value != DEPTH)
            .collect();
        let depth = pass
            .writes
            .iter()
            .find(|(output, _)| output.value == DEPTH)
            .map(|(_, texture)| texture.clone());
        let outputs = writes
            .iter()
            .map(|(output, texture)| (output.clone(), texture.clone()))
            .collect();
        if let Err(wrong) = self.plan(pass, pass.name.value.clone(), outputs, depth.as_ref()) {
            self.report.extend(wrong);
            // Once it is mended it writes these: who reads them is not to blame.
            self.written.extend(
                writes
                    .iter()
                    .map(|(_, t)| t)
                    .chain(&depth)
                    .map(|t| t.value.clone()),
            );
        }
        let Some((output, texture)) = writes
            .iter()
            .find(|(output, _)| output.value == COLOUR)
            .filter(|_| shown)
        else {
            return;
        };
        // The twin runs against a depth texture of its own, so that it sees what the pass saw.
        let twin = |texture: &Spanned<String>| Spanned {
            value: format!("{}{SHOWN}", texture.value),
            place: texture.place.clone(),
        };
        if let Some(declared) = self.textures.get(&texture.value) {
            let size = declared.size;
            self.textures.insert(
                twin(texture).value,
                Texture {
                    format: Format::Rgba32Float,
                    size,
                },
            );
        }
        if let Some((depth, declared)) = depth
            .as_ref()
            .and_then(|d| Some((d, self.textures.get(&d.value)?)))
        {
            let declared = *declared;
            self.textures.insert(twin(depth).value, declared);
        }
        let shown_output = Spanned {
            value: SHOWN_OUTPUT.to_owned(),
            place: output.place.clone(),
        };
        let name = format!("{}{SHOWN}", pass.name.value);
        let depth = depth.as_ref().map(twin);
        if let Err(wrong) = self.plan(
            pass,
            name,
            vec![(shown_output, twin(texture))],
            depth.as_ref(),
        ) {
            self.report.extend(wrong);
        }
    }

    fn plan(
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
        });
        Ok(())
    }

    fn declared(&self, texture: &Spanned<String>) -> Result<Texture, Report> {
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

    /// Checks every resource of a shader, and that what is read has been written.
    fn check(
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
    fn check_lists(&mut self) {
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

    fn check_output(&mut self) {
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
        .filter_map(|(path, value)| Some((shader.overrides.get(&path)?.clone(), value.value)))
        .collect()
}
