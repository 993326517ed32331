//! `study scaling --quick`: counts, bounded iterations, a model that is finite and positive, residuals, and the files.

use crate::support::keys::{self, Keys};
use crate::support::{mpi, program};
use lab::study::scaling::{ScalingPoint, ScalingProblem, ScalingReport, ScalingSeries, RANKS};
use mpi::Scratch;
use program::{fetifeti, run_fetifeti};

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study quick cores network points model body iterations iterations_of predictions"),
    ("network", "messages reductions modelled_reductions network median_deviation largest_deviation"),
    ("network.network", "alpha beta gamma"),
    (
        "points[]",
        "series problem ranks oversubscribed fitted bodies floating_bodies subdomains elements \
         multipliers iterations steps kappa setup iteration outside total memory_mb work communication \
         model setup_deviation iteration_deviation",
    ),
    ("points[].communication", "messages_per_iteration bytes_per_iteration reductions_per_iteration"),
    ("model", "laws cache"),
    ("model.laws[]", "phase terms seconds points median_deviation largest_deviation misfit residuals"),
    ("predictions[]", "network_name network rows limits iteration_limits doubles_at full_at"),
    ("predictions[].rows[]", "ranks kernels unknowns replicated_bytes seconds total without_kernels"),
    ("predictions[].limits[]", "from phase"),
];

fn runs(
    report: &ScalingReport,
    series: ScalingSeries,
    problem: ScalingProblem,
) -> Vec<&ScalingPoint> {
    let of = report.points.iter();
    of.filter(|p| p.series == series && p.problem == problem)
        .collect()
}

#[test]
fn counts_and_model() {
    let dir = Scratch::new("study-scaling");
    let (file, out) = (dir.path("report.json"), dir.path(""));
    let run = fetifeti(&[
        "study", "scaling", "--quick", "--quiet", "--json", &file, "--out", &out,
    ]);
    assert_eq!(run.code, 0, "{}", run.all());
    assert_eq!(run.stdout, "");
    let text = std::fs::read_to_string(&file).expect("a report");
    let report: ScalingReport = keys::read(&text, KEYS);

    sends(&report);
    grows(&report);
    fits(&report);
    predicts(&report);
    let files = ["scaling", "scaling-model"].map(|stem| ["csv", "png", "svg"].map(|e| (stem, e)));
    for (stem, end) in files.concat() {
        let file = dir.path(&format!("{stem}.{end}"));
        let size = std::fs::metadata(&file).map_or(0, |m| m.len());
        assert!(size > 500, "{file}: {size} bytes");
    }
    let csv = std::fs::read_to_string(dir.path("scaling.csv")).expect("a table");
    assert_eq!(csv.lines().count(), 1 + report.points.len());
    let columns = csv.lines().next().map_or(0, |l| l.split(',').count());
    assert!(csv.lines().all(|l| l.split(',').count() == columns));
}

/// Messages depend on ranks and scenes.
fn sends(report: &ScalingReport) {
    for p in &report.points {
        let c = &p.communication;
        let (messages, bytes) = (c.messages, c.bytes);
        assert_eq!(p.oversubscribed, p.ranks > report.cores);
        assert!(p.work.subdomains * p.ranks as f64 >= p.subdomains as f64);
        assert!(p.work.kernels as usize >= p.floating_bodies.min(1));
        if p.ranks == 1 {
            assert_eq!((messages.sum, bytes.sum, c.reductions), (0.0, 0.0, 0.0));
            continue;
        }
        assert!(messages.max <= messages.sum && bytes.max <= bytes.sum);
        assert!(messages.sum <= messages.max * p.ranks as f64);
        assert!(bytes.sum >= 8.0 * messages.sum);
        // CG: three all-reduces and, at times, a first norm. With floating bodies: four more.
        let floats = if p.floating_bodies > 0 { 4.0 } else { 0.0 };
        let reductions = c.reductions - floats;
        let most = 3.0 + p.steps as f64 / p.iterations as f64;
        assert!((3.0..=most + 1e-9).contains(&reductions), "{p:?}");
    }
    // The body in the middle of 3 × 3 sends λ and the jump of λ, around F and around M⁻¹, to each of at most eight
    // neighbours.
    let middle = runs(report, ScalingSeries::Neighbours, ScalingProblem::Tied)[0];
    let most = middle.communication.messages.max;
    assert!((8.0..=32.0).contains(&most), "{most}");
    assert_eq!(
        (middle.ranks, middle.bodies, middle.floating_bodies),
        (9, 9, 1)
    );
}

/// The number of iterations is bounded as bodies are added, and does not depend on ranks.
fn grows(report: &ScalingReport) {
    let growing = runs(report, ScalingSeries::Bodies, ScalingProblem::Tied);
    assert_eq!(growing.iter().map(|p| p.subdomains).max(), Some(256));
    for p in &growing {
        assert!(p.iterations > 3 && p.iterations < 30, "{p:?}");
        assert!(p.kappa.is_some_and(|k| k > 1.0 && k < 20.0), "{p:?}");
    }
    let one = |size: usize| {
        let of = growing.iter().filter(|p| p.subdomains == size * p.bodies);
        of.map(|p| p.iterations).collect::<Vec<_>>()
    };
    // From 64 to 256 bodies.
    let largest = one(1);
    assert!(largest[2] <= largest[1] + 2, "{largest:?}");
    for problem in [ScalingProblem::Tied, ScalingProblem::Contact] {
        let strong = runs(report, ScalingSeries::Strong, problem);
        assert_eq!(
            strong.iter().map(|p| p.ranks).collect::<Vec<_>>(),
            [1, 2, 4]
        );
        let its = strong.iter().map(|p| p.iterations);
        let spread = its.clone().max().zip(its.min()).map(|(a, b)| a - b);
        assert!(spread.is_some_and(|s| s <= 1), "{problem:?}");
    }
}

fn positive(x: f64) -> bool {
    x.is_finite() && x > 0.0
}

/// Every phase has a law with its residuals, and every run has the deviation of the model.
fn fits(report: &ScalingReport) {
    assert_eq!(report.model.laws.len(), 13);
    for law in &report.model.laws {
        assert_eq!(law.terms.len(), law.seconds.len());
        assert!(
            law.points >= 5 && law.residuals.len() == law.points,
            "{law:?}"
        );
        assert!(law.seconds.iter().all(|c| c.is_finite() && *c >= 0.0));
        assert!(law.seconds.iter().any(|c| *c > 0.0), "{law:?}");
        assert!(law
            .residuals
            .iter()
            .all(|(y, fitted)| positive(*y) && positive(*fitted)));
        assert!(law.median_deviation <= law.largest_deviation);
    }
    for p in &report.points {
        assert_eq!(p.fitted, p.ranks == 1 && p.problem == ScalingProblem::Tied);
        assert!(positive(p.setup.sum()) && positive(p.iteration.sum()));
        assert!(positive(p.model.setup.sum()) && positive(p.model.iteration.sum()));
        let off = p.model.iteration.sum() / p.iteration.sum() - 1.0;
        assert!((off - p.iteration_deviation).abs() < 1e-12 * (1.0 + off.abs()));
        assert!(p.setup_deviation.is_finite());
    }
    let net = report.network.network;
    assert!(positive(net.alpha) && net.beta >= 0.0 && net.gamma >= 0.0);
    assert_eq!(report.network.messages.len(), 8);
    assert_eq!(
        report.network.reductions.len(),
        report.network.modelled_reductions.len()
    );
    assert!(report.network.reductions.iter().any(|t| t.ranks == 4));
}

fn predicts(report: &ScalingReport) {
    assert_eq!(report.predictions.len(), 2);
    let stated = &report.predictions[0].network;
    assert_eq!((stated.alpha, stated.beta), (1.5e-6, 8e-11));
    for prediction in &report.predictions {
        let ranks: Vec<usize> = prediction.rows.iter().map(|r| r.ranks).collect();
        assert_eq!(ranks, RANKS);
        for pair in prediction.rows.windows(2) {
            // Where ranks begin to share the factor, messages take the place of all-reduces.
            assert!(positive(pair[0].total) && pair[1].total >= 0.9 * pair[0].total);
            assert!(pair[1].kernels > pair[0].kernels);
        }
        for row in &prediction.rows {
            let iterations = report.iterations as f64;
            let sum = row.seconds.setup.sum() + row.seconds.outside;
            let sum = sum + iterations * row.seconds.iteration.sum();
            assert!((sum / row.total - 1.0).abs() < 1e-12);
            assert!(positive(row.without_kernels) && row.without_kernels <= row.total);
        }
        assert!(!prediction.limits.is_empty() && !prediction.iteration_limits.is_empty());
        // A sparse factor of order 10⁶ has some 2 GB, of which a rank has its part; its order every rank has.
        assert_eq!(prediction.full_at, None);
        let last = prediction.rows.last().map(|r| r.replicated_bytes);
        assert!(last.is_some_and(|b| (1e8..4e8).contains(&b)), "{last:?}");
    }
}

#[test]
fn mistakes_are_one_sentence() {
    for (args, part) in [
        (&["-scaling_alpha", "0"][..], "-scaling_alpha is 0"),
        (&["-scaling_beta", "-1e-9"], "-scaling_beta is -0.000000001"),
        (&["-scaling_beta", "fast"], "-scaling_beta"),
        (&["-compare_time_limit", "0"], "-compare_time_limit is 0"),
        (&["strong"], "\"strong\" was not expected"),
        (&["--rounds", "3"], "--rounds"),
    ] {
        let run = fetifeti(&[&["study", "scaling", "--quick"], args].concat());
        assert_eq!(run.code, 2, "{args:?}: {}", run.all());
        assert!(run.stderr.contains(part), "{args:?}: {}", run.all());
        assert_eq!(run.stderr.trim().lines().count(), 1, "{}", run.all());
    }
    let run = run_fetifeti(2, &["study", "scaling", "--quick"]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(run.stderr.contains("2 ranks"), "{}", run.all());
}

#[test]
fn a_task_that_no_study_has_written_is_refused() {
    let dir = Scratch::new("study-scaling-task");
    let file = dir.file("task.json", "{\"result\": \"x\"}");
    let run = fetifeti(&["measure", &file]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(run.stderr.contains("task.json") && run.stderr.contains("study scaling"));
}

#[test]
fn a_run_that_fails_is_named() {
    // Too few iterations are allowed, in every run.
    let run = fetifeti(&["study", "scaling", "--quick", "-fetifeti_ksp_max_it", "2"]);
    assert_eq!(run.code, 1, "{}", run.all());
    assert!(run.stderr.contains("4 x 4 bodies"), "{}", run.all());
    assert!(run.stderr.contains("did not converge"), "{}", run.all());
}
