//! A deck with equations between displacements: two square plates, one on the other, in contact.

/// A plate of n × n cells with the lower left corner at (0, y), as lines of nodes and of cells. Numbers of both follow
/// `first`.
struct Plate {
    n: usize,
    y: usize,
    first: usize,
}

impl Plate {
    /// The number of node (i, j).
    fn at(&self, i: usize, j: usize) -> usize {
        self.first + 1 + j * (self.n + 1) + i
    }

    fn nodes(&self) -> String {
        let h = 1.0 / self.n as f64;
        let line = |(i, j): (usize, usize)| {
            let [x, y] = [i as f64 * h, self.y as f64 + j as f64 * h];
            format!("{},{x},{y}\n", self.at(i, j))
        };
        pairs(self.n + 1).map(line).collect()
    }

    fn cells(&self) -> String {
        let line = |(i, j): (usize, usize)| {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
            let [a, b, c, d] = corners.map(|(p, q)| self.at(i + p, j + q));
            format!("{},{a},{b},{c},{d}\n", self.cell(i, j))
        };
        pairs(self.n).map(line).collect()
    }

    /// The number of cell (i, j).
    fn cell(&self, i: usize, j: usize) -> usize {
        self.first + 1 + j * self.n + i
    }
}

/// (i, j) with both below n, row by row.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |j| (0..n).map(move |i| (i, j)))
}

/// An equation of (node, direction, coefficient), in the form of a deck.
fn equation(terms: &[(usize, usize, f64)]) -> String {
    let list: Vec<String> = terms
        .iter()
        .map(|(n, d, b)| format!("{n},{d},{b}"))
        .collect();
    format!("{}\n{}\n", terms.len(), list.join(","))
}

/// The deck, with plates of n × n cells; `more` are further equations. The right side of the lower plate is its left
/// side moved, however far, except where bounds decide; the upper plate has a flat top and sides of one shape. One
/// value follows the mean of its neighbours, one a given value, and one equation says what others say.
pub fn joined_plates(n: usize, more: &[&[(usize, usize, f64)]]) -> String {
    let [low, up] = [(0, 0), (1, 1_000_000)].map(|(y, first)| Plate { n, y, first });
    let mut equations = String::new();
    let mut add = |terms: &[(usize, usize, f64)]| equations += &equation(terms);
    for j in 1..=n {
        // At the top of the lower plate contact bounds u_y.
        for d in 1..=if j < n { 2 } else { 1 } {
            let [right, left] = [low.at(n, j), low.at(0, j)];
            let [corner, origin] = [low.at(n, 0), low.at(0, 0)];
            add(&[
                (right, d, 1.0),
                (left, d, -1.0),
                (corner, d, -1.0),
                (origin, d, 1.0),
            ]);
        }
        add(&[(up.at(n, j), 1, 1.0), (up.at(0, j), 1, -1.0)]);
        add(&[(up.at(j, n), 2, 2.0), (up.at(0, n), 2, -2.0)]);
    }
    add(&[(up.at(1, n), 2, 1.0), (up.at(2, n), 2, -1.0)]);
    let m = n / 2;
    let around = [(m - 1, m), (m + 1, m), (m, m - 1), (m, m + 1)];
    let around = around.map(|(i, j)| (low.at(i, j), 2, -0.25));
    add(&[&[(low.at(m, m), 2, 1.0)][..], &around].concat());
    add(&[(low.at(2, n - 2), 1, 1.0), (low.at(1, 1), 1, -0.5)]);
    more.iter().for_each(|terms| add(terms));
    let side = |plate: &Plate, j: usize, s: &str| -> String {
        let line = |i: usize| format!("{},{s}\n", plate.cell(i, j));
        (0..n).map(line).collect()
    };
    let pressed = |i: usize| format!("{},2,{}\n", up.at(i, n), -1.0 / n as f64);
    let loads: String = (0..=n).map(pressed).collect();
    let [origin, corner, given] = [low.at(0, 0), low.at(n, 0), low.at(1, 1)];
    let [pulled, held] = [up.at(n, 1), up.at(0, 0)];
    format!(
        "*NODE\n{}{}*ELEMENT,TYPE=CPE4,ELSET=E\n{}{}*SURFACE,NAME=LOW\n{}*SURFACE,NAME=UP\n{}\
         *MATERIAL,NAME=M\n*ELASTIC\n100,0.3\n*SOLID SECTION,ELSET=E,MATERIAL=M\n\
         *SURFACE INTERACTION,NAME=I\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=HARD\n\
         *CONTACT PAIR,INTERACTION=I,SMALL SLIDING\nUP,LOW\n*EQUATION\n{equations}\
         *BOUNDARY\n{origin},1,2\n{corner},2\n{given},1,1,0.01\n{held},1\n\
         *STEP\n*STATIC\n*CLOAD\n{loads}{pulled},2,0.4\n*END STEP\n",
        low.nodes(),
        up.nodes(),
        low.cells(),
        up.cells(),
        side(&low, n - 1, "S3"),
        side(&up, 0, "S1"),
    )
}

/// The number of node i on the upper side of the lower plate of [`joined_plates`].
pub fn on_top(n: usize, i: usize) -> usize {
    let low = Plate { n, y: 0, first: 0 };
    low.at(i, n)
}
