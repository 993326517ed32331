//! *TIE, *CONTACT PAIR, *CLEARANCE.

use super::base::DeckReader;
use super::named::{increasing, SurfaceGroups};
use super::params::Params;

use crate::cards::{squeeze, Card};
use crate::deck_line::DeckLine;
use crate::joint::{Adjust, ContactKind, ContactPair, Overclosure, SurfaceName, Tie};
use crate::numbers::clip;
use base::Result;

impl<'a> DeckReader<'a> {
    /// The surface of that name; a slave may be of nodes, and then a surface of nodes goes first.
    fn surface_name(
        &self,
        surfaces: &SurfaceGroups,
        name: &str,
        may_be_nodes: bool,
        place: DeckLine,
    ) -> Result<SurfaceName> {
        let name = squeeze(name);
        let of_nodes = surfaces.nodes.get(&name);
        let (group, nodes) = match (may_be_nodes, of_nodes, surfaces.sides.get(&name)) {
            (true, Some(&group), _) => (group, true),
            (_, _, Some(&group)) => (group, false),
            (false, Some(_), None) => {
                let message = format!(
                    "the surface {} consists of nodes, but one of sides of elements is expected",
                    clip(&name)
                );
                return Err(self.files.error(place, message));
            }
            _ => {
                let message = format!("there is no surface {}", clip(&name));
                return Err(self.files.error(place, message));
            }
        };
        Ok(SurfaceName { name, nodes, group })
    }

    pub(super) fn tie(&mut self, card: &'a Card, surfaces: &SurfaceGroups) -> Result<()> {
        let mut params = Params::new(card, self.files);
        params.refuse(
            &["CYCLICSYMMETRY", "MULTISTAGE"],
            "cyclic symmetry is not supported",
        )?;
        params.refuse(
            &["FLUIDCYCLIC", "FLUIDPERIODIC"],
            "fluids are not supported",
        )?;
        let name = params.name("NAME")?.unwrap_or_default();
        // CalculiX takes 2.5 % of the size of an element for tolerances below 1e-10.
        let tolerance = params.real("POSITIONTOLERANCE")?.filter(|&t| t >= 1e-10);
        let adjust = match params.value("ADJUST") {
            None | Some("YES") => true,
            Some("NO") => false,
            Some(other) => {
                return params.error(format!("ADJUST={} is neither YES nor NO", clip(other)))
            }
        };
        params.skip(&["TYPE", "NOROTATION", "NOTHICKNESS"]);
        params.done()?;
        let before = self.deck.ties.len();
        for row in self.cards.rows(card) {
            row.at_most(self.files, 2, "a tie")?;
            self.deck.ties.push(Tie {
                name: name.to_string(),
                slave: self.surface_name(surfaces, row.field(0), true, row.place)?,
                master: self.surface_name(surfaces, row.field(1), false, row.place)?,
                tolerance,
                adjust,
                place: row.place,
            });
        }
        if self.deck.ties.len() == before {
            return self.error(card, "the line that names slave and master is missing");
        }
        Ok(())
    }

    pub(super) fn contact_pair(&mut self, card: &'a Card, surfaces: &SurfaceGroups) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let name = params.required("INTERACTION")?;
        let kind = match params.value("TYPE") {
            // CalculiX asks for a type; this is what Abaqus takes.
            None | Some("NODETOSURFACE") => ContactKind::NodeToSurface,
            Some("SURFACETOSURFACE") => ContactKind::SurfaceToSurface,
            Some("MORTAR" | "LINMORTAR" | "PGLINMORTAR") => ContactKind::Mortar,
            Some("MASSLESS") => ContactKind::Massless,
            Some(other) => return params.error(format!("TYPE={} is not supported", clip(other))),
        };
        let by_nodes = params.value("TYPE") == Some("NODETOSURFACE");
        let small_sliding = params.flag("SMALLSLIDING");
        let adjust = match params.value("ADJUST") {
            None => Adjust::No,
            Some(text) => match crate::numbers::real(text) {
                Some(gap) if gap >= 0.0 => Adjust::Within(gap),
                Some(_) => return params.error("ADJUST= needs a gap that is not negative"),
                None => match self.nsets.get(text) {
                    Some(set) => Adjust::Nodes(increasing(&set.members)),
                    None => return params.error(format!("there is no node set {}", clip(text))),
                },
            },
        };
        params.done()?;
        let Some(&interaction) = self.interactions.get(name) else {
            return self.error(
                card,
                format!("there is no surface interaction {}", clip(name)),
            );
        };
        let found = &self.deck.interactions[interaction as usize];
        let tied = matches!(found.overclosure, Overclosure::Tied { .. });
        let instead = match found.overclosure {
            Overclosure::Linear { .. } if kind == ContactKind::NodeToSurface => {
                Some("LINEAR pressure has no tension where sides are apart (sigma_inf of CalculiX counts as 0)")
            }
            Overclosure::Hard | Overclosure::Linear { .. } => None,
            Overclosure::Exponential { .. } => {
                Some("EXPONENTIAL pressure is replaced by hard contact")
            }
            Overclosure::Tabular(_) => Some("TABULAR pressure is replaced by hard contact"),
            Overclosure::Tied { .. } => Some("TIED pressure is replaced by a tie"),
        };
        let before = self.deck.contacts.len();
        for row in self.cards.rows(card) {
            row.at_most(self.files, 2, "a contact pair")?;
            let may_be_nodes = matches!(kind, ContactKind::NodeToSurface | ContactKind::Massless);
            if let Adjust::Nodes(nodes) = &adjust {
                self.spend(nodes.len(), row.place)?;
            }
            if by_nodes {
                self.by_nodes.push(row.place);
            }
            self.deck.contacts.push(ContactPair {
                slave: self.surface_name(surfaces, row.field(0), may_be_nodes, row.place)?,
                master: self.surface_name(surfaces, row.field(1), false, row.place)?,
                interaction,
                kind,
                small_sliding,
                adjust: adjust.clone(),
                clearance: None,
                place: row.place,
            });
        }
        if self.deck.contacts.len() == before {
            return self.error(card, "the line that names slave and master is missing");
        }
        let note = |reason: &str| Self::note(card, card.place, reason);
        self.deck.replaced.extend(instead.map(note));
        if !small_sliding && !tied {
            let reason = "surfaces face each other as they do before they move (small sliding)";
            self.deck.replaced.push(note(reason));
        }
        Ok(())
    }

    pub(super) fn clearance(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let slave = params.required("SLAVE")?;
        let master = params.required("MASTER")?;
        let value = params.real("VALUE")?;
        params.done()?;
        let Some(value) = value else {
            return self.error(card, "the parameter VALUE= is missing");
        };
        let mut found = false;
        let mut nodes = false;
        for pair in &mut self.deck.contacts {
            if pair.slave.name == slave && pair.master.name == master {
                let by_nodes = self.by_nodes.contains(&pair.place);
                if !by_nodes {
                    pair.clearance = Some(value);
                }
                nodes |= by_nodes;
                found = true;
            }
        }
        if nodes {
            let reason =
                "in CalculiX it has no effect on pairs of TYPE=NODE TO SURFACE, whose gaps stay as they are";
            self.deck.ignored.push(Self::note(card, card.place, reason));
        }
        if found {
            return Ok(());
        }
        let (slave, master) = (clip(slave), clip(master));
        self.error(
            card,
            format!("there is no contact pair of slave {slave} and master {master}"),
        )
    }
}
