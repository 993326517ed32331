//! The files about contact, written as for a run with 2 and with 180 interfaces and read back: pictures, profiles, and
//! a time series as ParaView reads it. They stay in target/tmp/report_contact for inspection.

use crate::interfaces::InterfaceNodes;
use crate::json::contact::LoadStep;
use crate::paraview::contact_fields::ContactFields;
use crate::paraview::pvd::Pvd;
use crate::paraview::vtu::Vtu;
use crate::pictures::field;
use crate::pictures::field::{ContactMark, Marked, PlaneMesh, ShownField, Touch};
use crate::plots::load_steps;
use crate::plots::profile;
use crate::plots::profile::InterfaceProfile;
use elements::kind::CellKind;
use flate2::read::ZlibDecoder;
use mesh::Cells;
use std::io::Read;
use std::path::PathBuf;

/// A clean directory.
fn directory(name: &str) -> PathBuf {
    let own = std::env::current_exe().expect("the test knows its own path");
    let target = own.ancestors().nth(3).expect("target/<profile>/deps");
    let dir = target.join("tmp/report_contact").join(name);
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap();
    dir
}

/// Bodies in a grid, `nx` × `ny` unit squares of n × n cells, each with points of its own.
struct Bodies {
    nx: usize,
    ny: usize,
    n: usize,
    points: Vec<[f64; 2]>,
    quads: Vec<[u32; 4]>,
    body: Vec<u32>,
}

impl Bodies {
    fn new(nx: usize, ny: usize, n: usize) -> Self {
        let mut bodies = Bodies {
            nx,
            ny,
            n,
            points: Vec::new(),
            quads: Vec::new(),
            body: Vec::new(),
        };
        for b in 0..nx * ny {
            let first = bodies.points.len();
            for k in 0..(n + 1) * (n + 1) {
                let (i, j) = (k % (n + 1), k / (n + 1));
                let at = |body: usize, i: usize| body as f64 + i as f64 / n as f64;
                bodies.points.push([at(b % nx, i), at(b / nx, j)]);
            }
            for k in 0..n * n {
                let p = (first + (k / n) * (n + 1) + k % n) as u32;
                let up = n as u32 + 1;
                bodies.quads.push([p, p + 1, p + 1 + up, p + up]);
                bodies.body.push(b as u32);
            }
        }
        bodies
    }

    fn mesh(&self) -> PlaneMesh<'_> {
        PlaneMesh {
            points: &self.points,
            shown: &self.points,
            corners: &self.quads,
            body: &self.body,
            subdomain: &self.body,
        }
    }

    fn name(&self, b: usize) -> String {
        format!("body[{}][{}]", b % self.nx, b / self.nx)
    }

    /// The interfaces, as a start, a direction and a name.
    fn faces(&self) -> Vec<([f64; 2], [f64; 2], String)> {
        let mut out = Vec::new();
        for b in 0..self.nx * self.ny {
            let (x, y) = ((b % self.nx) as f64, (b / self.nx) as f64);
            if b % self.nx + 1 < self.nx {
                let name = format!("{}|{}", self.name(b), self.name(b + 1));
                out.push(([x + 1.0, y], [0.0, 1.0], name));
            }
            if b / self.nx + 1 < self.ny {
                let name = format!("{}|{}", self.name(b), self.name(b + self.nx));
                out.push(([x, y + 1.0], [1.0, 0.0], name));
            }
        }
        out
    }

    /// A parabolic pressure along every face. Its middle moves from face to face; faces k with k % 5 = 4 are open.
    fn profiles(&self, scale: f64) -> Vec<InterfaceProfile> {
        let faces = self.faces().into_iter().enumerate();
        let profile = |(k, (from, along, name)): (usize, ([f64; 2], [f64; 2], String))| {
            let middle = 0.3 + 0.4 * ((k * 7) % 11) as f64 / 11.0;
            let height = if k % 5 == 4 {
                -0.002
            } else {
                0.01 + 0.05 * ((k * 13) % 17) as f64 / 17.0
            };
            let s: Vec<f64> = (0..=self.n).map(|i| i as f64 / self.n as f64).collect();
            let shape: Vec<f64> = s.iter().map(|s| height - (s - middle).powi(2)).collect();
            let nodes = InterfaceNodes {
                name,
                t: s.iter()
                    .map(|s| [from[0] * along[0] + from[1] * along[1] + s, 0.0])
                    .collect(),
                points: s
                    .iter()
                    .map(|s| [from[0] + s * along[0], from[1] + s * along[1], 0.0])
                    .collect(),
                gap: shape.iter().map(|v| 0.01 * (-v).max(0.0)).collect(),
                multiplier: shape.iter().map(|v| scale * v.max(0.0)).collect(),
                active: shape.iter().map(|&v| v > 0.0).collect(),
                area: Vec::new(),
                smoothed: Vec::new(),
                friction: Vec::new(),
            };
            InterfaceProfile {
                nodes,
                label: if along[0] > 0.0 { "x" } else { "y" }.into(),
            }
        };
        faces.map(profile).collect()
    }

    /// The faces of the elements along the interfaces: closed where both ends are.
    fn marks(&self, profiles: &[InterfaceProfile]) -> Vec<ContactMark> {
        let of = |p: &InterfaceProfile| {
            let nodes = &p.nodes;
            let at = |k: usize| [nodes.points[k][0], nodes.points[k][1]];
            let mark = |k: usize| ContactMark {
                from: at(k),
                to: at(k + 1),
                touch: Touch::of_state(None, nodes.active[k] && nodes.active[k + 1]),
            };
            (0..nodes.t.len() - 1).map(mark).collect::<Vec<_>>()
        };
        profiles.iter().flat_map(of).collect()
    }

    fn u(&self) -> Vec<f64> {
        let value =
            |p: &[f64; 2]| (0.9 * p[0]).sin() + 0.4 * (1.3 * p[1]).cos() + 0.2 * p[0].floor();
        self.points.iter().map(value).collect()
    }
}

/// Width and height of a PNG, and the number of its pixels in the colour of the zone.
fn png(path: &PathBuf) -> (u32, u32, usize) {
    let mut reader = png::Decoder::new(std::fs::File::open(path).unwrap())
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let strong = pixels
        .chunks(3)
        .filter(|p| p == &[0xe8, 0x10, 0x3c])
        .count();
    (info.width, info.height, strong)
}

#[test]
fn two_interfaces() {
    let dir = directory("2");
    let bodies = Bodies::new(3, 1, 32);
    let profiles = bodies.profiles(3e-4);
    assert_eq!(profiles.len(), 2);
    profile::write(&profiles, "three bodies in a row", &dir).unwrap();
    let (u, rho) = (bodies.u(), vec![1.0; bodies.quads.len()]);
    let mut marks = bodies.marks(&profiles);
    // An obstacle under the first body that is partly in contact, and one above the last body in contact at a single
    // node.
    marks.extend((0..32).map(|k| ContactMark {
        from: [f64::from(k) / 32.0, 0.0],
        to: [f64::from(k + 1) / 32.0, 0.0],
        touch: Touch::of_state(None, (8..20).contains(&k)),
    }));
    marks.push(ContactMark {
        from: [2.5, 1.0],
        to: [2.5, 1.0],
        touch: Touch::Closed,
    });
    let path = dir.join("solution.png");
    field::write(
        &field::Beside::default(),
        &bodies.mesh(),
        &[
            ShownField::nodal("solution u", &u),
            ShownField::coefficient("coefficient ρ", &rho),
        ],
        &Marked {
            contact: &marks,
            tractions: &[],
        },
        false,
        "three bodies in a row",
        &path,
    )
    .unwrap();
    let with = png(&path);
    let plain = dir.join("plain.png");
    field::write(
        &field::Beside::default(),
        &bodies.mesh(),
        &[
            ShownField::nodal("solution u", &u),
            ShownField::coefficient("coefficient ρ", &rho),
        ],
        &Marked::default(),
        false,
        "three bodies in a row",
        &plain,
    )
    .unwrap();
    let without = png(&plain);
    assert!(with.2 > 1000 && without.2 == 0, "{} {}", with.2, without.2);
    assert!(with.0 == without.0 && with.1 > without.1);
}

#[test]
fn one_hundred_and_eighty_interfaces() {
    let dir = directory("180");
    let bodies = Bodies::new(10, 10, 16);
    let profiles = bodies.profiles(2.0);
    assert_eq!(profiles.len(), 180);
    profile::write(&profiles, "10 × 10 bodies", &dir).unwrap();
    let csv = std::fs::read_to_string(dir.join("interfaces.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 180 * 17, "the CSV has them all");
    let (u, rho) = (
        bodies.u(),
        bodies
            .body
            .iter()
            .map(|&b| f64::from(1 + b % 3))
            .collect::<Vec<_>>(),
    );
    let marks = bodies.marks(&profiles);
    let path = dir.join("solution.png");
    field::write(
        &field::Beside::default(),
        &bodies.mesh(),
        &[
            ShownField::nodal("solution u", &u),
            ShownField::coefficient("coefficient ρ", &rho),
        ],
        &Marked {
            contact: &marks,
            tractions: &[],
        },
        false,
        "10 × 10 bodies",
        &path,
    )
    .unwrap();
    assert!(png(&path).2 > 1000);
}

/// An element of an XML file.
#[derive(Debug, Default)]
struct Element {
    name: String,
    attributes: Vec<(String, String)>,
    text: String,
    children: Vec<Element>,
}

impl Element {
    fn get(&self, attribute: &str) -> &str {
        let found = self.attributes.iter().find(|a| a.0 == attribute);
        &found
            .unwrap_or_else(|| panic!("{} has no {attribute}", self.name))
            .1
    }

    fn child(&self, name: &str) -> &Element {
        let found = self.children.iter().find(|c| c.name == name);
        found.unwrap_or_else(|| panic!("{} has no {name}", self.name))
    }
}

/// Parses the XML that we write: a declaration, elements with attributes, text. Every tag must be closed.
fn xml(text: &str) -> Element {
    let unescape = |s: &str| {
        let s = s.replace("&quot;", "\"").replace("&lt;", "<");
        s.replace("&amp;", "&")
    };
    let mut open = vec![Element::default()];
    let mut rest = text
        .strip_prefix("<?xml version=\"1.0\"?>")
        .expect("a declaration");
    while let Some((before, after)) = rest.split_once('<') {
        open.last_mut().unwrap().text += before.trim();
        let (tag, after) = after.split_once('>').expect("tags end");
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            let done = open.pop().unwrap();
            assert_eq!(done.name, name, "tags are closed in order");
            open.last_mut().expect("one root").children.push(done);
            continue;
        }
        let (tag, empty) = tag.strip_suffix('/').map_or((tag, false), |t| (t, true));
        let (name, mut list) = tag.split_once(' ').unwrap_or((tag, ""));
        let mut element = Element {
            name: name.to_string(),
            ..Element::default()
        };
        while let Some((key, value)) = list.trim_start().split_once("=\"") {
            let (value, more) = value.split_once('"').expect("a closing quote");
            element.attributes.push((key.to_string(), unescape(value)));
            list = more;
        }
        assert!(list.trim().is_empty(), "{list}");
        if empty {
            open.last_mut().unwrap().children.push(element);
        } else {
            open.push(element);
        }
    }
    assert!(
        rest.trim().is_empty() && open.len() == 1,
        "everything is closed"
    );
    let mut root = open.pop().unwrap();
    assert_eq!(root.children.len(), 1);
    root.children.pop().unwrap()
}

/// The bytes of the numbers of an inline array: blocks of zlib after their number, two sizes and the size of each.
fn bytes(array: &Element) -> Vec<u8> {
    assert_eq!(array.get("format"), "binary");
    const DIGITS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = Vec::new();
    for group in array.text.as_bytes().chunks(4) {
        let digit = |c: &u8| DIGITS.find(char::from(*c)).unwrap_or(0) as u32;
        let bits = group.iter().fold(0, |bits, c| (bits << 6) | digit(c));
        let padding = group.iter().filter(|&&c| c == b'=').count();
        out.extend(&bits.to_be_bytes()[1..4 - padding]);
    }
    let word = |k: usize| u64::from_le_bytes(out[8 * k..8 * k + 8].try_into().unwrap()) as usize;
    let blocks = word(0);
    let (mut start, mut data) = (8 * (3 + blocks), Vec::new());
    for k in 0..blocks {
        let end = start + word(3 + k);
        let mut block = ZlibDecoder::new(&out[start..end]);
        block.read_to_end(&mut data).unwrap();
        start = end;
    }
    assert_eq!(start, out.len());
    data
}

fn floats(array: &Element) -> Vec<f64> {
    assert_eq!(array.get("type"), "Float64");
    bytes(array)
        .chunks(8)
        .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
        .collect()
}

fn integers(array: &Element) -> Vec<i32> {
    assert_eq!(array.get("type"), "Int32");
    bytes(array)
        .chunks(4)
        .map(|b| i32::from_le_bytes(b.try_into().unwrap()))
        .collect()
}

#[test]
fn a_time_series_reads_back() {
    let dir = directory("series");
    let bodies = Bodies::new(2, 1, 8);
    let points: Vec<[f64; 3]> = bodies.points.iter().map(|p| [p[0], p[1], 0.0]).collect();
    let mut pvd = Pvd::new(dir.join("solution.pvd"));
    let mut steps = Vec::new();
    for step in 1..=3 {
        let t = f64::from(step) / 3.0;
        let profiles = bodies.profiles(t);
        let mut contact = ContactFields::new(points.len());
        for p in profiles.iter().map(|p| &p.nodes) {
            for k in 0..p.t.len() {
                let here = |q: &&usize| bodies.points[**q] == p.points[k][..2];
                for &point in (0..points.len()).collect::<Vec<_>>().iter().filter(here) {
                    contact
                        .add(point, p.multiplier[k], p.gap[k], p.active[k])
                        .unwrap();
                }
            }
        }
        let u: Vec<f64> = bodies.u().iter().map(|u| t * u).collect();
        let file = dir.join(format!("steps/solution_{step:04}.vtu"));
        let mut cells = Cells::default();
        for quad in &bodies.quads {
            cells.push(CellKind::Quad4, quad);
        }
        let grid = Vtu::new(&points, &cells);
        contact
            .on(grid.point_data("u", 1, &u[..]))
            .write(&file)
            .unwrap();
        pvd.add(t, &file).unwrap();
        steps.push(LoadStep {
            t,
            outer_iterations: 3,
            iterations: 40,
            active: profiles[0].nodes.active.iter().filter(|a| **a).count(),
            energy: -t * t,
            contact_force: profiles[0].nodes.force(),
            ..LoadStep::default()
        });

        // After every step the collection exists and lists every file so far.
        let collection = xml(&std::fs::read_to_string(dir.join("solution.pvd")).unwrap());
        assert_eq!(collection.get("type"), "Collection");
        let sets = &collection.child("Collection").children;
        assert_eq!(sets.len(), step as usize);
        for (k, set) in sets.iter().enumerate() {
            let time: f64 = set.get("timestep").parse().unwrap();
            assert_eq!(time, (k + 1) as f64 / 3.0);
            assert!(!set.get("file").starts_with('/'));
            let file = xml(&std::fs::read_to_string(dir.join(set.get("file"))).unwrap());
            let piece = file.child("UnstructuredGrid").child("Piece");
            assert_eq!(piece.get("NumberOfPoints"), "162");
            let arrays = &piece.child("PointData").children;
            let named = |name: &str| arrays.iter().find(|a| a.get("Name") == name).expect(name);
            let (multiplier, gap) = (floats(named("multiplier")), floats(named("gap")));
            let (touches, candidate) = (integers(named("contact")), integers(named("candidate")));
            let p = &bodies.profiles(time)[0].nodes;
            assert!(multiplier.iter().chain(&gap).all(|v| v.is_finite()));
            // Both sides of the interface have multipliers, the rest of the bodies has none.
            let total: f64 = multiplier.iter().sum();
            assert!((total - 2.0 * p.force()).abs() < 1e-12 && total > 0.0);
            assert_eq!(candidate.iter().sum::<i32>() as usize, 2 * p.t.len());
            let closed = p.active.iter().filter(|a| **a).count();
            assert_eq!(touches.iter().sum::<i32>() as usize, 2 * closed);
            for (q, point) in bodies.points.iter().enumerate() {
                assert_eq!(candidate[q] == 1, point[0] == 1.0);
                assert!(
                    candidate[q] == 1 || (multiplier[q] == 0.0 && gap[q] == 0.0 && touches[q] == 0)
                );
                assert!(touches[q] == 0 || gap[q] == 0.0);
            }
        }
    }
    load_steps::write(&steps, "a ramp in three steps", &dir).unwrap();
}
