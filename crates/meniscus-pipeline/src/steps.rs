//! From steps as they are written to passes in a row.

use std::collections::BTreeMap;

use meniscus_source::ron::{Entries, Spanned};
use meniscus_source::{Diagnostic, Report};

use crate::file::{self, ComputeFile, DrawFile, RepeatFile, ScreenFile, Step, Value};
use crate::pipeline::{Pass, PassOver, Pipeline};
use crate::shortcut::Shortcut;

/// The most passes of a pipeline, repetitions counted.
const MAX_PASSES: usize = 1024;

/// Steps being unrolled into passes.
#[derive(Debug, Default)]
pub(crate) struct Steps {
    /// Those that were there before are not touched.
    passes: Vec<Pass>,
    shortcuts: Vec<Shortcut>,
    /// The shortcut whose steps are being added.
    within: Option<String>,
    report: Report,
}

/// What all kinds of passes are written with.
struct Common {
    name: Spanned<String>,
    like: Vec<Spanned<String>>,
    over: PassOver,
    skeleton: Spanned<String>,
    when: Option<Spanned<String>>,
    slots: Entries<Spanned<Value>>,
    reads: Entries<Spanned<String>>,
    writes: Entries<Spanned<String>>,
}

impl Steps {
    /// Steps that come to the passes of a pipeline.
    pub fn behind(pipeline: &Pipeline) -> Self {
        Self {
            passes: pipeline.passes.clone(),
            ..Self::default()
        }
    }

    /// Unrolls steps; passes of a repetition are numbered from 1.
    pub fn add(&mut self, steps: Vec<Step>, suffix: &str) {
        for step in steps {
            if self.passes.len() >= MAX_PASSES {
                let name = match &step {
                    Step::Draw(draw) => &draw.name,
                    Step::Screen(screen) => &screen.name,
                    Step::Compute(compute) => &compute.name,
                    Step::Shortcut(shortcut) => &shortcut.name,
                    Step::Repeat(_) => &Spanned::unplaced(String::new()),
                };
                self.report.add(placed(too_many(), name, "one too many"));
                return;
            }
            match step {
                Step::Draw(draw) => {
                    if let Some(common) = self.draw(draw) {
                        self.pass(common, suffix);
                    }
                }
                Step::Screen(screen) => self.pass(screen.into(), suffix),
                Step::Compute(compute) => self.pass(compute.into(), suffix),
                Step::Repeat(repeat) => self.repeat(repeat, suffix),
                Step::Shortcut(shortcut) => {
                    let (mut shortcut, steps) = Shortcut::new(shortcut);
                    shortcut.name.value.push_str(suffix);
                    if self.within.is_some() {
                        let nested = Diagnostic::error("a shortcut holds no other");
                        self.report
                            .add(placed(nested, &shortcut.name, "within another"));
                        continue;
                    }
                    self.within = Some(shortcut.name.value.clone());
                    self.shortcuts.push(shortcut);
                    self.add(steps, suffix);
                    self.within = None;
                }
            }
        }
    }

    /// Puts what was added into a pipeline: behind its pass of this index, or at its end.
    pub fn end(mut self, pipeline: &mut Pipeline, behind: Option<usize>, report: &mut Report) {
        let added = self
            .passes
            .split_off(pipeline.passes.len().min(self.passes.len()));
        let at = behind.map_or(pipeline.passes.len(), |index| index + 1);
        pipeline.passes.splice(at..at, added);
        for shortcut in &self.shortcuts {
            shortcut.check(pipeline, &mut self.report);
        }
        for shortcut in self.shortcuts {
            let name = shortcut.name.clone();
            if let Some(first) = pipeline.shortcuts.insert(name.value.clone(), shortcut) {
                let twice = Diagnostic::error(format!("two shortcuts are called `{}`", name.value));
                let twice = placed(twice, &name, "the second");
                self.report.add(match &first.name.place {
                    Some(place) => twice.see(place, "the first"),
                    None => twice,
                });
            }
        }
        report.extend(self.report);
    }

    fn repeat(&mut self, repeat: RepeatFile, suffix: &str) {
        let times = repeat.times.value as usize;
        let all = times
            .saturating_mul(count(&repeat.sequence))
            .saturating_add(self.passes.len());
        if times == 0 || all > MAX_PASSES {
            let wrong = too_many();
            self.report.add(match &repeat.times.place {
                Some(place) => wrong.at(place, "so many times"),
                None => wrong,
            });
            return;
        }
        for time in 1..=times {
            self.add(repeat.sequence.clone(), &format!("{suffix}.{time}"));
        }
    }

    /// A draw with the skeleton and geometry of the pass that it is like.
    fn draw(&mut self, draw: DrawFile) -> Option<Common> {
        let like = draw.like.first();
        let model = like.and_then(|like| self.passes.iter().find(|p| p.name.value == like.value));
        if let (Some(like), None) = (like, model) {
            let unknown = Diagnostic::error(format!("there is no pass `{}`", like.value));
            let names = self.passes.iter().map(|p| p.name.value.as_str());
            let unknown = placed(unknown, like, "no pass before this one");
            self.report.add(unknown.with_suggestion(&like.value, names));
            return None;
        }
        let geometry = draw.geometry.or_else(|| match &model?.over {
            PassOver::Draw(geometry) => Some(*geometry),
            _ => None,
        });
        let skeleton = draw.skeleton.or_else(|| Some(model?.skeleton.clone()));
        let missing = match (&skeleton, &geometry) {
            (None, _) => "skeleton",
            (_, None) => "geometry",
            _ => "",
        };
        let (Some(skeleton), Some(geometry)) = (skeleton, geometry) else {
            let what = format!("the draw `{}` has no `{missing}`", draw.name.value);
            let wrong = placed(Diagnostic::error(what), &draw.name, "in this pass");
            self.report
                .add(wrong.with_help("say it, or name a draw that it is `like`"));
            return None;
        };
        Some(Common {
            name: draw.name,
            like: draw.like,
            over: PassOver::Draw(geometry),
            skeleton,
            when: draw.when,
            slots: draw.slots,
            reads: draw.reads,
            writes: draw.writes,
        })
    }

    fn pass(&mut self, common: Common, suffix: &str) {
        let mut name = common.name;
        name.value.push_str(suffix);
        if let Some(first) = self.passes.iter().find(|p| p.name.value == name.value) {
            let mut twice = Diagnostic::error(format!("two passes are called `{}`", name.value));
            if let (Some(second), Some(first)) = (&name.place, &first.name.place) {
                twice = twice
                    .at(second, "the second")
                    .see(first, "the first")
                    .with_help("give it another name");
            }
            self.report.add(twice);
        }
        let mut slots = BTreeMap::new();
        let mut numbers = BTreeMap::new();
        for (slot, value) in common.slots.iter() {
            if let Value::Number(number) = value.value {
                let place = value.place.clone();
                let value = number;
                numbers.insert(slot.value.clone(), Spanned { value, place });
                continue;
            }
            match file::filling(slot, value) {
                Ok(filling) => drop(slots.insert(slot.value.clone(), filling)),
                Err(wrong) => self.report.add(wrong),
            }
        }
        self.passes.push(Pass {
            name,
            shortcut: self.within.clone(),
            like: common.like,
            over: common.over,
            skeleton: common.skeleton,
            when: common.when,
            slots,
            numbers,
            reads: file::connections(&common.reads),
            writes: common.writes.0,
        });
    }
}

impl From<ScreenFile> for Common {
    fn from(screen: ScreenFile) -> Self {
        Self {
            name: screen.name,
            like: Vec::new(),
            over: PassOver::Screen(screen.over, screen.runs),
            skeleton: screen.skeleton,
            when: screen.when,
            slots: screen.slots,
            reads: screen.reads,
            writes: screen.writes,
        }
    }
}

impl From<ComputeFile> for Common {
    fn from(compute: ComputeFile) -> Self {
        Self {
            name: compute.name,
            like: Vec::new(),
            over: PassOver::Compute(compute.dispatch),
            skeleton: compute.skeleton,
            when: compute.when,
            slots: compute.slots,
            reads: compute.reads,
            writes: Entries::default(),
        }
    }
}

/// How many passes steps come to.
fn count(steps: &[Step]) -> usize {
    let one = |step: &Step| match step {
        // An empty repetition costs time, too.
        Step::Repeat(repeat) => (repeat.times.value as usize)
            .saturating_mul(count(&repeat.sequence))
            .max(1),
        Step::Shortcut(shortcut) => count(&shortcut.sequence),
        _ => 1,
    };
    steps.iter().map(one).fold(0, usize::saturating_add).max(1)
}

fn too_many() -> Diagnostic {
    Diagnostic::error(format!(
        "a pipeline has 1 to {MAX_PASSES} passes, repetitions counted"
    ))
}

fn placed(diagnostic: Diagnostic, at: &Spanned<String>, words: &str) -> Diagnostic {
    match &at.place {
        Some(place) => diagnostic.at(place, words),
        None => diagnostic,
    }
}
