//! More rigid motions than dense algebra takes: answers of all loops against the assembled reference, and bodies that
//! nothing stops, which are named by loops that had not asked before.

use crate::support::sample::all_cases;
use crate::support::session::with_session;
use crate::support::{assembled, contact_judge, mpi};
use assembled::{Assembled, Reference};
use base::{Error, Result};
use contact_judge::How;
use fetifeti::settings::{ContactType, ProjectorKind};
use fetifeti::{FetiFeti, Settings};
use petsc::Session;
use scene::Scene;

const KINDS: [ContactType; 3] = [
    ContactType::ActiveSet,
    ContactType::AugmentedLagrangian,
    ContactType::Smalbe,
];

/// 5 × 4 × 4 elastic blocks, held at the bottom and normally at the sides: 210 rigid motions.
fn blocks(load: &str) -> String {
    format!(
        "dimension = 3\nphysics = \"elasticity\"\n[grid]\nbodies = [5, 4, 4]\nsize = [5, 4, 4]\n\
         subdomains = 1\nelements_per_subdomain = 2\nyoung = 1000\npoisson = 0.3\n{load}\n\
         dirichlet = {{ bottom = 0, left = {{ x = 0 }}, right = {{ x = 0 }}, front = {{ z = 0 }}, \
         back = {{ z = 0 }} }}\n[interface]\ndefault = \"contact\"\n"
    )
}

const WEIGHTS: [ProjectorKind; 3] = [
    ProjectorKind::Identity,
    ProjectorKind::Diagonal,
    ProjectorKind::Preconditioner,
];

/// Blocks that are pushed to all sides, and heights that are pushed up and down: rows open, and others must hold bodies
/// that have lost theirs.
fn scenes() -> [(&'static str, String); 2] {
    let pushed = "traction = { top = [0, \"-max(0, sin(2*x)*cos(1.5*z))\", 0] }\n\
                  load = [\"0.5*sin(1 + 1.7*bi + 2.3*bj + 3.1*bk)\", -0.05, \
                  \"0.5*cos(1 + 2.7*bi + 1.3*bj + 2.1*bk)\"]";
    let wall =
        "[grid]\nbodies = [14, 13]\nsize = [14, 13]\nsubdomains = 1\nelements_per_subdomain = 2\n\
                dirichlet = [\"right\", \"top\"]\nload = \"0.1 + cos(pi*x)*sin(1 + bi + 2.3*bj)\"\n\
                [interface]\ndefault = \"contact\"\n";
    [("blocks", blocks(pushed)), ("wall", wall.into())]
}

/// Energies agree with the reference's to 1e-8, KKT residuals are below 1e-8.
fn agree(session: &Session, kinds: &[ContactType]) -> Result<()> {
    for (name, text) in scenes() {
        let scene = Scene::parse(name, &text)?;
        let problem = Assembled::of_scene(&scene);
        let reference: Reference = problem.solve();
        for &kind in kinds {
            let what = (&scene, &problem, &reference);
            let title = format!("{name}, {}", kind.name());
            let agreement = contact_judge::judge(session, what, false, kind)
                .map_err(|why| Error::input(format!("{title}: {why}")))?;
            if session.rank() == 0 {
                println!("{title}: {agreement:?}");
            }
        }
    }
    Ok(())
}

/// The wall with coefficients 1 and 1e4 in a checkerboard, with every weight: the factor of GᵀQG is the crate's own.
fn agree_with_jumps(session: &Session, weights: &[ProjectorKind]) -> Result<()> {
    let [_, (_, text)] = scenes();
    let jump = "rho = { checkerboard = [1, 1e4], by = \"body\" }\n[interface]";
    let scene = Scene::parse("jumps", &text.replace("[interface]", jump))?;
    let problem = Assembled::of_scene(&scene);
    let reference: Reference = problem.solve();
    for &projector in weights {
        let how = How {
            projector,
            ..ContactType::ActiveSet.into()
        };
        contact_judge::judge(session, (&scene, &problem, &reference), false, how)
            .map_err(|why| Error::input(format!("Q = {}: {why}", projector.name())))?;
    }
    Ok(())
}

/// The blocks that are pushed to all sides, with coefficients from 1 to 10⁵ from element to element: `auto` leaves
/// eigenvalues that it would deflate in fewer bodies, and says so; with deflation the energy is the same to 1e-8.
fn deflation_is_declined(session: &Session) -> Result<()> {
    let [(name, text), _] = scenes();
    let noise = "young = \"10^(5*mod(43758.5453*sin(12.9898*x + 78.233*y + 37.719*z), 1))\"";
    let scene = Scene::parse(name, &text.replace("young = 1000", noise))?;
    let share = fetifeti::share(session, scene.n_subdomains());
    let solve = |deflate: bool| {
        let mut settings = Settings::default();
        settings.method.rtol = 1e-9;
        let rows = scene.substructures(&|s| share.contains(&s))?;
        let mut solver = FetiFeti::new(session, rows, settings)?;
        if deflate {
            solver.deflate()?;
        }
        let solution = solver.solve()?;
        let found = solver
            .deflated()
            .map_or(0, |cost| cost.vectors.iter().sum());
        Ok::<_, Error>((
            solution.converged(),
            solution.energy,
            found,
            solver.deflation_declined(),
        ))
    };
    let (plain, deflated) = (solve(false)?, solve(true)?);
    let left = plain
        .3
        .is_some_and(|(seen, from)| 15.0 < seen && seen < from);
    let apart = (plain.1 - deflated.1).abs() / plain.1.abs();
    let ended = plain.0 && deflated.0;
    if ended && left && plain.2 == 0 && deflated.2 > 0 && deflated.3.is_none() && apart < 1e-8 {
        Ok(())
    } else {
        Err(Error::input(format!(
            "left {plain:?}, deflated {deflated:?}"
        )))
    }
}

/// Four blocks at a corner of the top are pushed up, at once, or after a solution for other loads from which the search
/// for forces begins.
fn refused(session: &Session) -> Result<()> {
    let up = "load = [0, \"0.5*(bi > 2.5)*(bj > 2.5)*(bk > 1.5) - 0.01\", 0]";
    let scene = Scene::parse("up", &blocks(up))?;
    let before = Scene::parse("before", &scenes()[0].1)?;
    let share = fetifeti::share(session, scene.n_subdomains());
    let of = |scene: &Scene| scene.substructures(&|s| share.contains(&s));
    for (kind, later) in KINDS.iter().flat_map(|&k| [(k, false), (k, true)]) {
        let mut settings = Settings::default();
        settings.contact.kind = kind;
        let rows = of(&scene)?;
        let (loads, gaps): (Vec<_>, Vec<_>) = (
            rows.local.iter().map(|s| s.f.clone()).collect(),
            rows.rows.iter().map(|r| r.gap).collect(),
        );
        let mut solver = FetiFeti::new(session, if later { of(&before)? } else { rows }, settings)?;
        let warm = later
            .then(|| solver.solve())
            .transpose()?
            .map(|s| s.warm_start());
        solver.set_loads(loads, &gaps);
        let said = match solver.solve_from(warm.as_ref(), &mut |_, _| Ok(())) {
            Ok(solution) => format!("solved, {}", solution.status),
            Err(error) => error.to_string(),
        };
        let who = "bodies \"b3_3_2\", \"b4_3_2\", \"b3_3_3\", \"b4_3_3\" are pushed away for ever";
        if !said.contains(who) {
            return Err(Error::input(format!("{kind:?}, later {later}: {said}")));
        }
    }
    Ok(())
}

#[test]
fn many_motions_on_one_rank() {
    mpi::alone(|| {
        with_session(|session| {
            agree(session, &KINDS).unwrap();
            agree_with_jumps(session, &WEIGHTS).unwrap();
            deflation_is_declined(session).unwrap();
            refused(session).unwrap();
        });
    });
}

/// In the sample some on two ranks and others on four.
#[test]
fn many_motions_on_two_and_four_ranks() {
    let started = mpi::as_rank(|session, _| {
        let turn = |ranks: usize| session.size() == ranks || all_cases();
        if turn(4) {
            agree(session, &KINDS[..1])?;
        }
        if turn(2) {
            agree_with_jumps(session, &WEIGHTS[2..])?;
            refused(session)?;
        }
        Ok(())
    });
    for ranks in [2, 4] {
        let out = started.run(ranks, "many");
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
    }
}
