//! What frames take beside time: memory, uploads, preparation.

use meniscus_gpu::{Counters as Counted, Moved, Preprocessing, SceneBuffers, field_voxels};
use meniscus_measure::{Counters, median};
use meniscus_pipeline::{Geometry, PassKind, Plan};
use serde_json::{Map, Value, json};

/// What was made of a scene before the first frame, and its bytes, for the results.
pub(crate) fn of_scene(scene: &SceneBuffers) -> Map<String, Value> {
    let mut preprocessing = Map::new();
    // Of some there are several, with other numbers of voxels: together they are what was made.
    let all = scene.preprocessing();
    for name in all.iter().map(|made| made.name) {
        let same = || all.iter().filter(|made| made.name == name);
        let ms: f64 = same().map(|made| made.ms).sum();
        let bytes: u64 = same().map(|made| made.bytes).sum();
        preprocessing.insert(format!("{name}_ms"), json!(ms));
        preprocessing.insert(format!("{name}_bytes"), json!(bytes));
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
        "distance_field" => {
            let mut passes = plan.passes.iter();
            passes.any(|pass| {
                let mut bindings = pass.shader.bindings.iter();
                let field = bindings.any(|b| b.resource.starts_with("distance_"));
                field && made.voxels == Some(field_voxels(pass))
            })
        }
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

/// What it takes to follow what moves, for the results: medians; none where nothing does.
pub(crate) fn of_updates(updates: &[Moved]) -> Option<Value> {
    let last = updates.last().filter(|last| last.objects > 0)?;
    let ms = |of: fn(&Moved) -> f64| median(&updates.iter().map(of).collect::<Vec<_>>());
    Some(json!({
        "objects": last.objects,
        "bytes": last.bytes,
        "ms": ms(|moved| moved.ms),
        "tree_ms": ms(|moved| moved.tree_ms),
    }))
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
