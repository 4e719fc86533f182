//! What headers promise: domains that read, and results that are finite inside them.

use std::collections::BTreeSet;

use meniscus_shader::Role;
use meniscus_stress::modules::{Choice, Host, Specimen, declared};

use crate::lab::*;

/// Waters between which everything must be finite: ordinary, dense, thin, and nearly none.
const WATERS: [(f64, bool); 6] = [
    (1.333, true),
    (1.333, false),
    (2.5, true),
    (0.4, true),
    (1.0, true),
    (1.000_000_1, false),
];

/// Functions that tests call with proper arguments only: their domains are narrower than ranges
/// can say.
fn is_built_in(module: &str) -> bool {
    [
        "optics/",
        "geometry/",
        "screen/",
        "water/",
        "sky/",
        "shading/",
    ]
    .iter()
    .any(|folder| module.starts_with(folder))
}

#[test]
fn declared_domains_read_and_results_inside_are_finite() {
    let composer = composer(&[]);
    let (all, report) = declared(composer.library());
    assert!(report.0.is_empty(), "{report}");
    let mut rng = rng();
    let mut wrong = Vec::new();
    let mut functions = 0;
    for declared in all.iter().filter(|d| is_built_in(&d.module)) {
        let specimen = Specimen::new(&composer, &declared.module, &Choice::default())
            .unwrap_or_else(|e| panic!("{e}"));
        // Domains of structures belong to whatever takes them.
        if !specimen.function_names().any(|name| name == declared.name) {
            continue;
        }
        functions += 1;
        let function = specimen
            .function(&declared.name)
            .unwrap_or_else(|e| panic!("{e}"));
        for (index, above) in WATERS {
            let mut host = Host::default();
            host.water(index, above);
            let domain = declared
                .domain(&all, &function, &host)
                .unwrap_or_else(|e| panic!("{e}"));
            let mut inputs = domain.special(3000, &mut rng);
            inputs.extend((0..3000).map(|_| domain.draw(&mut rng)));
            let arguments = domain.lanes(&function, &inputs);
            let connected = specimen
                .connect(&function, &host)
                .unwrap_or_else(|e| panic!("{e}"));
            let found = function
                .call(&arguments, inputs.len(), &connected.resources())
                .unwrap_or_else(|trap| panic!("{}", specimen.explain(&trap)));
            let bad =
                (0..inputs.len()).find(|&lane| found.lane(lane).iter().any(|x| !x.is_finite()));
            if let Some(lane) = bad {
                wrong.push(format!(
                    "{}:{} with index {index}, above {above}: {:?} gives {:?}",
                    declared.module,
                    declared.name,
                    domain.numbers(&inputs[lane]),
                    found.lane(lane)
                ));
            }
        }
    }
    assert!(functions > 30, "{functions}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_module_of_optics_geometry_and_screen_that_has_functions_declares_a_domain() {
    let composer = composer(&[]);
    // In ranges, or in words: what walks through the scene's own arrays has the scene for its domain.
    let modules = composer.library().modules();
    let with_domain: BTreeSet<&str> = modules
        .filter(|m| !m.header.domain.is_empty())
        .map(|m| m.path.as_str())
        .collect();
    let folders = ["optics/", "geometry/", "screen/"];
    let mut missing = Vec::new();
    for module in composer.library().modules() {
        let concerned = folders.iter().any(|folder| module.path.starts_with(folder));
        if !concerned || module.role() == Role::Slot || with_domain.contains(module.path.as_str()) {
            continue;
        }
        let specimen = Specimen::new(&composer, &module.path, &Choice::default())
            .unwrap_or_else(|e| panic!("{e}"));
        let takes_something = specimen.function_names().any(|name| {
            specimen
                .function(name)
                .is_ok_and(|function| function.arguments().len() > 0)
        });
        if takes_something {
            missing.push(module.path.clone());
        }
    }
    assert!(missing.is_empty(), "no domain: {missing:?}");
}

#[test]
fn no_module_uses_inverse_trigonometry_and_powers_stand_in_the_seed_alone() {
    let composer = composer(&[]);
    for module in composer.library().modules() {
        let text = &module.file.text;
        let calls = |name: &str| {
            let called = format!("{name}(");
            text.match_indices(&called)
                .any(|(at, _)| !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_'))
        };
        for name in ["asin", "acos", "atan", "atan2"] {
            assert!(!calls(name), "{} calls {name}", module.path);
        }
        assert!(
            !calls("pow") || module.path == "optics/crossing_seed",
            "{}",
            module.path
        );
    }
}

fn domains_of(line: &str) -> String {
    let text =
        format!("// Test.\n//\n// domain: {line}\n\nfn f(x: f32) -> f32 {{\n    return x;\n}}\n");
    let composer = composer(&[("test/domain", &text)]);
    let (all, report) = declared(composer.library());
    if !report.0.is_empty() {
        return report.to_string();
    }
    let specimen = Specimen::new(&composer, "test/domain", &Choice::default())
        .unwrap_or_else(|e| panic!("{e}"));
    let function = specimen.function("f").unwrap_or_else(|e| panic!("{e}"));
    let own = all
        .iter()
        .find(|d| d.module == "test/domain")
        .expect("declared");
    match own.domain(&all, &function, &Host::default()) {
        Ok(_) => "fine".to_owned(),
        Err(report) => report.to_string(),
    }
}

#[test]
fn wrong_domains_are_told_with_their_place() {
    for line in [
        "f(x 1 to 2)",
        "f(x 1 to 2 log)",
        "f(x 0 to 3 near water.root_high / 2)",
        "f(x is 4)",
    ] {
        assert_eq!(domains_of(line), "fine", "{line}");
    }
    for (line, words) in [
        ("f(x 1 to 2", "bracket"),
        ("f(x one to 2)", "finite"),
        ("f(x 1 to 1e999)", "finite"),
        ("f(x 2 to 1)", "out of order"),
        ("f(x -1 to 1 log)", "across 0"),
        ("f(x 1 to 2 loud)", "may follow"),
        ("f(x 1 to 2 from 0)", "positive magnitude"),
        ("f(x)", "no range"),
        ("f(x unit)", "only vectors"),
        ("f(x is 1 2)", "as many"),
        ("f()", "says nothing of `x`"),
        ("f(x 1 to 2, y 1 to 2)", "takes no `y`"),
        ("f(x 1 to 2 near z)", "neither an argument nor a host value"),
        ("f(x 1 to 2 near 2 *)", "lacks a factor"),
        ("f(x 1 to 2 near )", "may follow"),
        ("f(x 1 to 2) against crossings", "`crossing`"),
        ("f(x 1 to 2) and", "only `against`"),
    ] {
        let said = domains_of(line);
        assert!(
            said.contains(words) && said.contains("test/domain.wgsl:3:"),
            "{line}: {said}"
        );
    }
}
