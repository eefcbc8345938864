//! Numbers as text has them.

/// Longest number with a decimal comma.
const LONGEST: usize = 64;

/// The number a word stands for. What stands for a missing one is NaN; `None` if the word is no
/// number. With `comma`, the decimal point is a comma.
pub(crate) fn number(word: &[u8], comma: bool) -> Option<f64> {
    if comma && word.contains(&b',') {
        let mut copy = [0; LONGEST];
        let copy = copy.get_mut(..word.len())?;
        copy.copy_from_slice(word);
        let place = copy.iter().position(|&byte| byte == b',')?;
        copy[place] = b'.';
        return plain(copy);
    }
    plain(word)
}

fn plain(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| odd(text))
}

/// Fortran's exponents, what C libraries print for NaN and infinity, and what spreadsheets and
/// statistics programs write for nothing.
fn odd(text: &str) -> Option<f64> {
    if text.is_empty() {
        return Some(f64::NAN);
    }
    let text = text.to_ascii_lowercase();
    let negative = text.starts_with('-');
    match text.trim_start_matches(['+', '-']) {
        "1.#inf" | "1.#inf00" if negative => Some(f64::NEG_INFINITY),
        "1.#inf" | "1.#inf00" => Some(f64::INFINITY),
        "na" | "n/a" | "#n/a" | "null" | "none" => Some(f64::NAN),
        text if text.starts_with("nan(") || text.starts_with("1.#") => Some(f64::NAN),
        unsigned if unsigned.starts_with(|c: char| c.is_ascii_digit() || c == '.') => {
            text.replacen('d', "e", 1).parse().ok()
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_all_spellings() {
        for (word, expected) in [
            ("1", 1.0),
            ("-1.5e-3", -0.0015),
            ("+.5", 0.5),
            ("5.", 5.0),
            ("1D+02", 100.0),
            ("-2.5d-1", -0.25),
            ("1e300", 1e300),
            ("1e999", f64::INFINITY),
            ("5e-324", 5e-324),
            ("-INF", f64::NEG_INFINITY),
            ("-1.#INF", f64::NEG_INFINITY),
            ("123456789.123456789", 123_456_789.123_456_79),
        ] {
            assert_eq!(number(word.as_bytes(), false), Some(expected), "{word}");
        }
        for word in ["nan", "NaN", "-nan(ind)", "1.#QNAN", "", "NA", "null"] {
            assert!(number(word.as_bytes(), false).is_some_and(f64::is_nan), "{word}");
        }
        for word in ["a", "1,5", "0x10", "1.2.3", "--1", "-", "d", "1e", "id5", "\u{661}"] {
            assert_eq!(number(word.as_bytes(), false), None, "{word}");
        }
        assert_eq!(number(b"-1,5e1", true), Some(-15.0));
        assert_eq!(number(b"1.5", true), Some(1.5));
        assert_eq!(number(b"1,000,000", true), None);
        assert_eq!(number(&[b','; 100], true), None);
    }
}
