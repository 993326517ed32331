//! `fetifeti plan`: describes what the solver will build for a scene, and why.

use std::fmt::Write;

use super::args::PlanArguments;
use super::coefficient::Coefficient;
use super::doubts;
use super::first_rank::on_first_rank;
use super::physics;
use super::plan_record::report;
use super::plan_tables::{bodies, interfaces, LIST};
use super::record::adaptive;
use super::solve::lines;
use base::Result;
use fetifeti::inside::{groups, watch, ProblemSizes, JUMPS};
use fetifeti::settings::{Adaptive, MethodSettings};
use fetifeti::{FetiFeti, Problem};
use parallel::team::Team;
use petsc::Session;
use report::destination::Destination;
use scene::{distribution, fits, Scene};

/// Validates the scene and prints the plan.
pub fn run(session: &Session, args: PlanArguments) -> Result<()> {
    let destination = Destination {
        json: args.json,
        ..Destination::default()
    };
    let scene = distribution::load(session, &args.scene)?;
    session.agree(fits::solved(
        session,
        &scene,
        &args.scene.display().to_string(),
    ))?;
    on_first_rank(session, || destination.prepare())?;
    let substructures = distribution::substructures(session, &scene)?;
    let settings = MethodSettings::default().with_options(session)?;
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let team = Team::new(if session.size() == 1 { threads } else { 1 })?;
    let sizes = ProblemSizes::with(session, &substructures, &team, settings.primal)?;
    let coefficient = Coefficient::of(session, &scene)?;
    let mut out = text(&scene, &sizes, &coefficient);
    let _ = writeln!(out, "{:<22}{}", "", of_a_solve(session, &scene));
    for group in groups(session, substructures.clone(), &settings) {
        let _ = writeln!(
            out,
            "{:<22}{group}: one body for the method, without the rows between them",
            "merged"
        );
    }
    let deflation = deflation(session, substructures, settings, &coefficient)?;
    let _ = writeln!(out, "{:<22}{deflation}", "adaptive");
    let record = report(session, &scene, &sizes)?;
    on_first_rank(session, || {
        destination.print(&out)?;
        destination.write_json("plan.json", &record)
    })
}

/// A sentence on the memory that a solve takes.
fn of_a_solve(session: &Session, scene: &Scene) -> String {
    let each = match session.size() {
        1 => "",
        _ => " on each rank",
    };
    let needed = fits::size(fits::needed(session, scene));
    format!("about {needed} for a solve{each}")
}

/// The effect of `-fetifeti_adaptive`. Where the solver is sure to search, the search is carried out here, and the
/// subdomains are factored for it. Collective.
fn deflation(
    session: &Session,
    problem: Problem,
    settings: MethodSettings,
    coefficient: &Coefficient,
) -> Result<String> {
    let contrast = coefficient.contrast();
    match settings.adaptive {
        Adaptive::Off => return Ok("off".into()),
        Adaptive::Auto if contrast <= JUMPS => {
            let limit = watch(settings.adaptive, contrast).unwrap_or(f64::INFINITY);
            return Ok(format!(
                "auto: none, unless the iterations see eigenvalues above {limit}"
            ));
        }
        _ => {}
    }
    let mut solver = FetiFeti::new(session, problem, settings)?;
    solver.deflate()?;
    let Some(adaptive) = adaptive(&solver)? else {
        return Ok("none".into());
    };
    let Some(report) = &adaptive.deflation else {
        return Ok(adaptive.constraints_text());
    };
    let names = &solver.method().problem().body_names;
    let counts = report.by_body.iter().zip(names).filter(|c| *c.0 > 0);
    let listed: Vec<String> = counts
        .clone()
        .take(LIST)
        .map(|(n, b)| format!("{b} {n}"))
        .collect();
    let more = counts.count().saturating_sub(LIST);
    let mut out = report.text();
    if adaptive.constraints.iter().any(|n| *n > 0) {
        out = format!("{}\n{:<22}{out}", adaptive.constraints_text(), "");
    }
    if !listed.is_empty() {
        let rest = if more > 0 {
            format!(" and {more} more bodies")
        } else {
            String::new()
        };
        let _ = write!(out, "\n{:<22}{}{rest}", "", listed.join(", "));
    }
    if solver.settings().method.spectrum {
        if let Some(s) = solver.spectrum()? {
            let _ = write!(out, "\n{:<22}κ with them {:.4}", "", s.kappa());
        }
    }
    Ok(out)
}

fn text(scene: &Scene, sizes: &ProblemSizes, coefficient: &Coefficient) -> String {
    let plan = scene.plan();
    let mut out = lines(&scene.sentences());
    let so =
        "a load that drives this has no answer, and without one the place along it is arbitrary";
    out += &lines(&doubts::free(&doubts::recorded(scene, &sizes.free), so));
    for warning in &scene.warnings {
        let _ = writeln!(out, "Warning: {warning}");
    }
    let _ = writeln!(out, "{}\n", plan.title);
    out += &bodies(&plan, sizes);
    out += &interfaces(scene, &plan);
    if scene.dim() == 3 || scene.form.is_elastic() {
        let _ = writeln!(out, "{:<22}{}", "physics", physics::form(scene));
    }
    let _ = writeln!(out, "{:<22}{}", "coefficient", coefficient.text(scene));
    out += &decisions(scene, &plan, sizes);
    out
}

fn decisions(scene: &Scene, plan: &scene::ScenePlan, sizes: &ProblemSizes) -> String {
    let mut out = String::new();
    let mut line = |what: &str, text: String| {
        let _ = writeln!(out, "{what:<22}{text}");
    };
    let (n_bodies, n_subdomains) = (plan.bodies.len(), plan.subdomains);
    line(
        "size",
        format!(
            "{} elements, {} dofs in {n_bodies} bodies of {n_subdomains} subdomains ({} unknowns if assembled)",
            plan.elements, plan.dofs, plan.assembled
        ),
    );
    line(
        "multipliers",
        format!(
            "{} inside bodies, {} between them, {} of those hold at the start",
            sizes.multipliers_local, sizes.multipliers_global, sizes.multipliers_active
        ),
    );
    line(
        "outer loop",
        match sizes.inequalities {
            0 => "none: no inequality".into(),
            n => format!("active set: {n} inequalities ({})", inequalities(plan)),
        },
    );
    if let Some(steps) = plan.steps {
        line(
            "load steps",
            format!("{steps}, each starts from the solution of the last"),
        );
        if scene.is_renewed() {
            line("renewed", renewed(scene, plan));
        }
    }
    let floating = sizes.defect.iter().filter(|d| **d > 0).count();
    line(
        "projector",
        match floating {
            0 => "none: no body floats".into(),
            n => format!(
                "natural coarse problem of size {}: {n} of {n_bodies} bodies float{}",
                sizes.defect.iter().sum::<usize>(),
                kernels(scene, sizes)
            ),
        },
    );
    line(
        "primal problem",
        match sizes.primal {
            0 => "none: every body is one subdomain".into(),
            n => constraints(scene, plan, n, sizes.largest_primal),
        },
    );
    let method = match (n_bodies, n_subdomains == n_bodies) {
        (1, true) => "direct: one body of one subdomain",
        (1, false) => "FETI-DP: one body",
        (_, true) => "one-level FETI: one subdomain per body",
        _ => "FETI-FETI: FETI-DP inside the bodies, one-level FETI between them",
    };
    line("method", method.into());
    let (kind, why) = (sizes.preconditioner.kind, sizes.preconditioner.why);
    line(
        "preconditioner",
        format!("{} ({}): {why}", kind.pc_type.name(), kind.symbol),
    );
    line(
        "factorisations",
        format!(
            "{} for {n_subdomains} subdomains: equal ones share theirs",
            sizes.kinds
        ),
    );
    if sizes.implicit_kinds > 0 {
        line(
            "operators",
            format!(
                "{} as sparse solves, the others as dense matrices: what costs less in the memory that there is",
                sizes.implicit_kinds
            ),
        );
    }
    let [factors, dense] = [sizes.factor_bytes, sizes.dense_bytes].map(|b| b / 1e6);
    line(
        "memory",
        format!(
            "{factors:.1} MB sparse factors, {dense:.1} MB dense operators (largest interface {} dofs)",
            sizes.largest_interface
        ),
    );
    out
}

/// A sentence with the number of bodies that float in all their rigid motions, and in some of them.
fn kernels(scene: &Scene, sizes: &ProblemSizes) -> String {
    if !scene.form.is_elastic() {
        return String::new();
    }
    let all = scene.form.rigid(scene.dim()).len();
    let freely = sizes.defect.iter().filter(|d| **d == all).count();
    let partly = sizes
        .defect
        .iter()
        .filter(|d| (1..all).contains(*d))
        .count();
    let part = |n: usize, text: String| (n > 0).then(|| format!("{n} {text}"));
    let parts = [
        part(freely, format!("in all {all} rigid motions")),
        part(partly, "in some".into()),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    format!(", {}", parts.join(", "))
}

/// A sentence on the primal constraints: vertices that subdomains share, corners where bodies may touch, averages.
fn constraints(scene: &Scene, plan: &scene::ScenePlan, primal: usize, largest: usize) -> String {
    if scene.dim() == 2 && !scene.form.is_elastic() {
        return format!("{primal} vertices, at most {largest} in a body");
    }
    let edges: usize = plan.bodies.iter().map(|b| b.edges).sum();
    let averages = match edges {
        0 => String::new(),
        n => format!("; subdomains share {n} edges, counted by component"),
    };
    format!(
        "{primal} constraints, at most {largest} in a body; {} at vertices inside bodies{averages}",
        plan.primal
    )
}

/// A sentence on what load steps renew.
fn renewed(scene: &Scene, plan: &scene::ScenePlan) -> String {
    let [renewed, kept] = scene.renewed_pairs();
    let mut out = format!(
        "at each load step normals, pairing and gaps of {renewed} contact pairs and {} obstacles, where the last step \
         left the bodies; ties and stiffness stay",
        plan.obstacles
    );
    if kept > 0 {
        let _ = write!(
            out,
            ", and so do {kept} pairs that are tied in part or meet in a corner"
        );
    }
    out
}

/// A sentence on the inequalities.
fn inequalities(plan: &scene::ScenePlan) -> String {
    let count = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    let contact = format!(
        "{} in {}",
        count(plan.contact_rows, "candidate node"),
        count(plan.contact_pairs, "contact pair")
    );
    let obstacles = format!(
        "{} beside {}",
        count(plan.obstacle_rows, "node"),
        count(plan.obstacles, "obstacle")
    );
    match (plan.contact_pairs, plan.obstacles) {
        (_, 0) => contact,
        (0, _) => obstacles,
        _ => format!("{contact}, {obstacles}"),
    }
}
