//! A frame whose plan is known takes no memory to decide on.

mod common;

use common::{composer, load, scene};
use glam::UVec2;
use meniscus_pipeline::{Outlook, PlanCache, Pruning, SceneBounds};

#[test]
fn known_plans_are_found_without_memory_and_are_the_same() {
    let (composer, mut scene) = (composer(&[]), scene());
    let pipeline = load(common::PIPELINE).unwrap();
    let bounds = SceneBounds::new(&scene);
    let mut cache = PlanCache::new(pipeline, Pruning::default(), false);
    assert!(cache.is_empty());
    let mut frames = |cache: &mut PlanCache| {
        let mut passes = 0;
        for frame in 0..64 {
            scene.camera.target.z = f64::from(frame) * 0.2 - 6.0;
            let outlook = Outlook::new(&scene, &bounds, UVec2::new(64, 36));
            let plan = cache.plan(&composer, outlook.facts).unwrap();
            passes += plan.passes.len();
        }
        passes
    };
    let mut first = 0;
    let made = allocation_counter::measure(|| first = frames(&mut cache));
    let plans = cache.len();
    assert!(plans > 1 && made.count_total > 0, "{plans} plans, {made:?}");
    let mut second = 0;
    let again = allocation_counter::measure(|| second = frames(&mut cache));
    assert_eq!((second, cache.len()), (first, plans));
    assert_eq!(again.count_total, 0, "{again:?}");
}
