//! What several tests need.
#![allow(dead_code, reason = "each test file uses some of it")]

use std::path::{Path, PathBuf};

use meniscus_scene::{Library, Scene, Setting};
use meniscus_source::{Report, SourceFile};

/// The scenes that the program has built in.
pub fn built_in() -> Library {
    let mut library = Library::default();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenes");
    library
        .add_directory(&folder)
        .expect("the scenes can be read");
    library
}

/// The text of a scene with one object of a shape, and more fields of the object.
pub fn text_with(shape: &str, more: &str) -> String {
    format!(
        "Scene(about: \"test\",\n camera: (position: (0, -9), height: 2, target: (0, 0, 0)),\n \
         water: (waves: [(direction: 10, wavelength: 1)]),\n materials: {{\"m\": (colour: (0.5, 0.5, 0.5))}},\n \
         objects: [(name: \"thing\", material: \"m\", shape: {shape}, {more})])"
    )
}

/// Reads a scene with settings.
pub fn load(text: &str, settings: &[&str]) -> Result<Scene, Report> {
    load_in(None, text, settings)
}

/// Reads a scene whose mesh files are in a folder.
pub fn load_in(folder: Option<&Path>, text: &str, settings: &[&str]) -> Result<Scene, Report> {
    let settings: Vec<Setting> = settings
        .iter()
        .map(|s| Setting::parse("--set", s).unwrap())
        .collect();
    Scene::load(&SourceFile::new("test.ron", text), folder, &settings)
}

/// A scene with one mesh file, whose bytes are given.
pub fn load_mesh(file: &str, bytes: &[u8]) -> Result<Scene, Report> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(file), bytes).unwrap();
    load_in(
        Some(folder.path()),
        &text_with(&format!("Mesh(file: \"{file}\")"), ""),
        &[],
    )
}

/// Real meshes beside the checkout; none where they are not.
pub fn models() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models");
    folder.is_dir().then_some(folder)
}

/// Volume inside, by the divergence theorem.
pub fn volume(scene: &Scene) -> f64 {
    (0..scene.mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = scene.mesh.corners(t);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

/// Whether each edge of a triangle is another's, the other way round, bit for bit.
pub fn is_closed(scene: &Scene) -> bool {
    let mut edges = std::collections::HashMap::new();
    let bits = |p: glam::DVec3| p.to_array().map(f64::to_bits);
    for t in 0..scene.mesh.triangles.len() {
        let corners = scene.mesh.corners(t);
        for k in 0..3 {
            let (a, b) = (bits(corners[k]), bits(corners[(k + 1) % 3]));
            *edges.entry((a, b)).or_insert(0) += 1;
            *edges.entry((b, a)).or_insert(0) -= 1;
        }
    }
    edges.values().all(|&balance| balance == 0)
}
