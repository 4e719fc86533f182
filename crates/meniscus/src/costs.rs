//! What frames take beside time: memory, uploads, preparation.

use meniscus_gpu::{Counters as Counted, Preprocessing, SceneBuffers};
use meniscus_measure::Counters;
use meniscus_pipeline::{Geometry, PassKind, Plan};
use serde_json::{Map, Value, json};

/// What was made of a scene before the first frame, and its bytes, for the results.
pub(crate) fn of_scene(scene: &SceneBuffers) -> Map<String, Value> {
    let mut preprocessing = Map::new();
    for made in scene.preprocessing() {
        preprocessing.insert(format!("{}_ms", made.name), json!(made.ms));
        preprocessing.insert(format!("{}_bytes", made.name), json!(made.bytes));
    }
    let mut more = Map::new();
    more.insert("preprocessing".to_owned(), Value::Object(preprocessing));
    more.insert("scene_bytes".to_owned(), json!(scene.bytes()));
    more
}

/// Whether a plan uses what was made of a scene.
fn uses(plan: &Plan, made: &Preprocessing) -> bool {
    let reads = |wanted: &dyn Fn(&str) -> bool| {
        let bindings = plan.passes.iter().flat_map(|pass| &pass.shader.bindings);
        bindings.into_iter().any(|b| wanted(&b.resource))
    };
    match made.name {
        "bvh" => reads(&|array| array == "triangles" || array.starts_with("bvh")),
        "distance_field" => reads(&|array| array.starts_with("distance_")),
        "far_side" => {
            let far = PassKind::Draw(Geometry::FarSide);
            plan.passes.iter().any(|pass| pass.kind == far)
        }
        _ => true,
    }
}

/// What a pipeline uses of a scene: bytes, and milliseconds that making it took.
pub(crate) fn of_plan(plan: &Plan, scene: &SceneBuffers) -> (u64, f64) {
    let mut bytes = scene.bytes();
    let mut ms = 0.0;
    for made in scene.preprocessing() {
        match uses(plan, &made) {
            true => ms += made.ms,
            false => bytes = bytes.saturating_sub(made.bytes),
        }
    }
    (bytes, ms)
}

/// Counters for the results. `scene_bytes`: see [`of_plan`].
pub(crate) fn counters(counted: &Counted, scene_bytes: u64) -> Counters {
    let passes = counted.passes.iter().map(|pass| {
        json!({
            "name": pass.name,
            "triangles": pass.triangles,
            "vertex_invocations": pass.vertex_invocations,
            "fragment_invocations": pass.fragment_invocations,
            "compute_invocations": pass.compute_invocations,
        })
    });
    let mut more = Map::new();
    for (name, value) in [
        ("dispatches", json!(counted.dispatches)),
        ("compute_invocations", json!(counted.compute_invocations)),
        ("texture_bytes", json!(counted.texture_bytes)),
        ("buffer_bytes", json!(counted.buffer_bytes)),
        ("scene_bytes", json!(scene_bytes)),
        ("uploaded_bytes", json!(counted.uploaded_bytes)),
        ("passes", Value::Array(passes.collect())),
    ] {
        more.insert(name.to_owned(), value);
    }
    Counters {
        triangles: Some(counted.triangles),
        vertex_invocations: counted.vertex_invocations,
        fragment_invocations: counted.fragment_invocations,
        draws: Some(counted.draws),
        more,
    }
}
