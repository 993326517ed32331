//! A box that is cut into equal bodies.

use std::collections::HashMap;

use super::body::{held_all_round, BodySpec, Load, SIDES};
use mesh::{places, BoxMesh};

/// A box cut into `bodies[0]` × `bodies[1]` (× `bodies[2]`) equal bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct GridSpec {
    /// Bodies in x, y and z.
    pub bodies: [usize; 3],
    /// The whole grid: its box, its map and its outer sides. Elements and subdomains are those of every body. Bodies
    /// are named `<name><i>_<j>` (`<name><i>_<j>_<k>` in three dimensions), column i, row j and layer k.
    pub whole: BodySpec,
}

impl GridSpec {
    /// The unit square, held all round, with ρ = 1 and f = 1.
    pub fn unit_square(bodies: [usize; 2], subdomains: [usize; 2], elements: [usize; 2]) -> Self {
        let mesh = BoxMesh::plane([0.0; 2], [1.0; 2], elements, subdomains);
        GridSpec::held([bodies[0], bodies[1], 1], mesh)
    }

    /// The unit cube, held all round, with ρ = 1 and f = 1.
    pub fn unit_cube(bodies: [usize; 3], subdomains: [usize; 3], elements: [usize; 3]) -> Self {
        let mesh = BoxMesh {
            origin: [0.0; 3],
            size: [1.0; 3],
            elements,
            subdomains,
        };
        GridSpec::held(bodies, mesh)
    }

    fn held(bodies: [usize; 3], mesh: BoxMesh) -> Self {
        let mut whole = BodySpec::new("b", mesh);
        whole.load = Load::constant(1.0);
        whole.dirichlet = held_all_round();
        GridSpec { bodies, whole }
    }

    /// Its bodies, layer by layer and row by row.
    pub fn expand(&self) -> Vec<BodySpec> {
        let GridSpec { bodies, whole } = self;
        let grid = whole
            .mesh
            .grid()
            .expect("a grid of bodies is cut from a box");
        let BoxMesh { origin, size, .. } = *grid;
        // Bodies at the same sides of the grid share what they have in common.
        let mut known: HashMap<[bool; SIDES.len()], BodySpec> = HashMap::new();
        let body = |place: [usize; 3]| {
            let outer = |s: usize| place[s / 2] == [0, bodies[s / 2] - 1][s % 2];
            let of_sides = |outer: [bool; SIDES.len()]| {
                let mut body = whole.clone();
                body.rho = whole.rho.over(*bodies);
                body.poisson = whole.poisson.over(*bodies);
                body.surface.retain(|load| outer[load.side]);
                body.springs.retain(|(side, _)| outer[*side]);
                let inner = body.dirichlet.iter_mut().zip(outer);
                let inner = inner.filter(|(_, outer)| !outer);
                inner.for_each(|(given, _)| *given = [const { None }; 3]);
                body
            };
            let at = std::array::from_fn(outer);
            let mut body = known.entry(at).or_insert_with(|| of_sides(at)).clone();
            let [i, j, k] = place;
            body.name = match whole.mesh.dim() {
                2 => format!("{}{i}_{j}", whole.name),
                _ => format!("{}{i}_{j}_{k}", whole.name),
            };
            body.place = place;
            let mut mesh = *grid;
            for d in 0..3 {
                mesh.origin[d] = origin[d] + size[d] * (place[d] as f64 / bodies[d] as f64);
                // The same to the last bit for every body: equal subdomains then have equal matrices.
                mesh.size[d] = size[d] / bodies[d] as f64;
            }
            body.mesh = mesh.into();
            body
        };
        places(*bodies).map(body).collect()
    }
}
