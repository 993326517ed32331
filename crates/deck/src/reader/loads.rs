//! *AMPLITUDE, *BOUNDARY, *CLOAD, *DLOAD and *DSLOAD.

use super::base::DeckReader;
use super::held::{Amplitude, HeldCellLoad, HeldValue, Timed};
use super::named::increasing;
use super::params::Params;
use crate::cards::{squeeze, Card, DataLine};
use crate::element::ElementModel;
use crate::model::unit;
use crate::numbers::clip;
use crate::step::BodyLoadKind;
use base::linalg::vec3::{cross, minus, norm};
use base::Result;

impl<'a> DeckReader<'a> {
    pub(super) fn amplitude(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let name = params.required("NAME")?;
        let total = match params.value("TIME") {
            None | Some("STEPTIME") => false,
            Some("TOTALTIME") => true,
            Some(other) => return params.error(format!("TIME={} is not supported", clip(other))),
        };
        params.refuse(&["USER"], "amplitudes of users are not supported")?;
        for (key, wanted) in [("DEFINITION", "TABULAR"), ("VALUE", "RELATIVE")] {
            if let Some(other) = params.value(key).filter(|v| *v != wanted) {
                return params.error(format!("{key}={} is not supported", clip(other)));
            }
        }
        let shift = [
            params.real("SHIFTX")?.unwrap_or(0.0),
            params.real("SHIFTY")?.unwrap_or(0.0),
        ];
        params.done()?;
        let mut table: Vec<(f64, f64)> = Vec::new();
        for row in self.cards.rows(card) {
            for k in (0..row.fields.len()).step_by(2) {
                let time = row.real(self.files, k, "a time")? + shift[0];
                let factor = row.real(self.files, k + 1, "a factor")? + shift[1];
                if table.last().is_some_and(|t| t.0 > time) {
                    return Err(self
                        .files
                        .error(row.place, "the times of an amplitude decrease"));
                }
                table.push((time, factor));
            }
        }
        if table.is_empty() {
            return self.error(card, "its table is missing");
        }
        let a = self.amplitudes.len();
        if self.amplitude_names.insert(name.to_string(), a).is_some() {
            return self.error(
                card,
                format!("the amplitude {} is defined before", clip(name)),
            );
        }
        self.amplitudes.push(Amplitude { total, table });
        Ok(())
    }

    /// The amplitude that a card of loads names, and how it is delayed.
    pub(super) fn timed(&self, params: &mut Params<'a>) -> Result<Option<Timed>> {
        let delay = params.real("TIMEDELAY")?;
        let Some(name) = params.name("AMPLITUDE")? else {
            return match delay {
                Some(_) => params.error("TIME DELAY needs AMPLITUDE="),
                None => Ok(None),
            };
        };
        let Some(&amplitude) = self.amplitude_names.get(name) else {
            return params.error(format!("there is no amplitude {}", clip(name)));
        };
        Ok(Some(Timed {
            amplitude,
            delay: delay.unwrap_or(0.0),
        }))
    }

    /// Whether loads of earlier steps are removed.
    pub(super) fn anew(&self, params: &mut Params<'a>) -> Result<bool> {
        match params.value("OP") {
            None | Some("MOD") => Ok(false),
            Some("NEW") => Ok(true),
            Some(other) => params.error(format!("OP={} is neither MOD nor NEW", clip(other))),
        }
    }

    pub(super) fn boundary(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let anew = self.anew(&mut params)?;
        let timed = self.timed(&mut params)?;
        params.refuse(&["USER"], "routines of users are not supported")?;
        params.refuse(&["MASSFLOW"], "fluids are not supported")?;
        params.refuse(&["SUBMODEL"], "results of other computations are not read")?;
        // In the first step, the displacement that is frozen is 0.
        let fixed = params.flag("FIXED");
        if fixed && self.state.number > 1 {
            return params.error("FIXED: displacements of the step before are not kept");
        }
        if let Some(kind) = params.value("TYPE").filter(|kind| *kind != "DISPLACEMENT") {
            return params.error(format!("TYPE={} is not supported", clip(kind)));
        }
        params.done()?;
        if anew && !self.state.seen.boundary {
            self.state.supports.clear();
        }
        self.state.seen.boundary = true;
        for row in self.cards.rows(card) {
            let nodes = self.target_nodes(&row, 0)?;
            let (dofs, value) = self.directions(&row)?;
            let value = if fixed { 0.0 } else { value };
            self.spend(nodes.len() * dofs.len().max(1), row.place)?;
            for node in nodes {
                for &dof in &dofs {
                    let held = HeldValue::new(value, timed, row.place);
                    self.state.supports.insert((node, dof), held);
                }
            }
        }
        Ok(())
    }

    /// The directions that a line of *BOUNDARY holds, from 0, and the value.
    fn directions(&self, row: &DataLine) -> Result<(Vec<u8>, f64)> {
        let named = match squeeze(row.field(1)).as_str() {
            "ENCASTRE" | "PINNED" => Some(vec![0, 1, 2]),
            "XSYMM" => Some(vec![0]),
            "YSYMM" => Some(vec![1]),
            "ZSYMM" => Some(vec![2]),
            "XASYMM" => Some(vec![1, 2]),
            "YASYMM" => Some(vec![0, 2]),
            "ZASYMM" => Some(vec![0, 1]),
            _ => None,
        };
        let dim = self.deck.dim() as u8;
        if let Some(mut dofs) = named {
            row.at_most(
                self.files,
                2,
                "a line with the name of a boundary condition",
            )?;
            dofs.retain(|&d| d < dim);
            return Ok((dofs, 0.0));
        }
        row.at_most(self.files, 4, "a line of *BOUNDARY")?;
        let first = row.whole(self.files, 1, "a direction")?;
        let last = match row.field(2) {
            "" => first,
            _ => row.whole(self.files, 2, "a direction")?,
        };
        let value = row.real_or(self.files, 3, 0.0, "a displacement")?;
        let message = if first == 0 || last > 6 {
            format!("directions are 1 to 6, but they are {first} to {last}")
        } else if last < first {
            format!("the last direction, {last}, comes before the first, {first}")
        } else if value != 0.0 && last > u64::from(dim) {
            format!("direction {last} cannot be given here: bodies of dimension {dim} have none")
        } else {
            let dofs = (first as u8 - 1..last as u8).filter(|&d| d < dim);
            return Ok((dofs.collect(), value));
        };
        Err(self.files.error(row.place, message))
    }

    pub(super) fn cload(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let anew = self.anew(&mut params)?;
        let timed = self.timed(&mut params)?;
        params.refuse(&["USER"], "routines of users are not supported")?;
        params.refuse(&["SUBMODEL"], "results of other computations are not read")?;
        params.done()?;
        self.within_step(card)?;
        if anew && !self.state.seen.cload {
            self.state.forces.clear();
        }
        self.state.seen.cload = true;
        for row in self.cards.rows(card) {
            row.at_most(self.files, 3, "a line of *CLOAD")?;
            let nodes = self.target_nodes(&row, 0)?;
            let dof = row.whole(self.files, 1, "a direction")?;
            let value = row.real_or(self.files, 2, 0.0, "a force")?;
            let dim = self.deck.dim() as u64;
            if !(1..=dim).contains(&dof) {
                if (1..=6).contains(&dof) && value == 0.0 {
                    continue;
                }
                let message =
                    format!("the direction of a force is 1 to {dim} here, but it is {dof}");
                return Err(self.files.error(row.place, message));
            }
            self.spend(nodes.len(), row.place)?;
            self.once(&row, &nodes)?;
            for node in nodes {
                let held = HeldValue::new(value, timed, row.place);
                let added = held.add_to(&mut self.state.forces, (node, dof as u8 - 1));
                added.map_err(|message| self.files.error(row.place, message))?;
            }
        }
        Ok(())
    }

    pub(super) fn dload(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let anew = self.anew(&mut params)?;
        let timed = self.timed(&mut params)?;
        params.refuse(&["SUBMODEL"], "results of other computations are not read")?;
        params.done()?;
        self.within_step(card)?;
        if anew && !self.state.seen.dload {
            self.state.pressures.clear();
            self.state.bodies.clear();
        }
        self.state.seen.dload = true;
        for row in self.cards.rows(card) {
            let label = squeeze(row.field(1));
            match label.as_str() {
                "GRAV" | "CENTRIF" => self.body_load(&row, &label, timed)?,
                "P" => {
                    let sides = self.sides_of_surface(&row)?;
                    self.pressure(&row, sides, timed)?;
                }
                _ if label.len() == 2 && label.starts_with('P') => {
                    let cells = self.target_cells(&row, 0)?;
                    let side = self.side(&row, 1, 'P', &cells)?;
                    self.once(&row, &cells)?;
                    let sides = cells.into_iter().map(|c| (c, side)).collect();
                    self.pressure(&row, sides, timed)?;
                }
                _ => {
                    let message = format!(
                        "loads of type '{}' are not supported, only P1 to P6, P on surfaces, GRAV and CENTRIF",
                        clip(row.field(1))
                    );
                    return Err(self.files.error(row.place, message));
                }
            }
        }
        Ok(())
    }

    /// The sides of the surface in the first field.
    fn sides_of_surface(&self, row: &DataLine) -> Result<Vec<(u32, u8)>> {
        let name = squeeze(row.field(0));
        let Some(set) = self.side_surfaces.get(&name) else {
            let message = format!("there is no surface of sides of elements {}", clip(&name));
            return Err(self.files.error(row.place, message));
        };
        self.once(row, &set.members)?;
        Ok(set.members.iter().map(|m| (m / 8, (m % 8) as u8)).collect())
    }

    /// The error if a load is put on something twice by one line: CalculiX adds it twice, Abaqus once.
    fn once(&self, row: &DataLine, members: &[u32]) -> Result<()> {
        if increasing(members).len() == members.len() {
            return Ok(());
        }
        let message = format!(
            "{} has members twice; CalculiX would double the load there, Abaqus would not",
            clip(row.field(0))
        );
        Err(self.files.error(row.place, message))
    }

    fn pressure(
        &mut self,
        row: &DataLine,
        sides: Vec<(u32, u8)>,
        timed: Option<Timed>,
    ) -> Result<()> {
        row.at_most(self.files, 3, "a pressure")?;
        let value = row.real(self.files, 2, "a pressure")?;
        self.spend(sides.len(), row.place)?;
        for side in sides {
            let held = HeldValue::new(value, timed, row.place);
            let added = held.add_to(&mut self.state.pressures, side);
            added.map_err(|message| self.files.error(row.place, message))?;
        }
        Ok(())
    }

    fn body_load(&mut self, row: &DataLine, label: &str, timed: Option<Timed>) -> Result<()> {
        let cells = increasing(&self.target_cells(row, 0)?);
        let value = row.real(self.files, 2, "its size")?;
        let fail = |message: &str| Err(self.files.error(row.place, message));
        let kind = if label == "GRAV" {
            row.at_most(self.files, 6, "gravity")?;
            let direction = row.vector(self.files, 3, "a component of its direction")?;
            if norm(direction) == 0.0 {
                return fail("the direction of gravity is 0");
            }
            if self.deck.dim() == 2 && direction[2] != 0.0 {
                return fail("gravity across a plane body is not supported");
            }
            BodyLoadKind::Gravity(unit(direction))
        } else {
            row.at_most(self.files, 9, "centrifugal load")?;
            let point = row.vector(self.files, 3, "a coordinate of a point of the axis")?;
            let direction = row.vector(self.files, 6, "a component of the axis")?;
            if norm(direction) == 0.0 {
                return fail("the direction of the axis is 0");
            }
            let direction = unit(direction);
            let is_axis = |axis: [f64; 3]| norm(cross(direction, axis)) < 1e-10;
            match self.deck.model() {
                ElementModel::Solid => {}
                ElementModel::Axisymmetric if !is_axis([0.0, 1.0, 0.0]) || point[0] != 0.0 => {
                    return fail("axisymmetric bodies turn about the y axis only");
                }
                ElementModel::PlaneStrain | ElementModel::PlaneStress
                    if !is_axis([0.0, 0.0, 1.0]) =>
                {
                    return fail("plane bodies turn about axes along z only");
                }
                _ => {}
            }
            BodyLoadKind::Centrifugal {
                omega2: value,
                point,
                direction,
            }
        };
        self.spend(cells.len(), row.place)?;
        let target = squeeze(row.field(0));
        let centrifugal = |k: &BodyLoadKind| matches!(k, BodyLoadKind::Centrifugal { .. });
        let mut others = self.state.bodies.iter().filter(|b| b.target == target);
        if centrifugal(&kind) && others.any(|b| centrifugal(&b.kind) && !same_load(&b.kind, &kind))
        {
            return fail("a set cannot turn about two axes; CalculiX would ignore this one");
        }
        let body = HeldCellLoad {
            target,
            cells,
            kind,
            held: HeldValue::new(value, timed, row.place),
        };
        let added = body.add_to(&mut self.state.bodies, same_load);
        added.map_err(|message| self.files.error(row.place, message))
    }
}

/// Whether two loads on the same cells are one that is added to or replaced: gravity of one direction, or one axis.
fn same_load(a: &BodyLoadKind, b: &BodyLoadKind) -> bool {
    use BodyLoadKind::{Centrifugal, Gravity};
    match (*a, *b) {
        (Gravity(a), Gravity(b)) => norm(minus(a, b)) < 1e-10,
        (
            Centrifugal {
                point: p,
                direction: d,
                ..
            },
            Centrifugal {
                point: q,
                direction: e,
                ..
            },
        ) => norm(minus(d, e)) < 1e-10 && norm(cross(minus(p, q), d)) < 1e-10,
        _ => false,
    }
}
