//! `[steps]`, `ramp`, and gaps and bounds in all their forms.

use super::document::{Item, Section, Value};
use super::Reader;
use crate::error::Result;
use crate::scene::model::profile::Profile;
use crate::scene::model::ramp::{Ramp, StepsSpec};

/// Largest number of load steps.
const MOST_STEPS: usize = 1 << 20;

impl<'a> Reader<'a> {
    pub(super) fn steps(&self, item: &'a Item) -> Result<StepsSpec> {
        let mut section = Section::new(self.source, "[steps]", item)?;
        let times = match (section.take("count"), section.take("times")) {
            (Some(item), None) => {
                let count = self.count(item, "a positive whole number")?;
                if count > MOST_STEPS {
                    return self.error(
                        item,
                        format_args!("{count} steps where at most {MOST_STEPS} were expected"),
                    );
                }
                (1..=count).map(|k| k as f64 / count as f64).collect()
            }
            (None, Some(item)) => {
                let wanted = "a list of increasing times";
                let mut times: Vec<f64> = Vec::new();
                for item in self.list(item, wanted)? {
                    let t = self.number(item)?;
                    match times.last() {
                        Some(last) if *last >= t => {
                            return self.error(
                                item,
                                format_args!(
                                "the time {t} after {last} where increasing times were expected"
                            ),
                            )
                        }
                        _ => times.push(t),
                    }
                }
                if times.is_empty() {
                    return self.expected(item, wanted);
                }
                times
            }
            (Some(_), Some(item)) => {
                return self.error(
                    item,
                    "both `count` and `times` are given where one was expected",
                )
            }
            (None, None) => {
                return self.error(item, "[steps] has no `count` (or `times`)");
            }
        };
        let mut factor = |key| match section.take(key) {
            Some(item) => self.ramp_value(item),
            None => Ok(Ramp::constant(1.0)),
        };
        let (load, gap, dirichlet) = (factor("load")?, factor("gap")?, factor("dirichlet")?);
        section.finish()?;
        Ok(StepsSpec {
            times,
            load,
            gap,
            dirichlet,
            written: self.written(item),
        })
    }

    /// `ramp`, where it is given.
    pub(super) fn ramp(&self, section: &mut Section<'a>) -> Result<Option<Ramp>> {
        let item = section.take("ramp");
        item.map(|item| self.ramp_value(item)).transpose()
    }

    fn ramp_value(&self, item: &Item) -> Result<Ramp> {
        match &item.value {
            Value::Integer(v) => Ok(Ramp::constant(*v as f64)),
            Value::Number(v) => Ok(Ramp::constant(*v)),
            Value::Text(text) => Ramp::parse(text).or_else(|message| {
                self.error(item, format_args!("bad expression \"{text}\": {message}"))
            }),
            _ => self.expected(item, "a number or an expression in t"),
        }
    }

    /// A number, an expression, or a table [[t, value], …].
    pub(super) fn profile(&self, item: &'a Item) -> Result<Profile> {
        let Value::List(rows) = &item.value else {
            return Ok(Profile::Expression(self.expression(item)?));
        };
        let wanted = "a table [[t, value], …] with increasing t between 0 and 1";
        let mut table: Vec<[f64; 2]> = Vec::with_capacity(rows.len());
        for row in rows {
            let [t, value] = self.pair(row, "a pair [t, value]")?;
            let after = table.last().is_none_or(|last| last[0] < t);
            if !((0.0..=1.0).contains(&t) && after) {
                return self.error(row, format_args!("t = {t} where {wanted} was expected"));
            }
            table.push([t, value]);
        }
        if table.is_empty() {
            return self.expected(item, wanted);
        }
        Ok(Profile::Table(table))
    }
}
