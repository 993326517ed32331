//! Which nodes *TIE holds, and those that it moves: as CalculiX, a tie takes the nodes of the slave that are within its
//! tolerance of the master, and moves them onto it unless the deck says ADJUST=NO.

use std::collections::HashMap;

use base::linalg::vec3::{minus, norm};
use deck::{Adjust, Deck, DeckLine, Overclosure, SurfaceName};
use elements::mortar::{self, Feet, MortarFace, MortarSide};
use mesh::{Members, MeshFile, MeshGroup};

/// Moves below this part of the coordinates are none.
const NOTHING: f64 = 1e-12;

/// Gives ties without a tolerance that of CalculiX, and moves the nodes that ties move. A sentence for each tie that
/// moves some.
pub(super) fn adjust(deck: &mut Deck) -> Vec<String> {
    let mut out = Vec::new();
    if deck.ties.iter().any(|tie| tie.tolerance.is_none()) {
        let masters = deck.ties.iter().map(|tie| tie.master.group as usize);
        let sides = masters.flat_map(|g| sides_of(&deck.mesh.groups[g]));
        let tolerance = side(&deck.mesh, deck.dim(), sides).small();
        for tie in &mut deck.ties {
            tie.tolerance.get_or_insert(tolerance);
        }
    }
    for tie in deck.ties.clone() {
        if tie.adjust {
            let reach = tie.tolerance.unwrap_or_default();
            let joint = Joint {
                names: [&tie.slave, &tie.master],
                place: tie.place,
                keyword: "*TIE",
                hint: " (ADJUST=NO leaves them where they are)",
            };
            out.extend(joint.moves(deck, reach, &|_| true));
        }
    }
    for pair in deck.contacts.clone() {
        let law = &deck.interactions[pair.interaction as usize].overclosure;
        if !matches!(law, Overclosure::Tied { .. }) {
            continue;
        }
        let joint = Joint {
            names: [&pair.slave, &pair.master],
            place: pair.place,
            keyword: "*CONTACT PAIR",
            hint: " (ADJUST)",
        };
        out.extend(match &pair.adjust {
            Adjust::No => None,
            Adjust::Within(gap) => joint.moves(deck, *gap, &|_| true),
            Adjust::Nodes(set) => {
                joint.moves(deck, f64::INFINITY, &|k| set.binary_search(&k).is_ok())
            }
        });
        out.extend(joint.keeps(deck));
    }
    out
}

/// The data that *TIE and tied contact have in common.
struct Joint<'d> {
    /// The slave and the master.
    names: [&'d SurfaceName; 2],
    place: DeckLine,
    keyword: &'static str,
    /// The end of the sentence on nodes that it moves.
    hint: &'static str,
}

impl Joint<'_> {
    fn master(&self, deck: &Deck) -> MortarSide {
        let sides = sides_of(&deck.mesh.groups[self.names[1].group as usize]);
        side(&deck.mesh, deck.dim(), sides)
    }

    /// The nodes of the slave that are `reach` away from the master at most, each with its place and the nearest point
    /// there. What is farther away than a few edges has none.
    fn feet(&self, deck: &Deck, reach: f64) -> Vec<(u32, [f64; 3], [f64; 3])> {
        let onto = self.master(deck);
        let feet = Feet::new(&onto);
        let reach = reach.min(mortar::reach(&onto, &onto, f64::INFINITY));
        let nodes = nodes_of(&deck.mesh, self.names[0].group as usize).into_iter();
        let foot = |node: u32| {
            let x = deck.mesh.points[node as usize];
            let foot = feet.of(x, reach, &|_| true)?;
            Some((node, x, foot.point))
        };
        nodes.filter_map(foot).collect()
    }

    /// Moves those of them that are meant onto the master, and says so.
    fn moves(&self, deck: &mut Deck, reach: f64, meant: &dyn Fn(u32) -> bool) -> Option<String> {
        let (mut moved, mut longest) = (0, 0.0_f64);
        for (node, x, to) in self.feet(deck, reach) {
            let way = norm(minus(to, x));
            if meant(node) && way > NOTHING * norm(x) {
                deck.mesh.points[node as usize] = to;
                (moved, longest) = (moved + 1, longest.max(way));
            }
        }
        let nodes = count(moved);
        let ([slave, master], at) = (self.names, deck.files.at(self.place));
        (moved > 0).then(|| {
            format!(
                "{at}: {} moves {nodes} of the slave {} onto the master {}, by {longest:.3e} at most, as CalculiX \
                 does{}",
                self.keyword, slave.name, master.name, self.hint
            )
        })
    }

    /// The sentence on gaps that a tie keeps where springs close them in CalculiX.
    fn keeps(&self, deck: &Deck) -> Option<String> {
        let small = self.master(deck).small();
        let gaps = self.feet(deck, f64::INFINITY).into_iter();
        let gaps = gaps
            .map(|(_, x, to)| norm(minus(to, x)))
            .filter(|gap| *gap > small);
        let (apart, widest) = gaps.fold((0, 0.0_f64), |(n, most), gap| (n + 1, most.max(gap)));
        let [slave, master] = self.names;
        (apart > 0).then(|| {
            format!(
                "{}: {} of the slave {} are up to {widest:.3e} from the master {}: the springs of CalculiX close such \
                 gaps, the tie keeps them (with ADJUST they are none)",
                deck.files.at(self.place),
                count(apart),
                slave.name,
                master.name
            )
        })
    }
}

fn count(nodes: usize) -> String {
    match nodes {
        1 => "1 node".into(),
        n => format!("{n} nodes"),
    }
}

/// The sides of cells of a surface.
fn sides_of(group: &MeshGroup) -> &[(u32, u8)] {
    match &group.members {
        Members::Sides(sides) => sides,
        _ => &[],
    }
}

/// The nodes of a surface, increasing.
fn nodes_of(mesh: &MeshFile, group: usize) -> Vec<u32> {
    let mut nodes = match &mesh.groups[group].members {
        Members::Nodes(nodes) => nodes.clone(),
        Members::Sides(sides) => {
            let of = |&(c, side): &(u32, u8)| mesh.cells.side_nodes(c as usize, side.into());
            sides.iter().flat_map(of).collect()
        }
        Members::Cells { .. } => Vec::new(),
    };
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// A side with some sides of cells as its faces.
fn side<'m>(
    mesh: &MeshFile,
    dim: usize,
    sides: impl IntoIterator<Item = &'m (u32, u8)>,
) -> MortarSide {
    let mut nodes: Vec<u32> = Vec::new();
    let mut place: HashMap<u32, u32> = HashMap::new();
    let mut faces = Vec::new();
    for &(cell, side) in sides {
        let of_face = mesh.cells.side_nodes(cell as usize, side.into());
        let local = of_face.map(|k| {
            *place.entry(k).or_insert_with(|| {
                nodes.push(k);
                nodes.len() as u32 - 1
            })
        });
        faces.push(MortarFace {
            nodes: local.collect(),
            kind: mesh.cells.kind(cell as usize).sides()[usize::from(side)].kind,
        });
    }
    let points = nodes.iter().map(|&k| mesh.points[k as usize]).collect();
    MortarSide::new(dim, points, faces)
}
