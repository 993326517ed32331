//! Reads TOML: values with their places, and tables that know which keys were used.
//!
//! This is a thin layer over the parser, not derived deserialisation: every message must name the line, the value found
//! there and the value expected, also where a key takes a number, a list or a table.

use base::{Error, Location, Result};
use std::fmt::Display;
use std::rc::Rc;
use toml::de::{DeTable, DeValue};

/// A value with its place.
#[derive(Debug)]
pub(super) struct Item<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Its line, from 1. The header of [[x]] has none of its own: the line of the first key is the nearest.
    line: usize,
    /// The key whose value it is, or that of the list in which it stands.
    key: Option<Rc<str>>,
    pub value: Value<'a>,
}

#[derive(Debug)]
pub(super) enum Value<'a> {
    Text(String),
    Integer(i64),
    Number(f64),
    Truth(bool),
    Date,
    List(Vec<Item<'a>>),
    /// Each key with its line and its value.
    Table(Vec<(String, usize, Item<'a>)>),
}

impl Value<'_> {
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

impl<'a> Item<'a> {
    /// Where it was written.
    pub fn location(&self) -> Location {
        let location = Location::line(self.file, self.line);
        match &self.key {
            Some(key) => location.with_key(key.as_ref()),
            None => location,
        }
    }

    /// The error `message` at this place.
    pub fn error<T>(&self, message: impl Display) -> Result<T> {
        Err(Error::input(message.to_string()).at(self.location()))
    }

    /// The error that this value is not what was `wanted`.
    pub fn expected<T>(&self, wanted: impl Display) -> Result<T> {
        let found = self.value.kind();
        self.error(format!("{found} where {wanted} was expected"))
    }

    pub fn list(&self, wanted: &str) -> Result<&[Item<'a>]> {
        match &self.value {
            Value::List(items) => Ok(items),
            _ => self.expected(wanted),
        }
    }

    pub fn text(&self, wanted: &str) -> Result<String> {
        match &self.value {
            Value::Text(text) => Ok(text.clone()),
            _ => self.expected(wanted),
        }
    }

    /// Whether it is the text `word`.
    pub fn is(&self, word: &str) -> bool {
        matches!(&self.value, Value::Text(text) if text == word)
    }

    /// The meaning of the text, which must be one of several words.
    pub fn choice<T: Copy>(&self, words: &[(&str, T)]) -> Result<T> {
        match words.iter().find(|(word, _)| self.is(word)) {
            Some((_, meaning)) => Ok(*meaning),
            None => {
                let quoted: Vec<String> = words.iter().map(|w| format!("\"{}\"", w.0)).collect();
                let (last, first) = quoted.split_last().expect("one word at least");
                self.expected(format!("{} or {last}", first.join(", ")))
            }
        }
    }

    /// The table, which messages call `what`.
    pub fn section<'i>(&'i self, what: &'i str) -> Result<TableSection<'i>> {
        match &self.value {
            Value::Table(entries) => Ok(TableSection {
                item: self,
                what,
                entries,
                known: Vec::new(),
            }),
            other => self.error(format!(
                "{what} is {} where a table was expected",
                other.kind()
            )),
        }
    }

    /// The one alternative that was found in this table; `all` lists those that exist.
    pub fn only<T>(&self, mut found: Vec<T>, one: &str, several: &str, all: &str) -> Result<T> {
        match found.len() {
            1 => Ok(found.remove(0)),
            0 => self.error(format!("{one} without {all}")),
            n => self.error(format!("{n} {several} where one of {all} was expected")),
        }
    }
}

/// The text of a scene file as a table; `file` names it in messages.
pub(super) fn parse<'a>(file: &'a str, text: &str) -> Result<Item<'a>> {
    let ends = text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
    let ends = ends.map(|(place, _)| place).collect();
    let source = SourceText { file, ends };
    let table = DeTable::parse(text).map_err(|e| {
        let line = e.span().map_or(1, |span| source.line(span.start));
        let message = e.message().split_whitespace().collect::<Vec<_>>().join(" ");
        Error::input(format!("not valid TOML: {message}")).at(Location::line(file, line))
    })?;
    Ok(Item {
        file,
        line: 1,
        key: None,
        value: source.table(table.get_ref())?,
    })
}

struct SourceText<'a> {
    file: &'a str,
    /// Where lines end.
    ends: Vec<usize>,
}

impl<'a> SourceText<'a> {
    fn line(&self, byte: usize) -> usize {
        self.ends.partition_point(|&end| end < byte) + 1
    }

    fn table(&self, table: &DeTable<'_>) -> Result<Value<'a>> {
        let mut entries = Vec::with_capacity(table.len());
        for (key, value) in table.iter() {
            let line = self.line(key.span().start);
            let name = key.get_ref().to_string();
            let value = self.item(value, &Rc::from(name.as_str()))?;
            entries.push((name, line, value));
        }
        // The order of the file: the first mistake is then reported first.
        entries.sort_by_key(|(_, line, _)| *line);
        Ok(Value::Table(entries))
    }

    fn item(&self, value: &toml::Spanned<DeValue<'_>>, key: &Rc<str>) -> Result<Item<'a>> {
        let line = self.line(value.span().start);
        let fail = |what: &str| {
            let place = Location::line(self.file, line).with_key(key.as_ref());
            Err(Error::input(format!("{what} where a finite number was expected")).at(place))
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
            DeValue::Array(items) => Value::List(
                items
                    .iter()
                    .map(|i| self.item(i, key))
                    .collect::<Result<_>>()?,
            ),
            DeValue::Table(table) => self.table(table)?,
        };
        Ok(Item {
            file: self.file,
            line,
            key: Some(key.clone()),
            value,
        })
    }
}

/// A table that is read key by key; the keys left over at the end are unknown.
pub(super) struct TableSection<'a> {
    item: &'a Item<'a>,
    /// The name of the table in messages: "[[body]]", "the scene", ….
    what: &'a str,
    /// All entries, for tables with arbitrary keys.
    pub entries: &'a [(String, usize, Item<'a>)],
    known: Vec<&'static str>,
}

impl<'a> TableSection<'a> {
    /// The value of `key`, if it is there.
    pub fn take(&mut self, key: &'static str) -> Option<&'a Item<'a>> {
        self.known.push(key);
        self.entry(key)
    }

    /// As [`TableSection::take`], for a key that is not allowed here.
    pub fn entry(&self, key: &str) -> Option<&'a Item<'a>> {
        let entry = self.entries.iter().find(|(k, _, _)| k == key);
        entry.map(|(_, _, item)| item)
    }

    /// The result of `read` for the value of `key`, if it is there.
    pub fn read<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&'a Item<'a>) -> Result<T>,
    ) -> Result<Option<T>> {
        self.take(key).map(read).transpose()
    }

    /// The tables under `key`: none, one, or a list.
    pub fn tables(&mut self, key: &'static str) -> Result<&'a [Item<'a>]> {
        let Some(item) = self.take(key) else {
            return Ok(&[]);
        };
        match &item.value {
            Value::Table(_) => Ok(std::slice::from_ref(item)),
            Value::List(items) => Ok(items),
            _ => item.expected("a table"),
        }
    }

    /// The results of `read` for the tables under `key`.
    pub fn each<T>(
        &mut self,
        key: &'static str,
        read: impl FnMut(&'a Item<'a>) -> Result<T>,
    ) -> Result<Vec<T>> {
        self.tables(key)?.iter().map(read).collect()
    }

    /// The value of `key`, or an error that says that it is missing.
    pub fn need(&mut self, key: &'static str, expected: &str) -> Result<&'a Item<'a>> {
        match self.take(key) {
            Some(item) => Ok(item),
            None => {
                let message = format!("{} has no `{key}` ({expected} was expected)", self.what);
                Err(Error::input(message).at(self.item.location().with_key(key)))
            }
        }
    }

    /// Returns an error for the first key that was not read.
    pub fn finish(self) -> Result<()> {
        let unknown = |entry: &&(String, usize, Item)| !self.known.contains(&entry.0.as_str());
        match self.entries.iter().find(unknown) {
            None => Ok(()),
            Some((key, line, _)) => Err(Error::input(format!(
                "unknown key `{key}` in {} (known keys are {})",
                self.what,
                self.known.join(", ")
            ))
            .at(Location::line(self.item.file, *line).with_key(key))),
        }
    }
}
