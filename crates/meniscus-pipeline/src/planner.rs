//! From a pipeline and facts to a plan.

use std::collections::{BTreeMap, BTreeSet};

use meniscus_shader::{Composer, Recipe, Stage};
use meniscus_source::Report;
use meniscus_source::ron::Spanned;

use crate::choose::{Choice, choose};
use crate::facts::Facts;
use crate::interface::SHOWN;
use crate::pipeline::{Pass, Pipeline};
use crate::plan::{Format, Plan, PlannedPass, Pruning, Texture};
use crate::rules::{Dropped, Rule};
use crate::sweep::sweep;

/// The output whose textures have a twin with what is shown.
const COLOUR: &str = "colour";
/// The output of a skeleton that says what its colour shows.
const SHOWN_OUTPUT: &str = "shown";
/// The entry in `writes` that is no output but the depth texture.
const DEPTH: &str = "depth";

/// What was decided on the way to a plan.
#[derive(Debug, Default)]
pub(crate) struct Decisions {
    /// Passes that were left out.
    pub dropped: Vec<Dropped>,
    /// Shortcuts that were not taken, and why.
    pub not_taken: BTreeMap<String, String>,
}

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
        Self::decided(pipeline, composer, facts, pruning, shown).map(|(plan, _)| plan)
    }

    /// The same, with what was decided.
    pub(crate) fn decided(
        pipeline: &Pipeline,
        composer: &Composer,
        facts: &Facts,
        pruning: Pruning,
        shown: bool,
    ) -> Result<(Self, Decisions), Report> {
        let facts = match pruning {
            Pruning::None => facts.unpruned(),
            _ => *facts,
        };
        let mut barred = BTreeMap::new();
        loop {
            let choice = choose(pipeline, composer.library(), &facts, pruning, &barred)?;
            let mut planner = Planner::new(pipeline, composer, facts, &choice);
            for (pass, dropped) in &choice.passes {
                match dropped {
                    None => planner.add(pass, shown),
                    Some(dropped) => planner.leave(pass, dropped.rule, shown),
                }
            }
            // Each time, one shortcut more is barred.
            if !planner.barred.is_empty() {
                barred.append(&mut planner.barred);
                continue;
            }
            planner.check_output();
            planner.check_lists();
            let mut plan = planner.finish(shown)?;
            plan.within_px = choice.within_px;
            let mut decisions = Decisions {
                dropped: choice.passes.into_iter().filter_map(|(_, d)| d).collect(),
                not_taken: choice.not_taken,
            };
            if pruning != Pruning::None {
                sweep(&mut plan, &mut decisions.dropped);
            }
            return Ok((plan, decisions));
        }
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

/// A plan in the making.
pub(crate) struct Planner<'p> {
    pub pipeline: &'p Pipeline,
    pub composer: &'p Composer,
    pub facts: Facts,
    pub textures: BTreeMap<String, Texture>,
    pub written: BTreeSet<String>,
    pub read: BTreeSet<String>,
    pub passes: Vec<PlannedPass>,
    /// What passes write for which shortcuts stand, with the shortcuts' names.
    pub replaced: BTreeMap<String, String>,
    /// Shortcuts whose passes do not make something that is read; and what is.
    pub barred: BTreeMap<String, String>,
    pub report: Report,
}

impl<'p> Planner<'p> {
    fn new(
        pipeline: &'p Pipeline,
        composer: &'p Composer,
        facts: Facts,
        choice: &Choice<'p>,
    ) -> Self {
        let mut replaced = BTreeMap::new();
        for pass in &pipeline.passes {
            if let Some(shortcut) = choice.replaced.get(pass.name.value.as_str()) {
                let textures = pass.writes.iter().map(|(_, texture)| texture);
                for texture in textures.map(|t| t.value.as_str()) {
                    for texture in [texture.to_owned(), format!("{texture}{SHOWN}")] {
                        replaced.insert(texture, (*shortcut).to_owned());
                    }
                }
            }
        }
        let textures = pipeline.textures.iter();
        Self {
            pipeline,
            composer,
            facts,
            textures: textures.map(|(name, t)| (name.clone(), t.value)).collect(),
            written: BTreeSet::new(),
            read: BTreeSet::new(),
            passes: Vec::new(),
            replaced,
            barred: BTreeMap::new(),
            report: Report::default(),
        }
    }

    /// Plans a pass, and its twin.
    fn add(&mut self, pass: &Pass, shown: bool) {
        let Written { outputs, depth } = Written::of(pass);
        let name = pass.name.value.clone();
        if let Err(wrong) = self.plan(pass, name, outputs.clone(), depth.as_ref()) {
            self.report.extend(wrong);
            // Once it is mended it writes these: who reads them is not to blame.
            let textures = outputs.iter().map(|(_, t)| t).chain(&depth);
            self.written.extend(textures.map(|t| t.value.clone()));
        }
        let Some((output, texture)) = self.twins(&outputs, depth.as_ref()).filter(|_| shown) else {
            return;
        };
        let shown_output = Spanned {
            value: SHOWN_OUTPUT.to_owned(),
            place: output.place.clone(),
        };
        let name = format!("{}{SHOWN}", pass.name.value);
        let depth = depth.as_ref().map(twin);
        let outputs = vec![(shown_output, twin(texture))];
        if let Err(wrong) = self.plan(pass, name, outputs, depth.as_ref()) {
            self.report.extend(wrong);
        }
    }

    /// Leaves a pass out. What it would have done nothing to but clear stays cleared: whoever reads
    /// it reads that.
    fn leave(&mut self, pass: &Pass, rule: Rule, shown: bool) {
        if matches!(rule, Rule::When | Rule::Shortcut) {
            return;
        }
        let Written { outputs, depth } = Written::of(pass);
        let textures = outputs.iter().map(|(_, t)| t).chain(&depth);
        self.written.extend(textures.map(|t| t.value.clone()));
        if let Some((_, texture)) = self.twins(&outputs, depth.as_ref()).filter(|_| shown) {
            self.written.insert(twin(texture).value);
        }
    }

    /// Makes the textures that a pass's twin writes; the output that has a twin, and its texture.
    fn twins<'w>(
        &mut self,
        outputs: &'w [(Spanned<String>, Spanned<String>)],
        depth: Option<&Spanned<String>>,
    ) -> Option<&'w (Spanned<String>, Spanned<String>)> {
        let colour = outputs.iter().find(|(output, _)| output.value == COLOUR)?;
        // The twin runs against a depth texture of its own, so that it sees what the pass saw.
        for texture in [Some(&colour.1), depth].into_iter().flatten() {
            if let Some(&declared) = self.textures.get(&texture.value) {
                let format = match declared.format {
                    Format::Depth32Float => Format::Depth32Float,
                    _ => Format::Rgba32Float,
                };
                let size = declared.size;
                self.textures
                    .insert(twin(texture).value, Texture { format, size });
            }
        }
        Some(colour)
    }

    fn finish(self, shown: bool) -> Result<Plan, Report> {
        let (read, written) = (&self.read, &self.written);
        let buffers = self.pipeline.buffers.iter();
        let lists = self.pipeline.lists.iter();
        let plan = Plan {
            pipeline: self.pipeline.name.clone(),
            // What is neither written nor read needs no memory.
            textures: self
                .textures
                .into_iter()
                .filter(|(name, _)| written.contains(name) || read.contains(name))
                .collect(),
            buffers: buffers.map(|(name, b)| (name.clone(), b.value)).collect(),
            lists: lists
                .map(|(name, buffer)| (name.clone(), buffer.value.clone()))
                .collect(),
            passes: self.passes,
            output: self.pipeline.output.value.clone(),
            shown: shown.then(|| format!("{}{SHOWN}", self.pipeline.output.value)),
            within_px: 0.0,
        };
        self.report.into_result(plan)
    }
}

/// What a pass writes: outputs with their textures, and the depth texture.
struct Written {
    outputs: Vec<(Spanned<String>, Spanned<String>)>,
    depth: Option<Spanned<String>>,
}

impl Written {
    fn of(pass: &Pass) -> Self {
        let is_depth = |(output, _): &&(Spanned<String>, Spanned<String>)| output.value == DEPTH;
        let depth = pass.writes.iter().find(is_depth);
        Self {
            outputs: pass
                .writes
                .iter()
                .filter(|w| !is_depth(w))
                .cloned()
                .collect(),
            depth: depth.map(|(_, texture)| texture.clone()),
        }
    }
}

/// The texture that says what another one shows.
fn twin(texture: &Spanned<String>) -> Spanned<String> {
    Spanned {
        value: format!("{}{SHOWN}", texture.value),
        place: texture.place.clone(),
    }
}
