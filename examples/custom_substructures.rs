//! Problem built by hand: no scene, no mesh, no finite elements.
//!
//!     cargo run --release --example custom_substructures
//!     mpirun -n 2 target/release/examples/custom_substructures -fetifeti_spectrum
//!
//! A sheet of resistors, 13 × 4 nodes. It is cut into three boards (the bodies) that overlap in a column of nodes, and
//! each board into two halves (the subdomains). The matrix of a half is its graph Laplacian. Wires tie the boards
//! together, and between the second and the third there is a battery in every wire: u_2 − u_3 = 1.5. One node of the
//! first board is earthed, the other boards float, and the solver has to detect that by itself: no
//! `near_kernel` is given.

use std::process::ExitCode;

use fetifeti::problem::{Csr, RowLabel, RowSource};
use fetifeti::settings::MethodSettings;
use fetifeti::{max_all, Error, FetiFeti, Problem, Result, Row, Session, Subdomain};

const BOARDS: usize = 3;
const HALVES: usize = 2;
/// Edges of a half along x, nodes along y.
const WIDTH: usize = 2;
const HEIGHT: usize = 4;
const COLUMNS: usize = BOARDS * HALVES * WIDTH + 1;
const VOLTS: f64 = 1.5;

fn main() -> ExitCode {
    fetifeti::run(run)
}

fn run(session: &Session) -> Result<()> {
    let n = BOARDS * HALVES;
    let mine = fetifeti::share(session, n);
    let mut problem =
        Problem::new((1..=BOARDS).map(|b| format!("board {b}")), n).with_subdomains(mine.map(half));
    // Any rank may provide any row, as long as exactly one does and rows of one block stay together.
    if session.rank() == 0 {
        problem.rows = wires();
    }
    let settings = MethodSettings::default().rtol(1e-12);
    let mut solver = FetiFeti::new(session, problem, settings)?;
    let spectrum = solver.spectrum()?.expect("there are multipliers");
    let solution = solver.solve()?;
    if !solution.converged() {
        return Err(Error::not_converged(solution.status.to_string()));
    }

    // The same sheet by one dense matrix.
    let direct = direct();
    let mut worst = [0.0f64];
    for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
        for (dof, u) in sub.dofs.iter().zip(u) {
            let (board, x, y) = (
                sub.body,
                *dof as usize % COLUMNS,
                *dof as usize / COLUMNS % HEIGHT,
            );
            let expected = direct[x * HEIGHT + y] - battery(board);
            worst[0] = worst[0].max((u - expected).abs());
        }
    }
    max_all(session.comm(), &mut worst);

    let facts = solver.facts();
    if session.rank() == 0 {
        println!(
            "bodies        {BOARDS}, {} of them floating",
            facts.floating_bodies
        );
        println!(
            "multipliers   {} inside boards, {} wires between them",
            facts.multipliers_local, facts.multipliers_global
        );
        println!("kappa         {:.4}", spectrum.kappa());
        println!("iterations    {}", solution.iterations);
        println!(
            "largest difference to the direct solution: {:.1e} V",
            worst[0]
        );
    }
    assert_eq!(facts.floating_bodies, 2);
    assert!(worst[0] < 1e-9, "not the solution");
    Ok(())
}

/// Conductance of the edge from (x, y) to the right or upwards; any positive function will do.
fn conductance(x: usize, y: usize, upwards: bool) -> f64 {
    1.0 + ((7 * x + 3 * y + 5 * usize::from(upwards)) % 11) as f64
}

/// All edges between columns x0 and x1: (node, node, conductance). An upward edge in an inner border column is a pair
/// of parallel resistors, one on either side of the cut.
fn edges(x0: usize, x1: usize) -> Vec<([usize; 2], [usize; 2], f64)> {
    let mut out = Vec::new();
    for x in x0..=x1 {
        for y in 0..HEIGHT {
            if x < x1 {
                out.push(([x, y], [x + 1, y], conductance(x, y, false)));
            }
            if y + 1 < HEIGHT {
                let on_a_cut = x % WIDTH == 0 && x > 0 && x + 1 < COLUMNS;
                let share = if on_a_cut { 0.5 } else { 1.0 };
                out.push(([x, y], [x, y + 1], share * conductance(x, y, true)));
            }
        }
    }
    out
}

/// Current fed into a node: 2 A into the last column; all of it leaves through earth.
fn current(x: usize) -> f64 {
    if x + 1 == COLUMNS {
        2.0 / HEIGHT as f64
    } else {
        0.0
    }
}

fn earthed(node: [usize; 2]) -> bool {
    node == [0, 0]
}

/// Global number of a node. Both halves of a board number their common nodes alike; nodes of different boards differ.
fn dof(board: usize, [x, y]: [usize; 2]) -> u64 {
    ((board * HEIGHT + y) * COLUMNS + x) as u64
}

/// One subdomain: the matrix, the load and the names of its unknowns.
fn half(index: usize) -> Subdomain {
    let board = index / HALVES;
    let (x0, x1) = (index * WIDTH, (index + 1) * WIDTH);
    // The earthed node has a prescribed value and is no unknown.
    let nodes: Vec<[usize; 2]> = (x0..=x1)
        .flat_map(|x| (0..HEIGHT).map(move |y| [x, y]))
        .filter(|&node| !earthed(node))
        .collect();
    let unknown = |node| nodes.iter().position(|&k| k == node).map(|i| i as u32);
    let mut triplets = Vec::new();
    for (a, b, c) in edges(x0, x1) {
        let (i, j) = (unknown(a), unknown(b));
        triplets.extend(i.map(|i| (i, i, c)));
        triplets.extend(j.map(|j| (j, j, c)));
        if let (Some(i), Some(j)) = (i, j) {
            triplets.extend([(i, j, -c), (j, i, -c)]);
        }
    }
    // The ends of the cut between the halves are primal. Without a primal dof a half would be singular, and the solver
    // would have to choose fixing dofs (it could).
    let ends = [0, HEIGHT - 1].map(|y| [(2 * board + 1) * WIDTH, y]);
    let mut primal: Vec<u32> = ends.into_iter().filter_map(unknown).collect();
    primal.sort_unstable();
    let k = Csr::from_triplets(nodes.len(), &triplets);
    let f = nodes.iter().map(|node| current(node[0])).collect();
    let dofs = nodes.iter().map(|&node| dof(board, node)).collect();
    Subdomain::new(index, board, k, f, dofs).with_primal(primal)
}

/// One row for each node that two boards share: u_left − u_right = volts.
fn wires() -> Vec<Row> {
    let mut rows = Vec::new();
    for left in 0..BOARDS - 1 {
        let x = (left + 1) * HALVES * WIDTH;
        for y in 0..HEIGHT {
            let terms = [(dof(left, [x, y]), 1.0), (dof(left + 1, [x, y]), -1.0)];
            let wire = Row::equality(terms, battery(left + 1) - battery(left))
                // No two wires end in the same node: every row is a block of its own.
                .in_block(rows.len() as u64)
                // The label says which boards the wire joins; solutions return it with the row.
                .with_label(RowLabel::new(RowSource::Interface(left), [None; 2]));
            rows.push(wire);
        }
    }
    rows
}

/// The voltage of a board relative to the first one, as lowered by the batteries.
fn battery(board: usize) -> f64 {
    if board == 2 {
        VOLTS
    } else {
        0.0
    }
}

/// Voltages of the whole sheet without batteries, node (x, y) at x · HEIGHT + y, by Gaussian elimination.
fn direct() -> Vec<f64> {
    let n = COLUMNS * HEIGHT;
    let at = |[x, y]: [usize; 2]| x * HEIGHT + y;
    let mut a = vec![vec![0.0; n + 1]; n];
    for s in 0..BOARDS * HALVES {
        for (p, q, c) in edges(s * WIDTH, (s + 1) * WIDTH) {
            let (i, j) = (at(p), at(q));
            a[i][i] += c;
            a[j][j] += c;
            a[i][j] -= c;
            a[j][i] -= c;
        }
    }
    for x in 0..COLUMNS {
        for y in 0..HEIGHT {
            // The halves on both sides of a cut feed their copy of a node; there is no current at the cuts here.
            a[at([x, y])][n] = current(x);
        }
    }
    // Earth: replace the equation of node (0, 0) by u = 0.
    a[0] = vec![0.0; n + 1];
    a[0][0] = 1.0;
    for k in 0..n {
        let pivot = a[k].clone(); // no pivoting: the matrix is an M-matrix
        for row in a.iter_mut().skip(k + 1) {
            let factor = row[k] / pivot[k];
            row.iter_mut()
                .zip(&pivot)
                .for_each(|(r, p)| *r -= factor * p);
        }
    }
    let mut u = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| a[i][j] * u[j]).sum();
        u[i] = (a[i][n] - known) / a[i][i];
    }
    u
}
