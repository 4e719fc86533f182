//! What users can get wrong on the command line, and what the machine may lack.

mod common;

use std::path::Path;

use common::{folder, program, program_without_adapter, run, words, write};

/// A line of arguments that is refused before anything is written.
#[track_caller]
fn line_is_refused(line: &str, expected: &[&str]) {
    let there = folder();
    run(program().current_dir(&there).args(words(line))).refused(expected);
    let left: Vec<_> = Path::read_dir(there.path()).expect("it is there").collect();
    assert!(left.is_empty(), "`{line}` leaves {left:?}");
}

#[test]
fn impossible_sizes_are_refused() {
    for command in [
        "render refraction/none -o x.png",
        "ablate refraction/none --out there",
    ] {
        for (size, expected) in [
            ("0x0", &["0x0", "no pixels", "begin at 1"][..]),
            ("640x0", &["640x0", "no pixels"]),
            ("100000x100000", &["100000×100000", "1 to "]),
            ("1x100000", &["1×100000", "1 to "]),
            ("99999999999x1", &["99999999999x1", "640x360"]),
            ("4294967295x1", &["4294967295x1", "end at 1000000"]),
            ("640", &["`640` is no size", "640x360"]),
            ("axb", &["`axb` is no size", "640x360"]),
            ("NaNxinf", &["is no size"]),
            ("1.5x2", &["is no size"]),
        ] {
            line_is_refused(&format!("{command} --size {size}"), expected);
        }
    }
}

#[test]
fn settings_are_refused_with_their_place_and_range() {
    for command in [
        "render refraction/combined --size 16x9 -o x.png",
        "ablate refraction/combined --size 16x9 --out there",
    ] {
        for (setting, expected) in [
            (
                "water.rms_slope=NaN",
                &["--set:1:17", "not a finite number", "0 to 4"][..],
            ),
            (
                "water.rms_slope=1e999",
                &["--set:1:17", "not a finite number", "0 to 4"],
            ),
            ("camera.height=-inf", &["--set:1:15", "not a finite number"]),
            (
                "water.time=soon",
                &["--set:1:12", "a number", "`soon`", "seconds"],
            ),
            (
                "water.rms_slope=5",
                &["--set:1:17", "out of range", "0 to 4"],
            ),
            (
                "water.geometry=round",
                &["--set:1:16", "flat or displaced", "`round`"],
            ),
            (
                "camra.height=1",
                &[
                    "--set:1:1",
                    "unknown setting",
                    "did you mean `camera.height`?",
                ],
            ),
            (
                "water.rms_slope",
                &["--set:1:1", "KEY=VALUE", "water.rms_slope=0.05"],
            ),
            ("=1", &["--set:1:1", "KEY=VALUE"]),
        ] {
            line_is_refused(&format!("{command} --set {setting}"), expected);
        }
    }
}

#[test]
fn changes_of_pipelines_are_refused_with_their_place() {
    for (change, expected) in [
        (
            "narrow.deflect=optics/refracted_rey",
            &[
                "--with narrow.deflect",
                "no module `optics/refracted_rey`",
                "did you mean `optics/refracted_ray`?",
            ][..],
        ),
        (
            "narow.deflect=optics/refracted_ray",
            &["no pass `narow`", "did you mean `narrow`?"],
        ),
        (
            "narrow.defect=optics/refracted_ray",
            &["no slot `defect`", "did you mean `deflect`?"],
        ),
        (
            "narrow.deflect.taps=NaN",
            &["--with narrow.deflect.taps:1:1", "finite"],
        ),
        (
            "narrow.deflect.taps=1e999",
            &["--with narrow.deflect.taps:1:1", "finite"],
        ),
        ("narrow.deflect.taps=3", &["`taps`", "optics/refracted_ray"]),
        ("narrow.deflect=3", &["--with narrow.deflect:1:1", "module"]),
        ("narrow.deflect=", &["--with narrow.deflect:1:1", "module"]),
        ("narrow=optics/snell", &["narrow", "PASS.SLOT"]),
        ("narrow.deflect", &["KEY=VALUE"]),
        ("narrow.deflect=(", &["--with narrow.deflect:1:"]),
        (
            "narrow.deflect=optics/snell",
            &["fills no slot", "provides: deflect"],
        ),
    ] {
        line_is_refused(
            &format!("render refraction/combined --size 16x9 -o x.png --with {change}"),
            expected,
        );
    }
}

#[test]
fn unknown_names_are_told_the_near_ones() {
    for (line, expected) in [
        (
            "render refraction/combind -o x.png",
            &[
                "no pipeline `refraction/combind`",
                "did you mean `refraction/combined`?",
            ][..],
        ),
        (
            "ablate refraction/combind",
            &[
                "no pipeline `refraction/combind`",
                "did you mean `refraction/combined`?",
            ],
        ),
        (
            "ablate nothing/*",
            &["no pipeline matches `nothing/*`", "refraction/combined"],
        ),
        (
            "check refraction/combind",
            &["did you mean `refraction/combined`?"],
        ),
        ("render mine.ron -o x.png", &["cannot read `mine.ron`"]),
        (
            "render refraction/none --scene pol -o x.png",
            &["unknown scene `pol`", "did you mean `pool`?"],
        ),
        (
            "render refraction/none --scene mine.ron -o x.png",
            &["cannot read", "mine.ron"],
        ),
        (
            "render refraction/none --adapter nobody -o x.png",
            &["no graphics adapter's name contains `nobody`", "help: "],
        ),
        (
            "compose refraction/combined --pass narow",
            &["no pass `narow`", "did you mean `narrow`?"],
        ),
        (
            "compose refraction/combined --pass narrow --facts wafes",
            &["no such fact", "did you mean `waves`?"],
        ),
        (
            "ablate refraction/none --baseline refraction/nome",
            &[
                "the baseline `refraction/nome`",
                "did you mean `refraction/none`?",
            ],
        ),
        (
            "ablate refraction/combined --size 16x9 --try narrow.deflect=optics/refracted_rey",
            &[
                "no module `optics/refracted_rey`",
                "did you mean `optics/refracted_ray`?",
            ],
        ),
        (
            "ablate refraction/none --rounds 0",
            &["--rounds", "1..=10000"],
        ),
        (
            "--modules nowhere list",
            &["cannot read the folder `nowhere`"],
        ),
        (
            "--pipelines nowhere check",
            &["cannot read the folder `nowhere`"],
        ),
        ("--scenes nowhere list", &["cannot read", "`nowhere`"]),
        ("rendr refraction/none", &["rendr", "render"]),
    ] {
        line_is_refused(line, expected);
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let there = folder();
    write(&there.path().join("file"), "");
    for (line, expected) in [
        (
            "render refraction/none -o file/x.png",
            &[
                "cannot write `file/x.png`",
                "`file` is no directory",
                "help",
            ][..],
        ),
        (
            "render refraction/none -o .",
            &["cannot write `.`", "it is a directory", "name a file in it"],
        ),
        ("ablate refraction/none --json .", &["cannot write `.`"]),
        (
            "ablate refraction/none --csv file/x.csv",
            &["cannot write `file/x.csv`"],
        ),
        (
            "ablate refraction/none --markdown file/x.md",
            &["cannot write `file/x.md`"],
        ),
        (
            "ablate refraction/none --out file",
            &["cannot write `file`"],
        ),
        (
            "ablate refraction/none --out file/there",
            &["cannot write `file/there`"],
        ),
    ] {
        // Three-digit rounds would take minutes, were they begun.
        let line = line.replace("ablate", "ablate --size 1280x720 --rounds 999");
        let said = run(program().current_dir(&there).args(words(&line)));
        said.refused(expected);
        assert!(said.out.is_empty(), "{}", said.out);
    }
}

#[test]
fn a_machine_without_adapter_is_told_how_to_get_one() {
    for line in [
        "render refraction/none --size 16x9 -o x.png",
        "ablate refraction/none --size 16x9",
        "adapters",
        "render refraction/none --size 16x9 -o x.png --adapter llvmpipe",
    ] {
        let there = folder();
        let said = run(program_without_adapter()
            .current_dir(&there)
            .args(words(line)));
        said.ended(1, &["adapter", "help: ", "mesa-vulkan-drivers libvulkan1"]);
    }
}

#[test]
fn a_reader_who_goes_away_is_no_mistake() {
    for line in [
        "list",
        "check",
        "adapters",
        "compose refraction/combined --pass narrow",
        "ablate refraction/none --size 16x9 --rounds 1 --json results.json",
    ] {
        let there = folder();
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut command = program();
        command.current_dir(&there).args(words(line)).stdout(writer);
        let said = run(&mut command);
        assert_eq!(said.code, Some(0), "{line}: {}", said.err);
        // The rest of the work is done nevertheless.
        let wanted = line.contains("results.json");
        assert_eq!(there.path().join("results.json").exists(), wanted);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let full = std::fs::File::create("/dev/full").expect("Linux has it");
    let mut command = program();
    command.arg("list").stdout(full);
    run(&mut command).ended(1, &["cannot write to standard output"]);
}
