//! What figures have in common: a frame with its title and axes, drawn as SVG.

use std::fmt::Write as _;

/// A figure, and the part of it in which is drawn; all in pixels.
pub(crate) struct Area {
    pub width: f64,
    pub height: f64,
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl Area {
    /// The beginning of an SVG, left open: title, names of the axes (to the right and upwards) and
    /// the frame.
    pub fn begin(&self, title: &str, [along, upwards]: [&str; 2]) -> String {
        let Self {
            width,
            height,
            left,
            right,
            top,
            bottom,
        } = self;
        format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-family="sans-serif" font-size="12" fill="#222">
<title>{0}</title><rect width="{width}" height="{height}" fill="#fff"/>
<text x="{left}" y="24" font-size="15" font-weight="bold">{0}</text>
<rect x="{left}" y="{top}" width="{1}" height="{2}" fill="none" stroke="#222"/>
<text x="{3}" y="{4}" text-anchor="middle">{5}</text>
<text transform="translate(20 {6}) rotate(-90)" text-anchor="middle">{7}</text>
"##,
            escaped(title),
            right - left,
            bottom - top,
            (left + right) / 2.0,
            bottom + 40.0,
            escaped(along),
            (top + bottom) / 2.0,
            escaped(upwards),
        )
    }

    /// A level line with its number for each tick of an upright axis.
    pub fn write_level(&self, svg: &mut String, y: &Axis) {
        for tick in y.ticks() {
            let at = y.at(tick);
            // Writing to a String cannot fail.
            let _ = writeln!(
                svg,
                r##"<path stroke="#ddd" d="M{} {at:.1}H{}"/><text x="{}" y="{:.1}" text-anchor="end">{}</text>"##,
                self.left,
                self.right,
                self.left - 8.0,
                at + 4.0,
                plain(tick)
            );
        }
    }

    /// An upright line with its number for each tick of a level axis.
    pub fn write_upright(&self, svg: &mut String, x: &Axis) {
        for tick in x.ticks() {
            let at = x.at(tick);
            let _ = writeln!(
                svg,
                r##"<path stroke="#ddd" d="M{at:.1} {}V{}"/>"##,
                self.top, self.bottom
            );
            self.write_under(svg, at, &plain(tick));
        }
    }

    /// Words under the frame.
    pub fn write_under(&self, svg: &mut String, x: f64, words: &str) {
        let _ = writeln!(
            svg,
            r#"<text x="{x:.1}" y="{}" text-anchor="middle">{}</text>"#,
            self.bottom + 18.0,
            escaped(words)
        );
    }
}

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
