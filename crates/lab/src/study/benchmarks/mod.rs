//! `study benchmarks`: answers beside references that were not computed by this program: closed forms, equilibrium,
//! other programs. Every case is solved on several meshes; a tolerance that is missed is reported.

mod decks;
mod friction;
mod hertz;
mod meshes;
mod patch;
mod picture;
mod punch;
mod report;
mod rings;
mod runner;
mod stack;
mod three;
mod units;

use std::path::Path;

pub use picture::{figure, markdown, table, text};
pub use report::{
    BenchmarkReport, BenchmarksReport, MeasuredValue, MeshResult, MeshSeries, ReferencePressure,
};
use runner::Runner;

use base::Result;
use petsc::Session;

/// The results of a case: its series, and why parts of it were not run.
type CaseResults = (Vec<MeshSeries>, Vec<String>);

/// A case of the study.
struct BenchmarkCase {
    name: &'static str,
    title: &'static str,
    reference: &'static str,
    run: fn(&mut Runner) -> Result<CaseResults>,
}

/// All cases.
const CASES: [BenchmarkCase; 20] = [
    BenchmarkCase {
        name: "patch",
        title: "Contact patch test: two blocks with different meshes under a pressure of 1 from all sides",
        reference: "the stress is −1 everywhere, so that the pressure between the blocks is 1",
        run: |r| Ok((patch::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "rings",
        title: "Two rings in contact under p0 + p2 cos 2θ from outside; 2n × 3n and 2n × 4n elements",
        reference: "closed form: an Airy function in each ring (tests/data/rings.json)",
        run: |r| Ok((rings::pressed(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "shrink-fit",
        title: "A ring shrunk onto another one with an interference of 5 µm; 2n × 3n and 2n × 4n elements",
        reference: "closed form: Lamé's rings (tests/data/rings.json)",
        run: |r| Ok((rings::shrink(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "hertz-cylinder",
        title: "A steel cylinder (R = 10 mm) on an aluminium block, plane strain, a/R = 0.05",
        reference: "Hertz for half-spaces: a = √(4FR/(πE*)), p0 = 2F/(πa); F is what is applied",
        run: |r| Ok((hertz::cylinder(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "hertz-sphere",
        title: "A steel ball (R = 10 mm) on an aluminium block, a/R = 0.06",
        reference: "Hertz for half-spaces: a = (3FR/(4E*))^(1/3), p0 = 3F/(2πa²); F is what is applied",
        run: |r| Ok((hertz::sphere(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "roller",
        title: "NAFEMS/FENET contact benchmark 1 without friction: a steel roller (R = 50 mm) under 35 kN/mm on an \
                aluminium block of 200 × 200 mm, plane strain",
        reference: "Hertz: a = √(4FR/(πE*)) = 6.21 mm, p0 = 2F/(πa) = 3585 N/mm² (NAFEMS states 6.2 mm and 3.6 GPa)",
        run: |r| Ok((hertz::roller(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "punch",
        title: "A flat punch (20 mm) with round edges (R = 500 mm) on a block, both steel, plane strain",
        reference: "Ciavarella, Hills and Monno (1998) for half-planes; F is what is applied",
        run: |r| Ok((punch::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "hueeber",
        title: "Two cubes on top of each other, decks of CalculiX's tests after Hüeber's thesis",
        reference: "the displacements that CalculiX printed (calculix-ccx-test), \
                    relative to the largest; CalculiX itself",
        run: decks::run,
    },
    BenchmarkCase {
        name: "stack",
        title: "A stack of blocks with different meshes under their own weight; only the lowest is held",
        reference: "equilibrium: the force at each joint is the weight above",
        run: |r| Ok((stack::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "three",
        title: "Three bodies each of which touches both others, under different pressures from the side and from above",
        reference: "equilibrium: the stresses are constant, and the pressures at the joints are those outside",
        run: |r| Ok((three::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "units",
        title: "The rings of SSNP167 in m, mm and µm",
        reference: "the scene in metres: relative differences",
        run: |r| Ok((units::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "incline",
        title: "A block on an incline, on both sides of the angle of friction, μ = 0.3",
        reference: "it stands if and only if tan α ≤ μ; equilibrium",
        run: |r| Ok((friction::incline::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "mindlin-cylinder",
        title: "Cattaneo's and Mindlin's cylinder on a block: pressed down, pushed along, and back; R = 8, E = 200, \
                ν = μ = 0.3",
        reference: "Mindlin and Deresiewicz (1953) for half-planes: c/a = √(1 − Q/μP), on the way back √(1 − ΔQ/2μP)",
        run: |r| Ok((friction::cylinders::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "mindlin-sphere",
        title: "Mindlin's balls: pressed together, pushed along each other, and back; R = 8, E = 200, ν = 0, μ = 0.3",
        reference: "Mindlin and Deresiewicz (1953) for half-spaces: c/a = (1 − Q/μP)^(1/3), on the way back \
                    (1 − ΔQ/2μP)^(1/3)",
        run: |r| Ok((friction::spheres::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "bar",
        title: "A bar of the length 1 and the height h, pressed onto its bed by p = 1 and pulled at one end, μ = 0.3",
        reference: "of a thin bar: it slips over ℓ = F/(μ p), and F² = 2 E h μ p u",
        run: |r| Ok((friction::bar::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "belt",
        title: "A belt of the thickness h around half of a drum of radius R, μ = 0.3",
        reference: "T2/T1 = exp(μ π/(1 + h/2R)), where thin belts have e^{μπ}",
        run: |r| Ok((friction::belt::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "arch",
        title: "A semicircular arch of voussoirs under its weight, at the least thickness and the least friction",
        reference: "limit analysis of rigid voussoirs; 0.1075 of the radius (Milankovitch, 1907) for many",
        run: |r| Ok((friction::arch::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "roller-friction",
        title: "NAFEMS/FENET contact benchmark 1 without friction and with μ = 0.1; the foot of the block is fixed",
        reference: "displacements of the point B, on the block under the roller, of Code_Aster's SSNP154 (V6.03.154), \
                    which takes rotations to be large; the curve is Hertz's p/p0, the bound of τ/(μ p0)",
        run: |r| Ok((friction::roller::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "plate",
        title: "Code_Aster's SSNV128: a plate of 40 × 40 mm on a rigid plane, under pressure from above and from the \
                side, μ = 1",
        reference: "the mean of several programs (Code_Aster's V6.04.128, which keeps 5 %)",
        run: |r| Ok((friction::plate::run(r)?, Vec::new())),
    },
    BenchmarkCase {
        name: "shoe",
        title: "Code_Aster's SSNV503: a shoe on a rigid plane, pressed by 300 N/mm² and pushed from the side, μ = 0.3",
        reference: "equilibrium (Code_Aster's V6.04.503): it sticks under 178.2 N/mm², slips by 9 mm under 181.8 N/mm²",
        run: |r| Ok((friction::shoe::run(r)?, Vec::new())),
    },
];

/// Runs the study, and calls `progress` before every mesh. Scenes and meshes are written into `dir`, which may be the
/// same on all ranks or another one on each. Collective.
///
/// # Errors
/// Those of the disk and of the method.
pub fn run(
    session: &Session,
    quick: bool,
    only: Option<&str>,
    dir: &Path,
    progress: &mut dyn FnMut(&str),
) -> Result<BenchmarksReport> {
    let mut cases = Vec::new();
    let chosen = super::chosen(CASES.into(), |c| c.name, only)?;
    let n = chosen.len();
    for (k, case) in chosen.into_iter().enumerate() {
        let mut runner = Runner {
            session,
            dir,
            quick,
            case: format!("{} of {n}", k + 1),
            progress: &mut *progress,
        };
        let (series, skipped) = (case.run)(&mut runner)?;
        cases.push(BenchmarkReport {
            case: case.name.into(),
            title: case.title.into(),
            reference: case.reference.into(),
            skipped,
            series,
        });
    }
    Ok(BenchmarksReport {
        study: "benchmarks".into(),
        cases,
    })
}
