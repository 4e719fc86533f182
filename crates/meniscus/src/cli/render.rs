//! `meniscus render`

use std::path::{Path, PathBuf};

use clap::Args;
use meniscus::measure::write_png;
use meniscus::source::Diagnostic;
use meniscus::{Project, Sequence, Shot};

use super::arguments::{Changes, Look, check_moments};
use super::say::say;
use super::{Failure, outputs};

#[derive(Debug, Args)]
pub(crate) struct Render {
    /// The pipeline, by name or file.
    pub pipeline: String,
    #[command(flatten)]
    pub look: Look,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub skipping: super::explain::Skipping,
    /// Render at these moments of the scene, seconds, in turn; passes of which nothing has changed
    /// since the last picture do not run again.
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    pub times: Vec<f64>,
    /// The picture to write. With --times, `{}` stands for the picture's number: frame-{}.png
    #[arg(short, long, value_name = "FILE.png")]
    pub output: PathBuf,
}

pub(crate) fn run(project: &Project, render: &Render) -> Result<(), Failure> {
    let mut pipelines = [project.pipeline(&render.pipeline)?];
    render.changes.apply(&mut pipelines)?;
    let mut scene = render.look.scene(project)?;
    check_moments(&render.times)?;
    let (times, files) = match render.times.as_slice() {
        [] => (vec![scene.water.time], vec![render.output.clone()]),
        times => (times.to_vec(), numbered(&render.output, times.len())?),
    };
    outputs::check(&files, None)?;
    let gpu = render.look.gpu()?;
    let (size, pruning) = (render.look.size, render.skipping.pruning());
    let mut sequence = Sequence::new(project, &gpu, &pipelines[0], &scene, size, pruning)?;
    for (time, file) in times.iter().zip(&files) {
        scene.set_time(*time);
        let shot = sequence.shot(&scene)?;
        write_png(file, shot.picture.size, &shot.picture.srgb())?;
        if render.times.is_empty() {
            say(&format!("{} ", file.display()))?;
        } else {
            say(&format!("{} at {time} s: {}\n", file.display(), ran(&shot)))?;
        }
    }
    say(&format!("on {}\n", gpu.facts()))
}

/// What ran for a picture, in words.
fn ran(shot: &Shot) -> String {
    match shot.ran.len() {
        0 => format!("none of {} passes ran, nothing has changed", shot.passes),
        ran => format!(
            "{ran} of {} passes ran: {}",
            shot.passes,
            shot.ran.join(", ")
        ),
    }
}

/// As many files as there are pictures; `{}` is the picture's number, from 1, in as many digits as
/// the last one takes.
fn numbered(output: &Path, count: usize) -> Result<Vec<PathBuf>, Diagnostic> {
    let pattern = output.to_str().filter(|text| text.contains("{}"));
    let Some(pattern) = pattern else {
        return match count {
            1 => Ok(vec![output.to_owned()]),
            _ => Err(Diagnostic::error(format!(
                "{count} pictures cannot all be `{}`",
                output.display()
            ))
            .with_help("put `{}` where their numbers are to stand, as in frame-{}.png")),
        };
    };
    let width = count.to_string().len();
    let numbers = (1..=count).map(|number| format!("{number:0width$}"));
    Ok(numbers
        .map(|number| pattern.replace("{}", &number).into())
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_numbered_in_as_many_digits_as_the_last_takes() {
        let names = |output: &str, count| numbered(Path::new(output), count);
        let one = names("a/b-{}.png", 1).unwrap();
        assert_eq!(one, [Path::new("a/b-1.png")]);
        let many = names("b-{}.png", 100).unwrap();
        assert_eq!(many[6], Path::new("b-007.png"));
        assert_eq!(many[99], Path::new("b-100.png"));
        assert_eq!(names("b.png", 1).unwrap(), [Path::new("b.png")]);
        let error = names("b.png", 2).unwrap_err();
        assert!(error.message.contains("`b.png`"), "{error:?}");
    }
}
