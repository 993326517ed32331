//! The command-line program.
fn main() {
    std::process::exit(0)
}
