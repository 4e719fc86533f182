//! How figures change along a swept setting, drawn as SVG.

use std::fmt::Write as _;

use crate::MeasureError;
use crate::axes::{Area, Axis, escaped};

/// One line of a figure: a name, and a value at each place along the axis where there is one.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What is written at the line's end.
    pub label: String,
    /// A positive value for each place, in order.
    pub values: Vec<Option<f64>>,
}

const AREA: Area = Area {
    width: 760.0,
    height: 420.0,
    left: 84.0,
    right: 540.0,
    top: 48.0,
    bottom: 356.0,
};
const LINE: f64 = 14.0;
/// Apart in hue and in lightness (Okabe and Ito 2008), for those who tell few hues apart.
const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9", "#222222",
];

/// Draws curves over places that stand at equal distances, whatever their values, so that words and
/// noughts have a place too; upwards the axis is logarithmic. Between words (scenes, modules) there is
/// nothing, so their points are not joined.
///
/// # Errors
/// [`MeasureError::Value`] when there is nothing to draw, or a value is not positive and finite.
pub fn curves_figure(
    title: &str,
    [along, upwards]: [&str; 2],
    places: &[String],
    curves: &[Curve],
) -> Result<String, MeasureError> {
    let values = || {
        curves
            .iter()
            .flat_map(|curve| curve.values.iter().flatten().copied())
    };
    if let Some(wrong) = values().find(|value| !(1e-100..=1e100).contains(value)) {
        let problem = format!("{wrong} cannot be drawn on a logarithmic axis");
        return Err(MeasureError::value(title, problem));
    }
    if values().next().is_none() || places.is_empty() {
        return Err(MeasureError::value(title, "there is nothing to draw"));
    }
    let y = Axis::holding(values(), AREA.bottom, AREA.top);
    let step = (AREA.right - AREA.left) / places.len() as f64;
    let x = |place: usize| AREA.left + (place as f64 + 0.5) * step;
    let joined = places.iter().all(|place| is_number(place));
    let mut svg = AREA.begin(title, [along, upwards]);
    AREA.write_level(&mut svg, &y);
    for (index, place) in places.iter().enumerate() {
        AREA.write_under(&mut svg, x(index), place);
    }
    for (curve, at) in curves.iter().zip(label_heights(curves, &y)) {
        let index = curves
            .iter()
            .position(|c| std::ptr::eq(c, curve))
            .unwrap_or(0);
        let colour = COLOURS[index % COLOURS.len()];
        let label = escaped(&curve.label);
        let known = curve.values.iter().enumerate();
        let points: Vec<[f64; 2]> = known
            .filter_map(|(place, value)| Some([x(place), y.at((*value)?)]))
            .collect();
        // Writing to a String cannot fail.
        let _ = write!(
            svg,
            r#"<g stroke="{colour}" fill="{colour}"><title>{label}</title>"#
        );
        if joined {
            let line: Vec<String> = points
                .iter()
                .map(|[x, y]| format!("{x:.1},{y:.1}"))
                .collect();
            let _ = write!(
                svg,
                r#"<polyline fill="none" stroke-width="2" points="{}"/>"#,
                line.join(" ")
            );
        }
        for [x, y] in &points {
            let _ = write!(svg, r#"<circle cx="{x:.1}" cy="{y:.1}" r="3.5"/>"#);
        }
        if let Some([x, y]) = points.last() {
            let _ = write!(
                svg,
                r#"<path fill="none" stroke-width="0.7" d="M{x:.1} {y:.1}L{} {at:.1}"/><text x="{}" y="{:.1}" stroke="none">{label}</text>"#,
                AREA.right + 4.0,
                AREA.right + 8.0,
                at + 4.0
            );
        }
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// Whether a place reads as a number, be it with a suffix (16k).
fn is_number(place: &str) -> bool {
    let digits = place.trim_start_matches(['-', '+', '.']);
    digits.starts_with(|first: char| first.is_ascii_digit())
}

/// Where the labels stand: at their lines' ends, pushed down where another is in the way.
fn label_heights(curves: &[Curve], y: &Axis) -> Vec<f64> {
    let end = |curve: &Curve| {
        let last = curve.values.iter().flatten().last();
        last.map_or(AREA.bottom, |value| y.at(*value))
    };
    let mut order: Vec<usize> = (0..curves.len()).collect();
    order.sort_by(|a, b| end(&curves[*a]).total_cmp(&end(&curves[*b])));
    let mut heights = vec![0.0; curves.len()];
    let mut free = AREA.top;
    for index in order {
        heights[index] = end(&curves[index]).max(free);
        free = heights[index] + LINE;
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(label: &str, values: &[Option<f64>]) -> Curve {
        Curve {
            label: label.into(),
            values: values.into(),
        }
    }

    #[test]
    fn points_over_numbers_are_joined_and_those_over_words_are_not() {
        let curves = [curve("a", &[Some(1.0), Some(2.0)])];
        let lines = |places: [&str; 2]| {
            let svg = curves_figure("t", ["x", "y"], &places.map(str::to_owned), &curves);
            svg.unwrap().matches("<polyline").count()
        };
        assert_eq!(lines(["-0.5", "16k"]), 1);
        assert_eq!(lines(["pool", "clutter"]), 0);
    }

    #[test]
    fn every_value_is_a_point_and_gaps_are_none() {
        let curves = [
            curve("a<b", &[Some(1.0), None, Some(3.0)]),
            curve("flat", &[Some(2.0); 3]),
        ];
        let places = ["0", "x&y", "1M"].map(str::to_owned);
        let svg = curves_figure("t", ["along", "up"], &places, &curves).unwrap();
        assert_eq!(svg.matches("<circle").count(), 5);
        assert!(svg.contains("a&lt;b") && svg.contains("x&amp;y"), "{svg}");
    }

    #[test]
    fn labels_of_equal_lines_stand_apart() {
        let curves = [
            curve("a", &[Some(1.0)]),
            curve("b", &[Some(1.0)]),
            curve("c", &[Some(1.01)]),
        ];
        let y = Axis::holding([1.0, 1.01].into_iter(), AREA.bottom, AREA.top);
        let mut heights = label_heights(&curves, &y);
        heights.sort_by(f64::total_cmp);
        assert!(
            heights
                .windows(2)
                .all(|pair| pair[1] - pair[0] >= LINE - 1e-9)
        );
    }

    #[test]
    fn what_has_no_place_on_the_axis_is_refused() {
        let places = ["0".to_owned()];
        for wrong in [
            Some(0.0),
            Some(-1.0),
            Some(f64::NAN),
            Some(f64::INFINITY),
            None,
        ] {
            let curves = [curve("a", &[wrong])];
            assert!(
                curves_figure("t", ["", ""], &places, &curves).is_err(),
                "{wrong:?}"
            );
        }
    }
}
