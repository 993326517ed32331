//! Tables of the study, and conclusions in words.

use super::{IterationSeconds, Limit, Point, Prediction, Report, Row, SetupSeconds, Work};
use crate::report::tables::table::{fixed, scientific, value, Align, Table};

/// A number with three digits; a dash for zero.
fn short(x: f64) -> String {
    match x {
        x if x <= 0.0 => "–".into(),
        x if (1e-3..1e5).contains(&x) => {
            let digits = (2 - x.log10().floor() as i32).max(0) as usize;
            format!("{x:.digits$}")
        }
        x => format!("{x:.1e}"),
    }
}

/// Seconds as milliseconds.
fn ms(seconds: f64) -> String {
    short(1e3 * seconds)
}

/// Seconds as microseconds.
fn us(seconds: f64) -> String {
    short(1e6 * seconds)
}

fn percent(deviation: f64) -> String {
    format!("{:+.0}", 100.0 * deviation)
}

/// Ranks, with a star where there are more than cores.
fn ranks(p: &Point) -> String {
    format!("{}{}", p.ranks, if p.oversubscribed { "*" } else { "" })
}

/// The description of a run: the first columns of both tables.
fn what(p: &Point) -> [String; 6] {
    [
        p.series.name().into(),
        p.problem.name().into(),
        ranks(p),
        p.bodies.to_string(),
        p.subdomains.to_string(),
        p.elements.to_string(),
    ]
}

const WHAT: [&str; 6] = ["series", "problem", "ranks", "bodies", "subdomains", "el"];

fn table(header: impl IntoIterator<Item = &'static str>) -> Table {
    Table::new(header)
        .align(0, Align::Left)
        .align(1, Align::Left)
}

fn runs(report: &Report) -> Table {
    let more = [
        "rows of B",
        "floating",
        "it",
        "κ",
        "set-up s",
        "solve s",
        "MB",
        "messages",
        "kB",
        "all-reduces",
    ];
    let mut out = table(WHAT.into_iter().chain(more));
    for p in &report.points {
        let c = &p.communication;
        let more = [
            p.multipliers.to_string(),
            p.floating_bodies.to_string(),
            p.iterations.to_string(),
            fixed(p.kappa, 2),
            fixed(Some(p.total[0]), 3),
            fixed(Some(p.total[1]), 3),
            fixed(Some(p.memory_mb[0] - p.memory_mb[1]), 0),
            fixed(Some(c.messages_per_iteration.max), 0),
            fixed(Some(1e-3 * c.bytes_per_iteration.max), 1),
            fixed(Some(c.reductions_per_iteration), 1),
        ];
        out.row(what(p).into_iter().chain(more));
    }
    out
}

/// Names of the phases with a mark in front.
fn marked(mark: &str, names: &[&str]) -> Vec<String> {
    names.iter().map(|n| format!("{mark} {n}")).collect()
}

fn phases(report: &Report) -> Table {
    let mut header: Vec<String> = WHAT.map(String::from).to_vec();
    header.extend(marked("S", &SetupSeconds::NAMES));
    header.push("model %".into());
    header.extend(marked("I", &IterationSeconds::NAMES));
    header.push("model %".into());
    let mut out = Table::new(header)
        .align(0, Align::Left)
        .align(1, Align::Left);
    for p in &report.points {
        let mut cells = what(p).to_vec();
        cells.extend(p.setup.all().map(ms));
        cells.push(percent(p.setup_deviation));
        cells.extend(p.iteration.all().map(us));
        cells.push(percent(p.iteration_deviation));
        out.row(cells);
    }
    out
}

fn laws(report: &Report) -> Table {
    let header = ["phase", "seconds", "runs", "median off %", "largest off %"];
    let mut out = table(header);
    for law in &report.model.laws {
        let terms = law.terms.iter().zip(&law.seconds);
        let sum: Vec<String> = terms
            .filter(|(_, c)| **c > 0.0)
            .map(|(t, c)| match t.as_str() {
                "1" => scientific(Some(*c)),
                t => format!("{} {t}", scientific(Some(*c))),
            })
            .collect();
        out.row([
            law.phase.clone(),
            sum.join(" + "),
            law.points.to_string(),
            fixed(Some(100.0 * law.median_deviation), 0),
            fixed(Some(100.0 * law.largest_deviation), 0),
        ]);
    }
    out
}

fn messages(report: &Report) -> Table {
    let mut out = table(["what", "ranks", "bytes", "µs", "model µs"]);
    let net = &report.network;
    for t in &net.messages {
        let model = net.network.messages(1.0, t.bytes as f64);
        out.row([
            "message".into(),
            t.ranks.to_string(),
            t.bytes.to_string(),
            us(t.seconds),
            us(model),
        ]);
    }
    for (t, model) in net.reductions.iter().zip(&net.modelled_reductions) {
        let star = if t.ranks > report.cores { "*" } else { "" };
        out.row([
            "all-reduce".into(),
            format!("{}{star}", t.ranks),
            t.bytes.to_string(),
            us(t.seconds),
            us(*model),
        ]);
    }
    out
}

fn prediction(p: &Prediction) -> Table {
    let mut header: Vec<String> = ["ranks", "unknowns", "r", "MB of r x r"]
        .map(String::from)
        .to_vec();
    header.extend(marked("S", &SetupSeconds::NAMES));
    header.extend(marked("I", &IterationSeconds::NAMES));
    let sums = ["set-up s", "iteration ms", "total s", "without r s"];
    header.extend(sums.map(String::from));
    let mut out = Table::new(header);
    for row in &p.rows {
        let s = &row.seconds;
        let mut cells = vec![
            row.ranks.to_string(),
            scientific(Some(row.unknowns)),
            row.kernels.to_string(),
            short(1e-6 * row.replicated_bytes),
        ];
        cells.extend(s.setup.all().map(ms));
        cells.extend(s.iteration.all().map(us));
        cells.extend([
            short(s.setup.sum()),
            ms(s.iteration.sum()),
            short(row.total),
            short(row.without_kernels),
        ]);
        out.row(cells);
    }
    out
}

/// Sentences about the limits of scaling.
fn limits(p: &Prediction) -> String {
    let course = |limits: &[Limit]| {
        let one = |(k, limit): (usize, &Limit)| match k {
            0 => limit.phase.clone(),
            _ => format!("from {} ranks on {}", limit.from, limit.phase),
        };
        let all: Vec<String> = limits.iter().enumerate().map(one).collect();
        all.join("; ")
    };
    let mut out = format!(
        "The longest phase of an iteration: {}.\nThe longest phase of all: {}",
        course(&p.iteration_limits),
        course(&p.limits)
    );
    let last = p.rows.last().map_or(0, |r| r.ranks);
    out += &match p.doubles_at {
        Some(at) => format!(
            ".\nFrom {at} ranks on the whole takes more than twice as long as on {} ranks, \
             at {last} ranks {} times as long",
            p.rows[0].ranks,
            growth(p)
        ),
        None => format!(
            ".\nUp to {last} ranks the whole takes less than twice as long as on {} ranks ({} times)",
            p.rows[0].ranks,
            growth(p)
        ),
    };
    out += &match p.full_at {
        Some(at) => format!(
            ".\nFrom {at} ranks on the dense matrices of order r, which every rank has, need more than \
             4 GB per rank during set-up: beyond that this set-up is not possible, whatever it takes.\n"
        ),
        None => format!(
            ".\nThe dense matrices of order r, which every rank has, need less than 4 GB per rank \
             up to {last} ranks.\n"
        ),
    };
    out
}

fn growth(p: &Prediction) -> String {
    let ends = p.rows.first().zip(p.rows.last());
    value(ends.map_or(1.0, |(a, b)| b.total / a.total))
}

/// All tables and sentences for terminals.
pub fn text(report: &Report) -> String {
    let net = report.network.network;
    let [s, e] = report.body;
    let mut out = format!(
        "Runs on {} cores, one thread per rank, no two subdomains equal; \
         * more ranks than cores: messages are counted, seconds mean nothing.\n\
         messages, kB: of the rank that sends most, in an iteration\n\n{}\n\
         Set-up by phase in milliseconds (S), an iteration in microseconds (I); \
         model %: how far the model is off. It is fitted to the tied runs on one rank.\n\n{}\n\
         Fitted seconds of a phase on one rank, relative deviations over the runs; \
         beyond: times the part of what is read that is beyond {:.1} MB of cache\n\n{}\n\
         Messages on this machine: α = {} s, β = {} s per byte, fitted to the messages, \
         γ = {} s per byte added up, fitted to the all-reduces on 2 ranks\n\n{}\n",
        report.cores,
        runs(report),
        phases(report),
        1e-6 * report.model.cache,
        laws(report),
        scientific(Some(net.alpha)),
        scientific(Some(net.beta)),
        scientific(Some(net.gamma)),
        messages(report),
    );
    for p in &report.predictions {
        out += &format!(
            "Predicted, network \"{}\": α = {} s, β = {} s per byte. A body of {s} x {s} subdomains \
             of {e} x {e} elements on every rank, {} iterations (those of {} bodies). \
             Set-up by phase in ms (S), an iteration in µs (I); without r: without what GᵀQG costs\n\n{}{}\n",
            p.network_name,
            scientific(Some(p.network.alpha)),
            scientific(Some(p.network.beta)),
            report.iterations,
            report.iterations_of,
            prediction(p),
            limits(p)
        );
    }
    out
}

fn exact(x: f64) -> String {
    match x.is_finite() {
        true => x.to_string(),
        false => String::new(),
    }
}

/// All runs for programs.
pub fn points_csv(report: &Report) -> Table {
    let first = [
        "series",
        "problem",
        "ranks",
        "oversubscribed",
        "fitted",
        "bodies",
        "floating_bodies",
        "subdomains",
        "elements",
        "multipliers",
        "iterations",
        "steps",
        "kappa",
        "setup_total",
        "solve_total",
        "solve_outside",
        "memory_mb",
        "memory_at_start_mb",
        "messages_sum",
        "messages_max",
        "bytes_sum",
        "bytes_max",
        "reductions",
        "reduced_bytes",
    ];
    let mut header: Vec<String> = first.map(String::from).to_vec();
    for of in ["measured", "model"] {
        header.extend(marked(&format!("{of} set-up"), &SetupSeconds::NAMES));
        header.extend(marked(&format!("{of} iteration"), &IterationSeconds::NAMES));
    }
    header.extend(marked("work", &Work::NAMES));
    let mut out = Table::new(header);
    for p in &report.points {
        let c = &p.communication;
        let mut cells = vec![
            p.series.name().into(),
            p.problem.name().into(),
            p.ranks.to_string(),
            p.oversubscribed.to_string(),
            p.fitted.to_string(),
            p.bodies.to_string(),
            p.floating_bodies.to_string(),
            p.subdomains.to_string(),
            p.elements.to_string(),
            p.multipliers.to_string(),
            p.iterations.to_string(),
            p.steps.to_string(),
            p.kappa.map(exact).unwrap_or_default(),
        ];
        let numbers = [
            p.total[0],
            p.total[1],
            p.outside,
            p.memory_mb[0],
            p.memory_mb[1],
            c.messages_per_iteration.sum,
            c.messages_per_iteration.max,
            c.bytes_per_iteration.sum,
            c.bytes_per_iteration.max,
            c.reductions_per_iteration,
            c.reduced_bytes_per_iteration,
        ];
        cells.extend(numbers.map(exact));
        for (setup, iteration) in [
            (&p.setup, &p.iteration),
            (&p.model.setup, &p.model.iteration),
        ] {
            cells.extend(setup.all().map(exact));
            cells.extend(iteration.all().map(exact));
        }
        cells.extend(p.work.all().map(exact));
        out.row(cells);
    }
    out
}

/// The predictions for programs.
pub fn prediction_csv(report: &Report) -> Table {
    let first = [
        "network",
        "alpha",
        "beta",
        "ranks",
        "unknowns",
        "r",
        "replicated_bytes",
    ];
    let mut header: Vec<String> = first.map(String::from).to_vec();
    header.extend(marked("set-up", &SetupSeconds::NAMES));
    header.extend(marked("iteration", &IterationSeconds::NAMES));
    header.extend(["outside", "total", "without_kernels"].map(String::from));
    let mut out = Table::new(header);
    let all = report.predictions.iter();
    for (p, row) in all.flat_map(|p| p.rows.iter().map(move |r: &Row| (p, r))) {
        let mut cells = vec![
            p.network_name.clone(),
            exact(p.network.alpha),
            exact(p.network.beta),
            row.ranks.to_string(),
            exact(row.unknowns),
            row.kernels.to_string(),
            exact(row.replicated_bytes),
        ];
        cells.extend(row.seconds.setup.all().map(exact));
        cells.extend(row.seconds.iteration.all().map(exact));
        cells.extend([row.seconds.outside, row.total, row.without_kernels].map(exact));
        out.row(cells);
    }
    out
}
