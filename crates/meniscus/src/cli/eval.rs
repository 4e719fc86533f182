//! `meniscus eval`

use std::path::Path;

use clap::{Args, ValueEnum};
use meniscus::gpu::Gpu;
use meniscus::source::{Diagnostic, Report};
use meniscus::stress::modules::{Choice, Device as _, Host, Kernel, Specimen};
use meniscus::stress::{
    Column, DoubleDouble, Dual, Function, Interval, Kind, Lanes, Resources, Scalar,
};
use meniscus::{FunctionsOnGpu, Project};

use super::Failure;
use super::arguments::{Eval, Numbers, Surroundings};

/// The most lines of a CSV file.
const MOST_LINES: usize = 10_000_000;

/// What computes.
#[derive(Debug, Args)]
pub(crate) struct Computer {
    /// What runs the function. A GPU computes in `f32`.
    #[arg(long, value_enum, default_value = "cpu")]
    pub device: Device,
    /// The graphics adapter, by a part of its name (see `meniscus adapters`); the best one if none
    /// is given.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Device {
    /// The evaluator, on the CPU.
    Cpu,
    /// A graphics adapter.
    Gpu,
}

impl Surroundings {
    /// What modules read.
    pub fn host(&self) -> Result<Host, Report> {
        let mut host = Host::default();
        let mut report = Report::default();
        for text in &self.set {
            let numbers = text.split_once('=').and_then(|(path, values)| {
                let values = values.split(',').map(|v| v.trim().parse::<f64>().ok());
                Some((path.trim(), values.collect::<Option<Vec<f64>>>()?))
            });
            match numbers {
                Some((path, values)) => {
                    report.extend(host.set(path, &values).err().unwrap_or_default());
                }
                None => report.add(
                    Diagnostic::error(format!("`--set {text}`: NAME=NUMBER is wanted"))
                        .with_help("for example --set water.refractive_index=1.5"),
                ),
            }
        }
        report.into_result(host)
    }

    /// Whether the water is said.
    pub fn sets_water(&self) -> bool {
        let chosen = ["water.refractive_index", "water.camera_side"];
        let says = |text: &String| {
            chosen
                .iter()
                .any(|name| text.trim_start().starts_with(name))
        };
        self.set.iter().any(says)
    }
}

pub(crate) fn run(project: &Project, eval: &Eval) -> Result<(), Failure> {
    let Some((module, name)) = eval.function.split_once(':') else {
        let wrong = Diagnostic::error(format!("`{}` names no function", eval.function));
        return Err(wrong.with_help("write FOLDER/MODULE:FUNCTION").into());
    };
    let host = eval.surroundings.host()?;
    let specimen = Specimen::new(&project.composer, module, &Choice::default())?;
    let function = specimen.function(name)?;
    let columns = function.numbers().collect::<Vec<_>>();
    let rows = match &eval.csv {
        Some(file) => read(file, &columns)?,
        None => vec![given(&eval.function, &columns, &eval.arguments)?],
    };
    let connected = specimen.connect(&function, &host)?;
    let resources = connected.resources();
    let call = Call {
        function: &function,
        rows: &rows,
        resources: &resources,
    };
    let found = match eval.scalar {
        Numbers::F32 if eval.computer.device == Device::Gpu => {
            let gpu = FunctionsOnGpu(Gpu::open(eval.computer.adapter.as_deref())?);
            let kernel = Kernel::new(&specimen, &function, &host)?;
            let launch = gpu.launcher(&kernel)?;
            let arguments = call.arguments(|x, _| x as f32);
            let words = launch(&kernel.pack(&arguments, rows.len()), rows.len())
                .map_err(|error| Failure::Machine(format!("error: {error}")))?;
            let found = kernel.unpack(&words, rows.len());
            Ok(self::rows(&found, rows.len(), |_, _, x| x.to_string()))
        }
        _ if eval.computer.device == Device::Gpu => {
            let wrong = Diagnostic::error("a GPU computes in `f32` alone");
            return Err(wrong.with_help("leave --scalar or --device out").into());
        }
        Numbers::F32 => call.each(|x: f32| x.to_string()),
        Numbers::F64 => call.each(|x: f64| x.to_string()),
        Numbers::Dd => call.each(|x: DoubleDouble| {
            let low = x.minus(DoubleDouble::from_f64(x.to_f64())).to_f64();
            format!(
                "{} {} {:e}",
                x.to_f64(),
                if low < 0.0 { '-' } else { '+' },
                low.abs()
            )
        }),
        Numbers::Interval => call.each(|x: Interval| format!("{} to {}", x.low, x.high)),
        Numbers::Dual => call.conditions(),
    };
    let found = found.map_err(|trap| specimen.explain(&trap))?;
    let leaves = function
        .result()
        .map(|shape| shape.leaves())
        .unwrap_or_default();
    let named = |(path, _): &(String, Kind)| match path.trim_start_matches('.') {
        "" => "result".to_owned(),
        path => path.to_owned(),
    };
    let names: Vec<String> = leaves.iter().map(named).collect();
    print(&names, &found, eval.csv.is_some())
}

fn number(word: &str, kind: Kind) -> Option<f64> {
    match (kind, word) {
        (Kind::Bool, "true" | "1") => Some(1.0),
        (Kind::Bool, "false" | "0") => Some(0.0),
        (Kind::Bool, _) => None,
        (Kind::Float, word) => word.parse().ok(),
        (Kind::Sint, word) => word.parse::<i32>().ok().map(f64::from),
        (Kind::Uint, word) => word.parse::<u32>().ok().map(f64::from),
    }
}

fn given(what: &str, columns: &[(String, Kind)], words: &[String]) -> Result<Vec<f64>, Report> {
    if words.len() != columns.len() {
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        let message = format!(
            "`{what}` takes {} numbers, not {}",
            columns.len(),
            words.len()
        );
        return Err(Diagnostic::error(message).with_help(names.join(" ")).into());
    }
    let mut report = Report::default();
    let mut numbers = Vec::new();
    for (word, (name, kind)) in words.iter().zip(columns) {
        match number(word.trim(), *kind) {
            Some(number) => numbers.push(number),
            None => report.add(Diagnostic::error(format!(
                "`{what}`: `{name}` is of the kind {}, which `{word}` is not",
                kind.name()
            ))),
        }
    }
    report.into_result(numbers)
}

fn read(file: &Path, columns: &[(String, Kind)]) -> Result<Vec<Vec<f64>>, Report> {
    let unreadable = |error: csv::Error| Diagnostic::error(format!("{}: {error}", file.display()));
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_path(file)
        .map_err(unreadable)?;
    let header = reader.headers().map_err(unreadable)?.clone();
    let mut places = Vec::new();
    let mut report = Report::default();
    for (name, _) in columns {
        match header.iter().position(|column| column == name) {
            Some(place) => places.push(place),
            None => report.add(
                Diagnostic::error(format!("{}: there is no column `{name}`", file.display()))
                    .with_suggestion(name, header.iter()),
            ),
        }
    }
    report.into_result(())?;
    let mut rows = Vec::new();
    for (index, record) in reader.records().enumerate() {
        let record = record.map_err(unreadable)?;
        if index >= MOST_LINES {
            let message = format!("{}: more than {MOST_LINES} lines", file.display());
            return Err(Diagnostic::error(message)
                .with_help("split the file")
                .into());
        }
        let words = places.iter().map(|&place| record[place].to_owned());
        let words: Vec<String> = words.collect();
        let line = record.position().map_or(0, csv::Position::line);
        rows.push(given(
            &format!("{}:{line}", file.display()),
            columns,
            &words,
        )?);
    }
    Ok(rows)
}

/// A function and the numbers it is called with, a row for each lane.
struct Call<'a> {
    function: &'a Function,
    rows: &'a [Vec<f64>],
    resources: &'a Resources<'a>,
}

type Found = Result<Vec<Vec<String>>, meniscus::stress::Trap>;

impl Call<'_> {
    /// Arguments; `make` gets the number and which one of its row it is.
    fn arguments<S: Scalar>(&self, make: impl Fn(f64, usize) -> S) -> Vec<Lanes<S>> {
        let mut at = 0;
        let mut column = |kind: Kind| {
            let index = at;
            at += 1;
            let numbers = self.rows.iter().map(move |row| row[index]);
            match kind {
                Kind::Float => Column::Float(numbers.map(|x| make(x, index)).collect()),
                Kind::Sint => Column::Sint(numbers.map(|x| x as i32).collect()),
                Kind::Uint => Column::Uint(numbers.map(|x| x as u32).collect()),
                Kind::Bool => Column::Bool(numbers.map(|x| x != 0.0).collect()),
            }
        };
        let shapes = self.function.arguments().map(|(_, shape)| shape.leaves());
        shapes
            .map(|leaves| Lanes {
                columns: leaves.into_iter().map(|(_, kind)| column(kind)).collect(),
            })
            .collect()
    }

    fn each<S: Scalar>(&self, show: impl Fn(S) -> String) -> Found {
        let arguments = self.arguments(|x, _| S::from_f64(x));
        let found = self
            .function
            .call(&arguments, self.rows.len(), self.resources)?;
        Ok(rows(&found, self.rows.len(), |_, _, x| show(x)))
    }

    /// Values and their condition numbers Σ |x ∂f/∂x| / |f|.
    fn conditions(&self) -> Found {
        let lanes = self.rows.len();
        let mut sums: Vec<Vec<f64>> = Vec::new();
        let mut last = None;
        let count = self.rows.first().map_or(0, Vec::len);
        for seeded in 0..count.max(1) {
            let arguments =
                self.arguments(|x, index| Dual::new(x, if index == seeded { x } else { 0.0 }));
            let found = self.function.call(&arguments, lanes, self.resources)?;
            sums.resize(found.columns.len(), vec![0.0; lanes]);
            for (leaf, sum) in sums.iter_mut().enumerate() {
                for (sum, dual) in sum.iter_mut().zip(found.floats(leaf).unwrap_or_default()) {
                    *sum += dual.slope.abs();
                }
            }
            last = Some(found);
        }
        let show = |leaf: usize, lane: usize, x: Dual| {
            let sum = sums[leaf][lane];
            let condition = if sum == 0.0 { 0.0 } else { sum / x.value.abs() };
            format!("{} (condition {condition:.3})", x.value)
        };
        Ok(last.map_or_else(Vec::new, |found| rows(&found, lanes, show)))
    }
}

/// The numbers of every lane in words; `show` gets number, lane and value.
fn rows<S: Scalar>(
    found: &Lanes<S>,
    lanes: usize,
    show: impl Fn(usize, usize, S) -> String,
) -> Vec<Vec<String>> {
    let word = |leaf: usize, lane: usize| match &found.columns[leaf] {
        Column::Float(c) => show(leaf, lane, c[lane]),
        Column::Sint(c) => c[lane].to_string(),
        Column::Uint(c) => c[lane].to_string(),
        Column::Bool(c) => c[lane].to_string(),
    };
    let row = |lane: usize| {
        (0..found.columns.len())
            .map(|leaf| word(leaf, lane))
            .collect()
    };
    (0..lanes).map(row).collect()
}

fn print(names: &[String], found: &[Vec<String>], as_csv: bool) -> Result<(), Failure> {
    if as_csv {
        let mut writer = csv::Writer::from_writer(std::io::stdout().lock());
        let unwritable = |error: csv::Error| Failure::Machine(format!("error: {error}"));
        writer.write_record(names).map_err(unwritable)?;
        for row in found {
            writer.write_record(row).map_err(unwritable)?;
        }
        return writer
            .flush()
            .map_err(|error| Failure::Machine(format!("error: {error}")));
    }
    let width = names.iter().map(String::len).max().unwrap_or(0);
    for (name, value) in names.iter().zip(found.iter().flatten()) {
        println!("{name:width$}  {value}");
    }
    Ok(())
}
