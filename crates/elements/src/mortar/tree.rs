//! A tree of boxes: which of many pieces of a surface are near a place.

/// The lowest and the highest corner of a box.
pub type Bounds = [[f64; 3]; 2];

/// Most boxes in a leaf.
const LEAF: usize = 4;

/// Boxes in a balanced binary tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    /// The numbers of the boxes, in the order of the leaves.
    order: Vec<u32>,
    boxes: Vec<Bounds>,
    /// Nodes in depth-first order: their bounds, their range of `order`, and the node after the last below them.
    nodes: Vec<(Bounds, [u32; 2], u32)>,
}

impl Tree {
    /// The tree of some boxes.
    pub fn new(boxes: Vec<Bounds>) -> Tree {
        let mut tree = Tree {
            order: (0..boxes.len() as u32).collect(),
            boxes,
            nodes: Vec::new(),
        };
        if !tree.order.is_empty() {
            tree.split(0, tree.order.len());
        }
        tree
    }

    fn split(&mut self, start: usize, end: usize) {
        let list = &mut self.order[start..end];
        let bounds = list
            .iter()
            .fold(NOTHING, |b, &k| union(b, self.boxes[k as usize]));
        let here = self.nodes.len();
        self.nodes.push((bounds, [start as u32, end as u32], 0));
        if end - start > LEAF {
            let extent = |d: &usize| bounds[1][*d] - bounds[0][*d];
            let longest = (0..3).max_by(|a, b| extent(a).total_cmp(&extent(b)));
            let d = longest.expect("three directions");
            let middle = (end - start) / 2;
            let boxes = &self.boxes;
            let centre = |k: &u32| boxes[*k as usize][0][d] + boxes[*k as usize][1][d];
            list.select_nth_unstable_by(middle, |a, b| {
                centre(a).total_cmp(&centre(b)).then(a.cmp(b))
            });
            self.split(start, start + middle);
            self.split(start + middle, end);
        }
        self.nodes[here].2 = self.nodes.len() as u32;
    }

    /// The boxes that meet `place`, increasing.
    pub fn meet(&self, place: &Bounds) -> Vec<u32> {
        let mut out = Vec::new();
        let mut k = 0;
        while let Some((bounds, [start, end], next)) = self.nodes.get(k) {
            let leaf = *next as usize == k + 1;
            if !meet(bounds, place) {
                k = *next as usize;
                continue;
            }
            if leaf {
                let list = &self.order[*start as usize..*end as usize];
                out.extend(
                    list.iter()
                        .filter(|&&b| meet(&self.boxes[b as usize], place)),
                );
            }
            k += 1;
        }
        out.sort_unstable();
        out
    }
}

/// The bounds that contain nothing.
const NOTHING: Bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// The bounds of points.
pub(super) fn bounds(points: impl Iterator<Item = [f64; 3]>) -> Bounds {
    points.fold(NOTHING, |b, p| union(b, [p, p]))
}

fn union(a: Bounds, b: Bounds) -> Bounds {
    [
        [0, 1, 2].map(|d| a[0][d].min(b[0][d])),
        [0, 1, 2].map(|d| a[1][d].max(b[1][d])),
    ]
}

fn meet(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d])
}

#[cfg(test)]
#[path = "../../tests/mortar/tree.rs"]
mod tests;
