//! The command-line program.

fn main() {
    std::process::exit(fetifeti::cli::main())
}
