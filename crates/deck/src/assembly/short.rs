//! Short names: those of sets and surfaces without that of their instance, and instances as sets of elements.

use std::collections::{HashMap, HashSet};

use super::flat::Flat;
use super::pieces::{defined, of_instance, SetName};
use super::placement::InstancePlacement;
use super::targets::{CardScope, Of, Offsets};
use crate::cards::{Card, Param};
use crate::deck_line::DeckLine;
use base::Result;

impl<'a> Flat<'a> {
    /// The names of sets and surfaces without that of their instance, where nothing else is called so; and each
    /// instance as a set of elements.
    pub(super) fn short_names(&mut self) -> Result<()> {
        let outline = self.outline;
        let taken: HashSet<SetName> = outline.others.iter().filter_map(|c| defined(c)).collect();
        let mut order: Vec<SetName> = Vec::new();
        let mut of: HashMap<SetName, Vec<usize>> = HashMap::new();
        for (k, instance) in outline.instances.iter().enumerate() {
            for card in of_instance(outline, instance).filter(|c| !c.lines().is_empty()) {
                let Some(named) = defined(card) else { continue };
                let list = of.entry(named).or_default();
                if list.is_empty() {
                    order.push(named);
                }
                if list.last() != Some(&k) {
                    list.push(k);
                }
            }
        }
        let short = |named: &SetName| of[named].len() == 1 && !taken.contains(named);
        let mut given: HashSet<SetName> = taken.clone();
        for named in order.into_iter().filter(short) {
            given.insert(named);
            self.short_name(named, of[&named][0])?;
        }
        for (k, instance) in outline.instances.iter().enumerate() {
            let [below, above] = self.numbers[k].map(|o| o.of(Of::Cells));
            if above > below && !given.contains(&("ELSET", instance.name)) {
                let start = self.lines.len();
                self.line(instance.place, &format!("{}, {above}", below + 1));
                let params = [("ELSET", instance.name), ("GENERATE", "")];
                self.set("ELSET", &params, instance.place, start);
            }
        }
        Ok(())
    }

    /// One of them, which instance `k` has.
    fn short_name(&mut self, (keyword, name): SetName<'a>, k: usize) -> Result<()> {
        let outline = self.outline;
        let instance = &outline.instances[k];
        let mut cards =
            of_instance(outline, instance).filter(|c| defined(c) == Some((keyword, name)));
        if keyword == "SURFACE" {
            let scopes = [
                CardScope {
                    instance: None,
                    offsets: Offsets::default(),
                },
                CardScope {
                    instance: Some(instance.name),
                    offsets: self.numbers[k][0],
                },
            ];
            return cards.try_for_each(|card| {
                let mut system = InstancePlacement::NONE;
                self.card(card, scopes, &InstancePlacement::NONE, &mut system)
            });
        }
        let place = cards.next().map_or(instance.place, |c| c.place);
        let start = self.lines.len();
        self.line(place, &format!("{}.{name}", instance.name));
        self.set(keyword, &[(keyword, name)], place, start);
        Ok(())
    }

    /// A card of a set, whose lines begin at `start`.
    fn set(&mut self, keyword: &str, params: &[(&str, &str)], place: DeckLine, start: usize) {
        let param = |(name, value): &(&str, &str)| Param {
            name: name.to_string(),
            value: value.to_string(),
        };
        let params = params.iter().map(param).collect();
        let lines = start..self.lines.len();
        self.out.push(Card::new(keyword, place, params, lines));
    }
}
