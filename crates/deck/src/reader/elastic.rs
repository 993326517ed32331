//! *ELASTIC of every type, and *ORIENTATION: the axes along which constants count.

use super::base::DeckReader;
use super::params::Params;

use crate::cards::Card;
use crate::model::Orientation;
use crate::numbers::clip;
use base::Result;
use elements::law::{Anisotropic, Constants, Law, Orthotropic};

/// Numbers in a line of constants.
const IN_A_LINE: usize = 8;

impl<'a> DeckReader<'a> {
    /// *ELASTIC.
    pub(super) fn elastic(&mut self, card: &'a Card, current: Option<usize>) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let kind = params.value("TYPE").unwrap_or("ISO");
        params.done()?;
        let law = match kind {
            "ISO" | "ISOTROPIC" => self.isotropic(card)?,
            "ORTHO" | "ORTHOTROPIC" => {
                let [a, b, c, d, e, f, g, h, i] = self.constants_in_lines(card)?;
                let mut all = [0.0; 21];
                all[..6].copy_from_slice(&[a, b, c, d, e, f]);
                (all[9], all[14], all[20]) = (g, h, i);
                self.law_of(card, &Anisotropic(all))?
            }
            "ENGINEERINGCONSTANTS" | "ENGINEERING CONSTANTS" => {
                let [e1, e2, e3, n12, n13, n23, g12, g13, g23] = self.constants_in_lines(card)?;
                let law = Orthotropic {
                    young: [e1, e2, e3],
                    poisson: [n12, n13, n23],
                    shear: [g12, g13, g23],
                };
                self.law_of(card, &law)?
            }
            "ANISO" | "ANISOTROPIC" => {
                let constants = self.constants_in_lines(card)?;
                self.law_of(card, &Anisotropic(constants))?
            }
            _ => {
                let reason = format!(
                    "TYPE={} is none of ISO, ORTHO, ENGINEERING CONSTANTS and ANISO",
                    clip(kind)
                );
                let note = Self::note(card, card.place, reason);
                self.current(card, current)?.refused.get_or_insert(note);
                return Ok(());
            }
        };
        self.current(card, current)?.elastic = Some(law);
        Ok(())
    }

    fn isotropic(&self, card: &'a Card) -> Result<Law> {
        let constants = self.constant(card, 2)?;
        let (young, poisson) = (constants[0], constants[1]);
        if young <= 0.0 {
            return self.error(
                card,
                format!("Young's modulus is {young}; it must be positive"),
            );
        }
        if poisson <= -1.0 || poisson >= 0.5 {
            let message = format!("Poisson's ratio is {poisson}; it must lie between -1 and 0.5");
            return self.error(card, message);
        }
        Ok(Law::Isotropic { young, poisson })
    }

    /// The law of these constants, if it makes sense.
    fn law_of(&self, card: &'a Card, constants: &dyn Constants) -> Result<Law> {
        let law = constants.tangent().map(Law::General);
        match law.and_then(|law| law.check().map(|()| law)) {
            Ok(law) => Ok(law),
            Err(clause) => self.error(card, clause),
        }
    }

    /// Constants, eight in a line; a temperature may follow the last. Further lines are for other temperatures and must
    /// say the same.
    fn constants_in_lines<const N: usize>(&self, card: &'a Card) -> Result<[f64; N]> {
        let mut found: Option<[f64; N]> = None;
        let mut now = [0.0; N];
        let mut filled = 0;
        for row in self.cards.rows(card) {
            let here = (N - filled).min(IN_A_LINE);
            let last = filled + here == N;
            row.at_most(
                self.files,
                here + usize::from(last),
                "a line of this property",
            )?;
            for k in 0..here {
                now[filled + k] = row.real(self.files, k, "a constant of the material")?;
            }
            filled += here;
            if !last {
                continue;
            }
            filled = 0;
            if found.is_some_and(|before| before != now) {
                let message = "properties that depend on temperature are not supported";
                return Err(self.files.error(row.place, message));
            }
            found = Some(now);
        }
        match found {
            Some(constants) if filled == 0 => Ok(constants),
            _ => self.error(
                card,
                format!("{N} constants were expected, eight in a line"),
            ),
        }
    }

    /// *ORIENTATION.
    pub(super) fn orientation(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let name = params.required("NAME")?;
        let cylindrical = match params.value("SYSTEM") {
            None | Some("RECTANGULAR") => false,
            Some("CYLINDRICAL") => true,
            Some(other) => {
                let found = clip(other);
                return params.error(format!(
                    "SYSTEM={found} is neither RECTANGULAR nor CYLINDRICAL"
                ));
            }
        };
        params.skip(&["DEFINITION"]);
        params.done()?;
        let axes = self.two_points(card, cylindrical)?;
        let mut rows = self.cards.rows(card);
        if let Some(row) = rows.next() {
            row.at_most(self.files, 6, "a line of two points")?;
        }
        let mut turn = None;
        if let Some(row) = rows.next() {
            row.at_most(self.files, 2, "a line with an axis and an angle")?;
            let axis = row.real(self.files, 0, "an axis")?;
            let angle = row.real_or(self.files, 1, 0.0, "an angle")?;
            if ![1.0, 2.0, 3.0].contains(&axis) {
                let message = format!("the axis is {axis}; it must be 1, 2 or 3");
                return Err(self.files.error(row.place, message));
            }
            turn = (angle != 0.0).then_some((axis as usize - 1, angle));
        }
        let place = self.deck.orientations.len() as u32;
        if self.orientations.insert(name.to_string(), place).is_some() {
            let message = format!("the orientation {} is defined before", clip(name));
            return self.error(card, message);
        }
        self.deck.orientations.push(Orientation { axes, turn });
        Ok(())
    }
}
