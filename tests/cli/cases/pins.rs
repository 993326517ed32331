//! Decks with pins in rings, pressed in by a thousandth of their radius: nothing but friction would hold their turn.

use std::fmt::Write;

/// Cells around a pin.
const AROUND: usize = 16;

/// Radii of the nodes of a pin and of its ring.
const PIN: [f64; 3] = [0.3, 0.65, 1.001];
const RING: [f64; 3] = [1.0, 1.5, 2.0];

/// Pins with their rings in a row, the first at a point. Coordinates have so many significant digits.
pub struct Pins<'a> {
    pub digits: usize,
    pub at: [f64; 2],
    pub count: usize,
    /// The first node stands at this angle.
    pub phase: f64,
    /// Solids of one layer in place of plane strain.
    pub solid: bool,
    /// Lines under *BOUNDARY; NSET PIN has the nodes of all pins, and P1 and P2 are opposite nodes of the first bore.
    pub held: &'a str,
    /// Lines after *BOUNDARY; `BORE` stands for those of *DLOAD with 100 in all bores.
    pub load: &'a str,
}

impl Default for Pins<'_> {
    fn default() -> Self {
        Pins {
            digits: 12,
            at: [0.0; 2],
            count: 1,
            phase: 0.0131,
            solid: false,
            held: "",
            load: "",
        }
    }
}

impl Pins<'_> {
    /// A number as %.Ng of C writes it, but for zeros at the end.
    fn number(&self, x: f64) -> String {
        let rounded: f64 = format!("{x:.*e}", self.digits - 1)
            .parse()
            .expect("a number");
        format!("{rounded}")
    }

    pub fn deck(&self) -> String {
        let layers = if self.solid { 2 } else { 1 };
        let mut text = String::from("*NODE\n");
        let node = |pin: usize, ring: usize, layer: usize, r: usize, k: usize| {
            1 + (((pin * 2 + ring) * layers + layer) * 3 + r) * AROUND + k % AROUND
        };
        for pin in 0..self.count {
            let centre = [self.at[0] + 5.0 * pin as f64, self.at[1]];
            for (ring, radii) in [PIN, RING].iter().enumerate() {
                for layer in 0..layers {
                    for (r, radius) in radii.iter().enumerate() {
                        for k in 0..AROUND {
                            let angle =
                                self.phase + std::f64::consts::TAU * k as f64 / AROUND as f64;
                            let id = node(pin, ring, layer, r, k);
                            let x = self.number(centre[0] + radius * angle.cos());
                            let y = self.number(centre[1] + radius * angle.sin());
                            writeln!(text, "{id}, {x}, {y}, {}", 0.5 * layer as f64).unwrap();
                        }
                    }
                }
            }
        }
        let cell = |pin: usize, ring: usize, r: usize, k: usize| {
            1 + ((pin * 2 + ring) * 2 + r) * AROUND + k
        };
        let kind = if self.solid { "C3D8" } else { "CPE4" };
        for (ring, name) in ["PINS", "RINGS"].iter().enumerate() {
            writeln!(text, "*ELEMENT, TYPE={kind}, ELSET={name}").unwrap();
            for (pin, r, k) in self.cells() {
                let layer = |l: usize| {
                    let corners = [(r, k), (r + 1, k), (r + 1, k + 1), (r, k + 1)];
                    corners
                        .map(|(r, k)| node(pin, ring, l, r, k).to_string())
                        .join(", ")
                };
                let nodes: Vec<String> = (0..layers).map(layer).collect();
                writeln!(text, "{}, {}", cell(pin, ring, r, k), nodes.join(", ")).unwrap();
            }
        }
        let mut set = |name: &str, nodes: Vec<usize>| {
            let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
            let lines: Vec<String> = nodes.chunks(8).map(|line| line.join(", ")).collect();
            writeln!(text, "*NSET, NSET={name}\n{}", lines.join(",\n")).unwrap();
        };
        let all = |ring: usize, rs: std::ops::Range<usize>| -> Vec<usize> {
            let pins = 0..self.count;
            let of = |pin: usize| {
                let rs = rs.clone();
                (0..layers).flat_map(move |l| {
                    let rs = rs.clone();
                    rs.flat_map(move |r| (0..AROUND).map(move |k| node(pin, ring, l, r, k)))
                })
            };
            pins.flat_map(of).collect()
        };
        set("PIN", all(0, 0..3));
        set("OUT", all(1, 2..3));
        set("P1", vec![node(0, 0, 0, 0, 0)]);
        set("P2", vec![node(0, 0, 0, 0, AROUND / 2)]);
        let [outer, inner] = if self.solid { [4, 6] } else { [2, 4] };
        for (name, ring, r, side) in [("SPIN", 0, 1, outer), ("SRING", 1, 0, inner)] {
            writeln!(text, "*SURFACE, NAME={name}").unwrap();
            for (pin, _, k) in self.cells().filter(|c| c.1 == 0) {
                writeln!(text, "{}, S{side}", cell(pin, ring, r, k)).unwrap();
            }
        }
        let bores = self.cells().filter(|c| c.1 == 0);
        let bores = bores.map(|(pin, _, k)| format!("{}, P{inner}, 100.\n", cell(pin, 0, 0, k)));
        let load = self
            .load
            .replace("BORE", &format!("*DLOAD\n{}", bores.collect::<String>()));
        let (components, held) = (if self.solid { 3 } else { 2 }, self.held);
        text + &format!(
            "*MATERIAL, NAME=M\n*ELASTIC\n210000., 0.3\n*SOLID SECTION, ELSET=PINS, MATERIAL=M\n\
             *SOLID SECTION, ELSET=RINGS, MATERIAL=M\n*SURFACE INTERACTION, NAME=I\n\
             *CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSPIN, SRING\n*STEP\n*STATIC\n\
             *BOUNDARY\nOUT, 1, {components}\n{held}{load}*NODE PRINT, NSET=PIN\nU\n*END STEP\n"
        )
    }

    /// Pin, layer of cells between radii, and cell around.
    fn cells(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let all = (0..self.count).flat_map(|pin| (0..2).map(move |r| (pin, r)));
        all.flat_map(|(pin, r)| (0..AROUND).map(move |k| (pin, r, k)))
    }
}

/// A pin alone, whose rim cannot move radially, with 100 in its bore. The rim is held by supports in turned systems, or
/// by an equation at each node whose coefficients have as many digits as the coordinates.
pub fn on_supports(digits: usize, at: [f64; 2], by_equations: bool) -> String {
    let pins = Pins {
        digits,
        at,
        ..Pins::default()
    };
    let angle = |k: usize| pins.phase + std::f64::consts::TAU * k as f64 / AROUND as f64;
    let node = |r: usize, k: usize| 1 + r * AROUND + k % AROUND;
    let mut text = String::from("*NODE\n");
    for (r, radius) in PIN.iter().enumerate() {
        for k in 0..AROUND {
            let x = pins.number(at[0] + radius * angle(k).cos());
            let y = pins.number(at[1] + radius * angle(k).sin());
            writeln!(text, "{}, {x}, {y}, 0", node(r, k)).unwrap();
        }
    }
    text += "*ELEMENT, TYPE=CPE4, ELSET=PIN\n";
    for (r, k) in (0..2).flat_map(|r| (0..AROUND).map(move |k| (r, k))) {
        let corners = [(r, k), (r + 1, k), (r + 1, k + 1), (r, k + 1)];
        let corners = corners.map(|(r, k)| node(r, k).to_string());
        writeln!(text, "{}, {}", 1 + r * AROUND + k, corners.join(", ")).unwrap();
    }
    writeln!(text, "*NSET, NSET=PIN, GENERATE\n1, {}", 3 * AROUND).unwrap();
    writeln!(
        text,
        "*NSET, NSET=RIM, GENERATE\n{}, {}",
        node(2, 0),
        3 * AROUND
    )
    .unwrap();
    text += "*MATERIAL, NAME=M\n*ELASTIC\n210000., 0.3\n*SOLID SECTION, ELSET=PIN, MATERIAL=M\n";
    let mut held = String::new();
    if by_equations {
        text += "*EQUATION\n";
        for k in 0..AROUND {
            let [c, s] = [angle(k).cos(), angle(k).sin()].map(|x| pins.number(x));
            writeln!(text, "2\n{0}, 1, {c}, {0}, 2, {s}", node(2, k)).unwrap();
        }
    } else {
        let [x, y] = at;
        writeln!(
            text,
            "*TRANSFORM, TYPE=C, NSET=RIM\n{x}, {y}, 0, {x}, {y}, 1"
        )
        .unwrap();
        held += "*BOUNDARY\nRIM, 1, 1\n";
    }
    let bore: String = (1..=AROUND).map(|e| format!("{e}, P4, 100.\n")).collect();
    text + &format!("*STEP\n*STATIC\n{held}*DLOAD\n{bore}*NODE PRINT, NSET=PIN\nU\n*END STEP\n")
}
