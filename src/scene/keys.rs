//! Number of different keys of a TOML text, counted without a parser, which would keep them all in memory.

use std::collections::HashSet;

/// Returns `true` if a TOML text has more than `most` different keys. The keys of all tables count together, as do
/// the names in headers; each part of a dotted key counts. Comments and strings do not count. The result has no
/// meaning for a text that is not TOML.
pub(super) fn has_more_different(text: &str, most: usize) -> bool {
    let mut known = HashSet::new();
    let mut parts = keys(text).flat_map(|key| key.split('.'));
    parts.any(|part| known.insert(part.trim()) && known.len() > most)
}

/// The keys of a text as they are written: the text before an equals sign, and the text within the brackets of a header.
fn keys(text: &str) -> impl Iterator<Item = &str> {
    let bytes = text.as_bytes();
    // `begin`: start of the text that may be a key; `depth`: number of open brackets.
    let (mut at, mut begin, mut depth) = (0, 0, 0_usize);
    std::iter::from_fn(move || {
        while let Some(&byte) = bytes.get(at) {
            let start = at;
            at += 1;
            match byte {
                b'#' => at = line_end(bytes, at),
                b'"' | b'\'' => at = string_end(bytes, start),
                b'=' => {
                    let key = text[begin..start].trim();
                    // No key comes before the value, and no header begins in it.
                    begin = start;
                    return Some(key);
                }
                b'[' if depth == 0 && text[begin..start].trim().is_empty() => {
                    let end = line_end(bytes, at);
                    let header = text[at..end].trim_start_matches('[').split(']').next();
                    (at, begin) = (end, end);
                    return header;
                }
                b'[' | b'{' => (depth, begin) = (depth + 1, at),
                b']' | b'}' => (depth, begin) = (depth.saturating_sub(1), at),
                b',' | b'\n' => begin = at,
                _ => {}
            }
        }
        None
    })
}

/// End of the line that contains the position `at`.
fn line_end(bytes: &[u8], at: usize) -> usize {
    bytes[at..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |length| at + length)
}

/// End of the string that begins at `start` with one quotation mark or three; up to two more marks may precede the
/// last three. An unclosed string of one mark ends with its line.
fn string_end(bytes: &[u8], start: usize) -> usize {
    let mark = bytes[start];
    let is_long = bytes[start..].starts_with(&[mark; 3]);
    let mut at = start + if is_long { 3 } else { 1 };
    while let Some(&byte) = bytes.get(at) {
        if byte == b'\\' && mark == b'"' {
            at += 2;
        } else if is_long && bytes[at..].starts_with(&[mark; 3]) {
            let more = bytes[at + 3..].iter().take(2).take_while(|byte| **byte == mark).count();
            return at + 3 + more;
        } else if !is_long && byte == b'\n' {
            return at;
        } else if !is_long && byte == mark {
            return at + 1;
        } else {
            at += 1;
        }
    }
    bytes.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<&str> {
        keys(text).collect()
    }

    #[test]
    fn keys_are_what_stands_before_equals_signs_and_in_headers() {
        let text = r#"
            a = 1 # b = 2
            [c]
            "d e" = 'f = 3'
            g.h= [ # i = 4
              [1, 2],
            ]
            [[ j ]]
            k = {l = 1, m="\"n="}
        "#;
        assert_eq!(found(text), ["a", "c", "\"d e\"", "g.h", " j ", "k", "l", "m"]);
    }

    #[test]
    fn long_strings_have_no_keys() {
        let text = "a = \"\"\"\nb = 1\n\\\"\"\" c = 2 \"\"\"\nd = '''\ne = 1 \\'''\nf = 1";
        assert_eq!(found(text), ["a", "d", "f"]);
        let quoted = r#"a = { b = """c"""", d = 1, e = '''f''''', g = 1 }"#.replace("\\'", "'");
        assert_eq!(found(&quoted), ["a", "b", "d", "e", "g"]);
    }

    #[test]
    fn lists_over_several_lines_have_no_headers() {
        let text = "points = [\n  [0.0, 1.0],\n  [1.0, 2.0],\n]\nmass = [\n  { x = 1 },\n  { x = 2 },\n]\n";
        assert_eq!(found(text), ["points", "mass", "x", "x"]);
        assert!(has_more_different(text, 2) && !has_more_different(text, 3));
    }

    #[test]
    fn a_text_that_is_cut_short_anywhere_has_an_end() {
        let text = "a = \"\\µ\" # µ\n[b]\n'µ' = '''µ''' \n\"\"\"µ\\";
        for end in text.char_indices().map(|(end, _)| end).chain([text.len()]) {
            let _ = found(&text[..end]);
        }
    }
}
