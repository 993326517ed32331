//! Tables of values at nodes as CalculiX prints them to its `.dat` files.

use super::model::Deck;
use super::step::{Printed, Totals};
use base::linalg::vec3::dot;
use std::fmt::Write;

/// The quantity in a [`DatTable`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DatQuantity {
    /// Displacements (U).
    Displacement,
    /// Forces (RF).
    Force,
    /// The sum of the forces; its one row has the number 0.
    TotalForce,
}

/// A table of a `.dat` file.
#[derive(Debug, Clone, PartialEq)]
pub struct DatTable {
    /// The quantity in the table.
    pub quantity: DatQuantity,
    /// The node set, in capitals.
    pub set: String,
    /// The total time.
    pub time: f64,
    /// Its rows.
    pub rows: Vec<TableRow>,
}

/// A row of a [`DatTable`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableRow {
    /// The number of the node.
    pub id: u64,
    /// Its vector.
    pub vector: [f64; 3],
    /// Whether the vector counts in the system of the node, not in the global one.
    pub local: bool,
}

impl DatQuantity {
    const ALL: [DatQuantity; 3] = [
        DatQuantity::Displacement,
        DatQuantity::Force,
        DatQuantity::TotalForce,
    ];

    /// The beginning of the title of its tables.
    const fn title(self) -> &'static str {
        match self {
            DatQuantity::Displacement => "displacements (vx,vy,vz)",
            DatQuantity::Force => "forces (fx,fy,fz)",
            DatQuantity::TotalForce => "total force (fx,fy,fz)",
        }
    }
}

/// The tables of displacements and forces of a `.dat` file; others are passed over.
pub fn read_dat(text: &str) -> Vec<DatTable> {
    let mut tables: Vec<DatTable> = Vec::new();
    let mut open = false;
    for line in text.lines() {
        if line.trim().is_empty() {
            continue;
        }
        let row = if open {
            row_of(line, tables.last())
        } else {
            None
        };
        match (row, tables.last_mut()) {
            (Some(row), Some(table)) => table.rows.push(row),
            _ => {
                let title = title_of(line);
                open = title.is_some();
                tables.extend(title);
            }
        }
    }
    tables
}

/// The empty table of a line such as ` displacements (vx,vy,vz) for set NALL and time  0.1000000E+01`.
fn title_of(line: &str) -> Option<DatTable> {
    let line = line.trim();
    let quantity = DatQuantity::ALL
        .into_iter()
        .find(|q| line.starts_with(q.title()))?;
    let (set, time) = line[quantity.title().len()..]
        .trim_start()
        .strip_prefix("for set ")?
        .rsplit_once(" and time ")?;
    Some(DatTable {
        quantity,
        set: set.trim().to_string(),
        time: time.trim().parse().ok()?,
        rows: Vec::new(),
    })
}

/// A row of numbers; `L`, for a vector in the system of its node, may follow.
fn row_of(line: &str, table: Option<&DatTable>) -> Option<TableRow> {
    let mut words = line.split_whitespace();
    let id = match table?.quantity {
        DatQuantity::TotalForce => 0,
        _ => words.next()?.parse().ok()?,
    };
    let mut vector = [0.0; 3];
    for x in &mut vector {
        *x = fortran(words.next()?)?;
    }
    let local = match words.next() {
        None => false,
        Some("L") => true,
        Some(_) => return None,
    };
    Some(TableRow { id, vector, local })
}

/// A number as Fortran prints it: exponents of three digits have no letter, as in `1.0-100`.
fn fortran(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| {
        let split = word.rfind(['+', '-']).filter(|&k| k > 0)?;
        format!("{}e{}", &word[..split], &word[split..])
            .parse()
            .ok()
    })
}

impl Deck {
    /// The tables that step `step` asks for, a list for each *NODE PRINT, of the displacements and forces of all nodes
    /// (by place, in the global system).
    pub fn tables(
        &self,
        step: usize,
        displacements: &[[f64; 3]],
        forces: &[[f64; 3]],
    ) -> Vec<Vec<DatTable>> {
        let step = &self.steps[step];
        let mut all = Vec::new();
        for print in &step.prints {
            let mut tables = Vec::new();
            let table = |quantity, rows| DatTable {
                quantity,
                set: print.nset.clone(),
                time: step.time,
                rows,
            };
            let row = |node: u32, vector: [f64; 3]| {
                let frame = self.frame(node).filter(|_| !print.global);
                let along = |f: [[f64; 3]; 3]| f.map(|axis| dot(axis, vector));
                TableRow {
                    id: self.mesh.node_ids[node as usize],
                    vector: frame.map_or(vector, along),
                    local: frame.is_some(),
                }
            };
            let rows = |of: &[[f64; 3]]| {
                let nodes = print.nodes.iter();
                nodes.map(|&n| row(n, of[n as usize])).collect()
            };
            for printed in &print.printed {
                match printed {
                    Printed::Displacement => {
                        tables.push(table(DatQuantity::Displacement, rows(displacements)));
                    }
                    Printed::Force => {
                        if print.totals != Totals::Only {
                            tables.push(table(DatQuantity::Force, rows(forces)));
                        }
                        if print.totals != Totals::No {
                            let at =
                                |d: usize| print.nodes.iter().map(move |&n| forces[n as usize][d]);
                            let vector = [0, 1, 2].map(|d| at(d).sum());
                            let total = TableRow {
                                id: 0,
                                vector,
                                local: false,
                            };
                            tables.push(table(DatQuantity::TotalForce, vec![total]));
                        }
                    }
                }
            }
            all.push(tables);
        }
        all
    }
}

/// The text that CalculiX prints for `tables`.
pub fn write_dat(tables: &[DatTable]) -> String {
    let mut text = String::new();
    for table in tables {
        let title = table.quantity.title();
        let time = scientific(table.time, 7, true);
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "\n {title} for set {} and time {time:>14}\n\n",
            table.set
        );
        for row in &table.rows {
            let _ = match table.quantity {
                DatQuantity::TotalForce => write!(text, "      "),
                _ => write!(text, "{:>10}", row.id),
            };
            for x in row.vector {
                let _ = write!(text, " {:>13}", scientific(x, 6, false));
            }
            text.push_str(if row.local { " L\n" } else { "\n" });
        }
    }
    text
}

/// A number with `digits` digits after the point, as Fortran's `e` format prints it: the first digit before the point
/// is 0 if `below_one`, else not.
fn scientific(x: f64, digits: usize, below_one: bool) -> String {
    if !x.is_finite() {
        return if x.is_nan() {
            "NaN".into()
        } else if x > 0.0 {
            "Infinity".into()
        } else {
            "-Infinity".into()
        };
    }
    let places = if below_one { digits - 1 } else { digits };
    let printed = format!("{x:.places$e}");
    let (mantissa, exponent) = printed.split_once('e').unwrap_or((&printed, "0"));
    let mut exponent: i32 = exponent.parse().unwrap_or(0);
    let mut mantissa = mantissa.to_string();
    if below_one {
        let (sign, rest) = match mantissa.strip_prefix('-') {
            Some(rest) => ("-", rest),
            None => ("", mantissa.as_str()),
        };
        mantissa = format!("{sign}0.{}", rest.replace('.', ""));
        exponent += i32::from(x != 0.0);
    }
    let sign = if exponent < 0 { '-' } else { '+' };
    match exponent.unsigned_abs() {
        e @ 0..=99 => format!("{mantissa}E{sign}{e:02}"),
        e => format!("{mantissa}{sign}{e:03}"),
    }
}

#[cfg(test)]
#[path = "../tests/dat.rs"]
mod tests;
