//! `[steps]`, `ramp`, and gaps and bounds in all their forms.

use super::document::{Item, TableSection, Value};
use super::SceneReader;
use crate::model::profile::Profile;
use crate::model::ramp::{Ramp, StepsSpec};
use base::Result;

/// Largest number of load steps.
const MOST_STEPS: usize = 1 << 20;

impl SceneReader {
    pub(super) fn steps(&self, item: &Item) -> Result<StepsSpec> {
        let mut section = item.section("[steps]")?;
        let times = match (section.take("count"), section.take("times")) {
            (Some(item), None) => {
                let count = item.count("a positive whole number")?;
                if count > MOST_STEPS {
                    return item.error(format!(
                        "{count} steps where at most {MOST_STEPS} were expected"
                    ));
                }
                (1..=count).map(|k| k as f64 / count as f64).collect()
            }
            (None, Some(item)) => self.times(item)?,
            (Some(_), Some(item)) => {
                return item.error("both `count` and `times` are given where one was expected")
            }
            (None, None) => return item.error("[steps] has no `count` (or `times`)"),
        };
        let mut factor = |key| {
            let read = section.read(key, ramp);
            Ok(read?.unwrap_or_else(|| Ramp::constant(1.0)))
        };
        let (load, gap, dirichlet) = (factor("load")?, factor("gap")?, factor("dirichlet")?);
        let update = section.read("update", |item| match item.value {
            Value::Truth(v) => Ok(v),
            _ => item.expected("true or false"),
        })?;
        section.finish()?;
        Ok(StepsSpec {
            times,
            load,
            gap,
            dirichlet,
            update: update.unwrap_or(false),
            location: item.location(),
        })
    }

    fn times(&self, item: &Item) -> Result<Vec<f64>> {
        let wanted = "a list of increasing times";
        let mut times: Vec<f64> = Vec::new();
        for item in item.list(wanted)? {
            let t = self.number(item)?;
            if let Some(last) = times.last().filter(|last| **last >= t) {
                return item.error(format!(
                    "the time {t} after {last} where increasing times were expected"
                ));
            }
            times.push(t);
        }
        if times.is_empty() {
            item.expected(wanted)
        } else {
            Ok(times)
        }
    }

    /// `ramp`, where it is given.
    pub(super) fn ramp(&self, section: &mut TableSection) -> Result<Option<Ramp>> {
        section.read("ramp", ramp)
    }

    /// A number, an expression, or a table [[t, value], …].
    pub(super) fn profile(&self, item: &Item) -> Result<Profile> {
        let Value::List(rows) = &item.value else {
            return Ok(Profile::Expression(self.expression(item)?));
        };
        let wanted = "a table [[t, value], …] with increasing t between 0 and 1";
        let mut table: Vec<[f64; 2]> = Vec::with_capacity(rows.len());
        for row in rows {
            let [t, value] = self.pair(row, "a pair [t, value]")?;
            let after = table.last().is_none_or(|last| last[0] < t);
            if !((0.0..=1.0).contains(&t) && after) {
                return row.error(format!("t = {t} where {wanted} was expected"));
            }
            table.push([t, value]);
        }
        if table.is_empty() {
            item.expected(wanted)
        } else {
            Ok(Profile::Table(table))
        }
    }
}

/// A factor as a function of t.
fn ramp(item: &Item) -> Result<Ramp> {
    match &item.value {
        Value::Integer(v) => Ok(Ramp::constant(*v as f64)),
        Value::Number(v) => Ok(Ramp::constant(*v)),
        Value::Text(text) => Ramp::parse(text)
            .or_else(|message| item.error(format!("bad expression \"{text}\": {message}"))),
        _ => item.expected("a number or an expression in t"),
    }
}
