//! One HTML file that holds everything an ablation found, pictures included, and asks for nothing
//! else: it can be mailed, and opened without a network.
//!
//! Written out here: a template engine would be another language for some forty lines of markup.

mod swept;

pub use swept::{Beside, sweep_report};

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use meniscus_measure::heat::{LogScale, error_map};
use meniscus_measure::{Claim, Contest, MeasureError, Results, Row, Table, png_bytes};
use serde_json::{Map, Value};

use crate::ablation::Outcome;
use crate::output;
use crate::picture::srgb;
use crate::rivalry::contests_of;
use crate::warnings::gathered_warnings;

const STYLE: &str = include_str!("report.css");
const SCRIPT: &str = include_str!("report.js");

/// What the reference is called.
const TRUTH: &str = "truth";

/// The report of an ablation: table, time against error, pictures to compare, times of passes,
/// warnings and provenance.
///
/// # Errors
/// When a picture cannot be encoded, or a figure cannot be drawn.
pub fn report(outcome: &Outcome) -> Result<String, MeasureError> {
    let results = &outcome.results;
    let [width, height] = results.size;
    let title = format!("{}, {width}×{height}", escaped(&results.scene));
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>meniscus: {title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header><h1>{title}</h1>\n<p>{}</p></header>\n<main>\n",
        escaped(&Table::of(results).notes())
    );
    page.push_str(&table(results));
    page.push_str(&warnings(results));
    if let Some(figure) = output::figure(outcome)? {
        section(&mut page, "plane", "Time against error", |page| {
            let _ = write!(
                page,
                "<p>Better is lower left. Filled points are on the Pareto front: none is as fast \
                 and less wrong.</p>\n<div class=\"wide plane\" tabindex=\"0\" role=\"region\" \
                 aria-label=\"Time against error\">{figure}</div>\n"
            );
        });
    }
    contests(&mut page, results);
    pictures(&mut page, outcome)?;
    moments(&mut page, results);
    passes(&mut page, results);
    costs(&mut page, results);
    marginal(&mut page, results);
    provenance(&mut page, results);
    let _ = write!(
        page,
        "</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n"
    );
    Ok(page)
}

fn section(page: &mut String, id: &str, heading: &str, content: impl FnOnce(&mut String)) {
    let _ = writeln!(
        page,
        "<section aria-labelledby=\"{id}\">\n<h2 id=\"{id}\">{heading}</h2>"
    );
    content(page);
    page.push_str("</section>\n");
}

/// A table whose first column names its rows; it scrolls by itself where it is too wide.
pub(crate) fn html_table(label: &str, headings: &[&str], rows: &[Vec<String>]) -> String {
    let mut html = format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table>\n<thead><tr>",
        escaped(label)
    );
    for heading in headings {
        let _ = write!(html, "<th scope=\"col\">{}</th>", escaped(heading));
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    for cells in rows {
        html.push_str("<tr>");
        for (index, cell) in cells.iter().enumerate() {
            let _ = match index {
                0 => {
                    // Long names may be broken after a slash.
                    let name = escaped(cell).replace('/', "/<wbr>");
                    write!(html, "<th scope=\"row\">{name}</th>")
                }
                _ => write!(html, "<td>{}</td>", escaped(cell)),
            };
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>\n");
    html
}

fn table(results: &Results) -> String {
    let table = Table::of(results);
    let mut html = String::new();
    section(&mut html, "table", "Time and error", |page| {
        page.push_str(&html_table(
            "Time and error",
            &table.headings(),
            &table.cells(),
        ));
    });
    html
}

fn warnings(results: &Results) -> String {
    let mut html = String::new();
    let gathered = gathered_warnings(results);
    if gathered.is_empty() {
        return html;
    }
    section(&mut html, "warnings", "Warnings", |page| {
        page.push_str("<ul class=\"warnings\">\n");
        for warning in gathered {
            let _ = writeln!(page, "<li>{}</li>", escaped(&warning));
        }
        page.push_str("</ul>\n");
    });
    html
}

fn data_url(size: [u32; 2], rgb: &[u8]) -> Result<String, MeasureError> {
    let png = STANDARD.encode(png_bytes(size, rgb)?);
    Ok(format!("data:image/png;base64,{png}"))
}

/// The controls find their labels, and the script its elements, by these.
const VIEWER: &str = r#"<div id="viewer" hidden>
<div class="controls">
<label>this <select id="first"></select></label>
<label>beside <select id="second"></select></label>
<fieldset><legend>shown as</legend>
<label><input type="radio" name="mode" value="slider" checked> slider</label>
<label><input type="radio" name="mode" value="flip"> flip</label>
<label><input type="radio" name="mode" value="difference"> difference × 8</label>
<label><input type="radio" name="mode" value="map"> error map</label>
</fieldset>
<label>divided at <input type="range" id="divide" min="0" max="100" value="50"></label>
<label>magnified <input type="range" id="zoom" min="2" max="24" value="8"></label>
</div>
<canvas id="stage" tabindex="0" role="img" aria-describedby="keys" aria-label="two pictures compared"></canvas>
<p id="state" aria-live="polite"></p>
<p id="keys">Point at the picture, or focus it and use the arrow keys (with Shift in larger steps), to move the
magnifier; Space changes sides, + and − magnify, [ and ] move the divide, 1 to 4 choose how it is shown.</p>
<div id="loupes"></div>
</div>
"#;

fn pictures(page: &mut String, outcome: &Outcome) -> Result<(), MeasureError> {
    let results = &outcome.results;
    let size = results.size;
    let scale = LogScale::PIXELS;
    let mut gallery = String::from("<div id=\"gallery\">\n");
    let mut add = |name: &str, colours: &[[f32; 3]], map: Option<String>| {
        let name = escaped(name);
        let picture = data_url(size, &srgb(colours))?;
        let _ = write!(
            gallery,
            "<figure><img alt=\"{name}\" data-name=\"{name}\" width=\"{}\" height=\"{}\" src=\"{picture}\">",
            size[0], size[1]
        );
        if let Some(map) = map {
            let _ = write!(
                gallery,
                "<img class=\"map\" alt=\"errors of {name}\" data-map=\"{name}\" width=\"{}\" height=\"{}\" src=\"{map}\">",
                size[0], size[1]
            );
        }
        let _ = writeln!(gallery, "<figcaption>{name}</figcaption></figure>");
        Ok::<(), MeasureError>(())
    };
    add(TRUTH, &outcome.truth.colour, None)?;
    for (row, figures) in outcome.rows.iter().zip(&results.rows) {
        let map = data_url(size, &error_map(&row.judgement.verdicts, &scale))?;
        add(&figures.pipeline, &row.colours, Some(map))?;
    }
    gallery.push_str("</div>\n");
    section(page, "pictures", "Pictures", |page| {
        let _ = write!(
            page,
            "{VIEWER}<p class=\"legend\">Error maps: {}.</p>\n<details id=\"all\" open>\
             <summary>All pictures</summary>\n{gallery}</details>\n",
            escaped(scale.legend().trim_end_matches('.'))
        );
    });
    Ok(())
}

fn passes(page: &mut String, results: &Results) {
    let slowest = results
        .rows
        .iter()
        .flat_map(|row| &row.passes)
        .fold(0.0f64, |most, pass| most.max(pass.ms));
    if slowest <= 0.0 {
        return;
    }
    section(page, "passes", "Time of each pass", |page| {
        page.push_str("<p>Medians in milliseconds, in the order passes run.</p>\n");
        for row in &results.rows {
            let sum: f64 = row.passes.iter().map(|pass| pass.ms).sum();
            let _ = writeln!(
                page,
                "<details><summary>{}: {:.2} ms in {} passes</summary>\n<table class=\"bars\">",
                escaped(&row.pipeline),
                sum,
                row.passes.len()
            );
            for pass in &row.passes {
                let _ = writeln!(
                    page,
                    "<tr><th scope=\"row\">{}</th><td>{:.3}</td><td class=\"bar\"><span \
                     style=\"width:{:.1}%\"></span></td></tr>",
                    escaped(&pass.name),
                    pass.ms,
                    100.0 * pass.ms / slowest
                );
            }
            page.push_str("</table></details>\n");
        }
    });
}

/// How the claim stands against each rival, where some were named; else who dominates whom.
fn contests(page: &mut String, results: &Results) {
    let contests = contests_of(results);
    if !contests.is_empty() {
        section(page, "contests", "Against rivals", |page| {
            let claim = escaped(&Claim::default().words());
            let _ = writeln!(
                page,
                "<p>Claim: {claim}; and no rival dominates one of ours.</p>"
            );
            let rows: Vec<Vec<String>> = contests.iter().map(Contest::cells).collect();
            page.push_str(&html_table("Against rivals", &Contest::HEADINGS, &rows));
        });
        return;
    }
    let by = |row: &Row| {
        let by = row.more.get("dominated_by").and_then(Value::as_array)?;
        let names: Vec<&str> = by.iter().filter_map(Value::as_str).collect();
        (!names.is_empty()).then(|| vec![row.pipeline.clone(), names.join(", ")])
    };
    let rows: Vec<Vec<String>> = results.rows.iter().filter_map(by).collect();
    if !rows.is_empty() {
        section(page, "contests", "Dominated", |page| {
            page.push_str(
                "<p>Others are as fast and as right, and better in one of the two.</p>\n",
            );
            page.push_str(&html_table("Dominated", &["pipeline", "by"], &rows));
        });
    }
}

/// The worst of each figure, where there were several moments.
fn moments(page: &mut String, results: &Results) {
    let rows = crate::moments::table(results);
    if !rows.is_empty() {
        section(page, "moments", "The worst of the moments", |page| {
            page.push_str(
                "<p>Above stand the means over the moments, and pictures of the first.</p>\n",
            );
            let label = "The worst of the moments";
            page.push_str(&html_table(label, &crate::moments::HEADINGS, &rows));
        });
    }
}

/// What frames take beside time.
fn costs(page: &mut String, results: &Results) {
    section(page, "costs", "What a frame takes beside time", |page| {
        let table = Table::of_costs(results);
        let _ = writeln!(page, "<p>{}</p>", escaped(&table.notes()));
        let label = "What a frame takes beside time";
        page.push_str(&html_table(label, &table.headings(), &table.cells()));
    });
}

/// What each filling brings and costs, where slots were put back to their defaults.
fn marginal(page: &mut String, results: &Results) {
    let rows = crate::marginal::table(results);
    if !rows.is_empty() {
        section(page, "marginal", "What each filling brings", |page| {
            page.push_str(&html_table(
                "What each filling brings",
                &crate::marginal::HEADINGS,
                &rows,
            ));
        });
    }
}

fn provenance(page: &mut String, results: &Results) {
    section(page, "provenance", "Where the figures come from", |page| {
        page.push_str("<dl>\n");
        let mut list = |entries: &Map<String, Value>| {
            for (name, value) in entries {
                let text = match value {
                    Value::String(text) => text.clone(),
                    Value::Number(number) if number.is_f64() => {
                        format!("{:.3}", number.as_f64().unwrap_or_default())
                    }
                    other => other.to_string(),
                };
                let _ = writeln!(
                    page,
                    "<dt>{}</dt><dd>{}</dd>",
                    escaped(name),
                    escaped(&text)
                );
            }
        };
        list(&results.provenance);
        list(&results.settings);
        for (name, value) in &results.more {
            // What has a section of its own is not told again.
            if let Value::Object(within) = value {
                list(within);
            } else if !value.is_array() {
                list(&Map::from_iter([(name.clone(), value.clone())]));
            }
        }
        page.push_str("</dl>\n");
        for row in &results.rows {
            let Some(Value::Object(shaders)) = row.more.get("shaders") else {
                continue;
            };
            let name = escaped(&row.pipeline);
            let _ = writeln!(page, "<details><summary>shaders of {name}</summary><dl>");
            for (pass, hash) in shaders {
                let hash = hash.as_str().unwrap_or_default();
                let _ = writeln!(
                    page,
                    "<dt>{}</dt><dd><code>{}</code></dd>",
                    escaped(pass),
                    escaped(hash)
                );
            }
            page.push_str("</dl></details>\n");
        }
    });
}

/// Text that may stand in HTML, attributes in double quotes included.
pub(crate) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            other => safe.push(other),
        }
    }
    safe
}
