//! Lines and numbers of text files.

use std::borrow::Cow;

/// The lines of a text file: their numbers, counted from 1, and their text without the line end (LF or CRLF). Bytes that are
/// not UTF-8 become replacement characters, which no number contains. No line follows the last line end.
pub(crate) fn lines(content: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    content.split_inclusive(|&byte| byte == b'\n').enumerate().map(|(index, line)| {
        let line = line.strip_suffix(b"\n").unwrap_or(line);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        (index + 1, String::from_utf8_lossy(line))
    })
}

/// A real number, with spaces around it, as C or Fortran writes it: `1.5e3`, `1.5D+03`, `1.5Q3`, or `1.5+103`, where Fortran
/// has no room for the letter. `NaN`, `inf` and numbers too large for a double become values that are not finite.
pub(crate) fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    let exponent = text.char_indices().skip(1).find(|&(_, c)| "dDqQ+-".contains(c));
    let (at, letter) = exponent?;
    let (mantissa, exponent) = text.split_at(at);
    let exponent = if letter.is_ascii_alphabetic() { &exponent[1..] } else { exponent };
    format!("{mantissa}e{exponent}").parse().ok()
}

/// A whole number, with spaces around it.
pub(crate) fn integer(text: &str) -> Option<i64> {
    text.trim().parse().ok()
}

/// A text of a file as a message quotes it: cut after 40 characters.
pub(crate) fn quote(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("`{}…`", &text[..end]),
        None => format!("`{text}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_c_and_fortran_are_read() {
        let numbers = [
            ("1.5e3", 1500.0),
            (" -1.5D+03 ", -1500.0),
            ("1.5d3", 1500.0),
            ("1.5Q-1", 0.15),
            ("1.5+103", 1.5e103),
            ("-1.5-103", -1.5e-103),
            ("+.5", 0.5),
            ("7", 7.0),
            ("1.+3", 1000.0),
            ("1e999", f64::INFINITY),
        ];
        for (text, value) in numbers {
            assert_eq!(number(text), Some(value), "{text}");
        }
        assert!(number("NaN").is_some_and(f64::is_nan));
        for text in ["", " ", "x", "+", "-", "1.5D", "1.5e3+3", "1.5 3", "é+3", "1,5", "0x10"] {
            assert_eq!(number(text), None, "{text}");
        }
    }

    #[test]
    fn lines_end_with_or_without_a_carriage_return() {
        let lines: Vec<_> =
            lines(b"a\r\n\nb\xff\nc").map(|(line, text)| (line, text.into_owned())).collect();
        let expected = [(1, "a"), (2, ""), (3, "b\u{fffd}"), (4, "c")];
        assert_eq!(lines, expected.map(|(line, text)| (line, text.to_owned())));
    }

    #[test]
    fn a_long_text_is_quoted_in_part() {
        assert_eq!(quote("ab"), "`ab`");
        assert_eq!(quote(&"é".repeat(50)), format!("`{}…`", "é".repeat(40)));
    }
}
