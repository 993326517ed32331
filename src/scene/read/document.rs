//! Reads TOML: values with their lines, and tables that know which keys were used.
//!
//! This is a thin layer over the parser, not derived deserialisation: every message must name the line, the value found
//! there and the value expected, also where a key takes a number, a list or a table.

use crate::error::{Error, Result};
use toml::de::{DeTable, DeValue};

/// A scene file, for messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Source<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Its text.
    pub text: &'a str,
}

/// A value with its line (from 1).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Item {
    pub line: usize,
    pub value: Value,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Text(String),
    Integer(i64),
    Number(f64),
    Truth(bool),
    Date,
    List(Vec<Item>),
    Table(Vec<(String, usize, Item)>),
}

impl Value {
    /// The type of the value, with its article.
    pub fn kind(&self) -> String {
        match self {
            Value::Text(text) => format!("the text \"{text}\""),
            Value::Integer(v) => format!("the number {v}"),
            Value::Number(v) => format!("the number {v}"),
            Value::Truth(v) => format!("{v}"),
            Value::Date => "a date".into(),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".into(),
        }
    }
}

impl Source<'_> {
    /// The place for messages about line `line`.
    pub fn place(&self, line: usize) -> String {
        format!("{}:{line}", self.file)
    }

    /// The whole file as a table.
    pub fn parse(&self) -> Result<Item> {
        let table = DeTable::parse(self.text).map_err(|e| {
            let line = e.span().map_or(1, |span| self.line(span.start));
            let message = e.message().split_whitespace().collect::<Vec<_>>().join(" ");
            Error::Input(format!("{}: not valid TOML: {message}", self.place(line)))
        })?;
        let value = self.table(table.get_ref())?;
        Ok(Item { line: 1, value })
    }

    fn line(&self, byte: usize) -> usize {
        let end = byte.min(self.text.len());
        self.text.as_bytes()[..end]
            .iter()
            .filter(|&&b| b == b'\n')
            .count()
            + 1
    }

    fn table(&self, table: &DeTable<'_>) -> Result<Value> {
        let mut entries = Vec::with_capacity(table.len());
        for (key, value) in table.iter() {
            let line = self.line(key.span().start);
            entries.push((key.get_ref().to_string(), line, self.item(value)?));
        }
        // The order of the file: the first mistake is then reported first.
        entries.sort_by_key(|(_, line, _)| *line);
        Ok(Value::Table(entries))
    }

    fn item(&self, value: &toml::Spanned<DeValue<'_>>) -> Result<Item> {
        let line = self.line(value.span().start);
        let fail = |what: &str| {
            Err(Error::Input(format!(
                "{}: {what} where a finite number was expected",
                self.place(line)
            )))
        };
        let value = match value.get_ref() {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(v) => match i64::from_str_radix(v.as_str(), v.radix()) {
                Ok(v) => Value::Integer(v),
                Err(_) => return fail(&format!("{} is too large", v.as_str())),
            },
            DeValue::Float(v) => match v.as_str().parse::<f64>() {
                Ok(number) if number.is_finite() => Value::Number(number),
                _ => return fail(v.as_str()),
            },
            DeValue::Boolean(v) => Value::Truth(*v),
            DeValue::Datetime(_) => Value::Date,
            DeValue::Array(items) => {
                Value::List(items.iter().map(|i| self.item(i)).collect::<Result<_>>()?)
            }
            DeValue::Table(table) => self.table(table)?,
        };
        Ok(Item { line, value })
    }
}

/// A table that is read key by key; the keys left over at the end are unknown.
pub(crate) struct Section<'a> {
    source: &'a Source<'a>,
    /// The name of the table in messages: "[[body]]", "the scene", ….
    what: &'a str,
    /// Line of the table.
    pub line: usize,
    entries: &'a [(String, usize, Item)],
    known: Vec<&'static str>,
}

impl<'a> Section<'a> {
    /// Reads `item` as a table.
    pub fn new(source: &'a Source<'a>, what: &'a str, item: &'a Item) -> Result<Section<'a>> {
        match &item.value {
            Value::Table(entries) => Ok(Section {
                source,
                what,
                // The header of [[x]] has no span of its own: the line of the first key is the nearest.
                line: item.line,
                entries,
                known: Vec::new(),
            }),
            other => Err(Error::Input(format!(
                "{}: {what} is {} where a table was expected",
                source.place(item.line),
                other.kind()
            ))),
        }
    }

    /// The value of `key`, if it is there.
    pub fn take(&mut self, key: &'static str) -> Option<&'a Item> {
        self.known.push(key);
        self.entry(key)
    }

    /// As [`Section::take`], for a key that is not allowed here.
    pub fn entry(&self, key: &str) -> Option<&'a Item> {
        self.entries
            .iter()
            .find(|(k, _, _)| k == key)
            .map(|(_, _, item)| item)
    }

    /// The value of `key`, or an error that says that it is missing.
    pub fn need(&mut self, key: &'static str, expected: &str) -> Result<&'a Item> {
        self.take(key).ok_or_else(|| {
            Error::Input(format!(
                "{}: {} has no `{key}` ({expected} was expected)",
                self.source.place(self.line),
                self.what
            ))
        })
    }

    /// Returns an error for every key that was not read.
    pub fn finish(self) -> Result<()> {
        match self
            .entries
            .iter()
            .find(|(key, _, _)| !self.known.contains(&key.as_str()))
        {
            None => Ok(()),
            Some((key, line, _)) => Err(Error::Input(format!(
                "{}: unknown key `{key}` in {} (known keys are {})",
                self.source.place(*line),
                self.what,
                self.known.join(", ")
            ))),
        }
    }

    /// All entries, for tables with arbitrary keys.
    pub fn entries(&self) -> &'a [(String, usize, Item)] {
        self.entries
    }
}
