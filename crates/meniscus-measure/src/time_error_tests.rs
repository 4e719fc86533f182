use super::*;
use proptest::prelude::*;

fn point(label: &str, ms: f64, error: f64) -> FigurePoint {
    FigurePoint {
        label: label.into(),
        ms,
        spread_ms: [ms * 0.9, ms * 1.2],
        error,
    }
}

/// All numbers of one attribute, in order.
fn numbers(svg: &str, tag: &str, attribute: &str) -> Vec<f64> {
    svg.split(&format!("<{tag} "))
        .skip(1)
        .filter_map(|t| {
            let rest = t.split(&format!("{attribute}=\"")).nth(1)?;
            rest.split('"').next()?.parse().ok()
        })
        .collect()
}

#[test]
fn equal_factors_are_equal_distances_on_both_axes() {
    let points = [
        point("a", 1.0, 0.01),
        point("b", 2.0, 0.1),
        point("c", 4.0, 1.0),
    ];
    let svg = time_error_figure("t", "error in px", &points).unwrap();
    for attribute in ["cx", "cy"] {
        let at = numbers(&svg, "circle", attribute);
        assert!((at[2] - at[1] - (at[1] - at[0])).abs() < 0.21, "{at:?}");
        assert!((at[1] - at[0]).abs() > 20.0);
    }
    let [x, y] = ["cx", "cy"].map(|a| numbers(&svg, "circle", a));
    assert!(
        x[0] < x[2] && y[0] > y[2],
        "faster is left, less wrong is lower"
    );
}

#[test]
fn no_error_at_all_is_drawn_inside_below_all_others() {
    let points = [point("exact", 9.0, 0.0), point("rough", 1.0, 0.5)];
    let svg = time_error_figure("t", "e", &points).unwrap();
    let y = numbers(&svg, "circle", "cy");
    assert!(y[0] > y[1] && y[0] < AREA.bottom);
    assert!(time_error_figure("t", "e", &[point("exact", 9.0, 0.0)]).is_ok());
}

#[test]
fn labels_do_not_lie_on_each_other() {
    let points: Vec<FigurePoint> = (0..8)
        .map(|i| point(&format!("pipeline-{i}"), 5.0 + 0.01 * f64::from(i), 1.0))
        .collect();
    let places: Vec<[f64; 2]> = (0..8).map(|i| [300.0 + f64::from(i), 200.0]).collect();
    let labels = place_labels(&points, &places);
    for (i, a) in labels.iter().enumerate() {
        for b in &labels[i + 1..] {
            assert!((a[1] - b[1]).abs() >= LINE - 1.0 || (a[0] - b[0]).abs() > 60.0);
        }
    }
}

#[test]
fn names_cannot_break_the_picture() {
    let svg = time_error_figure("<&\">", "\u{7}", &[point("a<b>&\"c\"", 1.0, 1.0)]).unwrap();
    assert!(svg.contains("a&lt;b&gt;&amp;&quot;c&quot;") && !svg.contains("a<b>"));
    assert!(svg.chars().all(|c| c == '\n' || !c.is_control()));
}

#[test]
fn what_cannot_be_drawn_is_refused_by_name() {
    assert!(time_error_figure("t", "e", &[]).is_err());
    for (ms, error) in [
        (0.0, 1.0),
        (-1.0, 1.0),
        (f64::NAN, 1.0),
        (1.0, f64::NAN),
        (1.0, -1.0),
        (1.0, f64::INFINITY),
        (f64::INFINITY, 1.0),
    ] {
        let said = time_error_figure("t", "e", &[point("culprit", ms, error)])
            .unwrap_err()
            .to_string();
        assert!(said.contains("culprit"), "{said}");
    }
}

proptest! {
    #[test]
    fn the_front_is_whom_nobody_beats(
        raw in prop::collection::vec((1u8..6, 0u8..6), 1..12),
    ) {
        let points: Vec<FigurePoint> = raw
            .iter()
            .map(|(ms, error)| point("p", f64::from(*ms), f64::from(*error)))
            .collect();
        let beaten = |i: usize| points.iter().any(|other| {
            let p = &points[i];
            other.ms <= p.ms && other.error <= p.error && (other.ms < p.ms || other.error < p.error)
        });
        let mut front = pareto_front(&points);
        front.sort_unstable();
        let expected: Vec<usize> = (0..points.len()).filter(|i| !beaten(*i)).collect();
        prop_assert_eq!(front, expected);
    }

    #[test]
    fn every_point_lands_inside_the_frame(
        raw in prop::collection::vec((-6.0f64..6.0, -9.0f64..6.0), 1..20),
    ) {
        let points: Vec<FigurePoint> = raw
            .iter()
            .map(|(ms, error)| point("p", 10f64.powf(*ms), 10f64.powf(*error)))
            .collect();
        let svg = time_error_figure("t", "e", &points).unwrap();
        prop_assert!(numbers(&svg, "circle", "cx").iter().all(|x| (AREA.left..=AREA.right).contains(x)));
        prop_assert!(numbers(&svg, "circle", "cy").iter().all(|y| (AREA.top..=AREA.bottom).contains(y)));
        prop_assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
