//! The report of a sweep: curves along each swept setting, and the tables of all points.

use std::fmt::Write as _;

use meniscus_measure::{Curve, MeasureError, Results, Sweep, SweepPoint, Table, curves_figure};
use serde_json::Value;

use super::{STYLE, escaped, html_table, provenance, section, warnings};

/// Figures of others, beside ours.
#[derive(Debug, Clone, Copy)]
pub struct Beside<'a> {
    /// Whose they are, and what to mind.
    pub source: &'a str,
    /// The table's headings.
    pub headings: &'a [&'a str],
    /// Its rows; the first cell of each is its heading.
    pub rows: &'a [Vec<String>],
}

/// A report of all points of a sweep in one HTML file: curves of time and of error along each swept
/// setting, and the tables.
///
/// # Errors
/// When a figure cannot be drawn.
pub fn sweep_report(sweep: &Sweep, beside: Option<Beside>) -> Result<String, MeasureError> {
    let points: Vec<(SweepPoint, &Results)> = sweep.places().collect();
    let (known, all) = sweep.progress();
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>meniscus: sweep</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header><h1>Sweep</h1>\n<p>{known} of {all} \
         points.</p></header>\n<main>\n"
    );
    let figures = curves(&points)?;
    if !figures.is_empty() {
        section(&mut page, "curves", "Along the swept settings", |page| {
            page.push_str("<div class=\"figures\">\n");
            for figure in figures {
                let _ = writeln!(
                    page,
                    "<div class=\"wide plane\" tabindex=\"0\">{figure}</div>"
                );
            }
            page.push_str("</div>\n");
        });
    }
    if let Some(beside) = beside {
        section(&mut page, "beside", "Beside what was published", |page| {
            let _ = writeln!(page, "<p>{}</p>", escaped(beside.source));
            let label = "Beside what was published";
            page.push_str(&html_table(label, beside.headings, beside.rows));
        });
    }
    for (point, results) in &points {
        let id = format!("point-{}", point.index + 1);
        section(&mut page, &id, &escaped(&point.label()), |page| {
            let table = Table::of(results);
            let _ = writeln!(page, "<p>{}</p>", escaped(&table.notes()));
            page.push_str(&html_table(
                &point.label(),
                &table.headings(),
                &table.cells(),
            ));
        });
        page.push_str(&warnings(results).replace("\"warnings\"", &format!("\"warnings-{id}\"")));
    }
    if let Some((_, results)) = points.first() {
        provenance(&mut page, results);
    }
    page.push_str("</main>\n</body>\n</html>\n");
    Ok(page)
}

fn text(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

/// Figures of time, of time relative to the baseline and of error for each swept setting and each choice of the others.
fn curves(points: &[(SweepPoint, &Results)]) -> Result<Vec<String>, MeasureError> {
    let mut figures = Vec::new();
    let Some((first, _)) = points.first() else {
        return Ok(figures);
    };
    for key in first.swept.keys() {
        // Points that differ in this setting alone belong together.
        let mut groups: Vec<(String, Vec<(String, &Results)>)> = Vec::new();
        for (point, results) in points {
            let mut others = point.clone();
            let Some(value) = others.swept.shift_remove(key) else {
                continue;
            };
            let label = others.label();
            match groups.iter_mut().find(|(known, _)| *known == label) {
                Some((_, group)) => group.push((text(&value), results)),
                None => groups.push((label, vec![(text(&value), results)])),
            }
        }
        for (others, group) in groups.iter().filter(|(_, group)| group.len() > 1) {
            let along = match others.is_empty() {
                true => key.clone(),
                false => format!("{key} at {others}"),
            };
            let time = |results: &Results, name: &str| {
                let row = results.rows.iter().find(|row| row.pipeline == name)?;
                Some(row.frame_ms.median)
            };
            let error = |results: &Results, name: &str| {
                let row = results.rows.iter().find(|row| row.pipeline == name)?;
                // No error at all has no place on the axis.
                Some(row.error.as_ref()?.position_px.mean).filter(|px| *px > 0.0)
            };
            figures.extend(figure(&along, "time per frame in ms", group, &time)?);
            let relative = |results: &Results, name: &str| {
                let row = results.rows.iter().find(|row| row.pipeline == name)?;
                Some(row.relative.as_ref()?.median)
            };
            let to = group.iter().find_map(|(_, results)| {
                let relative = results.rows.first()?.relative.as_ref()?;
                Some(relative.to.as_str())
            });
            if let Some(to) = to {
                let upwards = format!("time as a multiple of {to}'s");
                figures.extend(figure(&along, &upwards, group, &relative)?);
            }
            figures.extend(figure(
                &along,
                "mean position error, pixels",
                group,
                &error,
            )?);
        }
    }
    Ok(figures)
}

fn figure(
    along: &str,
    upwards: &str,
    group: &[(String, &Results)],
    value: &dyn Fn(&Results, &str) -> Option<f64>,
) -> Result<Option<String>, MeasureError> {
    let mut curves: Vec<Curve> = Vec::new();
    for row in group.iter().flat_map(|(_, results)| &results.rows) {
        if curves.iter().all(|curve| curve.label != row.pipeline) {
            let values = group
                .iter()
                .map(|(_, results)| value(results, &row.pipeline));
            curves.push(Curve {
                label: row.pipeline.clone(),
                values: values.collect(),
            });
        }
    }
    if curves
        .iter()
        .all(|curve| curve.values.iter().all(Option::is_none))
    {
        return Ok(None);
    }
    let places: Vec<String> = group.iter().map(|(place, _)| place.clone()).collect();
    let title = format!("{upwards}, along {along}");
    curves_figure(&title, [along, upwards], &places, &curves).map(Some)
}
