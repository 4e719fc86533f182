//! Runs the built program, and reads what it leaves behind.
#![allow(dead_code, reason = "each test file uses some of it")]

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;

use meniscus::pipeline::Pipeline;
use meniscus::scene::Scene;
use meniscus::{Ablation, Rounds};
use serde_json::Value;

/// How a run of the program ended, and what it said.
#[derive(Debug)]
pub struct Said {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

/// Pipelines on a scene for the sake of their errors: a single frame each, held to the truth of the water as
/// the scene has it.
pub fn untimed(pipelines: Vec<Pipeline>, scene: Scene, size: [u32; 2]) -> Ablation {
    Ablation {
        pipelines,
        baseline: None,
        truth: scene.water.geometry,
        scene,
        size,
        pruning: Default::default(),
        rounds: Rounds {
            warm_up: 0,
            counted: 1,
            ..Rounds::default()
        },
        without: Vec::new(),
        settings: Default::default(),
        moments: Vec::new(),
        rivalry: None,
    }
}

/// The program, ready for arguments. Mesa's layer that chooses devices writes to stderr on some
/// machines; it is told not to, so that tests see what the program itself says.
pub fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_meniscus"));
    command.env("NODEVICE_SELECT", "1");
    // Tests leave nothing in the user's folders.
    command.env("MENISCUS_CACHE", "off");
    command
}

/// The program where no driver is to be found.
pub fn program_without_adapter() -> Command {
    let mut command = program();
    for variable in [
        "VK_DRIVER_FILES",
        "VK_ICD_FILENAMES",
        "__EGL_VENDOR_LIBRARY_FILENAMES",
    ] {
        command.env(variable, "/nonexistent/driver.json");
    }
    command
}

/// Runs a command, which must never panic.
pub fn run(command: &mut Command) -> Said {
    let output = command.output().expect("the program starts");
    let said = Said {
        code: output.status.code(),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
    };
    assert!(!said.err.contains("panicked"), "{command:?}: {}", said.err);
    // A panic's code, or none at all where a signal ended the process.
    assert!(
        said.code.is_some_and(|code| code != 101),
        "{command:?}: {said:?}"
    );
    said
}

/// Runs the program with arguments.
pub fn meniscus<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Said {
    run(program().args(arguments))
}

/// Arguments out of a line; none of them may hold a space.
pub fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

impl Said {
    /// That it succeeded; its output.
    #[track_caller]
    pub fn done(self) -> String {
        assert_eq!(self.code, Some(0), "{}", self.err);
        self.out
    }

    /// That it was refused as a mistake in what was written, in these words.
    #[track_caller]
    pub fn refused(&self, words: &[&str]) {
        self.ended(2, words);
    }

    /// That it ended with this code and these words on stderr.
    #[track_caller]
    pub fn ended(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{}\n{}", self.err, self.out);
        for word in words {
            assert!(
                self.err.contains(word),
                "`{word}` is missing in\n{}",
                self.err
            );
        }
    }
}

/// A temporary directory.
pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary directory")
}

/// Writes a file, and the directories that it is in.
pub fn write(path: &Path, text: impl AsRef<[u8]>) {
    std::fs::create_dir_all(path.parent().expect("a file in a directory")).expect("a directory");
    std::fs::write(path, text).expect("a file");
}

/// A path as text.
pub fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

/// Reads a file of JSON.
pub fn json(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_slice(&bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The row of a pipeline.
#[track_caller]
pub fn row<'a>(results: &'a Value, pipeline: &str) -> &'a Value {
    let rows = results["rows"].as_array().expect("rows");
    rows.iter()
        .find(|row| row["pipeline"] == pipeline)
        .unwrap_or_else(|| panic!("no row of {pipeline}"))
}

/// A number of a JSON tree, by its path.
#[track_caller]
pub fn number(value: &Value, path: &str) -> f64 {
    let found = value.pointer(path).and_then(Value::as_f64);
    found.unwrap_or_else(|| panic!("no number at {path} in {value}"))
}

/// Rows, columns and numbers of an array of 32-bit floats in NumPy's format, version 1.
pub fn npy_f32(path: &Path) -> (Vec<usize>, Vec<f32>) {
    let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00", "{}", path.display());
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = std::str::from_utf8(&bytes[10..10 + length]).expect("a header in ASCII");
    assert!(header.contains("'<f4'"), "{header}");
    assert!(header.contains("'fortran_order': False"), "{header}");
    let (_, shape) = header.split_once('(').expect("a shape");
    let (shape, _) = shape.split_once(')').expect("the shape's end");
    let shape: Vec<usize> = shape
        .split(',')
        .filter(|part| !part.trim().is_empty())
        .map(|part| part.trim().parse().expect("a length"))
        .collect();
    let numbers: Vec<f32> = bytes[10 + length..]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    assert_eq!(numbers.len(), shape.iter().product::<usize>());
    (shape, numbers)
}
