//! What the readers of text share.

use std::borrow::Cow;

/// Text of any encoding whose words and numbers are ASCII, without byte order mark; bytes that are not UTF-8 (old
/// comments) are replaced, and so are the ends of lines where all are carriage returns.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    let text = String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
    if text.contains('\r') && !text.contains('\n') { Cow::Owned(text.replace('\r', "\n")) } else { text }
}

/// A real number as programs write it, also one that is not finite, for which C libraries have words of their own:
/// `nan`, `-inf`, `nan(ind)`, `-1.#IND`, `1.#INF`.
#[cfg(any(feature = "ply", feature = "obj"))]
pub(super) fn real(word: &str) -> Option<f64> {
    if let Ok(number) = word.parse() {
        return Some(number);
    }
    let (sign, word) = match word.strip_prefix('-') {
        Some(word) => (-1.0, word),
        None => (1.0, word.strip_prefix('+').unwrap_or(word)),
    };
    let word = word.to_ascii_lowercase();
    if word.starts_with("nan(") && word.ends_with(')') {
        return Some(f64::NAN);
    }
    // Cut to a width, they have zeros behind them.
    match word.strip_prefix("1.#")?.trim_end_matches('0') {
        "inf" => Some(sign * f64::INFINITY),
        "ind" | "nan" | "qnan" | "snan" => Some(f64::NAN),
        _ => None,
    }
}

#[cfg(all(test, any(feature = "ply", feature = "obj")))]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_not_finite() {
        for word in ["nan", "-NaN", "nan(ind)", "-nan(ind)", "NAN(0x1)", "-1.#IND", "1.#QNAN0", "1.#SNAN"] {
            assert!(real(word).is_some_and(f64::is_nan), "{word}");
        }
        for (word, number) in
            [("inf", f64::INFINITY), ("-Infinity", f64::NEG_INFINITY), ("-1.#INF00", f64::NEG_INFINITY)]
        {
            assert_eq!(real(word), Some(number), "{word}");
        }
        for (word, number) in [("0.", 0.0), (".5", 0.5), ("+1.0E+00", 1.0), ("-.5e-1", -0.05)] {
            assert_eq!(real(word), Some(number), "{word}");
        }
        for word in ["", "-", "two", "1.#", "1.#X", "nan(", "1,5", "0x10"] {
            assert_eq!(real(word), None, "{word}");
        }
    }

    #[test]
    fn lines_that_end_in_carriage_returns() {
        assert_eq!(text(b"\xef\xbb\xbfa\rb\r"), "a\nb\n");
        assert_eq!(text(b"a\r\nb\r"), "a\r\nb\r");
        assert!(matches!(text(b"a b"), Cow::Borrowed("a b")));
    }
}
