//! `make soak`: random scenes from successive seeds, until the time is up. A scene is named by its seed.
//!
//!     soak FIRST SECONDS COUNT         scenes from seed FIRST on; 0: no limit of seconds or of scenes
//!     soak --print SEED DIR            writes the scene of a seed into a directory
//!
//! On standard output a line for every scene: what it has come to, its seed, seconds, the error or a reason. A scene
//! that takes longer than two minutes ends the program with exit code 4, one that crashes it with another; the seed
//! stands in the file SOAK_SEED of the environment. Files of scenes lie in SOAK_DIR. scripts/soak.sh counts.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use fetifeti_cli::soak::{fate, write, Fate};
use base::Result;
use petsc::Session;

/// Seconds after which a scene hangs.
const LIMIT: u64 = 120;

static BEGUN: AtomicU64 = AtomicU64::new(0);

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize| args.get(k).and_then(|a| a.parse().ok()).unwrap_or(0);
    if args.first().is_some_and(|a| a == "--print") {
        let dir = args.get(2).map_or(".", String::as_str);
        let path = write(number(1), Path::new(dir)).expect("a directory that can be written");
        println!("{}", path.display());
        return;
    }
    let session = Session::new(&[], "").expect("PETSc starts");
    let code = session.run(|session| run(session, number(0), number(1), number(2)));
    // MPI has to be finalised, or mpirun takes the end of a rank for a failure.
    drop(session);
    std::process::exit(code);
}

fn watch(start: Instant) {
    std::thread::spawn(move || loop {
        std::thread::sleep(Duration::from_secs(1));
        if start.elapsed().as_secs() > BEGUN.load(Ordering::Relaxed) + LIMIT {
            std::process::exit(4);
        }
    });
}

fn run(session: &Session, first: u64, seconds: u64, count: u64) -> Result<()> {
    let (start, mut seed) = (Instant::now(), first);
    let dir: PathBuf = std::env::var_os("SOAK_DIR").map_or(std::env::temp_dir(), PathBuf::from);
    let noted = std::env::var_os("SOAK_SEED");
    watch(start);
    loop {
        let up = seconds > 0 && start.elapsed().as_secs() >= seconds;
        let mut ends = [f64::from(up || (count > 0 && seed - first >= count))];
        parallel::exchange::max_all(session.comm(), &mut ends);
        if ends[0] > 0.0 {
            break;
        }
        BEGUN.store(start.elapsed().as_secs(), Ordering::Relaxed);
        if let (Some(file), 0) = (&noted, session.rank()) {
            let _ = std::fs::write(file, seed.to_string());
        }
        let clock = Instant::now();
        let fate = fate(session, seed, &dir);
        let taken = clock.elapsed().as_secs_f64();
        let (kind, why) = match fate {
            Fate::Right(error) => ("right", format!("{error:.1e}")),
            Fate::Refused(why) => ("refused", why),
            Fate::NoSolution(why) => ("no_solution", why),
            Fate::Undecided(why) => ("undecided", why),
            Fate::NotConverged(why) => ("not_converged", why),
            Fate::Wrong(why) => ("wrong", why),
        };
        if session.rank() == 0 {
            println!("{kind} {seed} {taken:.2} {}", why.replace('\n', " "));
        }
        seed += 1;
    }
    Ok(())
}
