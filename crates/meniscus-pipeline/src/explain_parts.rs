//! The parts of an explanation, from a plan and from the one in which nothing is left out.

use std::collections::{BTreeMap, BTreeSet};

use meniscus_shader::{Composer, Filling};

use crate::explain::{
    DroppedSaid, FactSaid, ModuleSaid, ObjectsSaid, PassSaid, ResourceSaid, ShortcutSaid, Total,
    Work,
};
use crate::facts::{Facts, KNOWN};
use crate::file::{Dispatch, Over, Runs};
use crate::outlook::{Counted, Outlook};
use crate::pipeline::{Pass, PassOver, Pipeline};
use crate::plan::{Geometry, Plan, Size, Texture};
use crate::planner::Decisions;
use crate::rules::{Promise, Rule};

pub(crate) fn facts_said(facts: &Facts, outlook: &Outlook) -> Vec<FactSaid> {
    let numbers = |name: &str| match (name, outlook.water) {
        ("waves", _) if facts.has(name) => format!("slopes up to {:.3}", outlook.slope_bound),
        ("displaced", _) if facts.has(name) => format!("heights up to ±{:.3} m", outlook.reach),
        ("water_visible", Some(water)) => {
            let (low, high) = (water.low, water.high);
            let share = 100 * water.pixels() / pixels(outlook).max(1);
            format!(
                "columns {} to {}, rows {} to {}: {share} % of the frame",
                low.x, high.x, low.y, high.y
            )
        }
        _ => String::new(),
    };
    let said = KNOWN.iter().map(|&(name, says)| FactSaid {
        name,
        holds: facts.has(name),
        says,
        numbers: numbers(name),
    });
    said.collect()
}

fn pixels(outlook: &Outlook) -> u64 {
    u64::from(outlook.size.x) * u64::from(outlook.size.y)
}

/// What an explanation is made of.
pub(crate) struct Said<'p> {
    pub pipeline: &'p Pipeline,
    pub composer: &'p Composer,
    pub outlook: &'p Outlook,
    pub plan: &'p Plan,
    pub whole: &'p Plan,
    pub decisions: &'p Decisions,
}

impl Said<'_> {
    fn runs(&self, pass: &str) -> bool {
        self.plan.passes.iter().any(|planned| planned.name == pass)
    }

    /// Passes that run or were left out; those of shortcuts that are not taken are neither.
    fn known(&self) -> impl Iterator<Item = &Pass> {
        let waits = |pass: &&Pass| {
            let shortcut = pass.shortcut.as_ref();
            shortcut.is_none_or(|name| !self.decisions.not_taken.contains_key(name))
        };
        self.pipeline.passes.iter().filter(waits)
    }

    pub fn passes(&self) -> Vec<PassSaid> {
        let said = |pass: &Pass| {
            let name = &pass.name.value;
            let resolved = self.pipeline.resolved(pass, self.composer.library());
            let mut slots = BTreeMap::new();
            if let Ok(resolved) = &resolved {
                fillings(&resolved.slots, "", &mut slots);
            }
            let dropped = self.decisions.dropped.iter().find(|d| d.pass == *name);
            PassSaid {
                name: name.clone(),
                kept: dropped.is_none(),
                over: over(pass),
                skeleton: pass.skeleton.value.clone(),
                slots,
                dropped: dropped.map(|d| dropped_said(d.rule, &d.because, d.within_px)),
                work: self.work(pass),
                clusters: None,
            }
        };
        self.known().map(said).collect()
    }

    fn work(&self, pass: &Pass) -> Work {
        let Outlook {
            near,
            far,
            straddling,
            ..
        } = self.outlook;
        let all = pixels(self.outlook);
        let wet = self.outlook.water.map_or(0, |water| water.pixels());
        let drawn = |triangles: u64| Work {
            draws: 1,
            triangles,
            ..Work::default()
        };
        match &pass.over {
            PassOver::Draw(Geometry::NearSide) => drawn(near.triangles + straddling.triangles),
            PassOver::Draw(Geometry::FarSide) => drawn(far.triangles + straddling.triangles),
            PassOver::Draw(Geometry::All) => {
                drawn(near.triangles + far.triangles + straddling.triangles)
            }
            PassOver::Screen(over, runs) => {
                let by_threads = matches!(over, Over::List { .. }) || *runs == Runs::Compute;
                Work {
                    draws: u64::from(!by_threads),
                    dispatches: u64::from(by_threads),
                    triangles: 0,
                    pixels: match over {
                        Over::All => Some(all),
                        Over::Water => Some(wet),
                        Over::Dry => Some(all - wet),
                        Over::List { .. } => None,
                    },
                }
            }
            PassOver::Compute(dispatch) => Work {
                dispatches: 1,
                pixels: matches!(dispatch, Dispatch::Pixels(_)).then_some(all),
                ..Work::default()
            },
        }
    }

    pub fn shortcuts(&self) -> Vec<ShortcutSaid> {
        let said = |(name, shortcut): (&String, &crate::Shortcut)| {
            let why_not = self.decisions.not_taken.get(name);
            let why = self.decisions.dropped.iter().find(|dropped| {
                dropped.rule == Rule::Shortcut
                    && shortcut.instead_of.iter().any(|p| p.value == dropped.pass)
            });
            let own = self.pipeline.passes.iter();
            let own = own.filter(|pass| pass.shortcut.as_ref() == Some(name));
            ShortcutSaid {
                name: name.clone(),
                taken: why_not.is_none(),
                because: why_not
                    .cloned()
                    .or_else(|| why.map(|dropped| dropped.because.clone()))
                    .unwrap_or_default(),
                instead_of: shortcut
                    .instead_of
                    .iter()
                    .map(|p| p.value.clone())
                    .collect(),
                passes: own.map(|pass| pass.name.value.clone()).collect(),
            }
        };
        self.pipeline.shortcuts.iter().map(said).collect()
    }

    pub fn modules(&self) -> Vec<ModuleSaid> {
        let mut passes: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
        for pass in self.known() {
            let name = pass.name.value.as_str();
            let mut filled = BTreeMap::new();
            if let Ok(resolved) = self.pipeline.resolved(pass, self.composer.library()) {
                fillings(&resolved.slots, "", &mut filled);
            }
            filled.insert(String::new(), pass.skeleton.value.clone());
            for path in filled.into_values() {
                passes.entry(path).or_default().insert(name);
            }
        }
        let said = passes.into_iter().map(|(path, passes)| ModuleSaid {
            kept: passes.iter().any(|pass| self.runs(pass)),
            path,
            passes: passes.into_iter().map(str::to_owned).collect(),
        });
        said.collect()
    }

    fn bytes(&self, texture: Texture) -> u64 {
        texture.format.bytes() * pixels(self.outlook)
    }

    pub fn resources(&self) -> Vec<ResourceSaid> {
        let unused = |kept: bool| {
            let because = "no pass that runs uses it";
            (!kept).then(|| dropped_said(Rule::Unused, because, 0.0))
        };
        let mut said = Vec::new();
        for (name, texture) in &self.pipeline.textures {
            let kept = self.plan.textures.contains_key(name);
            said.push(ResourceSaid {
                name: name.clone(),
                kept,
                what: texture.value.to_string(),
                bytes: self.bytes(texture.value),
                guarded_texel: texel_if_guarded(texture.value),
                dropped: unused(kept),
            });
        }
        // Draws without a depth texture have one of their own.
        let declared = &self.pipeline.textures;
        let own: BTreeMap<_, _> = self
            .whole
            .textures
            .iter()
            .chain(&self.plan.textures)
            .collect();
        for (name, texture) in own
            .into_iter()
            .filter(|(name, _)| !declared.contains_key(*name))
        {
            let kept = self.plan.textures.contains_key(name);
            said.push(ResourceSaid {
                name: name.clone(),
                kept,
                what: texture.to_string(),
                bytes: self.bytes(*texture),
                guarded_texel: texel_if_guarded(*texture),
                dropped: unused(kept),
            });
        }
        for (name, buffer) in &self.pipeline.buffers {
            let kept = self.plan.buffers.contains_key(name);
            said.push(ResourceSaid {
                name: name.clone(),
                kept,
                what: buffer.value.to_string(),
                bytes: buffer.value.bytes + buffer.value.bytes_per_pixel * pixels(self.outlook),
                guarded_texel: 0,
                dropped: unused(kept),
            });
        }
        said
    }

    pub fn objects(&self) -> Vec<ObjectsSaid> {
        let Outlook {
            near,
            far,
            straddling,
            ..
        } = *self.outlook;
        let (n, f, all) = (Geometry::NearSide, Geometry::FarSide, Geometry::All);
        let said = |side, counted: Counted, drawn: &[Geometry]| {
            let draws = |pass: &&Pass| match &pass.over {
                PassOver::Draw(geometry) => drawn.contains(geometry),
                _ => false,
            };
            let whole = |pass: &&Pass| {
                let name = &pass.name.value;
                self.whole
                    .passes
                    .iter()
                    .any(|planned| planned.name == *name)
            };
            let name = |pass: &Pass| pass.name.value.clone();
            let runs = |pass: &&Pass| self.runs(&pass.name.value);
            let drawing = || self.pipeline.passes.iter().filter(draws);
            ObjectsSaid {
                side,
                objects: counted.objects,
                triangles: counted.triangles,
                drawn_by: drawing().filter(runs).map(name).collect(),
                not_by: drawing()
                    .filter(|pass| whole(pass) && !runs(pass))
                    .map(name)
                    .collect(),
            }
        };
        vec![
            said("on the camera's side", near, &[n, all]),
            said("on the other side", far, &[f, all]),
            said("across the water", straddling, &[n, f, all]),
        ]
    }

    pub fn total(&self, plan: &Plan) -> Total {
        let passes = self.pipeline.passes.iter();
        let planned = |pass: &&Pass| plan.passes.iter().any(|p| p.name == pass.name.value);
        let work: Vec<Work> = passes.filter(planned).map(|pass| self.work(pass)).collect();
        let textures: u64 = plan.textures.values().map(|t| self.bytes(*t)).sum();
        let buffers = plan.buffers.values();
        let buffers: u64 = buffers
            .map(|b| b.bytes + b.bytes_per_pixel * pixels(self.outlook))
            .sum();
        Total {
            passes: plan.passes.len() as u64,
            draws: work.iter().map(|w| w.draws).sum(),
            dispatches: work.iter().map(|w| w.dispatches).sum(),
            triangles: work.iter().map(|w| w.triangles).sum(),
            bytes: textures + buffers,
        }
    }
}

fn texel_if_guarded(texture: Texture) -> u64 {
    match texture.size {
        Size::Frame => 0,
        Size::Guarded => texture.format.bytes(),
    }
}

fn dropped_said(rule: Rule, because: &str, within_px: f64) -> DroppedSaid {
    DroppedSaid {
        rule: rule.name(),
        says: rule.says(),
        because: because.to_owned(),
        promise: match rule.promise(within_px) {
            Promise::Choice => "choice",
            Promise::Exact => "exact",
            Promise::Within(_) => "within",
        },
        within_px,
    }
}

fn fillings(slots: &BTreeMap<String, Filling>, above: &str, found: &mut BTreeMap<String, String>) {
    for (slot, filling) in slots {
        let path = match above {
            "" => slot.clone(),
            _ => format!("{above}.{slot}"),
        };
        fillings(&filling.slots, &path, found);
        found.insert(path, filling.module.value.clone());
    }
}

fn over(pass: &Pass) -> String {
    match &pass.over {
        PassOver::Draw(Geometry::NearSide) => "the camera's side".into(),
        PassOver::Draw(Geometry::FarSide) => "the other side".into(),
        PassOver::Draw(Geometry::All) => "all triangles".into(),
        PassOver::Screen(Over::All, _) => "every pixel".into(),
        PassOver::Screen(Over::Water, _) => "pixels that may show water".into(),
        PassOver::Screen(Over::Dry, _) => "pixels that cannot show water".into(),
        PassOver::Screen(Over::List { pixels, .. }, _) => format!("the list `{}`", pixels.value),
        PassOver::Compute(Dispatch::Pixels(Size::Frame)) => "a thread a pixel".into(),
        PassOver::Compute(Dispatch::Pixels(Size::Guarded)) => "a thread a guarded pixel".into(),
        PassOver::Compute(Dispatch::Fixed(x, y, z)) => format!("{x} × {y} × {z} workgroups"),
        PassOver::Compute(Dispatch::Indirect(by)) => format!("as much as `{}` says", by.value),
    }
}
