//! The interfaces of a scene, or those that one rank needs, by their number in the scene.

use std::ops::Index;

use super::geometry::interface::BodyInterface;

/// The interfaces of a scene, by their number in it. A rank that has read its part may know those alone that it needs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Interfaces {
    known: Vec<BodyInterface>,
    /// The numbers of those that are known, increasing; `None`: all are.
    numbers: Option<Vec<u32>>,
    /// How many the scene has.
    count: usize,
}

impl From<Vec<BodyInterface>> for Interfaces {
    fn from(known: Vec<BodyInterface>) -> Interfaces {
        Interfaces {
            count: known.len(),
            known,
            numbers: None,
        }
    }
}

impl Index<usize> for Interfaces {
    type Output = BodyInterface;

    /// # Panics
    /// If the scene has no such interface, or the part does not know it.
    fn index(&self, number: usize) -> &BodyInterface {
        let at = match &self.numbers {
            None => number,
            Some(numbers) => numbers
                .binary_search(&(number as u32))
                .expect("a part knows the interfaces of its bodies and rows"),
        };
        &self.known[at]
    }
}

impl<'a> IntoIterator for &'a Interfaces {
    type Item = &'a BodyInterface;
    type IntoIter = std::slice::Iter<'a, BodyInterface>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl Interfaces {
    /// The interfaces that `needs` selects by number, out of the list of all interfaces of a scene.
    pub(super) fn part(
        all: Vec<BodyInterface>,
        needs: impl Fn(usize, &BodyInterface) -> bool,
    ) -> Interfaces {
        let count = all.len();
        let needed = (0..).zip(all).filter(|(k, i)| needs(*k as usize, i));
        let (mut numbers, mut known): (Vec<u32>, Vec<BodyInterface>) = needed.unzip();
        numbers.shrink_to_fit();
        known.shrink_to_fit();
        Interfaces {
            known,
            numbers: Some(numbers),
            count,
        }
    }

    /// How many the scene has.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether the scene has none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The interfaces that are known, by increasing number.
    pub fn iter(&self) -> std::slice::Iter<'_, BodyInterface> {
        self.known.iter()
    }

    /// The interfaces that are known, each with its number in the scene.
    pub fn numbered(&self) -> impl Iterator<Item = (usize, &BodyInterface)> {
        let number = |at: usize| self.numbers.as_ref().map_or(at, |n| n[at] as usize);
        let known = self.known.iter().enumerate();
        known.map(move |(at, interface)| (number(at), interface))
    }
}
