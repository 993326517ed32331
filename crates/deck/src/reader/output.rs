//! *NODE PRINT, *NODE FILE, *EL FILE and their likes, *RESTART.

use super::base::DeckReader;
use super::params::Params;

use crate::cards::{squeeze, Card};
use crate::numbers::clip;
use crate::step::{FieldRequest, NodePrint, Printed, Totals};
use base::Result;

impl<'a> DeckReader<'a> {
    pub(super) fn node_print(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let Some(nset) = params.name("NSET")? else {
            let reason = "without NSET=, CalculiX prints nothing";
            self.deck.ignored.push(Self::note(card, card.place, reason));
            return Ok(());
        };
        let never = params.whole("FREQUENCY")? == Some(0);
        let totals = match params.value("TOTALS") {
            None | Some("NO") => Totals::No,
            Some("YES") => Totals::Yes,
            Some("ONLY") => Totals::Only,
            Some(other) => return params.error(format!("TOTALS={} is unknown", clip(other))),
        };
        let global = params.value("GLOBAL") == Some("YES");
        params.skip(&["FREQUENCYF", "TIMEPOINTS"]);
        params.done()?;
        self.within_step(card)?;
        if !self.state.seen.print {
            self.state.prints.clear();
        }
        self.state.seen.print = true;
        if never {
            return Ok(());
        }
        let Some(set) = self.nsets.get(nset) else {
            return self.no_nset(card, nset);
        };
        let nodes = set.members.clone();
        self.spend(nodes.len(), card.place)?;
        let mut printed = Vec::new();
        for row in self.cards.rows(card) {
            for field in &row.fields {
                match squeeze(field).as_str() {
                    "U" => printed.push(Printed::Displacement),
                    "RF" => printed.push(Printed::Force),
                    "" => {}
                    other => {
                        let reason = format!("{} is not printed, only U and RF", clip(other));
                        self.deck.ignored.push(Self::note(card, row.place, reason));
                    }
                }
            }
        }
        if !printed.is_empty() {
            self.state.prints.push(NodePrint {
                nset: nset.to_string(),
                nodes,
                printed,
                totals,
                global,
                place: card.place,
            });
        }
        Ok(())
    }

    pub(super) fn field_request(&mut self, card: &'a Card) -> Result<()> {
        self.within_step(card)?;
        let of_nodes = card.keyword.starts_with("NODE");
        let keyword = match card.keyword.as_str() {
            "NODEFILE" => "*NODE FILE",
            "NODEOUTPUT" => "*NODE OUTPUT",
            "ELFILE" => "*EL FILE",
            _ => "*ELEMENT OUTPUT",
        };
        let seen = if of_nodes {
            &mut self.state.seen.node_fields
        } else {
            &mut self.state.seen.cell_fields
        };
        if !std::mem::replace(seen, true) {
            let fields = &mut self.state.fields;
            fields.retain(|f| f.keyword.starts_with("*NODE") != of_nodes);
        }
        let mut fields = Vec::new();
        for row in self.cards.rows(card) {
            fields.extend(
                row.fields
                    .iter()
                    .map(|f| squeeze(f))
                    .filter(|f| !f.is_empty()),
            );
        }
        self.state.fields.push(FieldRequest {
            keyword,
            fields,
            place: card.place,
        });
        Ok(())
    }

    pub(super) fn restart(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        params.refuse(&["READ"], "results of other computations are not read")?;
        let reason = "no files to restart from are written";
        self.deck.ignored.push(Self::note(card, card.place, reason));
        Ok(())
    }
}
