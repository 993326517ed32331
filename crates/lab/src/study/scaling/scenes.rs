//! The runs: scenes as text, and their numbers of ranks.

use super::{ScalingProblem, ScalingSeries};

/// The set-up of one measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setup {
    /// The series it belongs to.
    pub series: ScalingSeries,
    /// The problem.
    pub problem: ScalingProblem,
    /// Number of bodies in x and y; two in contact.
    pub bodies: [usize; 2],
    /// Subdomains of a body in each direction.
    pub subdomains: usize,
    /// Elements of a subdomain in each direction.
    pub elements: usize,
    /// MPI ranks.
    pub ranks: usize,
}

/// A body of the predicted problem: subdomains and elements of a subdomain in each direction.
pub fn predicted_body(quick: bool) -> [usize; 2] {
    if quick {
        [2, 8]
    } else {
        [4, 32]
    }
}

/// All runs, in order.
pub fn setups(quick: bool) -> Vec<Setup> {
    let [s, e] = predicted_body(quick);
    let tied = |series, bodies, subdomains, elements, ranks| Setup {
        series,
        problem: ScalingProblem::Tied,
        bodies,
        subdomains,
        elements,
        ranks,
    };
    let mut out = Vec::new();
    // Bodies of fixed size: (subdomains in each direction, bodies in each direction).
    let growing: &[(usize, &[usize])] = if quick {
        &[(1, &[4, 8, 16]), (2, &[2, 4, 8]), (4, &[1, 2, 4])]
    } else {
        &[
            (1, &[8, 16, 32, 64]),
            (2, &[1, 2, 4, 8, 16, 32]),
            (8, &[1, 2, 4, 8]),
        ]
    };
    for &(subdomains, counts) in growing {
        let one = |&n: &usize| tied(ScalingSeries::Bodies, [n, n], subdomains, 8, 1);
        out.extend(counts.iter().map(one));
    }
    // Subdomains of other sizes, to measure the cost of a subdomain.
    let sizes: &[usize] = if quick { &[4, 16] } else { &[4, 16, 32, 64] };
    let one = |&elements: &usize| tied(ScalingSeries::Elements, [2, 2], 4, elements, 1);
    out.extend(sizes.iter().map(one));
    let side = if quick { 3 } else { 6 };
    out.push(tied(ScalingSeries::Elements, [side, side], s, e, 1));
    for ranks in [1, 2, 4] {
        let (bodies, elements) = if quick { (2, 8) } else { (4, 32) };
        out.push(tied(
            ScalingSeries::Strong,
            [bodies, bodies],
            s,
            elements,
            ranks,
        ));
    }
    for ranks in [1, 2, 4] {
        let (subdomains, elements) = if quick { (2, 8) } else { (8, 32) };
        out.push(Setup {
            series: ScalingSeries::Strong,
            problem: ScalingProblem::Contact,
            bodies: [2, 1],
            subdomains,
            elements,
            ranks,
        });
    }
    for (ranks, bodies) in [(1, [2, 2]), (2, [4, 2]), (4, [4, 4])] {
        out.push(tied(ScalingSeries::Weak, bodies, s, e, ranks));
    }
    // A body on every rank; the body in the middle has all eight neighbours.
    let sides: &[usize] = if quick { &[3] } else { &[3, 4, 5, 6] };
    let one = |&n: &usize| tied(ScalingSeries::Neighbours, [n, n], s, e, n * n);
    out.extend(sides.iter().map(one));
    out
}

impl Setup {
    /// Number of bodies.
    pub fn n_bodies(&self) -> usize {
        self.bodies[0] * self.bodies[1]
    }

    /// A description in a few words, for progress and errors.
    pub fn name(&self) -> String {
        format!(
            "{}, {}: {} x {} bodies of {n} x {n} subdomains of {e} x {e} elements on {}",
            self.series.name(),
            self.problem.name(),
            self.bodies[0],
            self.bodies[1],
            match self.ranks {
                1 => "1 rank".to_string(),
                r => format!("{r} ranks"),
            },
            n = self.subdomains,
            e = self.elements,
        )
    }

    /// The scene file. ρ is random by element, from 1 to 2: no two subdomains are equal, so that subdomains on one rank
    /// share no operators.
    pub fn scene(&self) -> String {
        let Setup {
            bodies: [nx, ny],
            subdomains,
            elements,
            ..
        } = *self;
        let n = (nx.max(ny) * subdomains * elements) as f64;
        let rho = format!("1 + mod(43758.5453*sin(12.9898*{n}*x + 78.233*{n}*y + 0.5), 1)");
        let parts = format!(
            "subdomains = {subdomains}\nelements_per_subdomain = {elements}\nrho = \"{rho}\"\n"
        );
        match self.problem {
            ScalingProblem::Tied => format!(
                "[grid]\nbodies = [{nx}, {ny}]\nsize = [{nx}, {ny}]\n\
                 load = \"1 + x + y^2\"\ndirichlet = \"all\"\n{parts}"
            ),
            ScalingProblem::Contact => format!(
                "[[body]]\nname = \"left\"\norigin = [0, 0]\nsize = [1, 1]\ndirichlet = [\"left\"]\n\
                 load = [{{ y = [0.75, 1], value = -3 }}]\n{parts}\n\
                 [[body]]\nname = \"right\"\norigin = [1, 0]\nsize = [1, 1]\n\
                 load = [{{ y = [0, 0.25], value = -1 }}]\n{parts}\n\
                 [[contact]]\nbodies = [\"left\", \"right\"]\ngap = 0\n"
            ),
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/study/scaling/scenes.rs"]
mod tests;
