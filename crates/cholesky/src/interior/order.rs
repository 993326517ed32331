//! The order in which the interior is eliminated, and the partition of its columns into fronts.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;
use faer::sparse::SymbolicSparseColMatRef;

use super::graph::{graph_of, Tree, NONE};
use crate::dissection::nested_dissection;
use base::linalg::csr::Csr;
use petsc::ordering::{have_metis, have_scotch, metis, scotch, Graph};

/// The order of elimination.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ordering {
    /// The ordering that measured best: [`Ordering::Nd`].
    #[default]
    Auto,
    /// Nested dissection, by coordinates if they are known, otherwise by distance in the graph.
    Nd,
    /// Approximate minimum degree (faer's).
    Amd,
    /// METIS's nested dissection, through CHOLMOD.
    Metis,
    /// Scotch's nested dissection.
    Scotch,
}

impl Ordering {
    /// All distinct orderings.
    pub const ALL: [Ordering; 4] = [
        Ordering::Nd,
        Ordering::Amd,
        Ordering::Metis,
        Ordering::Scotch,
    ];

    /// The names as the option spells them.
    pub const NAMES: &'static [&'static str] = &["auto", "nd", "amd", "metis", "scotch"];

    /// The name as the option spells it.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The ordering that is used: `Auto` resolved.
    pub fn taken(self) -> Ordering {
        match self {
            Ordering::Auto => Ordering::Nd,
            chosen => chosen,
        }
    }

    /// Whether this build has the ordering.
    pub fn available(self) -> bool {
        match self {
            Ordering::Auto | Ordering::Nd | Ordering::Amd => true,
            Ordering::Metis => have_metis(),
            Ordering::Scotch => have_scotch(),
        }
    }
}

/// The dofs of a subdomain in the order [interior, interface].
#[derive(Debug, Clone)]
pub struct Elimination {
    /// Interior dofs by front, in the order of elimination.
    pub supernodes: Vec<Vec<u32>>,
    /// Interior dofs in an equivalent order, with the same fill, in which every subtree of the elimination tree is
    /// contiguous.
    pub interior: Vec<u32>,
    /// The interface dofs, in the order wanted for S.
    pub interface: Vec<u32>,
}

impl Elimination {
    /// Orders the dofs of `k` that are not in `interface`; `coordinates`, if given, has one position per dof.
    ///
    /// # Errors If the library of the ordering fails: the reason, one sentence without a full stop.
    pub fn new(
        k: &Csr,
        interface: &[u32],
        coordinates: Option<&[[f64; 3]]>,
        ordering: Ordering,
    ) -> Result<Elimination, String> {
        let inside = k.others(interface);
        let graph = graph_of(k, &inside);
        let (order, given) = match ordering.taken() {
            Ordering::Auto | Ordering::Nd => {
                let sets = nested_dissection(k, &inside, coordinates);
                let vertex = |i: &u32| inside.binary_search(i).expect("an interior dof") as u32;
                (sets.iter().flatten().map(vertex).collect(), Some(sets))
            }
            Ordering::Amd => (minimum_degree(&graph), None),
            Ordering::Metis => (metis(&graph)?, None),
            Ordering::Scotch => (scotch(&graph)?, None),
        };
        let tree = Tree::new(&graph, order).postordered(&graph);
        let dofs = |set: &Vec<u32>| set.iter().map(|&v| inside[v as usize]).collect();
        let supernodes = match given {
            Some(sets) => sets,
            None => fronts(&tree, &tree.counts(&graph))
                .iter()
                .map(dofs)
                .collect(),
        };
        Ok(Elimination {
            supernodes,
            interior: dofs(&tree.order),
            interface: interface.to_vec(),
        })
    }

    /// All dofs in the order [interior, interface].
    pub fn dofs(&self) -> Vec<u32> {
        [&self.interior[..], &self.interface].concat()
    }
}

/// faer's approximate minimum degree.
fn minimum_degree(graph: &Graph) -> Vec<u32> {
    let n = graph.row.len() - 1;
    let row: Vec<u32> = graph.row.iter().map(|&r| r as u32).collect();
    let col: Vec<u32> = graph.col.iter().map(|&c| c as u32).collect();
    let a = SymbolicSparseColMatRef::new_checked(n, n, &row, None, &col);
    let (mut order, mut place) = (vec![0; n], vec![0; n]);
    let scratch = amd::order_scratch::<u32>(n, col.len());
    let mut buffer = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut buffer);
    amd::order(&mut order, &mut place, a, amd::Control::default(), stack)
        .expect("the pattern is square, and its size is known");
    order
}

/// Whether two fronts are worth merging. Small fronts are, because the dense kernels' overhead outweighs some zeros;
/// larger fronts are if the merged front has few zeros.
fn worth_merging(columns: usize, zeros: usize, entries: usize) -> bool {
    let share = zeros as f64 / entries as f64;
    columns <= 8 || (columns <= 24 && share < 0.5) || (columns <= 48 && share < 0.2) || share < 0.05
}

/// A front under construction.
struct Growing {
    /// Positions of its columns, in the order of elimination.
    columns: Vec<u32>,
    below: usize,
    zeros: usize,
    parent: u32,
    children: Vec<usize>,
}

impl Growing {
    fn size(&self) -> usize {
        self.columns.len() + self.below
    }
}

/// Groups the vertices of a postordered tree into fronts: columns of equal pattern form a front, and children are
/// merged into their parents where that is worth it (relaxed supernodes, Ashcraft and Grimes 1989).
fn fronts(tree: &Tree, counts: &[u32]) -> Vec<Vec<u32>> {
    let mut all: Vec<Growing> = Vec::new();
    let mut front_of = vec![0usize; counts.len()];
    for p in 0..counts.len() {
        let same = p > 0
            && tree.parent[p - 1] as usize == p
            && counts[p - 1] as usize == counts[p] as usize + 1;
        if !same {
            all.push(Growing {
                columns: Vec::new(),
                below: 0,
                zeros: 0,
                parent: NONE,
                children: Vec::new(),
            });
        }
        front_of[p] = all.len() - 1;
        let front = all.last_mut().expect("just pushed");
        front.columns.push(p as u32);
        front.below = counts[p] as usize - 1;
        front.parent = tree.parent[p];
    }
    for f in 0..all.len() {
        if all[f].parent != NONE {
            let parent = front_of[all[f].parent as usize];
            all[parent].children.push(f);
        }
    }
    for f in 0..all.len() {
        let mut kept = Vec::new();
        // Starts with the last child: its pattern is usually the nearest to the parent's.
        for c in std::mem::take(&mut all[f].children).into_iter().rev() {
            let (child, front) = (&all[c], &all[f]);
            let (width, columns) = (
                child.columns.len(),
                child.columns.len() + front.columns.len(),
            );
            let zeros = child.zeros + front.zeros + width * (front.size() - child.below);
            let size = columns + front.below;
            let entries = columns * size - columns * (columns - 1) / 2;
            if !worth_merging(columns, zeros, entries) {
                kept.push(c);
                continue;
            }
            let mut merged = std::mem::take(&mut all[c].columns);
            merged.append(&mut all[f].columns);
            kept.append(&mut all[c].children);
            all[f].columns = merged;
            all[f].zeros = zeros;
        }
        all[f].children = kept;
    }
    // A front comes after all fronts below it, including merged ones, since those had lower numbers.
    let sets = all.iter().filter(|f| !f.columns.is_empty());
    sets.map(|f| f.columns.iter().map(|&p| tree.order[p as usize]).collect())
        .collect()
}

#[cfg(test)]
#[path = "../../tests/interior/order.rs"]
mod tests;
