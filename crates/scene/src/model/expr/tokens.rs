//! Numbers, names and symbols of an expression.

use std::fmt;

/// A token.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Token {
    Number(f64),
    Name(String),
    Symbol(&'static str),
    End,
}

impl fmt::Display for Token {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Token::Number(v) => write!(out, "`{v}`"),
            Token::Name(name) => write!(out, "`{name}`"),
            Token::Symbol(s) => write!(out, "`{s}`"),
            Token::End => out.write_str("the end"),
        }
    }
}

/// Longer symbols first, so that `<=` is not read as `<`.
const SYMBOLS: [&str; 18] = [
    "<=", ">=", "==", "!=", "&&", "||", "**", "+", "-", "*", "/", "^", "(", ")", ",", "<", ">", "!",
];

/// The tokens of `text`, each with the number (from 1) of its first character.
pub(crate) fn tokenise(text: &str) -> Result<Vec<(usize, Token)>, String> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let place = text[..at].chars().count() + 1;
        if c.is_whitespace() {
            at += c.len_utf8();
        } else if c.is_ascii_digit() || c == '.' {
            let length = number_length(rest);
            let value: f64 = rest[..length]
                .parse()
                .map_err(|_| format!("`{}` at character {place} is no number", &rest[..length]))?;
            if !value.is_finite() {
                return Err(format!(
                    "`{}` at character {place} is too large",
                    &rest[..length]
                ));
            }
            tokens.push((place, Token::Number(value)));
            at += length;
        } else if c.is_alphabetic() || c == '_' {
            let length = rest
                .find(|c: char| !c.is_alphanumeric() && c != '_')
                .unwrap_or(rest.len());
            tokens.push((place, Token::Name(rest[..length].to_string())));
            at += length;
        } else if let Some(symbol) = SYMBOLS.iter().find(|s| rest.starts_with(**s)) {
            tokens.push((
                place,
                Token::Symbol(if *symbol == "**" { "^" } else { symbol }),
            ));
            at += symbol.len();
        } else {
            return Err(format!("`{c}` at character {place} has no meaning"));
        }
    }
    tokens.push((text.chars().count() + 1, Token::End));
    Ok(tokens)
}

/// Length in bytes of the decimal number at the start of `text`.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut k: usize| {
        while k < bytes.len() && (bytes[k].is_ascii_digit() || bytes[k] == b'.') {
            k += 1;
        }
        k
    };
    let mantissa = digits(0);
    let mut k = mantissa;
    if k < bytes.len() && (bytes[k] == b'e' || bytes[k] == b'E') {
        k += 1;
        if k < bytes.len() && (bytes[k] == b'+' || bytes[k] == b'-') {
            k += 1;
        }
        let end = digits(k);
        if end > k {
            return end;
        }
    }
    mantissa
}
