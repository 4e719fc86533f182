//! Every declared function is exact to 4 ulp after conditioning, except those that the README's table
//! of exceptions tells of.
//!
//! `MENISCUS_STRESS_SAMPLES` sets how many random inputs are tried per function, and
//! `MENISCUS_STRESS_ONLY` a part of the names of those that are.

use std::collections::BTreeMap;

use meniscus_stress::Effort;
use meniscus_stress::modules::{Assay, Host, declared};

use crate::lab::composer;

/// What is asked of a function that the table does not name, ulp / (1 + condition).
const ASKED: f64 = 4.0;

/// Functions and their bounds, from the table under "Exceptions".
fn exceptions() -> BTreeMap<String, f64> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = std::fs::read_to_string(path).expect("the README");
    let (_, part) = readme
        .split_once("\n## Exceptions\n")
        .expect("a part of that title");
    let part = part.split("\n## ").next().unwrap_or(part);
    let row = |line: &str| {
        let mut cells = line.strip_prefix('|')?.split('|').map(str::trim);
        let (name, bound) = (cells.next()?, cells.next()?);
        Some((name.to_owned(), bound.parse().ok()?))
    };
    part.lines().filter_map(row).collect()
}

#[test]
fn errors_after_conditioning_are_small_except_where_the_table_tells_why() {
    let samples = std::env::var("MENISCUS_STRESS_SAMPLES").ok();
    let samples = samples.and_then(|s| s.parse().ok()).unwrap_or(256);
    let only = std::env::var("MENISCUS_STRESS_ONLY").unwrap_or_default();
    let effort = Effort {
        random: samples,
        special: samples / 4,
        climb: samples,
        ..Effort::default()
    };
    let composer = composer(&[]);
    let (all, report) = declared(composer.library());
    assert!(report.0.is_empty(), "{report}");
    let exceptions = exceptions();
    let mut wrong = Vec::new();
    for declared in &all {
        let name = format!("{}:{}", declared.module, declared.name);
        if !declared.is_function(composer.library()) || !name.contains(&only) {
            continue;
        }
        let start = std::time::Instant::now();
        let assay = Assay::run(&composer, &all, declared, &Host::default(), &[], &effort)
            .unwrap_or_else(|e| panic!("{e}"));
        let bound = exceptions.get(&name).copied().unwrap_or(ASKED);
        println!(
            "{name:45} {:9.3e} rounding {:9.3e} {:6.1} s, of {bound}; branches {}, whole {}, not finite {}, at {:?}: {:?}",
            assay.found.scaled.max,
            assay.found.rounding.max,
            start.elapsed().as_secs_f64(),
            assay.found.branches,
            assay.found.whole,
            assay.found.non_finite,
            assay.parts_at,
            if assay.found.scaled.max > ASKED {
                &assay.worst_numbers[..]
            } else {
                &[]
            },
        );
        if assay.found.non_finite > 0 || assay.found.scaled.max > bound {
            wrong.push(format!(
                "{name}: {:.2} ulp / (1 + condition), {bound} allowed; {} not finite; worst {:?}",
                assay.found.scaled.max, assay.found.non_finite, assay.worst_numbers
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
