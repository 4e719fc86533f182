//! Numbers as people read them.

/// Three significant digits, never in powers of ten unless tiny.
pub(crate) fn digits(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 {
        "0".into()
    } else if size < 1e-4 {
        format!("{x:.0e}")
    } else {
        let whole = size.log10().floor() as i32;
        format!("{x:.*}", (2 - whole).clamp(0, 5) as usize)
    }
}

/// A share in percent. What is not all or nothing never looks like it: 99.999 % is not 100 %.
pub(crate) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    for decimals in 2..=6 {
        let text = format!("{percent:.decimals$}");
        let shown: f64 = text.parse().unwrap_or(percent);
        if (shown != 100.0 || share == 1.0) && (shown != 0.0 || share == 0.0) {
            return format!("{text} %");
        }
    }
    format!("{percent} %")
}

/// Bytes in binary units, three digits.
pub(crate) fn bytes(bytes: f64) -> String {
    let units = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut size = bytes;
    let mut unit = 0;
    while size.abs() >= 1024.0 && unit + 1 < units.len() {
        size /= 1024.0;
        unit += 1;
    }
    match unit {
        0 => format!("{size} {}", units[0]),
        _ => format!("{} {}", digits(size), units[unit]),
    }
}

/// A count with thin gaps between the thousands.
pub(crate) fn count(count: u64) -> String {
    let plain = count.to_string();
    let mut text = String::new();
    for (index, digit) in plain.chars().enumerate() {
        if index > 0 && (plain.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearly_all_is_not_shown_as_all() {
        assert_eq!(percent(1.0), "100.00 %");
        assert_eq!(percent(0.0), "0.00 %");
        assert_eq!(percent(0.999_99), "99.999 %");
        assert_eq!(percent(0.000_01), "0.001 %");
        assert_eq!(percent(0.5), "50.00 %");
    }

    #[test]
    fn three_digits_are_kept_at_every_size() {
        let shown = [1234.5, 12.345, 1.2345, 0.123_45, 0.001_234_5, 0.0, 1e-7].map(digits);
        assert_eq!(
            shown,
            ["1234", "12.3", "1.23", "0.123", "0.00123", "0", "1e-7"]
        );
    }

    #[test]
    fn bytes_and_counts_are_readable_at_every_size() {
        let shown = [0.0, 1023.0, 2048.0, 5.5 * 1048576.0, 3e15].map(bytes);
        assert_eq!(shown, ["0 B", "1023 B", "2.00 KiB", "5.50 MiB", "2728 TiB"]);
        let shown = [0, 999, 1000, 1_234_567].map(count);
        assert_eq!(
            shown,
            ["0", "999", "1\u{202f}000", "1\u{202f}234\u{202f}567"]
        );
    }
}
