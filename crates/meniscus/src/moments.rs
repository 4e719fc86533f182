//! The moments of a scene that an ablation runs at.

use meniscus_measure::{Errors, Results, Row, aligned};
use meniscus_pipeline::{Facts, KNOWN_FACTS};
use meniscus_scene::Scene;
use meniscus_source::{Diagnostic, Report};
use serde_json::{Value, json};

use crate::facts::facts_of;

/// A scene whose water moves, and whose objects may.
pub(crate) struct Moments {
    scene: Scene,
    times: Vec<f64>,
}

impl Moments {
    /// A scene at these times, seconds; at its own where none is given.
    ///
    /// # Errors
    /// When a time is not finite, or not the same facts hold at all of them: the plans would differ.
    pub fn new(
        scene: &Scene,
        times: &[f64],
        facts: &Facts,
        size: [u32; 2],
    ) -> Result<Self, Report> {
        let mut moments = Self {
            scene: scene.clone(),
            times: times.to_vec(),
        };
        if moments.times.is_empty() {
            moments.times.push(scene.water.time);
        }
        for index in 0..moments.times.len() {
            let time = moments.times[index];
            if !time.is_finite() {
                return Err(Diagnostic::error(format!("{time} s is no moment")).into());
            }
            if let Some(lost) = scene.lost_at(time) {
                let name = scene.objects.get(lost as usize).map_or("", |o| &o.name);
                let message = format!("at {time} s `{name}` is more than 1000 km away");
                let help =
                    "choose moments nearer to 0 s, at which objects stand where they are placed";
                return Err(Diagnostic::error(message).with_help(help).into());
            }
            let there = facts_of(moments.at(index), size);
            if there != *facts {
                let message = format!(
                    "at {time} s other facts hold of the scene than at {} s: {} against {}",
                    scene.water.time,
                    listed(&there),
                    listed(facts)
                );
                let help =
                    "moments of one run share their passes; run these apart, with --set water.time";
                return Err(Diagnostic::error(message).with_help(help).into());
            }
        }
        Ok(moments)
    }

    /// Whether there is more than one.
    pub fn are_several(&self) -> bool {
        self.times.len() > 1
    }

    /// The times, seconds; at least one.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The scene at the moment of an index, counted round and round.
    pub fn at(&mut self, index: usize) -> &Scene {
        self.scene.set_time(self.times[index % self.times.len()]);
        &self.scene
    }

    /// The scene at a moment that is none of these.
    pub fn elsewhere(&mut self) -> &Scene {
        self.scene.set_time(self.times[0] + ELSEWHERE);
        &self.scene
    }
}

/// Seconds from the first moment to one that is none: neither waves nor what turns or heaves are
/// likely to be back by then.
const ELSEWHERE: f64 = 1.037;

fn listed(facts: &Facts) -> String {
    let known = KNOWN_FACTS.iter().map(|(name, _)| *name);
    let names: Vec<&str> = known.filter(|name| facts.has(name)).collect();
    match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    }
}

/// What a row says of its moments: the errors at each, and the worst of each figure.
pub(crate) fn note(row: &mut Row, times: &[f64], errors: &[Option<Errors>]) {
    let moment = |(time, error): (&f64, &Option<Errors>)| json!({ "time": time, "error": error });
    let moments: Vec<Value> = times.iter().zip(errors).map(moment).collect();
    row.more.insert("moments".into(), json!(moments));
    let known: Vec<Errors> = errors.iter().flatten().cloned().collect();
    row.error = Errors::mean(&known);
    row.more
        .insert("worst".into(), json!(Errors::worst(&known)));
}

/// Headings of [`table`].
pub const HEADINGS: [&str; 8] = [
    "pipeline",
    "worst: px mean",
    "at",
    "px p99",
    "≤ ½ px",
    "wrong",
    "RMSE",
    "FLIP",
];

/// The worst figures over the moments, for people; none where there was one moment.
pub fn table(results: &Results) -> Vec<Vec<String>> {
    let line = |row: &Row| {
        let worst: Errors = serde_json::from_value(row.more.get("worst")?.clone()).ok()?;
        let mean = |moment: &Value| {
            moment
                .pointer("/error/position_px/mean")
                .and_then(Value::as_f64)
        };
        let moments = row.more.get("moments").and_then(Value::as_array)?;
        let at = moments
            .iter()
            .find(|m| mean(m) == Some(worst.position_px.mean));
        let at = at.and_then(|moment| moment["time"].as_f64());
        Some(vec![
            row.pipeline.clone(),
            format!("{:.4}", worst.position_px.mean),
            at.map_or("–".to_owned(), |time| format!("{time} s")),
            format!("{:.3}", worst.position_px.p99),
            format!("{:.3} %", 100.0 * worst.within_half_px),
            format!("{:.3} %", 100.0 * worst.wrong_object),
            format!("{:.4}", worst.rmse),
            worst
                .flip
                .map_or("–".to_owned(), |flip| format!("{flip:.4}")),
        ])
    };
    results.rows.iter().filter_map(line).collect()
}

/// The same as text; nothing where there was one moment.
pub fn moments_text(results: &Results) -> String {
    let rows = table(results);
    match rows.is_empty() {
        true => String::new(),
        false => format!(
            "\nThe worst of each figure over the moments; above, the means over them:\n{}",
            aligned(&HEADINGS, &rows)
        ),
    }
}
