//! The plane of run time and error, drawn as SVG.
//!
//! Written out here rather than by a plotting library: the one light library that is kept weighs
//! ninety thousand lines and most of a minute of building, for a scatter plot.

use std::fmt::Write as _;

use crate::MeasureError;

/// One pipeline on the plane of time and error.
#[derive(Debug, Clone, PartialEq)]
pub struct FigurePoint {
    /// What is written beside the point.
    pub label: String,
    /// Time of a frame in milliseconds, positive.
    pub ms: f64,
    /// The spread of that time, low and high, in milliseconds; drawn as a bar.
    pub spread_ms: [f64; 2],
    /// The error, not negative. No error at all, for which a logarithmic axis has no place, is drawn
    /// a decade below the smallest error, and said beside the label.
    pub error: f64,
}

/// Which points nobody beats: no other is as fast and as right, and better in one of the two.
///
/// Indices into `points`, by rising time.
pub fn pareto_front(points: &[FigurePoint]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| {
        let (a, b) = (&points[*a], &points[*b]);
        a.ms.total_cmp(&b.ms).then(a.error.total_cmp(&b.error))
    });
    let mut front: Vec<usize> = Vec::new();
    for i in order {
        let beaten = front.last().is_some_and(|last| {
            let (best, point) = (&points[*last], &points[i]);
            // Twins share a place on the front.
            best.error <= point.error && (best.ms, best.error) != (point.ms, point.error)
        });
        if !beaten {
            front.push(i);
        }
    }
    front
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 500.0;
const LEFT: f64 = 84.0;
const RIGHT: f64 = 736.0;
const TOP: f64 = 48.0;
const BOTTOM: f64 = 436.0;
const LETTER: f64 = 6.4;
const LINE: f64 = 14.0;

/// A logarithmic axis: a range of numbers onto a range of the picture.
pub(crate) struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// An axis that holds all `values` (positive) with room at both ends.
    pub fn holding(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
        // At least a factor of four, so that equal values do not blow up the axis.
        let middle = (low.ln() + high.ln()) / 2.0;
        let half = ((high / low).ln() / 2.0 * 1.12).max(4f64.ln() / 2.0);
        Self {
            low: (middle - half).exp(),
            high: (middle + half).exp(),
            from,
            to,
        }
    }

    pub fn at(&self, value: f64) -> f64 {
        let share = (value / self.low).ln() / (self.high / self.low).ln();
        self.from + share * (self.to - self.from)
    }

    /// Powers of ten, and 2 and 5 times them where the axis is short.
    pub fn ticks(&self) -> Vec<f64> {
        let decades = (self.high / self.low).log10();
        let steps: &[f64] = if decades > 4.0 {
            &[1.0]
        } else {
            &[1.0, 2.0, 5.0]
        };
        let first = self.low.log10().floor() as i32;
        let last = self.high.log10().ceil() as i32;
        let stride = ((last - first) / 12).max(1) as usize;
        (first..=last)
            .step_by(stride)
            .flat_map(|e| steps.iter().map(move |s| s * 10f64.powi(e)))
            .filter(|v| (self.low..=self.high).contains(v))
            .collect()
    }
}

/// Draws points on logarithmic axes: time to the right, error upwards, so that better is lower left.
///
/// Points of the Pareto front are filled and joined by steps; the others are hollow.
/// `error_axis` names the error and its unit.
///
/// # Errors
/// [`MeasureError::Value`] when there is no point, or a time or an error cannot be drawn.
pub fn time_error_figure(
    title: &str,
    error_axis: &str,
    points: &[FigurePoint],
) -> Result<String, MeasureError> {
    check(points)?;
    let smallest = points
        .iter()
        .map(|p| p.error)
        .filter(|e| *e > 0.0)
        .fold(f64::INFINITY, f64::min);
    // Where no error at all is drawn: well below the smallest.
    let floor = if smallest.is_finite() {
        smallest / 10.0
    } else {
        1.0
    };
    let drawn = |error: f64| if error > 0.0 { error } else { floor };
    let times = points
        .iter()
        .flat_map(|p| [p.ms, p.spread_ms[0], p.spread_ms[1]]);
    let x = Axis::holding(times, LEFT, RIGHT);
    let y = Axis::holding(points.iter().map(|p| drawn(p.error)), BOTTOM, TOP);
    let front = pareto_front(points);

    let mut svg = String::new();
    // Writing to a String cannot fail.
    let _ = write_frame(&mut svg, title, error_axis, &x, &y);
    let places: Vec<[f64; 2]> = points
        .iter()
        .map(|p| [x.at(p.ms), y.at(drawn(p.error))])
        .collect();
    let _ = write_front(&mut svg, &front, &places);
    let labels = place_labels(points, &places);
    for (i, point) in points.iter().enumerate() {
        let _ = write_point(&mut svg, point, places[i], &x, front.contains(&i));
    }
    for (point, place) in points.iter().zip(labels) {
        let _ = write_label(&mut svg, point, place);
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn check(points: &[FigurePoint]) -> Result<(), MeasureError> {
    if points.is_empty() {
        return Err(MeasureError::value(
            "figure of time against error",
            "there is no point",
        ));
    }
    for p in points {
        let times = [p.ms, p.spread_ms[0], p.spread_ms[1]];
        // Beyond this range the logarithms of the axes run out of numbers.
        let drawable = |v: &f64| (1e-100..=1e100).contains(v);
        if !times.iter().all(drawable) || !(p.error == 0.0 || drawable(&p.error)) {
            return Err(MeasureError::value(
                format!("{} in the figure of time against error", p.label),
                format!("{times:?} ms with an error of {} cannot be drawn", p.error),
            ));
        }
    }
    Ok(())
}

fn write_frame(
    svg: &mut String,
    title: &str,
    error_axis: &str,
    x: &Axis,
    y: &Axis,
) -> std::fmt::Result {
    writeln!(
        svg,
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="12" fill="#222">
<title>{0}</title>
<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>
<text x="{LEFT}" y="24" font-size="15" font-weight="bold">{0}</text>
<g stroke="#ddd">"##,
        escaped(title)
    )?;
    for tick in x.ticks() {
        writeln!(svg, r#"<path d="M{0:.1} {TOP}V{BOTTOM}"/>"#, x.at(tick))?;
    }
    for tick in y.ticks() {
        writeln!(svg, r#"<path d="M{LEFT} {0:.1}H{RIGHT}"/>"#, y.at(tick))?;
    }
    writeln!(svg, r#"</g><g text-anchor="middle">"#)?;
    for tick in x.ticks() {
        writeln!(
            svg,
            r#"<text x="{:.1}" y="{}">{tick}</text>"#,
            x.at(tick),
            BOTTOM + 18.0
        )?;
    }
    writeln!(
        svg,
        r#"<text x="{}" y="{}">time per frame in ms, with its 10th to 90th percentile</text></g><g text-anchor="end">"#,
        (LEFT + RIGHT) / 2.0,
        BOTTOM + 40.0
    )?;
    for tick in y.ticks() {
        writeln!(
            svg,
            r#"<text x="{}" y="{:.1}">{}</text>"#,
            LEFT - 8.0,
            y.at(tick) + 4.0,
            plain(tick)
        )?;
    }
    let middle = (TOP + BOTTOM) / 2.0;
    writeln!(
        svg,
        r##"</g><text transform="translate(20 {middle}) rotate(-90)" text-anchor="middle">{}</text>
<rect x="{LEFT}" y="{TOP}" width="{}" height="{}" fill="none" stroke="#222"/>"##,
        escaped(error_axis),
        RIGHT - LEFT,
        BOTTOM - TOP
    )
}

fn write_front(svg: &mut String, front: &[usize], places: &[[f64; 2]]) -> std::fmt::Result {
    let Some(([x, y], rest)) = front.split_first().map(|(i, rest)| (places[*i], rest)) else {
        return Ok(());
    };
    // Nothing is known between two points, so the front goes by steps.
    write!(
        svg,
        r##"<path fill="none" stroke="#0a6e8a" stroke-dasharray="5 3" d="M{x:.1} {TOP}V{y:.1}"##
    )?;
    for i in rest {
        let [x, y] = places[*i];
        write!(svg, "H{x:.1}V{y:.1}")?;
    }
    writeln!(svg, r##"H{RIGHT}"><title>Pareto front</title></path>"##)
}

fn write_point(
    svg: &mut String,
    point: &FigurePoint,
    [px, py]: [f64; 2],
    x: &Axis,
    on_front: bool,
) -> std::fmt::Result {
    let fill = if on_front { "#0a6e8a" } else { "#fff" };
    let name = escaped(&shown_label(point));
    writeln!(
        svg,
        r##"<g><title>{name}: {} ms, error {}</title><path stroke="#0a6e8a" d="M{:.1} {py:.1}H{:.1}"/><circle cx="{px:.1}" cy="{py:.1}" r="5" fill="{fill}" stroke="#0a6e8a" stroke-width="2"/></g>"##,
        plain(point.ms),
        plain(point.error),
        x.at(point.spread_ms[0]),
        x.at(point.spread_ms[1]),
    )
}

/// A label with a halo, so that it can be read where it crosses a line.
fn write_label(svg: &mut String, point: &FigurePoint, [x, y]: [f64; 2]) -> std::fmt::Result {
    writeln!(
        svg,
        r##"<text x="{x:.1}" y="{y:.1}" paint-order="stroke" stroke="#fff" stroke-width="3">{}</text>"##,
        escaped(&shown_label(point))
    )
}

fn shown_label(point: &FigurePoint) -> String {
    if point.error == 0.0 {
        format!("{} (no error)", point.label)
    } else {
        point.label.clone()
    }
}

/// Lower left corners of the labels: above or below each point, the first place that is free.
fn place_labels(points: &[FigurePoint], places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    type Area = [f64; 4];
    let overlap = |a: &Area, b: &Area| a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
    let mut taken: Vec<Area> = places
        .iter()
        .map(|[x, y]| [x - 6.0, y - 6.0, x + 6.0, y + 6.0])
        .collect();
    let mut found = Vec::with_capacity(points.len());
    for (point, [x, y]) in points.iter().zip(places) {
        let wide = shown_label(point).chars().count() as f64 * LETTER;
        let candidates: Vec<[f64; 2]> = (0..8)
            .flat_map(|ring| {
                let away = f64::from(ring) * LINE;
                [x + 5.0, x - 5.0 - wide, x - wide / 2.0]
                    .map(|left| [[left, y - 9.0 - away], [left, y + 19.0 + away]])
            })
            .flatten()
            .collect();
        let area = |[x, y]: &[f64; 2]| [*x, y - 11.0, x + wide, y + 3.0];
        let inside = |a: &Area| a[0] >= LEFT && a[2] <= RIGHT && a[1] >= TOP && a[3] <= BOTTOM;
        let free = |c: &&[f64; 2]| {
            let a = area(c);
            inside(&a) && !taken.iter().any(|t| overlap(t, &a))
        };
        let place = candidates
            .iter()
            .find(free)
            .copied()
            .unwrap_or(candidates[0]);
        taken.push(area(&place));
        found.push(place);
    }
    found
}

/// At most four significant digits, without trailing noughts.
pub(crate) fn plain(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    if (1e-4..1e6).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}

pub(crate) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            // XML has no way to write most control characters.
            c if c.is_control() => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
#[path = "time_error_tests.rs"]
mod tests;
