//! The row of a pipeline in the results: times, counts and errors.

use std::time::{Duration, Instant};

use meniscus_gpu::{self as gpu, FrameTiming};
use meniscus_measure::{
    PassMs, Relative, Row, Timer, Timing, Verdict, median, relative_time, timing_warnings,
};
use serde_json::{Map, Value, json};

use crate::ablation::{Ablation, AblationError, RowOutcome};
use crate::costs;
use crate::moments::{self, Moments};
use crate::subject::{Stage, Subject};

/// How often a frame is brought to another moment and back, to see what that takes …
const UPDATES: usize = 3;
/// … unless it takes very long.
const PATIENCE: Duration = Duration::from_secs(1);

impl Ablation {
    /// The row of a subject, of which this was found at each moment. `timed`: the subject's index
    /// among the timings of all.
    pub(crate) fn row(
        &self,
        subject: &mut Subject,
        (timed, timings): (usize, &Timings),
        outcomes: &[RowOutcome],
        stage: &Stage,
        moments: &mut Moments,
    ) -> Result<Row, AblationError> {
        let own = timings.of(timed)?;
        let warnings = timing_warnings(&own);
        let relative = self.relative(&own, timings)?;
        // Back and forth, so that the last upload is of water and objects that have moved.
        let (mut updates, start) = (Vec::new(), Instant::now());
        while updates.len() < 2 * UPDATES && (updates.is_empty() || start.elapsed() < PATIENCE) {
            subject.frame.update(moments.elsewhere())?;
            updates.push(*subject.frame.moved());
            subject.frame.update(moments.at(0))?;
            updates.push(*subject.frame.moved());
        }
        let counted = subject.frame.counters()?;
        let plan = subject.frame.plan();
        let (scene_bytes, preprocessing_ms) = costs::of_plan(plan, &stage.scene);
        let mut counters = costs::counters(&counted, scene_bytes);
        let mut more = Map::new();
        if let Some(first) = outcomes.first().filter(|first| !first.lists.is_empty()) {
            for (name, list) in &first.lists {
                let listed = list.iter().filter(|listed| **listed).count();
                counters.more.insert(name.clone(), json!(listed));
            }
            more.insert("lists".into(), json!(list_errors(outcomes)));
        }
        if let Some(update) = costs::of_updates(&updates) {
            more.insert("update".into(), update);
        }
        if !warnings.is_empty() {
            let told = warnings.iter().map(ToString::to_string);
            more.insert("warnings".into(), json!(told.collect::<Vec<_>>()));
        }
        let hashes = plan.passes.iter();
        let hashes = hashes.map(|pass| (pass.name.clone(), json!(pass.shader.hash)));
        more.insert("shaders".into(), Value::Object(hashes.collect()));
        let not_finite: usize = outcomes.iter().map(RowOutcome::not_finite).sum();
        more.insert("within_px".into(), json!(plan.within_px));
        more.insert("not_finite_pixels".into(), json!(not_finite));
        more.insert("preprocessing_ms".into(), json!(preprocessing_ms));
        let errors: Vec<_> = outcomes
            .iter()
            .map(|o| o.judgement.errors.clone())
            .collect();
        let mut row = Row {
            pipeline: subject.name.clone(),
            timer: match timings.clock {
                gpu::Timer::Gpu => Timer::Gpu,
                gpu::Timer::Wall => Timer::Wall,
            },
            frame_ms: own.frame_ms(),
            relative,
            passes: timings.passes(timed, subject),
            counters,
            error: errors.first().cloned().flatten(),
            more,
        };
        if moments.are_several() {
            moments::note(&mut row, moments.times(), &errors);
        }
        Ok(row)
    }

    fn relative(&self, own: &Timing, timings: &Timings) -> Result<Option<Relative>, AblationError> {
        let Some(baseline) = self.baseline else {
            return Ok(None);
        };
        let name = &self.pipelines[baseline].name;
        Ok(Some(relative_time(own, &timings.of(baseline)?, name)?))
    }
}

/// Frame times of all subjects in order, by one clock, or their ratios would compare clocks.
pub(crate) struct Timings {
    clock: gpu::Timer,
    frames: Vec<Vec<FrameTiming>>,
}

impl Timings {
    pub fn new(frames: Vec<Vec<FrameTiming>>) -> Self {
        let every: Vec<FrameTiming> = frames.iter().flatten().cloned().collect();
        Self {
            clock: gpu::Timer::of(&every),
            frames,
        }
    }

    fn of(&self, index: usize) -> Result<Timing, AblationError> {
        let frames = self.frames[index].iter();
        Ok(Timing::new(frames.map(|f| f.ms(self.clock)).collect())?)
    }

    /// The median of each pass that was timed.
    fn passes(&self, index: usize, subject: &Subject) -> Vec<PassMs> {
        let frames = &self.frames[index];
        let passes = subject.frame.plan().passes.iter().enumerate();
        let timed = passes.filter_map(|(pass, planned)| {
            let ms = frames.iter().filter_map(|f| f.passes.get(pass)?.ms);
            Some(PassMs {
                name: planned.name.clone(),
                ms: median(&ms.collect::<Vec<_>>())?,
            })
        });
        timed.collect()
    }
}

/// Of every list, over all moments: the share of the judged pixels that it holds, and of those that
/// it does not hold, the share with errors beyond half a pixel and with wrong objects. That tells how
/// far the estimate can be trusted by which the list was made.
fn list_errors(outcomes: &[RowOutcome]) -> Map<String, Value> {
    let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
    let mut found = Map::new();
    let names = outcomes.first().into_iter().flat_map(|o| o.lists.keys());
    for name in names {
        let [mut judged, mut listed, mut far, mut wrong] = [0usize; 4];
        let lists = outcomes
            .iter()
            .filter_map(|o| Some((o, o.lists.get(name)?)));
        let pixels = lists.flat_map(|(o, list)| o.judgement.verdicts.iter().zip(list));
        for (verdict, is_listed) in pixels {
            let Verdict::Error {
                px, wrong_object, ..
            } = verdict
            else {
                continue;
            };
            judged += 1;
            listed += usize::from(*is_listed);
            far += usize::from(!is_listed && *px > 0.5);
            wrong += usize::from(!is_listed && *wrong_object);
        }
        let figures = json!({
            "listed": share(listed, judged),
            "unlisted_beyond_half_px": share(far, judged),
            "unlisted_wrong_object": share(wrong, judged),
        });
        found.insert(name.clone(), figures);
    }
    found
}
