//! Tables of the study, and conclusions in words.

use super::{
    IterationSeconds, Law, PhaseLimit, PredictedRow, Prediction, ScalingPoint, ScalingReport,
    SetupSeconds, Timing, Work,
};
use report::tables::table::{fixed, scientific, value, Columns, Table};

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
fn ranks(ranks: usize, crowded: bool) -> String {
    format!("{ranks}{}", if crowded { "*" } else { "" })
}

/// The runs with their description, the first columns of two tables.
fn described(report: &ScalingReport) -> Columns<&ScalingPoint> {
    Table::of(&report.points)
        .words("series", |p| p.series.name())
        .words("problem", |p| p.problem.name())
        .numbers("ranks", |p| ranks(p.ranks, p.oversubscribed))
        .numbers("bodies", |p| p.bodies)
        .numbers("subdomains", |p| p.subdomains)
        .numbers("el", |p| p.elements)
}

fn runs(report: &ScalingReport) -> Table {
    described(report)
        .numbers("rows of B", |p| p.multipliers)
        .numbers("floating", |p| p.floating_bodies)
        .numbers("it", |p| p.iterations)
        .numbers("κ", |p| fixed(p.kappa, 2))
        .numbers("set-up s", |p| fixed(Some(p.total[0]), 3))
        .numbers("solve s", |p| fixed(Some(p.total[1]), 3))
        .numbers("MB", |p| fixed(Some(p.memory_mb[0] - p.memory_mb[1]), 0))
        .numbers("messages", |p| fixed(Some(p.communication.messages.max), 0))
        .numbers("kB", |p| fixed(Some(1e-3 * p.communication.bytes.max), 1))
        .numbers("all-reduces", |p| {
            fixed(Some(p.communication.reductions), 1)
        })
        .table()
}

/// Adds a column for each of the numbers of a record; `mark` stands in front of their names.
fn each<R, const N: usize>(
    mut table: Columns<R>,
    mark: &str,
    names: [&str; N],
    numbers: impl Fn(&R) -> [f64; N],
    text: fn(f64) -> String,
) -> Columns<R> {
    for (k, name) in names.into_iter().enumerate() {
        table = table.numbers(format!("{mark} {name}"), |r| text(numbers(r)[k]));
    }
    table
}

fn phases(report: &ScalingReport) -> Table {
    let table = described(report);
    let table = each(table, "S", SetupSeconds::NAMES, |p| p.setup.all(), ms);
    let table = table.numbers("model %", |p| percent(p.setup_deviation));
    let table = each(
        table,
        "I",
        IterationSeconds::NAMES,
        |p| p.iteration.all(),
        us,
    );
    table
        .numbers("model %", |p| percent(p.iteration_deviation))
        .table()
}

fn laws(report: &ScalingReport) -> Table {
    let term = |(term, seconds): (&String, &f64)| match term.as_str() {
        "1" => scientific(Some(*seconds)),
        term => format!("{} {term}", scientific(Some(*seconds))),
    };
    let sum = |law: &Law| {
        let terms = law.terms.iter().zip(&law.seconds);
        let terms: Vec<String> = terms.filter(|t| *t.1 > 0.0).map(term).collect();
        terms.join(" + ")
    };
    Table::of(&report.model.laws)
        .words("phase", |law| &law.phase)
        .words("seconds", |law| sum(law))
        .numbers("runs", |law| law.points)
        .numbers("median off %", |law| {
            fixed(Some(100.0 * law.median_deviation), 0)
        })
        .numbers("largest off %", |law| {
            fixed(Some(100.0 * law.largest_deviation), 0)
        })
        .table()
}

fn messages(report: &ScalingReport) -> Table {
    let net = &report.network;
    let model = |t: &Timing| net.network.messages(1.0, t.bytes as f64);
    let messages = net.messages.iter().map(|t| ("message", t, false, model(t)));
    let reductions = net.reductions.iter().zip(&net.modelled_reductions);
    let reductions = reductions.map(|(t, model)| ("all-reduce", t, t.ranks > report.cores, *model));
    Table::of(messages.chain(reductions))
        .words("what", |(what, ..)| *what)
        .words("ranks", |(_, t, crowded, _)| ranks(t.ranks, *crowded))
        .numbers("bytes", |(_, t, ..)| t.bytes)
        .numbers("µs", |(_, t, ..)| us(t.seconds))
        .numbers("model µs", |(.., model)| us(*model))
        .table()
}

fn prediction(p: &Prediction) -> Table {
    let table = Table::of(&p.rows)
        .numbers("ranks", |r| r.ranks)
        .numbers("unknowns", |r| scientific(Some(r.unknowns)))
        .numbers("r", |r| r.kernels)
        .numbers("MB of GᵀQG", |r| short(1e-6 * r.replicated_bytes));
    let table = each(
        table,
        "S",
        SetupSeconds::NAMES,
        |r| r.seconds.setup.all(),
        ms,
    );
    let iteration = |r: &&PredictedRow| r.seconds.iteration.all();
    each(table, "I", IterationSeconds::NAMES, iteration, us)
        .numbers("set-up s", |r| short(r.seconds.setup.sum()))
        .numbers("iteration ms", |r| ms(r.seconds.iteration.sum()))
        .numbers("total s", |r| short(r.total))
        .numbers("without r s", |r| short(r.without_kernels))
        .table()
}

/// Sentences about the limits of scaling.
fn limits(p: &Prediction) -> String {
    let course = |limits: &[PhaseLimit]| {
        let one = |(k, limit): (usize, &PhaseLimit)| match k {
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
            ".\nFrom {at} ranks on GᵀQG and a rank's part of its factor need more than 4 GB per \
             rank: beyond that this set-up is not possible, whatever it takes.\n"
        ),
        None => format!(
            ".\nGᵀQG and a rank's part of its factor need less than 4 GB per rank up to {last} ranks.\n"
        ),
    };
    out
}

fn growth(p: &Prediction) -> String {
    let ends = p.rows.first().zip(p.rows.last());
    value(ends.map_or(1.0, |(a, b)| b.total / a.total))
}

/// All tables and sentences for terminals.
pub fn text(report: &ScalingReport) -> String {
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

/// As [`each`], for programs.
fn each_exact<R, const N: usize>(
    mut table: Columns<R>,
    mark: &str,
    names: [&str; N],
    numbers: impl Fn(&R) -> [f64; N],
) -> Columns<R> {
    for (k, name) in names.into_iter().enumerate() {
        table = table.exact(format!("{mark} {name}"), |r| numbers(r)[k]);
    }
    table
}

/// All runs for programs.
pub fn points_csv(report: &ScalingReport) -> Table {
    let table = Table::of(&report.points)
        .exact("series", |p| p.series.name())
        .exact("problem", |p| p.problem.name())
        .exact("ranks", |p| p.ranks)
        .exact("oversubscribed", |p| p.oversubscribed)
        .exact("fitted", |p| p.fitted)
        .exact("bodies", |p| p.bodies)
        .exact("floating_bodies", |p| p.floating_bodies)
        .exact("subdomains", |p| p.subdomains)
        .exact("elements", |p| p.elements)
        .exact("multipliers", |p| p.multipliers)
        .exact("iterations", |p| p.iterations)
        .exact("steps", |p| p.steps)
        .exact("kappa", |p| p.kappa)
        .exact("setup_total", |p| p.total[0])
        .exact("solve_total", |p| p.total[1])
        .exact("solve_outside", |p| p.outside)
        .exact("memory_mb", |p| p.memory_mb[0])
        .exact("memory_at_start_mb", |p| p.memory_mb[1])
        .exact("messages_sum", |p| p.communication.messages.sum)
        .exact("messages_max", |p| p.communication.messages.max)
        .exact("bytes_sum", |p| p.communication.bytes.sum)
        .exact("bytes_max", |p| p.communication.bytes.max)
        .exact("reductions", |p| p.communication.reductions)
        .exact("reduced_bytes", |p| p.communication.reduced_bytes);
    let (setup, iteration) = (SetupSeconds::NAMES, IterationSeconds::NAMES);
    let table = each_exact(table, "measured set-up", setup, |p| p.setup.all());
    let table = each_exact(table, "measured iteration", iteration, |p| {
        p.iteration.all()
    });
    let table = each_exact(table, "model set-up", setup, |p| p.model.setup.all());
    let table = each_exact(table, "model iteration", iteration, |p| {
        p.model.iteration.all()
    });
    each_exact(table, "work", Work::NAMES, |p| p.work.all()).table()
}

/// The predictions for programs.
pub fn prediction_csv(report: &ScalingReport) -> Table {
    let all = report.predictions.iter();
    let table = Table::of(all.flat_map(|p| p.rows.iter().map(move |row| (p, row))))
        .exact("network", |(p, _)| p.network_name.as_str())
        .exact("alpha", |(p, _)| p.network.alpha)
        .exact("beta", |(p, _)| p.network.beta)
        .exact("ranks", |(_, r)| r.ranks)
        .exact("unknowns", |(_, r)| r.unknowns)
        .exact("r", |(_, r)| r.kernels)
        .exact("replicated_bytes", |(_, r)| r.replicated_bytes);
    let (setup, iteration) = (SetupSeconds::NAMES, IterationSeconds::NAMES);
    let table = each_exact(table, "set-up", setup, |(_, r)| r.seconds.setup.all());
    each_exact(table, "iteration", iteration, |(_, r)| {
        r.seconds.iteration.all()
    })
    .exact("outside", |(_, r)| r.seconds.outside)
    .exact("total", |(_, r)| r.total)
    .exact("without_kernels", |(_, r)| r.without_kernels)
    .table()
}
