//! What is composed anew, and what is the same every time.

mod common;

use std::collections::BTreeMap;

use common::{compose, composer, number, plain, recipe, sources};
use meniscus_shader::{Composer, Filling, Library, Shader};
use meniscus_source::SourceFile;

/// A generator of orders, the same in every run.
struct Shuffler(u64);

impl Shuffler {
    fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            // Knuth's MMIX generator.
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            items.swap(last, (self.0 >> 33) as usize % (last + 1));
        }
    }
}

fn everything(shader: &Shader) -> String {
    let again = naga::back::wgsl::write_string(
        &shader.module,
        &shader.info,
        naga::back::wgsl::WriterFlags::all(),
    )
    .unwrap();
    format!(
        "{}\n{}\n{again}\n{:?}\n{:?}\n{:?}",
        shader.hash, shader.text, shader.bindings, shader.overrides, shader.attributes
    )
}

#[test]
fn composition_is_the_same_in_every_order_of_files() {
    let taps = |tap: Filling| Filling {
        slots: BTreeMap::from([("tap".to_owned(), tap)]),
        ..plain("geometry/taps")
    };
    let wanted = recipe(&[
        ("deflect", plain("optics/bent")),
        ("intersect", taps(taps(plain("geometry/plane")))),
    ]);
    let mut files = sources(&[]);
    let mut shuffler = Shuffler(7);
    let mut first = None;
    for _ in 0..100 {
        shuffler.shuffle(&mut files);
        let (library, report) = Library::new(files.iter().map(|(p, f)| (p.as_str(), f.clone())));
        assert!(report.0.is_empty());
        // A composer of its own: its maps have other seeds, and nothing is kept from before.
        let shader = everything(&compose(&Composer::new(library), &wanted));
        assert_eq!(first.get_or_insert_with(|| shader.clone()), &shader);
    }
}

#[test]
fn messages_are_the_same_in_every_order_of_files() {
    let wrong = |name: &str| {
        format!(
            "// W.\n//\n// provides: shift\n// needs: nothing_{name}\n\nfn shift(x: f32) -> f32 {{\n    return {name};\n}}\n"
        )
    };
    let mut files = sources(&[]);
    files.extend(["a", "b", "c"].map(|name| {
        (
            name.to_owned(),
            SourceFile::new(format!("{name}.wgsl"), wrong(name)),
        )
    }));
    let mut shuffler = Shuffler(3);
    let mut first = None;
    for _ in 0..100 {
        shuffler.shuffle(&mut files);
        let (library, mut report) =
            Library::new(files.iter().map(|(p, f)| (p.as_str(), f.clone())));
        report.extend(Composer::new(library).check_library());
        assert_eq!(
            first.get_or_insert_with(|| report.to_string()),
            &report.to_string()
        );
    }
}

#[test]
fn variants_that_differ_only_in_numbers_compose_nothing_anew() {
    let composer = composer(&[]);
    let bent = |bend: f64| Filling {
        numbers: BTreeMap::from([("bend".to_owned(), number(bend))]),
        ..plain("optics/bent")
    };
    let first = compose(&composer, &recipe(&[("deflect", bent(0.0))]));
    for step in 1..=100 {
        let shader = compose(
            &composer,
            &recipe(&[("deflect", bent(f64::from(step) * 0.02))]),
        );
        assert!(std::sync::Arc::ptr_eq(&first, &shader));
    }
    assert_eq!(composer.composed(), 1);
}

#[test]
fn a_hundred_variants_of_one_slot_compose_a_hundred_shaders_on_any_number_of_threads() {
    let modules: Vec<(String, String)> = (0..100)
        .map(|i| (format!("water/shift{i}"), format!("// S.\n//\n// provides: shift\n\nfn shift(x: f32) -> f32 {{\n    return x + {i}.0;\n}}\n")))
        .collect();
    let modules: Vec<(&str, &str)> = modules
        .iter()
        .map(|(p, t)| (p.as_str(), t.as_str()))
        .collect();
    let composer = composer(&modules);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for (path, _) in &modules {
                    compose(
                        &composer,
                        &recipe(&[
                            ("intersect", plain("geometry/plane")),
                            ("shift", plain(path)),
                        ]),
                    );
                    // Another pass, the same in all variants.
                    compose(&composer, &recipe(&[("deflect", plain("optics/bent"))]));
                }
            });
        }
    });
    assert_eq!(composer.composed(), 101);
}
