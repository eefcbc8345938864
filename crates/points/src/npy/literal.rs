//! Python literals, as NumPy writes them above an array.

/// Deepest nesting that is read.
const DEEPEST: u32 = 16;

/// A literal.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Literal {
    Text(String),
    Number(i64),
    Bool(bool),
    None,
    /// A list or a tuple.
    List(Vec<Literal>),
    /// In the order of the text.
    Dict(Vec<(Literal, Literal)>),
}

/// The literal that a text is, blanks around it aside; `None` if it is none.
pub(super) fn parse(text: &str) -> Option<Literal> {
    let mut parser = Parser { rest: text };
    let literal = parser.literal(DEEPEST)?;
    parser.skip_blanks();
    parser.rest.is_empty().then_some(literal)
}

struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    fn skip_blanks(&mut self) {
        self.rest = self.rest.trim_start();
    }

    /// Passes over blanks and a sign, if the sign comes next.
    fn eat(&mut self, sign: char) -> bool {
        self.skip_blanks();
        let rest = self.rest.strip_prefix(sign);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn literal(&mut self, depth: u32) -> Option<Literal> {
        let depth = depth.checked_sub(1)?;
        self.skip_blanks();
        match self.rest.chars().next()? {
            '{' => self.dict(depth),
            '[' => self.list(']', depth),
            '(' => self.list(')', depth),
            '\'' | '"' => self.text().map(Literal::Text),
            '-' | '0'..='9' => self.number(),
            _ => self.word(),
        }
    }

    fn dict(&mut self, depth: u32) -> Option<Literal> {
        let mut entries = Vec::new();
        self.eat('{');
        while !self.eat('}') {
            let key = self.literal(depth)?;
            self.eat(':').then_some(())?;
            entries.push((key, self.literal(depth)?));
            if !self.eat(',') {
                return self.eat('}').then_some(Literal::Dict(entries));
            }
        }
        Some(Literal::Dict(entries))
    }

    /// A list, a tuple, or a literal in brackets.
    fn list(&mut self, end: char, depth: u32) -> Option<Literal> {
        let mut items = Vec::new();
        self.rest = &self.rest[1..];
        while !self.eat(end) {
            items.push(self.literal(depth)?);
            if !self.eat(',') {
                self.eat(end).then_some(())?;
                let alone = end == ')' && items.len() == 1;
                return if alone { items.pop() } else { Some(Literal::List(items)) };
            }
        }
        Some(Literal::List(items))
    }

    /// A string, with the escapes that NumPy writes.
    fn text(&mut self) -> Option<String> {
        let mut chars = self.rest.chars();
        let quote = chars.next()?;
        let mut text = String::new();
        loop {
            match chars.next()? {
                '\\' => match chars.next()? {
                    'n' => text.push('\n'),
                    't' => text.push('\t'),
                    'x' => text.push(code(&mut chars, 2)?),
                    'u' => text.push(code(&mut chars, 4)?),
                    other => text.push(other),
                },
                end if end == quote => break,
                other => text.push(other),
            }
        }
        self.rest = chars.as_str();
        Some(text)
    }

    /// A whole number; those of Python 2 may end with L.
    fn number(&mut self) -> Option<Literal> {
        let digits = self.rest[1..].find(|c: char| !c.is_ascii_digit());
        let (number, rest) =
            self.rest.split_at(digits.map_or(self.rest.len(), |digits| digits + 1));
        self.rest = rest.strip_prefix('L').unwrap_or(rest);
        number.parse().ok().map(Literal::Number)
    }

    /// True, False, None, or the letter before a string.
    fn word(&mut self) -> Option<Literal> {
        let end = self.rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        match word {
            "True" => Some(Literal::Bool(true)),
            "False" => Some(Literal::Bool(false)),
            "None" => Some(Literal::None),
            "u" | "b" if rest.starts_with(['\'', '"']) => self.text().map(Literal::Text),
            _ => None,
        }
    }
}

/// The character of so many hexadecimal digits.
fn code(chars: &mut std::str::Chars<'_>, digits: usize) -> Option<char> {
    let text: String = chars.take(digits).collect();
    char::from_u32(u32::from_str_radix(&text, 16).ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_of_numpy_are_read() {
        let text = "{'descr': [('x', '<f4'), (('a \\'title\\'', u'y'), \"<f8\", (2, 3L))], \
                    'fortran_order': False, 'shape': (10,), } \n";
        let text_of = |text: &str| Literal::Text(text.to_owned());
        let expected = Literal::Dict(vec![
            (
                text_of("descr"),
                Literal::List(vec![
                    Literal::List(vec![text_of("x"), text_of("<f4")]),
                    Literal::List(vec![
                        Literal::List(vec![text_of("a 'title'"), text_of("y")]),
                        text_of("<f8"),
                        Literal::List(vec![Literal::Number(2), Literal::Number(3)]),
                    ]),
                ]),
            ),
            (text_of("fortran_order"), Literal::Bool(false)),
            (text_of("shape"), Literal::List(vec![Literal::Number(10)])),
        ]);
        assert_eq!(parse(text), Some(expected));
        assert_eq!(parse("()"), Some(Literal::List(Vec::new())));
        assert_eq!(parse("(7)"), Some(Literal::Number(7)));
        assert_eq!(parse("'\\x41\\u00e9'"), Some(text_of("A\u{e9}")));
    }

    #[test]
    fn what_is_no_literal_is_refused() {
        for text in [
            "",
            "{",
            "{'a'}",
            "{'a': 1",
            "[1, 2",
            "(1 2)",
            "'a",
            "'\\x4'",
            "1.5",
            "-",
            "True1",
            "a",
            "__import__('os')",
            "99999999999999999999",
            "[1] 2",
            "\u{e9}",
            "-\u{e9}",
        ] {
            assert_eq!(parse(text), None, "{text}");
        }
        assert_eq!(parse(&"[".repeat(1_000_000)), None);
    }
}
