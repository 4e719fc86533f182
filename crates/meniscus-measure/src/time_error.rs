//! The plane of run time and error, drawn as SVG.
//!
//! Written out here rather than by a plotting library: the one light library that is kept weighs
//! ninety thousand lines and most of a minute of building, for a scatter plot.

use std::fmt::Write as _;

use crate::MeasureError;
use crate::axes::{Area, Axis, escaped, plain};

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

const AREA: Area = Area {
    width: 760.0,
    height: 500.0,
    left: 84.0,
    right: 736.0,
    top: 48.0,
    bottom: 436.0,
};
/// What stands under the axis to the right.
const TIME_AXIS: &str = "time per frame in ms, with its 10th to 90th percentile";
const LETTER: f64 = 6.4;
const LINE: f64 = 14.0;

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
    plane_figure(title, [TIME_AXIS, error_axis], points)
}

/// The same with other words under the axes: to the right, upwards. Times may then be in another
/// unit.
///
/// # Errors
/// As [`time_error_figure`].
pub fn plane_figure(
    title: &str,
    axes: [&str; 2],
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
    let x = Axis::holding(times, AREA.left, AREA.right);
    let y = Axis::holding(points.iter().map(|p| drawn(p.error)), AREA.bottom, AREA.top);
    let front = pareto_front(points);

    let mut svg = AREA.begin(title, axes);
    AREA.write_upright(&mut svg, &x);
    AREA.write_level(&mut svg, &y);
    let places: Vec<[f64; 2]> = points
        .iter()
        .map(|p| [x.at(p.ms), y.at(drawn(p.error))])
        .collect();
    // Writing to a String cannot fail.
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

fn write_front(svg: &mut String, front: &[usize], places: &[[f64; 2]]) -> std::fmt::Result {
    let Some(([x, y], rest)) = front.split_first().map(|(i, rest)| (places[*i], rest)) else {
        return Ok(());
    };
    // Nothing is known between two points, so the front goes by steps.
    write!(
        svg,
        r##"<path fill="none" stroke="#0a6e8a" stroke-dasharray="5 3" d="M{x:.1} {}V{y:.1}"##,
        AREA.top
    )?;
    for i in rest {
        let [x, y] = places[*i];
        write!(svg, "H{x:.1}V{y:.1}")?;
    }
    writeln!(
        svg,
        r##"H{}"><title>Pareto front</title></path>"##,
        AREA.right
    )
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
    type Place = [f64; 4];
    let overlap = |a: &Place, b: &Place| a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
    let mut taken: Vec<Place> = places
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
        let inside = |b: &Place| {
            b[0] >= AREA.left && b[2] <= AREA.right && b[1] >= AREA.top && b[3] <= AREA.bottom
        };
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

#[cfg(test)]
#[path = "time_error_tests.rs"]
mod tests;
