//! *NODE and *ELEMENT.

use super::base::{title, DeckReader};
use super::params::Params;
use crate::cards::{Card, DataLine};
use crate::element::{shape, what_is, ElementModel, ElementType};
use crate::gap::GapElement;
use crate::numbers::clip;
use base::Result;
use elements::kind::CellKind;
use mesh::file::FARTHEST;

impl<'a> DeckReader<'a> {
    pub(super) fn node(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let set = params.name("NSET")?;
        if let Some(system) = params.value("SYSTEM") {
            if system != "R" {
                return params.error("only rectangular coordinates are supported");
            }
        }
        params.done()?;
        let set = set.map(|name| self.nsets.open(name, card.place));
        let mut moved = None;
        for row in self.cards.rows(card) {
            let id = row.whole(self.files, 0, "the number of a node")?;
            if id == 0 {
                return Err(self.files.error(row.place, "nodes are numbered from 1"));
            }
            // After the coordinates Abaqus may have a normal, which solids do not need.
            row.at_most(self.files, 7, "a node")?;
            let mut point = [0.0; 3];
            for (k, x) in point.iter_mut().enumerate() {
                *x = row.real_or(self.files, k + 1, 0.0, "a coordinate")?;
                self.digits.see(row.field(k + 1).as_bytes());
            }
            if let Some(x) = point.iter().find(|x| x.abs() > FARTHEST) {
                let message = format!(
                    "node {id} has a coordinate {x:e} where at most {FARTHEST:e} was expected (take other units)"
                );
                return Err(self.files.error(row.place, message));
            }
            let mesh = &mut self.deck.mesh;
            let next = mesh.points.len() as u32;
            let node = *self.nodes.places.entry(id).or_insert(next);
            if node == next {
                if next == u32::MAX {
                    return Err(self.files.error(row.place, "too many nodes"));
                }
                mesh.points.push(point);
                mesh.node_ids.push(id);
            } else if mesh.points[node as usize] != point {
                mesh.points[node as usize] = point;
                moved = moved.or(Some((row.place, id)));
            }
            if let Some(set) = set {
                self.nsets.add(set, node);
            }
        }
        if let Some((place, id)) = moved {
            let reason =
                format!("node {id} is defined before with other coordinates; the later ones hold");
            self.deck.replaced.push(Self::note(card, place, reason));
        }
        Ok(())
    }

    pub(super) fn element(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let set = params.name("ELSET")?;
        let name = params.required("TYPE")?;
        params.done()?;
        // Gap elements are no cells.
        let gap = self.whole && name == "GAPUNI";
        let kind = match gap {
            true => CellKind::Line2,
            false => self.element_kind(card, name)?,
        };
        let set = set.map(|name| self.elsets.open(name, card.place));
        let mut rows = self.cards.rows(card);
        let mut nodes = Vec::with_capacity(CellKind::MOST_NODES);
        while let Some(row) = rows.next() {
            let id = row.whole(self.files, 0, "the number of an element")?;
            if id == 0 {
                return Err(self.files.error(row.place, "elements are numbered from 1"));
            }
            nodes.clear();
            self.element_nodes(&row, 1, id, &mut nodes)?;
            while nodes.len() < kind.nodes() {
                match rows.next() {
                    Some(more) => self.element_nodes(&more, 0, id, &mut nodes)?,
                    None => break,
                }
            }
            if nodes.len() != kind.nodes() {
                let message = format!(
                    "element {id} has {} nodes, but elements of type {} have {}",
                    nodes.len(),
                    clip(name),
                    kind.nodes()
                );
                return Err(self.files.error(row.place, message));
            }
            if kind == CellKind::Line3 {
                // Abaqus has the middle between the ends.
                nodes.swap(1, 2);
            }
            let cell = match (gap, &nodes[..]) {
                (true, &[a, b]) => self.gaps.add(GapElement {
                    id,
                    nodes: [a, b],
                    place: row.place,
                }),
                _ => self.deck.mesh.cells.len() as u32,
            };
            if self.cells.places.insert(id, cell).is_some() {
                let message = format!("element {id} is defined before");
                return Err(self.files.error(row.place, message));
            }
            if let Some(set) = set {
                self.elsets.add(set, cell);
            }
            if gap {
                continue;
            }
            self.deck.mesh.cells.push(kind, &nodes);
            self.deck.mesh.cell_ids.push(id);
            if let (true, Some(element)) = (self.whole, ElementType::named(name)) {
                self.deck.elements.push(element);
            }
        }
        Ok(())
    }

    /// The kind of the cells of an *ELEMENT card.
    fn element_kind(&self, card: &Card, name: &str) -> Result<CellKind> {
        let message = if self.whole {
            let Some(element) = ElementType::named(name) else {
                return self.error(
                    card,
                    format!(
                        "elements of type {} ({}) are not supported",
                        clip(name),
                        what_is(name)
                    ),
                );
            };
            let Some(first) = self.deck.elements.first() else {
                return Ok(element.kind());
            };
            let of = |model| match model {
                ElementModel::PlaneStrain | ElementModel::PlaneStress => "plane",
                ElementModel::Solid => "solid",
                ElementModel::Axisymmetric => "axisymmetric",
            };
            if of(first.model()) == of(element.model()) {
                return Ok(element.kind());
            }
            format!(
                "elements of type {name} are {}, but those before are {}",
                of(element.model()),
                of(first.model())
            )
        } else {
            match shape(name) {
                Some(kind) => return Ok(kind),
                None => format!("the shape of elements of type {} is not known", clip(name)),
            }
        };
        self.error(card, message)
    }

    /// Adds the nodes of an element that `row` has from field `from` on.
    fn element_nodes(
        &self,
        row: &DataLine,
        from: usize,
        id: u64,
        nodes: &mut Vec<u32>,
    ) -> Result<()> {
        for k in from..row.fields.len() {
            let node = row.whole(self.files, k, "the number of a node")?;
            let Some(place) = self.nodes.place(node) else {
                let message = format!("element {id} has node {node}, which is not defined");
                return Err(self.files.error(row.place, message));
            };
            nodes.push(place);
        }
        Ok(())
    }

    /// Plane cells lie in the plane z = 0, and to the right of the axis if they are axisymmetric.
    pub(super) fn check_plane(&mut self) -> Result<()> {
        if self.deck.dim() != 2 {
            return Ok(());
        }
        let card = self.cards.cards.iter().find(|c| c.keyword == "ELEMENT");
        let title = card.map_or("*ELEMENT".to_string(), title);
        let mesh = &mut self.deck.mesh;
        let extent = mesh
            .points
            .iter()
            .flatten()
            .fold(0.0_f64, |m, x| m.max(x.abs()));
        let axisymmetric = self.deck.elements[0].model() == ElementModel::Axisymmetric;
        for c in 0..mesh.cells.len() {
            for &node in mesh.cells.nodes(c) {
                let point = &mut mesh.points[node as usize];
                let message = if point[2].abs() > 1e-9 * extent {
                    format!(
                        "plane elements lie in the plane z = 0, but z is {}",
                        point[2]
                    )
                } else if axisymmetric && point[0] < -1e-9 * extent {
                    format!(
                        "axisymmetric elements lie at positive x, but x is {}",
                        point[0]
                    )
                } else {
                    point[2] = 0.0;
                    continue;
                };
                let (id, cell) = (mesh.node_ids[node as usize], mesh.cell_ids[c]);
                let place = card.map(|c| c.place).unwrap_or_default();
                let message = format!("{title}: {message} at node {id} of element {cell}");
                return Err(self.files.error(place, message));
            }
        }
        Ok(())
    }
}
