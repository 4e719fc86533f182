//! More waves than a uniform block holds are read from storage, and shape the water alike.

use meniscus::gpu::Gpu;
use meniscus::pipeline::host::BLOCK_WAVES;
use meniscus::scene::{Setting, Wave};
use meniscus::{Picture, Project, Sources};

/// The pool's picture with each wave as a sum of so many equal ones, of which the first `kept` stay.
fn picture(project: &Project, gpu: &Gpu, parts: usize, kept: usize) -> Vec<[f32; 3]> {
    let settings = [Setting::new("water.rms_slope", "0.1")];
    let mut scene = project.scene("pool", &settings).unwrap();
    let whole = std::mem::take(&mut scene.water.waves);
    let divided = whole.iter().flat_map(|wave| {
        let part = Wave {
            amplitude: wave.amplitude / parts as f64,
            ..*wave
        };
        std::iter::repeat_n(part, parts)
    });
    scene.water.waves = divided.take(kept).collect();
    let pipeline = project.pipeline("refraction/refined").unwrap();
    let picture = Picture::render(project, gpu, &pipeline, &scene, [320, 180]);
    picture.unwrap_or_else(|error| panic!("{error}")).colours
}

fn mean_difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    let channels = a.iter().flatten().zip(b.iter().flatten());
    channels.map(|(a, b)| (a - b).abs()).sum::<f32>() / (3 * a.len()) as f32
}

#[test]
fn waves_may_be_divided_into_more_than_a_block_holds() {
    let project = Project::open(&Sources::default()).unwrap();
    let gpu = Gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
    let whole = picture(&project, &gpu, 1, usize::MAX);
    // Five waves: 60 parts fit, 100 do not.
    for parts in [12, 20] {
        let divided = picture(&project, &gpu, parts, usize::MAX);
        let difference = mean_difference(&whole, &divided);
        assert!(difference < 1e-4, "{parts} parts: {difference}");
    }
    // If only as many were taken as a block holds, it would show.
    let cut = picture(&project, &gpu, 20, BLOCK_WAVES);
    assert!(mean_difference(&whole, &cut) > 1e-3);
}
